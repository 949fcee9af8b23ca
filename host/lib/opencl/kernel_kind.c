#include "opencl/kernel_kind.h"

#include "sample_types.h"

_Static_assert(SAMPLE_TYPE_COUNT == 8, "kinds are numbered by eight types, here and in KERNEL_KINDS");

unsigned kind_number(kernel_kind k) {
    return ((((k.grid * 8 + (unsigned)k.type) * 2 + k.hybrid) * 2 + k.missing) * 2 + k.normals) * 2 + k.emits;
}

kernel_kind kind_of_number(unsigned n) {
    return (kernel_kind){.grid = n >> 7, .type = (tc_type)(n >> 4 & 7), n >> 3 & 1, n >> 2 & 1, n >> 1 & 1, n & 1};
}

kernel_kind kind_of_classify(kernel_kind kind) {
    kind.emits = kind.normals = false;
    if (kind.grid != KIND_COMPLEX) kind.grid = 0;
    return kind;
}
