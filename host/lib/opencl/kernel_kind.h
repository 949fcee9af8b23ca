/*
 * kernel_kind.h - the kind of a call's kernels: each kind is built, tried and judged separately
 */
#ifndef KERNEL_KIND_H
#define KERNEL_KIND_H

#include "tetracubes.h"

#include <stdbool.h>

typedef struct kernel_kind {
    unsigned grid; /* as grid_kind, or KIND_COMPLEX; kernel 1 of structured grids is the same for all: 0 */
    tc_type type;
    bool hybrid, missing, normals, emits; /* emits: kernel 2 too */
} kernel_kind;

enum { KIND_COMPLEX = 3, KERNEL_KINDS = 4 * 8 * 2 * 2 * 2 * 2 };

/* A number below KERNEL_KINDS, and back. */
unsigned kind_number(kernel_kind kind);
kernel_kind kind_of_number(unsigned number);

/* The kind without kernel 2. */
kernel_kind kind_of_classify(kernel_kind kind);

#endif
