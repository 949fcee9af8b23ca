/*
 * snap_wish_groups.cl - wishes for groups: each work-item looks at the samples of a row
 */
#ifndef SNAP_WISH_GROUPS_CL
#define SNAP_WISH_GROUPS_CL

#include "nearest.cl"
#include "snap_crossed.cl"
#include "snap_wishes.cl"

typedef struct wish_room {
    long offsets[LINK_EVEN];
} wish_room;

inline_always void wishes_begin(const slab *s, wish_room *room) { link_offsets(s, room->offsets); }

inline_always void wishes_make(const slab *s, const brick_around *a, brick_place p, uint number,
                               global const BITS *samples, global const ulong *cells, wish_results results,
                               wish_room *room) {
    const row_set r = set_of_plane(p.y, p.z, p.w, (uint)get_local_id(0) % BRICK_WORDS);
    const borders b = borders_of(s, r);
    const ulong wanted = rows_wanted(s, a, r, &b, cells), border = b.across[0] | b.across[1] | b.across[2];
    const ulong start = row_start(s, r.y, r.z) + 64ul * r.w, even = samples_even(s, r);
    ulong wishes_of_row = border_wishes(s, r.y, r.z, r.w, wanted & border, samples);
    for (ulong rest = wanted & ~border; rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest);
        if (wishes_inside(s, samples + start + bit, room->offsets, !(even >> bit & 1))) wishes_of_row |= 1ul << bit;
    }
    set_store(wishes_of_row, results.wishes + BRICK_WORDS * (ulong)number, r);
    if (wishes_of_row) wishing_enter(number, results);
}

inline_always void wishes_end(const slab *s, global const BITS *samples, wish_results results, wish_room *room) {}

#endif
