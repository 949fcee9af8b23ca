/*
 * snap_rows_alone.cl - for a work-item alone: eight rows of a brick at once
 */
#ifndef SNAP_ROWS_ALONE_CL
#define SNAP_ROWS_ALONE_CL

#include "snap_rows.cl"

/* Sets of a brick: its planes; or one set of the rows of a colour. */
#define SETS_OF_PLANES BRICK_PLANES
#define SETS_STRIDED   1

inline_always row_set rows_of_plane(uint y0, uint z0, uint w, uint set) {
    row_set r = {y0, z0 + set, w, LANE_NUMBERS + y0, (lanes)(z0 + set)};
    return r;
}

/* Of the rows that begin at odd_y and odd_z of the brick. */
inline_always row_set rows_strided(uint y0, uint z0, uint w, uint set, uint odd_y, uint odd_z) {
    row_set r = {y0 + odd_y, z0 + odd_z, w, (lanes)(0, 2, 4, 6, 0, 2, 4, 6) + (y0 + odd_y),
                 (lanes)(0, 0, 0, 0, 2, 2, 2, 2) + (z0 + odd_z)};
    return r;
}

/* The words of a brick and of the 26 around it, by step in z, y and x, plus 1. Beyond the window's borders, bricks at
 * the borders stand for those around. */
typedef struct brick_around {
    global const ulong *words[3][3][3];
} brick_around;

inline_always void around_make(const slab *s, global const ulong *words, global const brick_state *bricks, uint brick,
                               brick_around *a) {
    const brick_steps steps = brick_steps_of(s, brick);
#pragma unroll
    for (uint n = 0; n < 27; n++) {
        const uint other = brick + steps.layer[n / 9] + steps.row[n / 3 % 3] + steps.word[n % 3];
        a->words[n / 9][n / 3 % 3][n % 3] = brick_words(other, bricks[other].sign, words);
    }
}

/* Prefetches what a pass reads of a brick, and of the one after it in z, which is read here first. */
inline_always void around_prefetch(const slab *s, global const ulong *words, global const ulong *violated, uint brick) {
    global const ulong *own = words + BRICK_WORDS * (ulong)brick;
    const ulong deep = BRICK_WORDS * (ulong)s->bricks_y * s->words_x;
    for (uint line = 0; line < BRICK_WORDS; line += 8) {
        line_prefetch(own + line);
        line_prefetch(zeros_of(s, own) + line);
        line_prefetch(violated + BRICK_WORDS * (ulong)brick + line);
    }
    line_prefetch(own + deep);
    line_prefetch(zeros_of(s, own) + deep);
}

/* The plane of words a step from the brick's, of the brick in the middle or the one before or after it in y. */
inline_always global const ulong *plane_beside(const slab *s, const brick_around *a, int plane, int step_y, int step_w,
                                               bool zeros) {
    const int step_z = plane < 0 ? -1 : plane >= BRICK_PLANES ? 1 : 0;
    global const ulong *words = a->words[1 + step_z][1 + step_y][1 + step_w] + BRICK_ROWS * (plane & 3);
    return zeros ? zeros_of(s, words) : words;
}

/* Rows y, y + 2, y + 4, y + 6 of a plane, for y from -1 to 2. */
inline_always ulong4 rows_second(const slab *s, const brick_around *a, int y, int plane, int step_w, bool zeros) {
    const lanes all = vload8(0, plane_beside(s, a, plane, 0, step_w, zeros));
    if (y == 0) return all.even;
    if (y == 1) return all.odd;
    if (y == 2) return (ulong4)(all.even.s123, *plane_beside(s, a, plane, 1, step_w, zeros));
    return (ulong4)(plane_beside(s, a, plane, -1, step_w, zeros)[BRICK_ROWS - 1], all.odd.s012);
}

/* Words at w + step_w of the rows a step from those of the set. Where there are none, those
 * of the brick at the border, which callers mask; words of a constant brick go on
 * outside the grid. */
inline_always lanes words_beside(const slab *s, const brick_around *a, row_set r, bool strided, int step_y, int step_z,
                                 int step_w, bool zeros) {
    const int plane = (int)(r.z % BRICK_PLANES) + step_z;
    if (strided) {
        const int y = (int)(r.y & 1) + step_y;
        return (lanes)(rows_second(s, a, y, plane, step_w, zeros), rows_second(s, a, y, plane + 2, step_w, zeros));
    }
    const lanes here = vload8(0, plane_beside(s, a, plane, 0, step_w, zeros));
    if (step_y < 0) return (lanes)(plane_beside(s, a, plane, -1, step_w, zeros)[BRICK_ROWS - 1], here.s0123, here.s456);
    if (step_y > 0) return lanes_next_row(here, *plane_beside(s, a, plane, 1, step_w, zeros));
    return here;
}

/* Loads a set's words from its brick's; of a strided set from two planes. */
inline_always lanes rows_load(global const ulong *brick, row_set r, bool strided) {
    if (!strided) return vload8(r.z % BRICK_PLANES, brick);
    const lanes a = vload8(r.z % BRICK_PLANES, brick), b = vload8(r.z % BRICK_PLANES + 2, brick);
    return r.y & 1 ? (lanes)(a.odd, b.odd) : (lanes)(a.even, b.even);
}

inline_always void rows_store(lanes x, global ulong *brick, row_set r) { vstore8(x, r.z % BRICK_PLANES, brick); }

/* Adds the bits of a strided set. */
inline_always void rows_add(lanes x, global ulong *brick, row_set r) {
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

#endif
