/*
 * snap_violated_alone.cl - violated samples, for a work-item alone: sixteen samples at once, from a sample with a
 * crossing on
 */
#ifndef SNAP_VIOLATED_ALONE_CL
#define SNAP_VIOLATED_ALONE_CL

#include "nearest_alone.cl"
#include "../structured/sign.cl"
#include "snap_crossed.cl"
#include "snap_violated.cl"

/* A brick's samples with crossings, and which of them are violated. */
typedef struct violated_list {
    grid_index origin;
    uint brick;
    uint rows; /* bit n: row n has samples in `crossed`, which are not tested yet */
    ulong crossed[BRICK_WORDS];
    ulong violated[BRICK_WORDS];
} violated_list;

/* Two lists in turn: a brick is finished after samples of the next one have been asked for, so that its own have
 * arrived. */
typedef struct violated_work {
    long offsets[LINK_EVEN];
    violated_list lists[2];
    uint brick_count;
} violated_work;

/* Enters the samples of a plane that have a crossing. Of those that cannot be looked at together the violated ones are
 * found here. */
inline_always void plane_enter(const slab *s, row_set r, lanes crossed_any, const borders *b,
                               global const BITS *samples, violated_list *l) {
    const uint plane = r.z % BRICK_PLANES;
    const bool fit = links_fit16(s, r.w, r.y + BRICK_ROWS - 1, r.z);
    const lanes inner = fit ? ~(b->by_axis[0] | b->by_axis[1] | b->by_axis[2]) : (lanes)0,
                others = crossed_any & ~inner;
    ulong *violated = l->violated + BRICK_ROWS * plane;
    vstore8(crossed_any & inner, plane, l->crossed), vstore8(others, 0, violated);
    for (uint rows = lanes_nonzero(others); rows; rows &= rows - 1) {
        const uint y = lowest_bit(rows);
        violated[y] = border_violated(s, r.y + y, r.z, r.w, violated[y], samples);
    }
    l->rows |= lanes_nonzero(crossed_any & inner) << (BRICK_ROWS * plane);
}

inline_always void list_finish(const slab *s, violated_list *l, const long *offsets, global const BITS *samples,
                               violated_results results) {
    global ulong *out = results.violated + BRICK_WORDS * (ulong)l->brick;
    for (uint rows = l->rows; rows; rows &= rows - 1) {
        const uint row = lowest_bit(rows), y = l->origin.y + row % BRICK_ROWS, z = l->origin.z + row / BRICK_ROWS;
        const uint odd = (s->parity + y + z) & 1;
        global const BITS *first = samples + row_start(s, y, z) + l->origin.x;
        ulong found = 0;
        for (ulong rest = l->crossed[row]; rest; rest = bits_after16(rest)) {
            const uint bit = lowest_bit(rest);
            const samples16 here = samples16_of(s, vload16(0, first + bit));
            found |= (ulong)violated16(s, &here, first + bit, odd ^ (bit & 1), offsets) << bit;
        }
        l->violated[row] |= found & l->crossed[row];
    }
    lanes any = 0;
    for (uint plane = 0; plane < BRICK_PLANES; plane++) {
        const lanes of_plane = vload8(plane, l->violated);
        any |= of_plane;
        vstore8(of_plane, plane, out);
    }
    if (lanes_any(any)) violated_brick_enter(l->brick, results);
}

inline_always void violated_begin(const slab *s, violated_work *work) {
    link_offsets(s, work->offsets);
    work->brick_count = 0;
}

/* Whether samples beside a uniform brick may be on another side than its own: those of the bricks around it that are
 * next to it. */
inline_always bool uniform_crossed(const brick_around *a, ulong uniform) {
    lanes differ = 0;
    ulong differs = 0;
#pragma unroll
    for (uint n = 0; n < 27; n++) {
        const uint x = n % 3, y = n / 3 % 3, z = n / 9;
        const ulong columns = x == 0 ? 1ul << 63 : x == 2 ? 1 : ~0ul;
        for (uint plane = z == 0 ? BRICK_PLANES - 1 : 0; plane < (z == 2 ? 1 : BRICK_PLANES); plane++) {
            global const ulong *rows = a->words[z][y][x] + BRICK_ROWS * plane;
            if (y == 1)
                differ |= (vload8(0, rows) ^ uniform) & columns;
            else
                differs |= (rows[y == 0 ? BRICK_ROWS - 1 : 0] ^ uniform) & columns;
        }
    }
    return differs || lanes_any(differ);
}

inline_always void violated_find(const slab *s, const brick_around *a, grid_index origin, uint brick,
                                 global const BITS *samples, global const ulong *cells, violated_results results,
                                 violated_work *work) {
    violated_list *l = &work->lists[work->brick_count & 1];
    const uint sign = results.bricks[brick].sign;
    if (sign != SIGN_MIXED && !uniform_crossed(a, sign_word(sign))) return;
    l->origin = origin, l->brick = brick, l->rows = 0;
    for (uint set = 0; set < SETS_OF_PLANES; set++) {
        const row_set r = rows_of_plane(origin.y, origin.z, brick_word(s, brick), set);
        const borders b = borders_of(s, r);
        plane_enter(s, r, rows_wanted(s, a, r, &b, cells), &b, samples, l);
    }
    links_prefetch(s, brick_word(s, brick), origin.y, origin.z, samples);
    if (work->brick_count++) list_finish(s, &work->lists[work->brick_count & 1], work->offsets, samples, results);
}

inline_always void violated_end(const slab *s, global const BITS *samples, violated_results results,
                                violated_work *work) {
    if (work->brick_count) list_finish(s, &work->lists[(work->brick_count - 1) & 1], work->offsets, samples, results);
}

#endif
