/*
 * kernels.h - the kernels for a call, from programs that are vetted (vetting.h) and built when first asked for
 */
#ifndef KERNELS_H
#define KERNELS_H

#include "opencl/context.h"

/* A kernel, and the work-items per group that it was built for. */
typedef struct sized_kernel {
    cl_kernel kernel;
    uint32_t work_items;
} sized_kernel;

/* In the order in which they run. */
enum { SNAP_SIGN, SNAP_NEAR, SNAP_VIOLATED, SNAP_WORDS, SNAP_PASS_EVEN, SNAP_PASS_ODD, SNAP_JOIN, SNAP_KERNELS };

typedef struct kernels {
    sized_kernel classify, cells, emit; /* cells: where samples may be missing */
    sized_kernel snap[SNAP_KERNELS];    /* method snap */
    sized_kernel interval_count, interval_emit;
} kernels;

/* Of structured grids: kernel 1, and kernel 2 too where the kind emits; of interval volumes their own instead. */
tc_status kernels_get(tc_context *context, kernel_kind kind, kernels *out);

/* Of complexes: all of them, in the order of complex_job.h; of cells that are kept whole by TC_METHOD_HYBRID; of
 * interval volumes their own instead. */
tc_status complex_kernels_get(tc_context *context, kernel_kind kind, sized_kernel out[ALL_COMPLEX_KERNELS]);

/* Of label maps: kernel 1 and kernel 2. */
enum { LABEL_CLASSIFY, LABEL_EMIT, LABEL_KERNELS };
tc_status label_kernels_get(tc_context *context, kernel_kind kind, sized_kernel out[LABEL_KERNELS]);

typedef struct kernel_argument {
    size_t bytes;
    const void *value;
} kernel_argument;

#define ARGUMENT(x)                                                                                                    \
    { sizeof(x), &(x) }

/* Sets one argument after the other, then enqueues as many groups of the kernel's work-items as the context launches.
 * name: for the error. */
tc_status kernel_launch(const tc_context *context, sized_kernel kernel, const char *name,
                        const kernel_argument *arguments, cl_uint argument_count);

#endif
