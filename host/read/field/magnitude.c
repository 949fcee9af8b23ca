/* magnitude.c - the Euclidean length of tuples; see magnitude.h */
#include "field/magnitude.h"

#include "sample_types.h"

#include <float.h>
#include <math.h>

tc_type magnitude_type(tc_type type) { return type_is_wide(type) ? TC_F64 : TC_F32; }

/* Of values whose squares, or their sum, no double holds: they are divided by the greatest first. */
static double scaled_length(tc_type type, const void *values, uint64_t first, int components) {
    double greatest = 0, sum = 0;
    for (int c = 0; c < components; c++) greatest = fmax(greatest, fabs(value_at(type, values, first + (uint64_t)c)));
    if (greatest == 0) return 0;
    for (int c = 0; c < components; c++) {
        double share = value_at(type, values, first + (uint64_t)c) / greatest;
        sum += share * share;
    }
    return greatest * sqrt(sum);
}

static double length_of(tc_type type, const void *values, uint64_t first, int components) {
    double sum = 0;
    for (int c = 0; c < components; c++) {
        double value = value_at(type, values, first + (uint64_t)c);
        sum += value * value;
    }
    int is_safe = sum > DBL_MIN / DBL_EPSILON && sum <= DBL_MAX;
    return is_safe || isnan(sum) ? sqrt(sum) : scaled_length(type, values, first, components);
}

void magnitude_of(tc_type type, const void *values, int components, uint64_t count, void *lengths) {
    tc_type wanted = magnitude_type(type);
    for (uint64_t n = 0; n < count; n++) {
        double length = length_of(type, values, n * (uint64_t)components, components);
        if (wanted == TC_F64)
            ((double *)lengths)[n] = length;
        else
            ((float *)lengths)[n] = length > (double)FLT_MAX && isfinite(length) ? FLT_MAX : (float)length;
    }
}
