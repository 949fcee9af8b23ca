/* vtk_legacy_array.h - arrays of VTK legacy files */
#ifndef VTK_LEGACY_ARRAY_H
#define VTK_LEGACY_ARRAY_H

#include "vtk_legacy/vtk_legacy_text.h"

/* The name of a type of values. */
int legacy_type(legacy *r, int *type);

/* Reads tuples * components values, and the METADATA after them, into memory of the dataset. `wanted` is the type that
 * they get:
 *
 *     the stored type   of any array. Bits are read as TC_U8. Large binary arrays stay in the mapped file
 *     TC_F32, TC_F64    of coordinates
 *     TC_F64            of 64-bit integers
 *     ELEMENT_I64       of any integers
 *     TC_U8             of TC_I32
 *
 * *unfit: how many values are out of its range, rounded, or not finite; unfit may be NULL where nothing is converted.
 * Where out is NULL the values, which may also be strings, are only skipped. `what` names the array in messages. */
int legacy_array(legacy *r, const char *what, int type, int64_t tuples, int64_t components, int wanted, void **out,
                 uint64_t *unfit);

#endif
