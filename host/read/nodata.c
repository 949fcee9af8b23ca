#include "nodata.h"

#include <math.h>

static int is_whole(double value, double least, double most) {
    return value >= least && value <= most && value == floor(value);
}

int nodata_of_type(tc_type type, double typed, double *value) {
    *value = typed;
    switch (type) {
    case TC_U8:
        return is_whole(typed, 0, UINT8_MAX);
    case TC_I8:
        return is_whole(typed, INT8_MIN, INT8_MAX);
    case TC_U16:
        return is_whole(typed, 0, UINT16_MAX);
    case TC_I16:
        return is_whole(typed, INT16_MIN, INT16_MAX);
    case TC_U32:
        return is_whole(typed, 0, UINT32_MAX);
    case TC_I32:
        return is_whole(typed, INT32_MIN, INT32_MAX);
    case TC_F32:
        if (!isfinite((float)typed)) return 0;
        *value = (double)(float)typed;
        return 1;
    case TC_F64:
        return isfinite(typed);
    }
    return 0;
}

#define FIND(c_type)                                                                                                   \
    {                                                                                                                  \
        const c_type *at = values, wanted = (c_type)value;                                                             \
        while (n < count && at[n] != wanted) n++;                                                                      \
    }                                                                                                                  \
    break

uint64_t nodata_find(tc_type type, const void *values, uint64_t count, double value) {
    uint64_t n = 0;
    switch (type) {
    case TC_U8:
        FIND(uint8_t);
    case TC_I8:
        FIND(int8_t);
    case TC_U16:
        FIND(uint16_t);
    case TC_I16:
        FIND(int16_t);
    case TC_U32:
        FIND(uint32_t);
    case TC_I32:
        FIND(int32_t);
    case TC_F32:
        FIND(float);
    case TC_F64:
        FIND(double);
    }
    return n;
}
