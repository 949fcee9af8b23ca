/*
 * snap_wish_groups.cl - wishes for groups: each work-item looks at the samples of a row
 */
#ifndef SNAP_WISH_GROUPS_CL
#define SNAP_WISH_GROUPS_CL

#include "nearest.cl"
#include "snap_link.cl"

typedef struct wish_room {
    long offsets[LINK_EVEN];
    uint row;
    ulong wishes;
} wish_room;

inline_always void wishes_enter(const slab *s, row_set r, lanes crossed_any, lanes border, global const BITS *samples,
                                wish_room *room) {
    const ulong start = row_start(s, r.y, r.z) + 64ul * r.w, even = samples_even(s, r);
    room->row = set_row(r), room->wishes = border_wishes(s, r.y, r.z, r.w, crossed_any & border, samples);
    for (ulong rest = crossed_any & ~border; rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest);
        if (wishes_inside(s, samples + start + bit, room->offsets, !(even >> bit & 1))) room->wishes |= 1ul << bit;
    }
}

inline_always void wishes_store(const slab *s, brick_place p, global const BITS *samples, global ulong *out,
                                const wish_room *room) {
    out[room->row] = room->wishes;
}

#endif
