/*
 * snap_rows.cl - method snap: LANES rows of samples that are looked at together, their words and those of rows beside
 * them
 */
#ifndef SNAP_ROWS_CL
#define SNAP_ROWS_CL

#include "../base/words.cl"

inline_always uint window_layers(const slab *s) {
    return (s->z1 - s->results.word_z + BRICK_PLANES - 1) / BRICK_PLANES;
}

/* What is added to a brick's index for the bricks beside it, modulo 2^32: element 0 for a step of -1, 1 for none, 2 for
 * +1. */
typedef struct brick_steps {
    uint word[3], row[3], layer[3];
} brick_steps;

/* A step out of the window leads to the brick itself. */
inline_always brick_steps brick_steps_of(const slab *s, uint brick) {
    const uint w = brick % s->words_x, row = brick / s->words_x % s->bricks_y;
    const uint layer_size = s->bricks_y * s->words_x, layer = brick / layer_size;
    brick_steps steps = {{w ? -1u : 0, 0, w + 1 < s->words_x ? 1 : 0},
                         {row ? -s->words_x : 0, 0, row + 1 < s->bricks_y ? s->words_x : 0},
                         {layer ? -layer_size : 0, 0, layer + 1 < window_layers(s) ? layer_size : 0}};
    return steps;
}

/* Rows of a brick. In a dense set: from (y, z) on, one after another in y. In a strided one, of even samples of one
 * colour: rows y, y + 2, y + 4, y + 6 of plane z, then those of plane z + 2. */
typedef struct row_set {
    uint y, z, w;
    lanes at_y, at_z; /* where each row is */
} row_set;

#if WORK_ITEMS == 1
#include "snap_rows_alone.cl"
#else
#include "snap_rows_groups.cl"
#endif

#endif
