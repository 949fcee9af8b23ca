/*
 * complex_cluster_alone.cl - clusters where a work-item is alone: the samples of four tetrahedra make a vector
 */
#ifndef COMPLEX_CLUSTER_ALONE_CL
#define COMPLEX_CLUSTER_ALONE_CL

#include "complex_cluster.cl"

inline_always bool cluster_valid(const complex_job *c, uint n, complex_arrays in) {
    global const uint *points = in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    uint largest = 0, count = 4 * cluster_size(c, n);
    if (count == CLUSTER_POINTS) {
        uint16 most = 0;
        for (uint m = 0; m < CLUSTER_POINTS / 16; m++) most = max(most, vload16(m, points));
        return mask_pack(convert_char16(most >= c->point_count)) == 0;
    }
    for (uint m = 0; m < count; m++) largest = max(largest, points[m]);
    return largest < c->point_count;
}

/* Samples 16 part to 16 part + 15 of a cluster; past the end of a cluster that is not full, its first sample. Loaded
 * one by one: vector gathers of CPUs are no faster. */
inline_always BITS16 cluster_samples(const complex_job *c, uint n, uint part, complex_arrays in) {
    global const uint *p = in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    global const BITS *s = in.samples;
    uint count = 4 * cluster_size(c, n);
    if (count == CLUSTER_POINTS) {
        p += 16 * part;
        return (BITS16)(s[p[0]], s[p[1]], s[p[2]], s[p[3]], s[p[4]], s[p[5]], s[p[6]], s[p[7]], s[p[8]], s[p[9]],
                        s[p[10]], s[p[11]], s[p[12]], s[p[13]], s[p[14]], s[p[15]]);
    }
    BITS samples[16];
    for (uint m = 0; m < 16; m++) samples[m] = s[p[16 * part + m < count ? 16 * part + m : 0]];
    return vload16(0, samples);
}

/* Checks the cluster's point numbers first. Where one is invalid, *invalid is set and the range is {0, 0}. */
inline_always brick_range cluster_range(const complex_job *c, uint n, complex_arrays in, uint *invalid) {
    brick_range range = {0, 0};
    if (!cluster_valid(c, n, in)) {
        *invalid = 1;
        return range;
    }
    BITS16 low = (BITS) ~(BITS)0, high = 0;
    for (uint m = 0; m < CLUSTER_POINTS / 16; m++) {
        BITS16 keys = keys16(cluster_samples(c, n, m, in), &c->test);
        low = min(low, keys), high = max(high, keys);
    }
    return keys_range(low, high);
}

/* What the surface makes of a cluster, whose point numbers have to be valid. */
inline_always cluster_report cluster_count(const complex_job *c, uint n, complex_arrays in) {
    ulong inside = 0, missing = 0;
    for (uint m = 0; m < CLUSTER_POINTS / 16; m++) {
        BITS16 bits = cluster_samples(c, n, m, in);
        inside |= (ulong)mask_pack(inside_mask(bits, &c->test)) << (16 * m);
#if FLOATING
        missing |= (ulong)mask_pack(missing_mask(bits, &c->test)) << (16 * m);
#endif
    }
    uint size = cluster_size(c, n);
    if (size < CLUSTER_TETRAHEDRA) missing |= ~0ul << 4 * size;
    return report_of(inside, missing);
}

/* Prefetches the tetrahedra of a cluster. */
inline_always void points_prefetch(const complex_job *c, uint n, complex_arrays in) {
    global const uint *points = in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    for (uint m = 0; m < CLUSTER_POINTS; m += 16) line_prefetch(points + m);
}

/* Prefetches samples of a cluster whose tetrahedra are in the cache: those of every fourth tetrahedron, as the samples
 * of the others lie close to them. */
inline_always void cluster_prefetch(const complex_job *c, uint n, complex_arrays in) {
    if (cluster_size(c, n) < CLUSTER_TETRAHEDRA) return;
    for (uint m = 0; m < CLUSTER_POINTS; m += m % 16 < 3 ? 1 : 13)
        line_prefetch(in.samples + in.tetrahedra[(ulong)CLUSTER_POINTS * n + m]);
}

#endif
