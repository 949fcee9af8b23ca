/* vtk_legacy_array.h - arrays of VTK legacy files */
#ifndef VTK_LEGACY_ARRAY_H
#define VTK_LEGACY_ARRAY_H

#include "vtk_legacy_text.h"

/* The name of a type of values. */
int legacy_type(legacy *r, int *type);

/* Reads tuples * components values and the METADATA behind them, in memory of the dataset. They become values of type
 * `wanted`: the stored type itself (bits: TC_U8; bytes of large binary arrays stay in the mapped file), TC_F32 or
 * TC_F64 (coordinates), TC_F64 (of 64-bit integers), ELEMENT_I64 (of any integers) or TC_U8 (of TC_I32). *unfit is the
 * number of values that it cannot hold, or that are not finite, rounded, or out of range; it may be NULL where nothing
 * is converted. With out NULL they are only skipped, and may be text too. `what` names the array in failures. */
int legacy_array(legacy *r, const char *what, int type, int64_t tuples, int64_t components, int wanted, void **out,
                 uint64_t *unfit);

#endif
