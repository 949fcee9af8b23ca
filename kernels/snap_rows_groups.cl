/*
 * snap_rows_groups.cl - words of a row, and of the rows beside it, where work-items take a row each
 */
#ifndef SNAP_ROWS_GROUPS_CL
#define SNAP_ROWS_GROUPS_CL

#include "snap_rows.cl"

/* The word at w of row y, or of the row before it or after it for step_y -1 or 1. 0 outside the grid. */
inline_always lanes rows_beside(const slab *s, stored_words m, uint y, uint z, uint w, int step_y, bool zeros) {
    if (w >= s->words_x || z < s->results.word_z || z >= s->z1) return 0; /* w wraps below 0, y and z too */
    if (y + step_y >= s->ny) return 0;
    return *row_stored(s, m, y + step_y, z, w, zeros);
}

inline_always lanes lanes_load(global const ulong *at) { return *at; }
inline_always void lanes_store(lanes x, global ulong *out) { *out = x; }
inline_always void lanes_add(lanes x, global ulong *out) { *out |= x; }

inline_always ulong lane_of(const lanes *x, uint n) { return *x; }

inline_always lanes lanes_of(const ulong *x) { return *x; }

#endif
