/*
 * snap_violated_groups.cl - violated samples, for groups: each work-item looks at the samples of a row
 */
#ifndef SNAP_VIOLATED_GROUPS_CL
#define SNAP_VIOLATED_GROUPS_CL

#include "nearest.cl"
#include "snap_crossed.cl"
#include "snap_violated.cl"

typedef struct violated_work {
    long offsets[LINK_EVEN];
} violated_work;

inline_always void violated_begin(const slab *s, violated_work *work) { link_offsets(s, work->offsets); }

inline_always void violated_find(const slab *s, const brick_around *a, grid_index origin, uint brick,
                                 global const BITS *samples, global const ulong *cells, violated_results results,
                                 violated_work *work) {
    const row_set r = rows_of_plane(origin.y, origin.z, brick_word(s, brick), (uint)get_local_id(0) % BRICK_WORDS);
    const borders b = borders_of(s, r);
    const ulong wanted = rows_wanted(s, a, r, &b, cells), border = b.by_axis[0] | b.by_axis[1] | b.by_axis[2];
    const ulong start = row_start(s, r.y, r.z) + 64ul * r.w, even = samples_even(s, r);
    ulong violated_of_row = border_violated(s, r.y, r.z, r.w, wanted & border, samples);
    for (ulong rest = wanted & ~border; rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest);
        if (is_violated(s, samples + start + bit, work->offsets, !(even >> bit & 1))) violated_of_row |= 1ul << bit;
    }
    rows_store(violated_of_row, results.violated + BRICK_WORDS * (ulong)brick, r);
    if (violated_of_row) violated_brick_enter(brick, results);
}

inline_always void violated_end(const slab *s, global const BITS *samples, violated_results results,
                                violated_work *work) {}

#endif
