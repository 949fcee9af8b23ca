/*
 * sample_types.h - the table of sample types (host/README.md says what else a new one needs)
 *
 * A list is a macro that applies ROW to every row, so that tables, and switches whose loops are of one C type each,
 * are made of it:
 *
 *     ROW(type, name, c_type, least, most, cl_bits, cl_value)
 *
 *     name      of tc_type_name, and of the option --type
 *     c_type    of a sample in memory, which its size and sign follow from
 *     cl_bits   the kernels' type for a sample's bits: OpenCL's unsigned integer of that size
 *     cl_value  such bits, b, as the number that crossings are interpolated with: float, of wide types double
 *
 * What files call them stands in stored_types.h.
 */
#ifndef SAMPLE_TYPES_H
#define SAMPLE_TYPES_H

#include "tetracubes.h"

#include <float.h>
#include <stddef.h>
#include <stdint.h>

/* clang-format off */
#define INTEGER_TYPES(ROW)                                                                                             \
    ROW(TC_U8,  u8,  uint8_t,  0,         UINT8_MAX,  uchar,  (float)(b))                                              \
    ROW(TC_I8,  i8,  int8_t,   INT8_MIN,  INT8_MAX,   uchar,  (float)as_char(b))                                       \
    ROW(TC_U16, u16, uint16_t, 0,         UINT16_MAX, ushort, (float)(b))                                              \
    ROW(TC_I16, i16, int16_t,  INT16_MIN, INT16_MAX,  ushort, (float)as_short(b))                                      \
    ROW(TC_U32, u32, uint32_t, 0,         UINT32_MAX, uint,   (double)(b))                                             \
    ROW(TC_I32, i32, int32_t,  INT32_MIN, INT32_MAX,  uint,   (double)as_int(b))

#define REAL_TYPES(ROW)                                                                                                \
    ROW(TC_F32, f32, float,    -FLT_MAX,  FLT_MAX,    uint,   as_float(b))                                             \
    ROW(TC_F64, f64, double,   -DBL_MAX,  DBL_MAX,    ulong,  as_double(b))
/* clang-format on */

#define SAMPLE_TYPES(ROW) INTEGER_TYPES(ROW) REAL_TYPES(ROW)

/* tc_type counts them from 0 without a gap. */
#define TYPE_COUNTED(...) +1
enum { SAMPLE_TYPE_COUNT = 0 SAMPLE_TYPES(TYPE_COUNTED) };
#undef TYPE_COUNTED
_Static_assert(SAMPLE_TYPE_COUNT == TC_F64 + 1, "a type of tetracubes.h has no row here, or more than one");

/* Bytes of a sample; 0 where it is none of the types. */
static inline size_t sample_bytes(tc_type type) {
    switch (type) {
#define TYPE_CASE(type, name, c_type, ...)                                                                             \
    case type:                                                                                                         \
        return sizeof(c_type);
        SAMPLE_TYPES(TYPE_CASE)
#undef TYPE_CASE
    }
    return 0;
}

/* Sets of types: bit t stands for type t. Real types are of floating point, so that samples may be NaN or infinite.
 * Wide types have values that float32 does not hold; they are interpolated in double. */
#define TYPE_REAL(type, ...)                       | 1u << type
#define TYPE_WIDE_INTEGER(type, name, c_type, ...) | (sizeof(c_type) > sizeof(uint16_t)) << type
#define TYPE_WIDE_REAL(type, name, c_type, ...)    | (sizeof(c_type) > sizeof(float)) << type
enum {
    REAL_TYPE_SET = 0 REAL_TYPES(TYPE_REAL),
    WIDE_TYPE_SET = 0 INTEGER_TYPES(TYPE_WIDE_INTEGER) REAL_TYPES(TYPE_WIDE_REAL)
};
#undef TYPE_REAL
#undef TYPE_WIDE_INTEGER
#undef TYPE_WIDE_REAL

static inline int type_is_real(tc_type type) { return REAL_TYPE_SET >> (unsigned)type & 1; }

static inline int type_is_wide(tc_type type) { return WIDE_TYPE_SET >> (unsigned)type & 1; }

/* Value n of an array, exact. The type has to be one of the table. */
static inline double value_at(tc_type type, const void *values, uint64_t n) {
    switch (type) {
#define TYPE_CASE(type, name, c_type, ...)                                                                             \
    case type:                                                                                                         \
        return (double)((const c_type *)values)[n];
        SAMPLE_TYPES(TYPE_CASE)
#undef TYPE_CASE
    }
    __builtin_unreachable();
}

#endif
