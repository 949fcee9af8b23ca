/*
 * snap_rows_groups.cl - for groups: each work-item takes a row of a brick
 */
#ifndef SNAP_ROWS_GROUPS_CL
#define SNAP_ROWS_GROUPS_CL

#include "snap_rows.cl"

#define SETS_OF_PLANES BRICK_WORDS
#define SETS_SPREAD    8

inline_always row_set set_of_plane(uint y0, uint z0, uint w, uint set) {
    const uint y = y0 + set % BRICK_ROWS, z = z0 + set / BRICK_ROWS;
    row_set r = {y, z, w, y, z};
    return r;
}

inline_always row_set set_spread(uint y0, uint z0, uint w, uint set, uint odd_y, uint odd_z) {
    const uint y = y0 + odd_y + 2 * (set % 4), z = z0 + odd_z + 2 * (set / 4);
    row_set r = {y, z, w, y, z};
    return r;
}

inline_always lanes words_beside(const slab *s, stored_words m, row_set r, bool spread, int step_y, int step_z,
                                 int step_w, bool zeros) {
    const uint w = r.w + step_w, z = r.z + step_z, y = r.y + step_y; /* wrap below 0 */
    const bool stored = w < s->words_x && y < s->ny && z >= s->results.word_z && z < s->z1;
    return stored ? *row_stored(s, m, y, z, w, zeros) : 0;
}

inline_always uint set_row(row_set r) { return r.z % BRICK_PLANES * BRICK_ROWS + r.y % BRICK_ROWS; }
inline_always lanes set_load(global const ulong *brick, row_set r, bool spread) { return brick[set_row(r)]; }
inline_always void set_store(lanes x, global ulong *brick, row_set r) { brick[set_row(r)] = x; }
inline_always void set_add(lanes x, global ulong *brick, row_set r) { brick[set_row(r)] |= x; }

inline_always ulong lane_of(const lanes *x, uint n) { return *x; }
inline_always lanes lanes_of(const ulong *x) { return *x; }

#endif
