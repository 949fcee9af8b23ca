/*
 * nearest.cl - method snap: which crossing is nearest to a sample; host/lib/reference/reference_nearest.inc is its twin
 *
 * Without division: crossings of a sample lie at the same difference from it in value, so the greater the difference of
 * an edge's samples, the nearer its crossing. All numbers are halved, so that no difference overflows.
 */
#ifndef NEAREST_CL
#define NEAREST_CL

#include "../base/values.cl"
#include "link_steps.cl"
#include "../base/words.cl"

#ifdef REAL

/* Without the sign. */
inline_always REAL difference_of(REAL a, REAL b) {
    REAL difference = a - b;
    return difference < 0 ? -difference : difference;
}

/* One over the length of an edge across a face. */
#define ACROSS ((REAL)0.70710678f)

/* Whether the crossing on an edge is near the sample: no farther than the threshold, as a part of the edge; one just at
 * the threshold is the inside sample's. difference: half of that between the edge's samples. */
inline_always bool near_enough(const slab *s, BITS sample, REAL difference) {
    const REAL half_of = (REAL)0.5f, reach = (REAL)s->snapping.threshold * difference;
    const REAL distance = difference_of(half_of * ISOVALUE(&s->test), half_of * SAMPLE_VALUE(sample));
    return bits_inside(sample, &s->test) ? distance <= reach : distance < reach;
}

/* From a sample to those of its link, in the sample buffer. */
inline_always long link_offset(const slab *s, uint n) {
    return link_steps[n][0] + (link_steps[n][1] + link_steps[n][2] * (long)s->ny) * (long)s->nx;
}

inline_always void link_offsets(const slab *s, long offsets[LINK_EVEN]) {
    for (uint n = 0; n < LINK_EVEN; n++) offsets[n] = link_offset(s, n);
}

/* Whether a sample on no border of the grid is near enough to a crossing: on the edge to
 * the sample of its link that differs most from it, on the other side, lies the nearest one, as a part of its edge. */
inline_always bool is_violated(const slab *s, global const BITS *at, const long *offsets, bool odd) {
    const REAL half_of = (REAL)0.5f, here = SAMPLE_VALUE(*at);
    REAL least = here, most = here;
#pragma unroll
    for (uint n = 0; n < LINK_ODD; n++) {
        const REAL other = SAMPLE_VALUE(at[offsets[n]]);
        least = other < least ? other : least, most = other > most ? other : most;
    }
#pragma unroll
    for (uint n = LINK_ODD; n < LINK_EVEN && !odd; n++) {
        const REAL other = SAMPLE_VALUE(at[offsets[n]]);
        least = other < least ? other : least, most = other > most ? other : most;
    }
    const REAL farthest = bits_inside(*at, &s->test) ? least : most;
    const REAL difference = difference_of(half_of * farthest, half_of * here);
    return difference > 0 && near_enough(s, *at, difference);
}

/* The index in its link of the nearest crossing of any sample; LINK_EVEN: none is near enough. A sample on a border of
 * the grid moves within the border only. */
inline_always uint nearest_of_sample(const slab *s, uint x, uint y, uint z, global const BITS *samples) {
    const bool border_x = x == 0 || x + 1 == s->nx, border_y = y == 0 || y + 1 == s->ny;
    const bool border_z = z == 0 || z + 1 == s->nz;
    const uint count = (s->parity + x + y + z) & 1 ? LINK_ODD : LINK_EVEN;
    const REAL half_of = (REAL)0.5f;
    global const BITS *at = samples + row_start(s, y, z) + x;
    uint nearest = LINK_EVEN;
    REAL steepness = 0;
#pragma unroll 1
    for (uint n = 0; n < count; n++) {
        if ((border_x && link_steps[n][0]) || (border_y && link_steps[n][1]) || (border_z && link_steps[n][2]))
            continue;
        const BITS other = at[link_offset(s, n)];
        const REAL difference = difference_of(half_of * SAMPLE_VALUE(other), half_of * SAMPLE_VALUE(*at));
        const REAL steep = n < LINK_ODD ? difference : difference * ACROSS;
        if (bits_inside(other, &s->test) == bits_inside(*at, &s->test)) continue;
        if (near_enough(s, *at, difference) && steep > steepness) steepness = steep, nearest = n;
    }
    return nearest;
}

/* Which of the samples of a row on the grid's border are near enough to a crossing. */
inline_always ulong border_violated(const slab *s, uint y, uint z, uint w, ulong rest, global const BITS *samples) {
    ulong violated = 0;
    for (; rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest);
        if (nearest_of_sample(s, 64 * w + bit, y, z, samples) != LINK_EVEN) violated |= 1ul << bit;
    }
    return violated;
}

#endif

#endif
