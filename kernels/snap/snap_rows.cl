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

/* The first sample of a brick of the window. */
typedef struct brick_place {
    uint w, y, z;
} brick_place;

inline_always brick_place brick_place_of(const slab *s, uint number) {
    brick_place p = {number % s->words_x, number / s->words_x % s->bricks_y * BRICK_ROWS,
                     s->results.word_z + number / s->words_x / s->bricks_y * BRICK_PLANES};
    return p;
}

/* From the number of a brick of the window to those of the bricks beside it, modulo 2^32: by step plus 1. */
typedef struct brick_steps {
    uint word[3], row[3], layer[3];
} brick_steps;

/* A step across the window's border stays. */
inline_always brick_steps brick_steps_of(const slab *s, uint number) {
    const uint w = number % s->words_x, row = number / s->words_x % s->bricks_y;
    const uint layer_size = s->bricks_y * s->words_x, layer = number / layer_size;
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
