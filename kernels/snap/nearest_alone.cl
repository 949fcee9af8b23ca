/*
 * nearest_alone.cl - method snap, for a work-item alone: the nearest crossings of sixteen samples at once, by the rules
 * of nearest.cl
 *
 * What is found of samples that have no crossing, or are on the grid's border, means nothing.
 */
#ifndef NEAREST_ALONE_CL
#define NEAREST_ALONE_CL

#include "nearest.cl"

#ifdef REAL

#define REAL16 PASTE(REAL, 16)

/* ---------------------------------------------------------------------------------------------------------- samples */

/* Whether sixteen samples can be loaded from each sample of the links of a word, which is at no border in y and z. */
inline_always bool links_fit16(const slab *s, uint w, uint y, uint z) {
    const ulong last = row_start(s, y + 1, z + 1) + 64ul * (w + 1) + 16;
    return last <= s->arrays.sample_offset + s->arrays.sample_count;
}

/* Prefetches the samples of a brick, and of the rows beside it. */
inline_always void links_prefetch(const slab *s, uint w, uint y, uint z, global const BITS *samples) {
    const ulong plane_size = (ulong)s->ny * s->nx, before = plane_size + s->nx;
    global const BITS *plane = samples + (long)(row_start(s, y, z) + 64ul * w - before);
    for (uint n = 0; n < BRICK_PLANES + 2; n++, plane += plane_size)
        for (uint row = 0; row < BRICK_ROWS + 2; row++)
            for (uint sample = 0; sample < 64; sample += 64 / sizeof(BITS))
                line_prefetch(plane + row * (ulong)s->nx + sample);
}

/* Bits beyond the sixteen from the lowest one on. */
inline_always ulong bits_after16(ulong bits) {
    const uint bit = lowest_bit(bits);
    return bit < 48 ? bits & ~0ul << (bit + 16) : 0;
}

/* Samples as pulls: values whose sign is turned where the sample that looks at them is inside, so that of several
 * neighbours the one with the greatest pull is farthest beyond the isovalue. Pulls of integers are integers, of which
 * more fit a register. */
#if FLOATING
typedef REAL16 pulls16;
#define pulls_of(bits, turn)  PASTE(as_, REAL16)((bits) ^ (turn))
#define pulls_greater(a, b)   ((a) > (b) ? (a) : (b))
#define pulls_real(pulls)     (pulls)
#define values_of(bits, flip) PASTE(as_, REAL16)(bits)
#define PULL_TURN             ((BITS)1 << (FLOATING - 1))
#else
typedef BITS16 pulls16;
#define pulls_of(bits, turn)  ((bits) ^ (turn))
#define pulls_greater(a, b)   max(a, b)
#define pulls_real(pulls)     PASTE(convert_, REAL16)(pulls)
#define values_of(bits, flip) (PASTE(convert_, REAL16)((bits) ^ (flip)) - (REAL)(flip))
#define PULL_TURN             ((BITS) ~(BITS)0)
#endif

/* Sixteen samples; masks are all bits or none. */
typedef struct samples16 {
    char16 inside;
    BITS16 turn; /* from bits to pulls */
    pulls16 pulls;
    REAL16 distance; /* of half their values from half the isovalue */
} samples16;

inline_always samples16 samples16_of(const slab *s, BITS16 bits) {
    const BITS flip = FLOATING ? (BITS)0 : (BITS)s->test.key_flip;
    const char16 inside = inside_mask(bits, &s->test);
    const BITS16 turn = (PASTE(convert_, BITS16)(as_uchar16(inside & (char16)1)) * PULL_TURN) ^ flip;
    const REAL16 beyond = (REAL)0.5f * ISOVALUE(&s->test) - (REAL)0.5f * values_of(bits, flip);
    samples16 here = {inside, turn, pulls_of(bits, turn), fabs(beyond)};
    return here;
}

/* -------------------------------------------------------------------------------------------------------- crossings */

/* Half the difference in value to neighbours with these pulls, positive towards the other side. */
inline_always REAL16 differences16(const samples16 *here, pulls16 pulls) {
    return (REAL)0.5f * pulls_real(pulls) - (REAL)0.5f * pulls_real(here->pulls);
}

/* Whether the crossing on an edge with this difference is near enough. */
inline_always char16 near_enough16(const slab *s, const samples16 *here, REAL16 difference) {
    const REAL16 reach = (REAL)s->snapping.threshold * difference;
    const char16 within = convert_char16(here->distance <= reach), before = convert_char16(here->distance < reach);
    return convert_char16(difference > (REAL16)0) & within & (here->inside | before);
}

/* A bit for each sample that is near enough to a crossing. The neighbour that differs most on the other side has the
 * nearest one along its kind of edge. */
inline_always uint violated16(const slab *s, const samples16 *here, global const BITS *at, uint odd,
                              const long *offsets) {
    const char16 even = (char16)(-1, 0, -1, 0, -1, 0, -1, 0, -1, 0, -1, 0, -1, 0, -1, 0);
    pulls16 along = here->pulls, across = here->pulls;
#pragma unroll
    for (uint n = 0; n < LINK_EVEN; n++) {
        const pulls16 pulls = pulls_of(vload16(0, at + offsets[n]), here->turn);
        along = n < LINK_ODD ? pulls_greater(pulls, along) : along;
        across = n < LINK_ODD ? across : pulls_greater(pulls, across);
    }
    return mask_pack(near_enough16(s, here, differences16(here, along)) |
                     ((odd ? ~even : even) & near_enough16(s, here, differences16(here, across))));
}

/* The link samples of sixteen samples, by index in the link. */
typedef struct links16 {
    BITS bits[LINK_EVEN][16];
} links16;

inline_always pulls16 link_pulls16(const samples16 *here, const links16 *links, uint n) {
    return pulls_of(vload16(0, links->bits[n]), here->turn);
}

/* The index in its link of each sample's nearest crossing; LINK_EVEN: none is near enough. All samples are odd, or all
 * are even. */
#if FLOATING
inline_always uchar16 nearest16(const slab *s, const samples16 *here, const links16 *links, bool odd) {
    REAL16 steepness = 0;
    uchar16 nearest = LINK_EVEN;
#pragma unroll
    for (uint n = 0; n < (odd ? LINK_ODD : LINK_EVEN); n++) {
        const REAL16 difference = differences16(here, link_pulls16(here, links, n));
        const REAL16 steep = n < LINK_ODD ? difference : difference * ACROSS;
        const char16 nearer = near_enough16(s, here, difference) & convert_char16(steep > steepness);
        nearest = nearer ? (uchar16)n : nearest;
        steepness = PASTE(convert_, SIGNED16)(nearer) ? steep : steepness;
    }
    return nearest;
}
#else /* equal differences of integers are of equal values, so the values can be compared */
inline_always uchar16 nearest16(const slab *s, const samples16 *here, const links16 *links, bool odd) {
    pulls16 along = here->pulls, across = here->pulls;
    BITS16 to_along = LINK_EVEN, to_across = LINK_EVEN;
#pragma unroll
    for (uint n = 0; n < LINK_ODD; n++) {
        const pulls16 pulls = link_pulls16(here, links, n);
        to_along = pulls > along ? (BITS16)n : to_along, along = max(pulls, along);
    }
#pragma unroll
    for (uint n = LINK_ODD; n < LINK_EVEN && !odd; n++) {
        const pulls16 pulls = link_pulls16(here, links, n);
        to_across = pulls > across ? (BITS16)n : to_across, across = max(pulls, across);
    }
    const REAL16 steep_along = differences16(here, along), steep_across = differences16(here, across);
    const char16 near_along = near_enough16(s, here, steep_along);
    const char16 near_across = near_enough16(s, here, steep_across);
    const char16 is_across = near_across & (~near_along | convert_char16(steep_across * ACROSS > steep_along));
    const uchar16 nearest = near_along ? convert_uchar16(to_along) : (uchar16)LINK_EVEN;
    return is_across ? convert_uchar16(to_across) : nearest;
}
#endif

#endif

#endif
