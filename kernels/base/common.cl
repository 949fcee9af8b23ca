/*
 * common.cl - what all kernels begin with
 *
 * There are two variants of the kernels. One is for groups of work-items: plain OpenCL C 1.2, vectors of 2, 3, 4, 8 and
 * 16 elements, which every compiler takes and which can be translated to SPIR-V. The other is for a work-item alone
 * in its group, for CPUs: extensions.cl holds what it needs beyond OpenCL C. Files named _groups or _alone, and others
 * that say so, belong to one variant, the rest to both. host/lib/opencl/variant.c chooses that of a device.
 *
 * The build defines (host/lib/opencl/program.c):
 *
 *     WORK_ITEMS          of a group; 1: the variant for a work-item alone
 *     BITS                the unsigned type as wide as a sample
 *     FLOATING            the width of samples that are floating; else 0
 *     FP64, WIDE          the device has double; samples need more than float
 *     REAL, SAMPLE_VALUE  the type in which t is computed, and a sample in it; undefined where the host makes vertices
 *     DIVISION            how crossing.cl divides
 *     GRID                where positions come from: grid_kind of host/lib/grid/grid.h
 *     METHOD              a name in methods.h
 *     MISSING, CLOSED, NORMALS, WHOLE   samples may be missing; surfaces are closed; normals are made; cells are kept
 *                         whole
 */
#ifndef COMMON_CL
#define COMMON_CL

#include "slab.h"

#pragma OPENCL FP_CONTRACT OFF
#ifdef FP64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif

/* Two warnings are off. Compilers warn that code for processors with longer registers passes vectors to functions in
 * another way, but all functions are inlined. A loop that is not unrolled as asked is no fault. */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wpsabi"
#pragma clang diagnostic ignored "-Wpass-failed"
#endif

#ifndef CLOSED
#define CLOSED 0
#endif

#define PASTE2(a, b) a##b
#define PASTE(a, b)  PASTE2(a, b)
#define BITS8        PASTE(BITS, 8)
#define BITS16       PASTE(BITS, 16)

#ifndef inline_always /* tools that run kernels unoptimised define it empty */
#define inline_always static inline __attribute__((always_inline, unused))
#endif

#if FLOATING == 32
#define EXPONENT 0x7f800000u
#elif FLOATING == 64
#define EXPONENT 0x7ff0000000000000ul
#endif

#if FLOATING == 32
typedef int signed_bits;
#define SIGNED16 int16
#elif FLOATING == 64
typedef long signed_bits;
#define SIGNED16 long16
#endif

#if WORK_ITEMS == 1
#include "extensions.cl"
#endif

#endif
