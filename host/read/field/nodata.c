#include "field/nodata.h"

#include "sample_types.h"

#include <math.h>

static int is_whole(double value, double least, double most) {
    return value >= least && value <= most && value == floor(value);
}

int nodata_of_type(tc_type type, double typed, double *value) {
    *value = typed;
    switch (type) {
#define WHOLE_CASE(type, name, c_type, least, most, ...)                                                               \
    case type:                                                                                                         \
        return is_whole(typed, least, most);
        INTEGER_TYPES(WHOLE_CASE)
#undef WHOLE_CASE
    case TC_F32:
        if (!isfinite((float)typed)) return 0;
        *value = (double)(float)typed;
        return 1;
    case TC_F64:
        return isfinite(typed);
    }
    return 0;
}

uint64_t nodata_find(tc_type type, const void *values, uint64_t count, double value) {
    uint64_t n = 0;
    switch (type) {
#define FIND_CASE(type, name, c_type, ...)                                                                             \
    case type: {                                                                                                       \
        const c_type *at = values, wanted = (c_type)value;                                                             \
        while (n < count && at[n] != wanted) n++;                                                                      \
        break;                                                                                                         \
    }
        SAMPLE_TYPES(FIND_CASE)
#undef FIND_CASE
    }
    return n;
}
