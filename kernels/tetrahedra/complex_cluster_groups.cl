/*
 * complex_cluster_groups.cl - clusters where the work-items of a group take one each: point by point
 */
#ifndef COMPLEX_CLUSTER_GROUPS_CL
#define COMPLEX_CLUSTER_GROUPS_CL

#include "complex_cluster.cl"

inline_always bool cluster_valid(const complex_job *c, uint n, complex_arrays in) {
    global const uint *points = in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    const uint count = 4 * cluster_size(c, n);
    uint largest = 0;
#pragma unroll 4
    for (uint m = 0; m < count; m++) largest = max(largest, points[m]);
    return largest < c->point_count;
}

/* Checks the cluster's point numbers first. Where one is invalid, *invalid is set and the range is {0, 0}. */
inline_always brick_range cluster_range(const complex_job *c, uint n, complex_arrays in, uint *invalid) {
    global const uint *points = in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    const uint count = 4 * cluster_size(c, n);
    brick_range range = {0, 0};
    if (!cluster_valid(c, n, in)) {
        *invalid = 1;
        return range;
    }
    BITS low = (BITS) ~(BITS)0, high = 0;
#pragma unroll 4
    for (uint m = 0; m < count; m++) {
        const BITS key = key_of(in.samples[points[m]], &c->test);
        low = min(low, key), high = max(high, key);
    }
    range.low = key_upper(low), range.high = key_upper(high);
    return range;
}

/* What the surface makes of a cluster, whose point numbers have to be valid. */
inline_always cluster_report cluster_count(const complex_job *c, uint n, complex_arrays in) {
    global const uint *points = in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    const uint count = 4 * cluster_size(c, n);
    ulong inside = 0, missing = 0;
#pragma unroll 4
    for (uint m = 0; m < count; m++) {
        const BITS bits = in.samples[points[m]];
        inside |= (ulong)bits_inside(bits, &c->test) << m;
#if FLOATING
        missing |= (ulong)bits_missing(bits, &c->test) << m;
#endif
    }
    return report_of(inside, missing);
}

#endif
