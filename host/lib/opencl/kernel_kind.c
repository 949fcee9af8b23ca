#include "opencl/kernel_kind.h"

#include "sample_types.h"

_Static_assert(SAMPLE_TYPE_COUNT == 8, "kinds are numbered by eight types, here and in KERNEL_KINDS");

unsigned kind_number(kernel_kind k) {
    const unsigned shape = (k.grid * METHOD_COUNT + (unsigned)k.method) * 8 + (unsigned)k.type;
    const unsigned of_third = (shape << CHANNEL_COUNT | k.made) * 4 + 2u * k.missing + k.emits;
    return of_third + (k.interval ? 2 * OPEN_KINDS : k.closed ? OPEN_KINDS : 0);
}

kernel_kind kind_of_number(unsigned n) {
    const unsigned shape = n % OPEN_KINDS >> 2 >> CHANNEL_COUNT;
    return (kernel_kind){.grid = shape / 8 / METHOD_COUNT,
                         .method = (tc_method)(shape / 8 % METHOD_COUNT),
                         .type = (tc_type)(shape % 8),
                         .made = n >> 2 & ((1u << CHANNEL_COUNT) - 1),
                         .missing = n >> 1 & 1,
                         .emits = n & 1,
                         .closed = n / OPEN_KINDS == 1,
                         .interval = n / OPEN_KINDS == 2};
}

kernel_kind kind_of_classify(kernel_kind kind) {
    kind.emits = false;
    kind.made = 0;
    kind.interval = false;
    if (kind.grid != KIND_COMPLEX) kind.grid = 0;
    return kind;
}
