/*
 * program.h - the programs of kernels, built when first asked for, owned by the context
 */
#ifndef PROGRAM_H
#define PROGRAM_H

#include "opencl/context.h"

/* Each is one text with all that it includes (embed.cmake), in either variant (variant.h). */
typedef enum program_name {
    PROGRAM_CLASSIFY,
    PROGRAM_EMIT,
    PROGRAM_SNAP,
    PROGRAM_COMPLEX,
    PROGRAM_WHOLE,
    PROGRAM_COMPLEX_CAPS,     /* closes surfaces of PROGRAM_COMPLEX and PROGRAM_WHOLE */
    PROGRAM_COMPLEX_INTERVAL, /* interval volumes of PROGRAM_COMPLEX */
    PROGRAM_LABELS,
    PROGRAM_INTERVAL,
    PROGRAM_COUNT
} program_name;

/* Where the program of kernel 1 has more than that kernel: cells_mark, where samples may be missing. */
enum { KERNEL_CELLS = 1 };

tc_status program_get(tc_context *context, program_name name, kernel_kind kind, const program **out);

/* What was built here goes to the cache, as its kernels have run now. */
void programs_release(tc_context *context);

/* All sources of kernels, for a key: the same text, the same number. */
uint64_t kernel_sources_hash(void);

#endif
