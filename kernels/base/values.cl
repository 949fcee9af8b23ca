/*
 * values.cl - samples and the isovalue as numbers
 *
 * From the build: REAL (float for u8 i8 u16 i16 f32, double for u32 i32 f64), where the device makes vertices; WIDE, 1
 * for double; SAMPLE_VALUE(bits), of type REAL.
 */
#ifndef VALUES_CL
#define VALUES_CL

#include "common.cl"

#if WIDE
#define ISOVALUE(test) as_double((test)->isovalue64)
#else
#define ISOVALUE(test) ((test)->isovalue32)
#endif

#endif
