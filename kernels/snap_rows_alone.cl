/*
 * snap_rows_alone.cl - for a work-item alone: eight rows of a brick at once
 */
#ifndef SNAP_ROWS_ALONE_CL
#define SNAP_ROWS_ALONE_CL

#include "snap_rows.cl"

/* Sets of a brick: its planes; or one set of the rows of a colour. */
#define SETS_OF_PLANES BRICK_PLANES
#define SETS_SPREAD    1

inline_always row_set set_of_plane(uint y0, uint z0, uint w, uint set) {
    row_set r = {y0, z0 + set, w, LANE_NUMBERS + y0, (lanes)(z0 + set)};
    return r;
}

/* Of the rows that begin at odd_y and odd_z of the brick. */
inline_always row_set set_spread(uint y0, uint z0, uint w, uint set, uint odd_y, uint odd_z) {
    row_set r = {y0 + odd_y, z0 + odd_z, w, (lanes)(0, 2, 4, 6, 0, 2, 4, 6) + (y0 + odd_y),
                 (lanes)(0, 0, 0, 0, 2, 2, 2, 2) + (z0 + odd_z)};
    return r;
}

inline_always bool plane_stored(const slab *s, uint z) { return z >= s->results.word_z && z < s->z1; }

inline_always ulong word_stored(const slab *s, stored_words m, uint y, uint z, uint w, bool zeros) {
    return y < s->ny ? *row_stored(s, m, y, z, w, zeros) : 0; /* y wraps below 0 */
}

/* Rows y, y + 2, y + 4, y + 6 of a plane; y is a step from a row of the brick. */
inline_always ulong4 rows_second(const slab *s, stored_words m, uint y0, uint y, uint z, uint w, bool zeros) {
    if (!plane_stored(s, z)) return 0;
    const lanes all = vload8(0, row_stored(s, m, y0, z, w, zeros));
    if (y == y0) return all.even;
    if (y == y0 + 1) return all.odd;
    if (y == y0 + 2) return (ulong4)(all.even.s123, word_stored(s, m, y0 + BRICK_ROWS, z, w, zeros));
    return (ulong4)(word_stored(s, m, y, z, w, zeros), all.odd.s012);
}

/* Words at w + step_w of the rows a step from those of the set, 0 where there are none; words of a constant brick go on
 * outside the grid. */
inline_always lanes words_beside(const slab *s, stored_words m, row_set r, bool spread, int step_y, int step_z,
                                 int step_w, bool zeros) {
    const uint w = r.w + step_w, z = r.z + step_z, y0 = r.y / BRICK_ROWS * BRICK_ROWS;
    if (w >= s->words_x) return 0; /* w wraps below 0 */
    if (spread)
        return (lanes)(rows_second(s, m, y0, r.y + step_y, z, w, zeros),
                       rows_second(s, m, y0, r.y + step_y, z + 2, w, zeros));
    if (!plane_stored(s, z)) return 0;
    const lanes here = vload8(0, row_stored(s, m, r.y, z, w, zeros));
    if (step_y < 0) return (lanes)(word_stored(s, m, r.y - 1, z, w, zeros), here.s0123, here.s456);
    if (step_y > 0) return lanes_next_row(here, word_stored(s, m, r.y + BRICK_ROWS, z, w, zeros));
    return here;
}

/* Where a set's words are in those of its brick; of a spread set, of its two planes. */
inline_always lanes set_load(global const ulong *brick, row_set r, bool spread) {
    if (!spread) return vload8(r.z % BRICK_PLANES, brick);
    const lanes a = vload8(r.z % BRICK_PLANES, brick), b = vload8(r.z % BRICK_PLANES + 2, brick);
    return r.y & 1 ? (lanes)(a.odd, b.odd) : (lanes)(a.even, b.even);
}

inline_always void set_store(lanes x, global ulong *brick, row_set r) { vstore8(x, r.z % BRICK_PLANES, brick); }

/* Adds the bits of a spread set. */
inline_always void set_add(lanes x, global ulong *brick, row_set r) {
    for (uint plane = 0; plane < 2; plane++) {
        const uint z = r.z % BRICK_PLANES + 2 * plane;
        const ulong4 half_of = plane ? x.hi : x.lo;
        lanes wide = 0;
        if (r.y & 1)
            wide.odd = half_of;
        else
            wide.even = half_of;
        vstore8(vload8(z, brick) | wide, z, brick);
    }
}

/* Lane n of a value in memory. */
inline_always ulong lane_of(const lanes *x, uint n) { return ((const ulong *)x)[n]; }
inline_always lanes lanes_of(const ulong *x) { return vload8(0, x); }

#endif
