/*
 * stored_types.h - the types of numbers that files hold, and what each format calls them
 *
 * They are the sample types, with the same values (sample_types.h), and integers of 64 bits, which become f64. As
 * there, a list is a macro; in the list of names a row is
 *
 *     ROW(type, nrrd, metaimage, nifti, ply, vtk_legacy, vtk_xml)
 *
 *     nrrd, metaimage, vtk_legacy    all its names, with a bar before, between and after them; NRRD files are written
 *                                    with the first
 *     nifti                          nifti1.h's name of the code, which has a meaning only where that is included
 *     ply                            the word of a property
 *
 * Formats whose types are not all here (bits, texts, colours) have the others in tables of their own.
 */
#ifndef STORED_TYPES_H
#define STORED_TYPES_H

#include "sample_types.h"

enum element { ELEMENT_I64 = TC_F64 + 1, ELEMENT_U64, ELEMENT_COUNT };

/* Rows as in sample_types.h; kernels know nothing of these. */
#define LONG_INTEGERS(ROW)                                                                                             \
    ROW(ELEMENT_I64, i64, int64_t, INT64_MIN, INT64_MAX, , )                                                           \
    ROW(ELEMENT_U64, u64, uint64_t, 0, UINT64_MAX, , )
#define STORED_INTEGERS(ROW) INTEGER_TYPES(ROW) LONG_INTEGERS(ROW)
#define STORED_TYPES(ROW)    SAMPLE_TYPES(ROW) LONG_INTEGERS(ROW)

/* clang-format off */
#define STORED_NAMES(ROW)                                                                                              \
    ROW(TC_U8,  "|uint8|uchar|unsigned char|uint8_t|",                                                                 \
                "|MET_UCHAR|",              NIFTI_TYPE_UINT8,   "uchar",  "|unsigned_char|uint8|", "UInt8")            \
    ROW(TC_I8,  "|int8|signed char|int8_t|",                                                                           \
                "|MET_CHAR|MET_ASCII_CHAR|", NIFTI_TYPE_INT8,   "char",   "|char|signed_char|", "Int8")                \
    ROW(TC_U16, "|uint16|ushort|unsigned short|unsigned short int|uint16_t|",                                          \
                "|MET_USHORT|",             NIFTI_TYPE_UINT16,  "ushort", "|unsigned_short|uint16|", "UInt16")         \
    ROW(TC_I16, "|int16|short|short int|signed short|signed short int|int16_t|",                                       \
                "|MET_SHORT|",              NIFTI_TYPE_INT16,   "short",  "|short|", "Int16")                          \
    ROW(TC_U32, "|uint32|uint|unsigned int|uint32_t|",                                                                 \
                "|MET_UINT|MET_ULONG|",     NIFTI_TYPE_UINT32,  "uint",   "|unsigned_int|uint32|", "UInt32")           \
    ROW(TC_I32, "|int32|int|signed int|int32_t|",                                                                      \
                "|MET_INT|MET_LONG|",       NIFTI_TYPE_INT32,   "int",    "|int|vtkIdType|", "Int32")                  \
    ROW(TC_F32, "|float|float32|",                                                                                     \
                "|MET_FLOAT|",              NIFTI_TYPE_FLOAT32, "float",  "|float|", "Float32")                        \
    ROW(TC_F64, "|double|float64|",                                                                                    \
                "|MET_DOUBLE|",             NIFTI_TYPE_FLOAT64, "double", "|double|float64|", "Float64")               \
    ROW(ELEMENT_I64, "|int64|longlong|long long|long long int|signed long long|signed long long int|int64_t|",         \
                "|MET_LONG_LONG|",          NIFTI_TYPE_INT64,   NULL,     "|long|int64|vtktypeint64|", "Int64")        \
    ROW(ELEMENT_U64, "|uint64|ulonglong|unsigned long long|unsigned long long int|uint64_t|",                          \
                "|MET_ULONG_LONG|",         NIFTI_TYPE_UINT64,  NULL,                                                  \
                "|unsigned_long|uint64|unsigned_int64|vtktypeuint64|", "UInt64")
/* clang-format on */

#define ELEMENT_COUNTED(...) +1
_Static_assert(ELEMENT_COUNT == 0 STORED_TYPES(ELEMENT_COUNTED), "a stored type has no row, or more than one");
_Static_assert(ELEMENT_COUNT == 0 STORED_NAMES(ELEMENT_COUNTED), "a stored type has no names, or more than one row");
#undef ELEMENT_COUNTED

/* Bytes of one element; 1 where there is no such type. */
static inline size_t element_bytes(int element) {
    switch (element) {
#define ELEMENT_CASE(element, name, c_type, ...)                                                                       \
    case element:                                                                                                      \
        return sizeof(c_type);
        STORED_TYPES(ELEMENT_CASE)
#undef ELEMENT_CASE
    default: /* nothing is divided by 0 */
        return 1;
    }
}

static inline int element_is_real(int element) {
    return (unsigned)element < SAMPLE_TYPE_COUNT && type_is_real((tc_type)element);
}

/* The type of a field of such elements: the sample type itself, f64 of 64-bit integers. */
static inline tc_type element_sample_type(int element) {
    return element < SAMPLE_TYPE_COUNT ? (tc_type)element : TC_F64;
}

/* Writes the integer of that absolute value and sign as an element in this machine's byte order. Returns 0 where the
 * type cannot hold it, or is of floating point. */
int element_put_integer(int element, uint64_t absolute, int is_negative, void *to);

/* The names of each type, without NIfTI's codes. names_have (header_text.h) searches a list with bars. */
typedef struct stored_names {
    const char *nrrd, *metaimage, *ply, *vtk_legacy, *vtk_xml;
} stored_names;

extern const stored_names stored_types[ELEMENT_COUNT];

#endif
