/*
 * interval_rows.cl - 64 cubes at a time: which of their corners are below, within and above an interval
 */
#ifndef INTERVAL_ROWS_CL
#define INTERVAL_ROWS_CL

#include "../structured/cells.cl"
#include "interval_job.h"
#include "../structured/mesh.cl"

/* What kernel 1 has left of a bound. */
typedef struct bound {
    global const ulong *words, *offsets;
    global const brick_state *bricks;
    ulong fixed; /* the words of all rows where there is no such bound */
    bool exists;
} bound;

inline_always bound bound_of(global const ulong *words, global const ulong *offsets, global const brick_state *bricks,
                             uint exists, ulong fixed_word) {
    bound b = {words + UNIFORM_BRICKS * BRICK_WORDS, offsets, bricks, fixed_word, exists != 0};
    return b;
}

/* The side of a bound that a brick is on. */
inline_always uint bound_sign(const bound *b, uint brick) {
    if (!b->exists) return b->fixed ? SIGN_INSIDE : SIGN_OUTSIDE;
    return b->bricks[brick].sign;
}

/* Whether the brick's cubes have all their corners on one side of a bound. */
inline_always bool brick_is(const slab *s, const bound *b, uint brick, uint sign) {
    const uint x = brick % s->words_x, y = brick / s->words_x % s->bricks_y;
    bool same = true;
    for (uint n = 0; n < 8; n++) {
        const bool exists = x + (n & 1) < s->words_x && y + (n >> 1 & 1) < s->bricks_y;
        const uint beside = brick + (n & 1) + s->words_x * ((n >> 1 & 1) + s->bricks_y * (n >> 2));
        if (exists && beside < s->words_x * s->bricks_y * ((s->z1 - s->z0 + BRICK_PLANES - 1) / BRICK_PLANES))
            same = same && bound_sign(b, beside) == sign;
    }
    return same;
}

/* Samples of a row that are not below the bound; bits past the row's end may be set. */
inline_always ulong bound_word(const slab *s, const bound *b, uint y, uint z, uint w) {
    if (!b->exists) return b->fixed;
    const uint brick = brick_index(s, y, z, w);
    return brick_words(brick, b->bricks[brick].sign, b->words)[row_in_brick(s, y, z)];
}

/* A row of samples, and the same shifted to x + 1; 0 outside the grid and behind the window. */
inline_always sample_rows bound_row(const slab *s, const bound *b, uint y, uint z, uint w) {
    if (y >= s->ny || z >= s->z1) return rows_shifted(0, 0);
    const ulong next = w + 1 < s->words_x ? bound_word(s, b, y, z, w + 1) : 0;
    return rows_shifted(bound_word(s, b, y, z, w) & word_valid(s, w), next);
}

/* The four rows of samples of a row of cubes: y, z; y + 1, z; y, z + 1; y + 1, z + 1. */
typedef struct interval_rows {
    sample_rows low[4], high[4];
} interval_rows;

inline_always interval_rows rows_load(const slab *s, const bound *low, const bound *high, uint y, uint z, uint w) {
    interval_rows r;
#pragma unroll
    for (uint n = 0; n < 4; n++) {
        r.low[n] = bound_row(s, low, y + (n & 1), z + (n >> 1), w);
        r.high[n] = bound_row(s, high, y + (n & 1), z + (n >> 1), w);
    }
    return r;
}

/* Cubes of a row that are there. */
inline_always ulong cubes_present(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
    if (y + 1 >= s->ny || z + 1 >= s->nz) return 0;
#if MISSING
    return cells_at(s, cells, y, z, w);
#else
    return w + 1 < s->words_x ? ~0ul : word_valid(s, w) >> 1;
#endif
}

/* Samples of a row that a present cube has. */
inline_always ulong samples_used(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
#if MISSING
    return cells_before(s, cells, y, z, w) | cells_before(s, cells, y - 1, z, w) | cells_before(s, cells, y, z - 1, w) |
           cells_before(s, cells, y - 1, z - 1, w);
#else
    return ~0ul;
#endif
}

/* Samples within of a row, which are vertices. */
inline_always ulong samples_within(const slab *s, const bound *low, const bound *high, global const ulong *cells,
                                   uint y, uint z, uint w) {
    if (y >= s->ny || z >= s->z1) return 0;
    return bound_word(s, low, y, z, w) & ~bound_word(s, high, y, z, w) & word_valid(s, w) &
           samples_used(s, cells, y, z, w);
}

/* Cubes of which a corner is not below and another not above: those that can have any tetrahedra. */
inline_always ulong cubes_reached(const interval_rows *r, ulong present) {
    ulong any = 0, all = ~0ul;
#pragma unroll
    for (uint n = 0; n < 4; n++) any |= r->low[n].at | r->low[n].next, all &= r->high[n].at & r->high[n].next;
    return any & ~all & present;
}

#endif
