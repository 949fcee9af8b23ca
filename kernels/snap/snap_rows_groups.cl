/*
 * snap_rows_groups.cl - for groups: each work-item takes a row of a brick
 */
#ifndef SNAP_ROWS_GROUPS_CL
#define SNAP_ROWS_GROUPS_CL

#include "snap_rows.cl"

#define SETS_OF_PLANES BRICK_WORDS
#define SETS_STRIDED   8

inline_always row_set rows_of_plane(uint y0, uint z0, uint w, uint set) {
    const uint y = y0 + set % BRICK_ROWS, z = z0 + set / BRICK_ROWS;
    row_set r = {y, z, w, y, z};
    return r;
}

inline_always row_set rows_strided(uint y0, uint z0, uint w, uint set, uint odd_y, uint odd_z) {
    const uint y = y0 + odd_y + 2 * (set % 4), z = z0 + odd_z + 2 * (set / 4);
    row_set r = {y, z, w, y, z};
    return r;
}

/* Sign words, and what is known of bricks. */
typedef struct brick_around {
    global const ulong *words;
    global const brick_state *bricks;
} brick_around;

inline_always void around_make(const slab *s, global const ulong *words, global const brick_state *bricks, uint brick,
                               brick_around *a) {
    a->words = words, a->bricks = bricks;
}

/* No prefetch: while a work-item waits for memory, others of its group run. */
inline_always void around_prefetch(const slab *s, global const ulong *words, global const ulong *violated, uint brick) {
}

/* The word at w + step_w of the row a step from that of the set, 0 where there is none. */
inline_always lanes words_beside(const slab *s, const brick_around *a, row_set r, bool strided, int step_y, int step_z,
                                 int step_w, bool zeros) {
    const uint w = r.w + step_w, z = r.z + step_z, y = r.y + step_y; /* wrap below 0 */
    if (w >= s->words_x || y >= s->ny || z < s->results.word_z || z >= s->z1) return 0;
    const uint brick = brick_index(s, y, z, w);
    global const ulong *words = brick_words(brick, a->bricks[brick].sign, a->words);
    return (zeros ? zeros_of(s, words) : words)[row_in_brick(s, y, z)];
}

inline_always uint row_of_set(row_set r) { return r.z % BRICK_PLANES * BRICK_ROWS + r.y % BRICK_ROWS; }
inline_always lanes rows_load(global const ulong *brick, row_set r, bool strided) { return brick[row_of_set(r)]; }
inline_always void rows_store(lanes x, global ulong *brick, row_set r) { brick[row_of_set(r)] = x; }
inline_always void rows_add(lanes x, global ulong *brick, row_set r) { brick[row_of_set(r)] |= x; }

#endif
