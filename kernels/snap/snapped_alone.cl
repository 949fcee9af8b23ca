/*
 * snapped_alone.cl - kernel 2 in method snap, for a work-item alone: the edges of the snapped samples of a row
 */
#ifndef SNAPPED_ALONE_CL
#define SNAPPED_ALONE_CL

#include "nearest_alone.cl"
#include "snapped.cl"

#ifdef REAL

/* In their links the other ends of the edges of a row's snapped samples, a bit each. */
inline_always void row_snapped_to(const slab *s, uint x, uint y, uint z, ulong snapped, const long *offsets,
                                  global const BITS *samples, uchar to[64 + 16]) {
    const bool inner_row = y > 0 && y + 1 < s->ny && z > 0 && z + 1 < s->nz && links_fit16(s, x / 64, y, z);
    const ulong inner = inner_row ? has_before(x / 64) & has_after(s, x / 64) : 0;
    const uint odd = (s->parity + y + z) & 1;
    for (ulong rest = snapped & inner; rest; rest = bits_after16(rest)) {
        const uint bit = lowest_bit(rest);
        const samples16 here = samples16_of(s, samples + row_start(s, y, z) + x + bit, odd ^ (bit & 1));
        const uchar16 nearest = nearest16(s, &here, offsets);
        *(bytes16 *)(to + bit) = nearest < (uchar16)LINK_EVEN ? nearest : (uchar16)1;
    }
    for (ulong rest = snapped & ~inner; rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest);
        to[bit] = (uchar)snapped_to(s, x + bit, y, z, samples);
    }
}

#endif

#endif
