/*
 * inside.h - "sample >= isovalue" as a test on bit patterns, exact for every sample type
 *
 * The isovalue is a double. Samples compare with the smallest value of their type that is >= it. The patterns that are
 * inside form one run of unsigned integers modulo 2^width, so that (bits - low) <= span, unsigned, decides: integers
 * count up from low; floats above 0 order like integers; from a negative float f or 0 on, all patterns from +0 to
 * +infinity and from -0 down to f are inside, which is one run again.
 */
#ifndef INSIDE_H
#define INSIDE_H

#include "kernels/base/slab.h"
#include "tetracubes.h"

#include <stdbool.h>

typedef struct inside_range {
    bool uniform; /* all values of the type are on the same side: no surface, but for a closed one where that is inside
                   */
    bool inside;  /* of uniform: all are inside */
    uint64_t low, span;
    uint64_t key_flip;                /* for integers: see slab.h */
    uint32_t key_inside, key_outside; /* ranges of bricks compare with them: see slab.h */
} inside_range;

inside_range inside_range_of(tc_type type, double isovalue);

/* False where no samples of the type have a surface. */
static inline bool inside_has_surface(inside_range inside, bool closed) {
    return !inside.uniform || (closed && inside.inside);
}

/* The same for the kernels; has_nodata is 0. */
isovalue_test isovalue_test_of(inside_range inside, double isovalue);

/* Bit patterns of samples that equal `value`: two for zero in floating types. False where no sample can equal it. */
bool value_bits(tc_type type, double value, uint64_t patterns[2]);

#endif
