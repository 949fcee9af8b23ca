/*
 * snapped_alone.cl - kernel 2 in method snap, for a work-item alone: the edges of the snapped samples of a brick
 *
 * Odd and even samples, whose links differ, are listed apart. Sixteen of a list are then looked at together, wherever
 * they are in the brick.
 */
#ifndef SNAPPED_ALONE_CL
#define SNAPPED_ALONE_CL

#include "nearest_alone.cl"
#include "snapped.cl"

#ifdef REAL

/* Snapped samples on no border of the grid, of either parity: which vertices of the brick they are. */
typedef struct snapped_list {
    ushort vertex[2][BRICK_WORDS * 32];
    uint count[2];
} snapped_list;

inline_always void snapped_enter(snapped_list *list, uint odd, uint vertex) {
    list->vertex[odd][list->count[odd]++] = (ushort)vertex;
}

/* Of sixteen samples at these indices in the sample buffer the other ends of their edges. */
inline_always uchar16 snapped16_to(const slab *s, const ulong at[16], bool odd, global const BITS *samples) {
    BITS own[16];
    links16 links;
    for (uint lane = 0; lane < 16; lane++) {
        global const BITS *sample = samples + at[lane];
        own[lane] = *sample;
        uint n = 0;
#define LINK_BITS(x, y, z)                                                                                             \
    if (n < (odd ? LINK_ODD : LINK_EVEN)) links.bits[n++][lane] = sample[(x) + ((y) + (z) * (long)s->ny) * (long)s->nx];
        LINK_SAMPLES(LINK_BITS)
#undef LINK_BITS
    }
    const samples16 here = samples16_of(s, vload16(0, own));
    const uchar16 nearest = nearest16(s, &here, &links, odd);
    return nearest < (uchar16)LINK_EVEN ? nearest : (uchar16)1;
}

/* Turns the codes of snapped samples, which have no steps yet, into those of the edges on which their vertices lie.
 * edges: the brick's vertices, as EDGE_CODE has them. row_start: the index of a row's first sample, by bits 7 to 13 of
 * the code. */
inline_always void snapped_turn(const slab *s, bool odd, const snapped_list *list, const uint *codes,
                                const ulong *row_start, global const BITS *samples, uint *edges) {
    const ushort *vertex = list->vertex[odd];
    for (uint first = 0, count = list->count[odd]; first < count; first += 16) {
        const uint left = min(count - first, 16u);
        ulong at[16];
        uchar to[16];
        for (uint n = 0; n < 16; n++) {
            const uint edge = edges[vertex[first + min(n, left - 1)]];
            at[n] = row_start[edge >> 7 & 0x7f] + (edge & 0x7f);
        }
        vstore16(snapped16_to(s, at, odd, samples), 0, to);
        for (uint n = 0; n < left; n++) edges[vertex[first + n]] += codes[to[n]];
    }
}

#endif

#endif
