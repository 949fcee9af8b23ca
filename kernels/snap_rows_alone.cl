/*
 * snap_rows_alone.cl - words of the eight rows of a plane of a brick, and of the rows beside them, for a work-item
 * alone
 */
#ifndef SNAP_ROWS_ALONE_CL
#define SNAP_ROWS_ALONE_CL

#include "snap_rows.cl"

/* The words at w of the rows from y on, rows of one brick; of the rows before them or after them for step_y -1 or 1. 0
 * outside the grid, but words of a constant brick may go on there. */
inline_always lanes rows_beside(const slab *s, stored_words m, uint y, uint z, uint w, int step_y, bool zeros) {
    if (w >= s->words_x || z < s->results.word_z || z >= s->z1) return 0; /* w wraps below 0, z too */
    lanes here = vload8(0, row_stored(s, m, y, z, w, zeros));
    if (step_y < 0) return (lanes)(y ? *row_stored(s, m, y - 1, z, w, zeros) : 0, here.s0123, here.s456);
    if (step_y > 0)
        return lanes_next_row(here, y + BRICK_ROWS < s->ny ? *row_stored(s, m, y + BRICK_ROWS, z, w, zeros) : 0);
    return here;
}

inline_always lanes lanes_load(global const ulong *at) { return vload8(0, at); }
inline_always void lanes_store(lanes x, global ulong *out) { vstore8(x, 0, out); }
inline_always void lanes_add(lanes x, global ulong *out) { vstore8(vload8(0, out) | x, 0, out); }

/* Lane n of a value that is stored in memory. */
inline_always ulong lane_of(const lanes *x, uint n) { return ((const ulong *)x)[n]; }

inline_always lanes lanes_of(const ulong *x) { return vload8(0, x); }

#endif
