/*
 * regular_groups.cl - regular points for groups: one sample after another, its link as bits of a mask, which takes few
 * registers
 */
#ifndef REGULAR_GROUPS_CL
#define REGULAR_GROUPS_CL

#include "link_steps.cl"
#include "snap_samples.cl"

/* To which others each sample of a link is joined, of even and of odd links; and the rings across each axis. */
constant const uint link_joined[2][LINK_EVEN] = {{0x01540, 0x02a80, 0x140c0, 0x28300, 0x0cc00, 0x33000, 0x15405,
                                                  0x16806, 0x29409, 0x2a80a, 0x0c151, 0x0c292, 0x30161, 0x302a2,
                                                  0x00cd4, 0x00f18, 0x030e4, 0x03328},
                                                 {0x0003c, 0x0003c, 0x00033, 0x00033, 0x0000f, 0x0000f}};
constant const uint link_rings[2][3] = {{0x3c03c, 0x03c33, 0x003cf}, {0x0003c, 0x00033, 0x0000f}};

/* The signs of a sample's link. Samples outside the grid are in none of the three. */
typedef struct link_masks {
    uint plus, minus, zero;
} link_masks;

inline_always link_masks link_masks_of(const slab *s, const brick_around *a, row_set r, uint bit, bool odd) {
    link_masks l = {0, 0, 0};
    const uint count = odd ? LINK_ODD : LINK_EVEN;
#pragma unroll 1
    for (uint n = 0; n < count; n++) {
        const int x = (int)bit + link_steps[n][0], step_w = x >> 6; /* -1, 0 or 1 */
        const uint at_x = 64 * r.w + bit + link_steps[n][0], at_y = r.y + link_steps[n][1],
                   at_z = r.z + link_steps[n][2];
        if (at_x >= s->nx || at_y >= s->ny || at_z < s->results.word_z || at_z >= s->z1) continue; /* wrap below 0 */
        const ulong sign = words_beside(s, a, r, false, link_steps[n][1], link_steps[n][2], step_w, false);
        ulong zero = 0; /* of an even link, samples along the axes are odd: no zeros yet */
        if (odd || n >= LINK_ODD) zero = words_beside(s, a, r, false, link_steps[n][1], link_steps[n][2], step_w, true);
        if (zero >> (x & 63) & 1)
            l.zero |= 1u << n;
        else if (sign >> (x & 63) & 1)
            l.plus |= 1u << n;
        else
            l.minus |= 1u << n;
    }
    return l;
}

inline_always bool link_connected(uint samples, bool odd) {
    uint seen = samples & -samples, before = 0;
#pragma unroll 1
    while (seen != before) {
        before = seen;
#pragma unroll 1
        for (uint rest = seen; rest; rest &= rest - 1) seen |= link_joined[odd][lowest_bit(rest)] & samples;
    }
    return samples && seen == samples;
}

/* Two changes between + and - on a ring, one where it is cut open; zeros between + and -. */
inline_always bool ring_regular(link_masks l, uint ring, bool odd) {
    const uint samples = ring & (l.plus | l.minus | l.zero);
    uint changes = 0;
#pragma unroll 1
    for (uint rest = samples; rest; rest &= rest - 1) {
        const uint n = lowest_bit(rest), beside = link_joined[odd][n] & samples;
        const uint plus = (uint)popcount(beside & l.plus), minus = (uint)popcount(beside & l.minus);
        if ((l.zero >> n & 1) && (plus != 1 || minus != 1)) return false;
        changes += l.zero >> n & 1 ? 1 : l.plus >> n & 1 ? minus : 0;
    }
    return changes == (samples == ring ? 2u : 1u);
}

inline_always bool point_regular(link_masks l, uint border, bool odd) {
    if (!link_connected(l.plus, odd) || !link_connected(l.minus, odd)) return false;
#pragma unroll 1
    for (uint rest = l.zero; rest; rest &= rest - 1)
        if (!ring_regular(l, link_joined[odd][lowest_bit(rest)], odd)) return false;
#pragma unroll 1
    for (uint axis = 0; axis < 3; axis++)
        if ((border >> axis & 1) && !ring_regular(l, link_rings[odd][axis], odd)) return false;
    return true;
}

/* Of the samples in a row those that are regular points. */
inline_always lanes rows_regular(const slab *s, const brick_around *a, row_set r, bool strided, lanes wanted,
                                 bool odd) {
    const uint border_y = r.y == 0 || r.y + 1 == s->ny, border_z = r.z == 0 || r.z + 1 == s->nz;
    lanes regular = 0;
#pragma unroll 1
    for (lanes rest = wanted; rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest), x = 64 * r.w + bit, border_x = x == 0 || x + 1 == s->nx;
        const link_masks l = link_masks_of(s, a, r, bit, odd);
        if (point_regular(l, border_x | border_y << 1 | border_z << 2, odd)) regular |= 1ul << bit;
    }
    return regular;
}

#endif
