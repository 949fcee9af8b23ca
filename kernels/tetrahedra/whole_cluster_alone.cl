/*
 * whole_cluster_alone.cl - clusters of cells where a work-item is alone: the samples of two hexahedra make a vector
 */
#ifndef WHOLE_CLUSTER_ALONE_CL
#define WHOLE_CLUSTER_ALONE_CL

#include "whole_cluster.cl"

/* Whether the cluster is 64 points that follow each other, eight for each cell. */
inline_always bool cluster_packed(const complex_job *c, uint n, complex_arrays in) {
    return c->one_code && c->cell_points == 8 && cluster_size(c, n) == CLUSTER_CELLS &&
           shape_of(c->one_code, in)[SHAPE_CORNERS] == 8;
}

inline_always global const uint *packed_words(const complex_job *c, uint n, complex_arrays in) {
    return in.tetrahedra + (ulong)CLUSTER_POINTS * n * c->word_step;
}

inline_always bool packed_valid(const complex_job *c, uint n, complex_arrays in) {
    global const uint *words = packed_words(c, n, in);
    uint16 most = 0, upper = 0;
    if (c->word_step == 1) {
        for (uint m = 0; m < CLUSTER_POINTS / 16; m++) most = max(most, vload16(m, words));
    } else {
        for (uint m = 0; m < CLUSTER_POINTS / 8; m++) upper |= vload16(m, words);
        for (uint m = 0; m < CLUSTER_POINTS / 8; m += 2) {
            const uint16 a = vload16(m, words), b = vload16(m + 1, words);
            most = max(most, (uint16)(a.even, b.even));
        }
        upper = (uint16)(upper.odd, upper.odd);
    }
    return mask_pack(convert_char16((most >= c->point_count) | (upper != 0))) == 0;
}

inline_always bool cluster_valid(const complex_job *c, uint n, complex_arrays in) {
    return cluster_packed(c, n, in) ? packed_valid(c, n, in) : cells_valid(c, n, in);
}

/* Samples 16 part to 16 part + 15. Loaded one by one: vector gathers of CPUs are no faster. */
#define SAMPLES_AT(step)                                                                                               \
    (BITS16)(s[p[0]], s[p[step]], s[p[2 * step]], s[p[3 * step]], s[p[4 * step]], s[p[5 * step]], s[p[6 * step]],      \
             s[p[7 * step]], s[p[8 * step]], s[p[9 * step]], s[p[10 * step]], s[p[11 * step]], s[p[12 * step]],        \
             s[p[13 * step]], s[p[14 * step]], s[p[15 * step]])

inline_always BITS16 packed_samples(const complex_job *c, uint n, uint part, complex_arrays in) {
    global const uint *p = packed_words(c, n, in) + 16 * part * c->word_step;
    global const BITS *s = in.samples;
    if (c->word_step == 1) return SAMPLES_AT(1);
    return SAMPLES_AT(2);
}

inline_always brick_range packed_range(const complex_job *c, uint n, complex_arrays in) {
    BITS16 low = (BITS) ~(BITS)0, high = 0;
    for (uint m = 0; m < CLUSTER_POINTS / 16; m++) {
        BITS16 keys = keys16(packed_samples(c, n, m, in), &c->test);
        low = min(low, keys), high = max(high, keys);
    }
    return keys_range(low, high);
}

/* Checks the cluster's point numbers first. Where one is invalid, *invalid is set and the range is {0, 0}. */
inline_always brick_range cluster_range(const complex_job *c, uint n, complex_arrays in, uint *invalid) {
    brick_range range = {0, 0};
    if (cluster_valid(c, n, in)) return cluster_packed(c, n, in) ? packed_range(c, n, in) : cells_range(c, n, in);
    *invalid = 1;
    return range;
}

/* Bit n: a bit of byte n is set. */
inline_always ulong bytes_any(ulong x) {
    x |= x >> 4, x |= x >> 2, x |= x >> 1;
    return ((x & 0x0101010101010101ul) * 0x0102040810204080ul) >> 56;
}

/* What the surface makes of a cluster, whose point numbers have to be valid. */
inline_always cluster_report cluster_count(const complex_job *c, uint n, complex_arrays in) {
    ulong inside = 0, missing = 0;
    if (!cluster_packed(c, n, in)) return cells_count(c, n, in);
    for (uint m = 0; m < CLUSTER_POINTS / 16; m++) {
        BITS16 bits = packed_samples(c, n, m, in);
        inside |= (ulong)mask_pack(inside_mask(bits, &c->test)) << (16 * m);
#if FLOATING
        missing |= (ulong)mask_pack(missing_mask(bits, &c->test)) << (16 * m);
#endif
    }
    return cells_report(bytes_any(inside) & bytes_any(~inside) & ~bytes_any(missing));
}

/* Prefetches the points of a cluster. */
inline_always void points_prefetch(const complex_job *c, uint n, complex_arrays in) {
    global const uint *words = cell_points_at(c, n * CLUSTER_CELLS, in);
    const uint count = CLUSTER_CELLS * (c->cell_points ? c->cell_points : 8) * c->word_step;
    for (uint m = 0; m < count; m += 16) line_prefetch(words + m);
}

/* Prefetches samples of a cluster whose points are in the cache: those of its first cell, as the samples of the others
 * lie close to them. */
inline_always void cluster_prefetch(const complex_job *c, uint n, complex_arrays in) {
    global const uint *words = cell_points_at(c, n * CLUSTER_CELLS, in);
    const uint count = shape_of(cell_code(c, n * CLUSTER_CELLS, in), in)[SHAPE_CORNERS];
    for (uint m = 0; m < count; m++) line_prefetch(in.samples + words[m * c->word_step]);
}

#endif
