/*
 * sample.h - one sample of any type as a double, exactly
 */
#ifndef SAMPLE_H
#define SAMPLE_H

#include "tetracubes.h"

static inline double sample_at(const void *samples, tc_type type, uint64_t n) {
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

#endif
