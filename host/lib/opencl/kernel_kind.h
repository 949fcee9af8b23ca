/*
 * kernel_kind.h - the kind of a call's kernels: each kind is built, tried and judged separately
 */
#ifndef KERNEL_KIND_H
#define KERNEL_KIND_H

#include "base/channels.h"
#include "kernels/base/methods.h"
#include "tetracubes.h"

#include <stdbool.h>

typedef struct kernel_kind {
    unsigned grid; /* as grid_kind, KIND_COMPLEX, or KIND_LABELS; kernel 1 of structured grids is the same for all: 0 */
    tc_type type;
    tc_method method;
    channel_set made;    /* by kernel 2 */
    bool missing, emits; /* emits: kernel 2 too */
    bool closed;         /* surfaces are closed */
    bool interval;       /* an interval volume is made, by TC_METHOD_TETRA */
} kernel_kind;

enum {
    KIND_COMPLEX = 3,
    KIND_LABELS = 4,
    OPEN_KINDS = (5 * 8 * METHOD_COUNT * 2 * 2)
                 << CHANNEL_COUNT, /* open surfaces; closed ones and interval volumes have as many each */
    KERNEL_KINDS = 3 * OPEN_KINDS
};

/* A number below KERNEL_KINDS, and back. Its lowest bits: emits, missing; its thirds: open, closed, interval. */
unsigned kind_number(kernel_kind kind);
kernel_kind kind_of_number(unsigned number);

/* The kind without kernel 2. */
kernel_kind kind_of_classify(kernel_kind kind);

#endif
