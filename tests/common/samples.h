/*
 * samples.h - samples of every type as doubles
 */
#ifndef SAMPLES_H
#define SAMPLES_H

#include "tetracubes.h"

#include <float.h>
#include <stdbool.h>

static inline double sample_get(const void *samples, tc_type type, int64_t n) {
    switch (type) {
    case TC_U8:
        return ((const uint8_t *)samples)[n];
    case TC_I8:
        return ((const int8_t *)samples)[n];
    case TC_U16:
        return ((const uint16_t *)samples)[n];
    case TC_I16:
        return ((const int16_t *)samples)[n];
    case TC_U32:
        return ((const uint32_t *)samples)[n];
    case TC_I32:
        return ((const int32_t *)samples)[n];
    case TC_F32:
        return (double)((const float *)samples)[n];
    default:
        return ((const double *)samples)[n];
    }
}

/* Integers truncate towards zero; what the type cannot hold is the caller's mistake. */
static inline void sample_set(void *samples, tc_type type, int64_t n, double value) {
    switch (type) {
    case TC_U8:
        ((uint8_t *)samples)[n] = (uint8_t)value;
        break;
    case TC_I8:
        ((int8_t *)samples)[n] = (int8_t)value;
        break;
    case TC_U16:
        ((uint16_t *)samples)[n] = (uint16_t)value;
        break;
    case TC_I16:
        ((int16_t *)samples)[n] = (int16_t)value;
        break;
    case TC_U32:
        ((uint32_t *)samples)[n] = (uint32_t)value;
        break;
    case TC_I32:
        ((int32_t *)samples)[n] = (int32_t)value;
        break;
    case TC_F32:
        ((float *)samples)[n] = (float)value;
        break;
    default:
        ((double *)samples)[n] = value;
        break;
    }
}

static inline bool type_is_floating(tc_type type) { return type >= TC_F32; }

/* Least and greatest finite values. */
static inline double type_least(tc_type type) {
    static const double least[] = {0, INT8_MIN, 0, INT16_MIN, 0, INT32_MIN, -FLT_MAX, -DBL_MAX};
    return least[type];
}

static inline double type_most(tc_type type) {
    static const double most[] = {UINT8_MAX, INT8_MAX, UINT16_MAX, INT16_MAX, UINT32_MAX, INT32_MAX, FLT_MAX, DBL_MAX};
    return most[type];
}

#endif
