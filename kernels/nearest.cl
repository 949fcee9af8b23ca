/*
 * nearest.cl - method snap: which crossing is nearest to a sample; host/lib/reference/reference_nearest.inc is its twin
 *
 * Without division: crossings of a sample lie at the same difference from it in value, so the greater the difference of
 * an edge's samples, the nearer its crossing. All numbers are halved, so that no difference overflows.
 */
#ifndef NEAREST_CL
#define NEAREST_CL

#include "crossing.cl"
#include "link.h"
#include "words.cl"

#ifdef REAL

inline_always REAL difference_of(REAL a, REAL b) {
    REAL difference = a - b;
    return difference < 0 ? -difference : difference;
}

/* Whether the crossing lies at most s->snapping.threshold of the edge from the sample, and nearer than *steepness
 * tells, which it replaces. A crossing just at the threshold is the inside sample's. across: the edge is a diagonal. */
inline_always bool crossing_is_nearer(const slab *s, BITS sample, BITS other, bool across, REAL *steepness) {
    const REAL half_of = (REAL)0.5f, here = half_of * SAMPLE_VALUE(sample);
    REAL distance = difference_of(half_of * ISOVALUE(&s->test), here);
    REAL difference = difference_of(half_of * SAMPLE_VALUE(other), here);
    REAL steep = across ? difference * (REAL)0.70710678f : difference; /* over the root of 2, its length */
    const REAL reach = (REAL)s->snapping.threshold * difference;
    const bool near_enough = bits_inside(sample, &s->test) ? distance <= reach : distance < reach;
    if (!near_enough || steep <= *steepness) return false;
    *steepness = steep;
    return true;
}

#endif

#endif
