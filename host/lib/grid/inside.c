#include "grid/inside.h"

#include "sample_types.h"

#include <float.h>
#include <math.h>
#include <string.h>

static uint32_t bits_of_f32(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static uint64_t bits_of_f64(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static inside_range integer_range(double isovalue, double least, double most) {
    double threshold = ceil(isovalue);
    const bool all = threshold <= least;
    if (threshold > most) return (inside_range){.uniform = true};
    if (all) threshold = least;
    uint64_t flip = least < 0 ? (uint64_t)(int64_t)least : 0; /* the sign bit, and above it what keys do not have */
    uint32_t key = (uint32_t)((uint64_t)(int64_t)threshold - (uint64_t)(int64_t)least);
    return (inside_range){all, all, (uint64_t)(int64_t)threshold, (uint64_t)(most - threshold), flip, key, key};
}

static inside_range f32_range(double isovalue) {
    float threshold = (float)isovalue;
    if ((double)threshold < isovalue) threshold = nextafterf(threshold, INFINITY);
    const bool all = threshold <= -FLT_MAX;
    if (threshold > FLT_MAX) return (inside_range){.uniform = true};
    uint32_t bits = bits_of_f32(threshold), sign = 0x80000000, key = threshold > 0 ? bits | sign : ~(bits | sign);
    if (threshold > 0) return (inside_range){false, false, bits, 0x7fffffff - bits, 0, key, key};
    return (inside_range){all, all, 0, sign | bits, 0, key, key};
}

static inside_range f64_range(double isovalue) {
    const bool all = isovalue <= -DBL_MAX;
    uint64_t bits = bits_of_f64(isovalue), sign = UINT64_C(1) << 63, key = isovalue > 0 ? bits | sign : ~(bits | sign);
    uint32_t below = (uint32_t)(key >> 32), from = below + ((uint32_t)key != 0);
    if (isovalue > 0) return (inside_range){false, false, bits, INT64_MAX - bits, 0, from, below};
    return (inside_range){all, all, 0, sign | bits, 0, from, below};
}

inside_range inside_range_of(tc_type type, double isovalue) {
    switch (type) {
#define RANGE_CASE(type, name, c_type, least, most, ...)                                                               \
    case type:                                                                                                         \
        return integer_range(isovalue, least, most);
        INTEGER_TYPES(RANGE_CASE)
#undef RANGE_CASE
    case TC_F32:
        return f32_range(isovalue);
    case TC_F64:
        return f64_range(isovalue);
    }
    return (inside_range){.uniform = true}; /* no type */
}

static bool integer_pattern(double value, double least, double most, uint64_t patterns[2]) {
    if (!(value >= least && value <= most) || value != floor(value)) return false;
    patterns[0] = patterns[1] = (uint64_t)(int64_t)value;
    return true;
}

isovalue_test isovalue_test_of(inside_range inside, double isovalue) {
    isovalue_test test = {.inside_low = inside.low,
                          .inside_span = inside.span,
                          .key_flip = inside.key_flip,
                          .key_inside = inside.key_inside,
                          .key_outside = inside.key_outside,
                          .isovalue32 = (float)isovalue};
    memcpy(&test.isovalue64, &isovalue, sizeof isovalue);
    return test;
}

bool value_bits(tc_type type, double value, uint64_t patterns[2]) {
    patterns[0] = patterns[1] = 0;
    switch (type) {
#define PATTERN_CASE(type, name, c_type, least, most, ...)                                                             \
    case type:                                                                                                         \
        return integer_pattern(value, least, most, patterns);
        INTEGER_TYPES(PATTERN_CASE)
#undef PATTERN_CASE
    case TC_F32:
        if (!isfinite(value) || (double)(float)value != value) return false;
        patterns[0] = patterns[1] = bits_of_f32((float)value);
        if (value == 0) patterns[0] = 0, patterns[1] = UINT64_C(1) << 31;
        return true;
    case TC_F64:
        if (!isfinite(value)) return false;
        patterns[0] = patterns[1] = bits_of_f64(value);
        if (value == 0) patterns[0] = 0, patterns[1] = UINT64_C(1) << 63;
        return true;
    }
    return false;
}
