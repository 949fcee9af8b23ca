/*
 * complex_cluster.cl - a cluster of 64 tetrahedra: its range of samples, and where the surface passes through it
 *
 * The four samples of every tetrahedron are gathered next to each other, so that what follows runs over whole vectors:
 * 16 samples make the patterns of four tetrahedra, 64 bits those of 16.
 */
enum { CLUSTER_POINTS = 4 * CLUSTER_TETRAHEDRA };

/* The arrays of a complex, from their first item on. */
typedef struct complex_arrays {
    global const BITS *samples;
    global const uint *tetrahedra;
} complex_arrays;

typedef struct cluster_report {
    ulong active;
    uint triangles, edges;
} cluster_report;

inline_always uint cluster_size(const complex_job *c, uint n) {
    return min(c->tetrahedron_count - n * CLUSTER_TETRAHEDRA, (uint)CLUSTER_TETRAHEDRA);
}

inline_always bool cluster_valid(const complex_job *c, uint n, global const uint *points) {
    uint largest = 0, count = 4 * cluster_size(c, n);
    if (count == CLUSTER_POINTS) {
        uint16 most = 0;
        for (uint m = 0; m < CLUSTER_POINTS / 16; m++) most = max(most, vload16(m, points));
        uint8 m8 = max(most.lo, most.hi);
        uint4 m4 = max(m8.lo, m8.hi);
        largest = max(max(m4.x, m4.y), max(m4.z, m4.w));
    } else {
        for (uint m = 0; m < count; m++) largest = max(largest, points[m]);
    }
    return largest < c->point_count;
}

/* A cluster that is not full repeats its first sample. */
inline_always void cluster_gather(const complex_job *c, uint n, complex_arrays in, BITS out[CLUSTER_POINTS]) {
    global const uint *points = in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    uint count = 4 * cluster_size(c, n);
    if (count == CLUSTER_POINTS)
        for (uint m = 0; m < CLUSTER_POINTS; m++) out[m] = in.samples[points[m]];
    else
        for (uint m = 0; m < CLUSTER_POINTS; m++) out[m] = in.samples[points[m < count ? m : 0]];
}

/* Nothing is known of the cluster's points yet; where one is not valid, its range is empty. */
inline_always brick_range cluster_range(const slab *s, const complex_job *c, uint n, complex_arrays in, uint *invalid) {
    BITS samples[CLUSTER_POINTS];
    brick_range range = {0, 0};
    if (!cluster_valid(c, n, in.tetrahedra + (ulong)CLUSTER_POINTS * n)) {
        *invalid = 1;
        return range;
    }
    cluster_gather(c, n, in, samples);
    BITS16 low = (BITS) ~(BITS)0, high = 0;
    for (uint m = 0; m < CLUSTER_POINTS / 16; m++) {
        BITS16 keys = keys16(vload16(m, samples), s);
        low = min(low, keys), high = max(high, keys);
    }
    range.low = keys_least(low);
    range.high = keys_most(high);
    return range;
}

/* The lowest bits of 16 nibbles, next to each other. */
inline_always ulong nibbles_pack(ulong x) {
    x = (x | x >> 3) & 0x0303030303030303ul;
    x = (x | x >> 6) & 0x000f000f000f000ful;
    x = (x | x >> 12) & 0x000000ff000000fful;
    return (x | x >> 24) & 0xfffful;
}

/* Any bit of each nibble, in its lowest. */
inline_always ulong nibbles_any(ulong x) { return (x | x >> 1 | x >> 2 | x >> 3) & 0x1111111111111111ul; }

/* Where the surface passes through, and what it makes there. Of points that are valid. */
inline_always cluster_report cluster_count(const slab *s, const complex_job *c, uint n, complex_arrays in) {
    BITS samples[CLUSTER_POINTS];
    cluster_report report = {0, 0, 0};
    uint size = cluster_size(c, n);
    cluster_gather(c, n, in, samples);
    for (uint part = 0; part < 4; part++) {
        ulong inside = 0, missing = 0;
        for (uint m = 0; m < 4; m++) {
            BITS16 bits = vload16(4 * part + m, samples);
            inside |= (ulong)mask_pack(inside_mask(bits, s)) << (16 * m);
#if FLOATING
            missing |= (ulong)mask_pack(missing_mask(bits, s)) << (16 * m);
#endif
        }
        ulong odd = inside ^ inside >> 1, mixed = nibbles_any(inside) & nibbles_any(~inside) & ~nibbles_any(missing);
        odd = (odd ^ odd >> 2) & mixed;
        if (size < 16 * part + 16) {
            ulong valid = size > 16 * part ? (1ul << (4 * (size - 16 * part))) - 1 : 0;
            odd &= valid, mixed &= valid;
        }
        uint one = (uint)popcount(odd), all = (uint)popcount(mixed);
        report.active |= nibbles_pack(mixed) << (16 * part);
        report.triangles += 2 * all - one;
        report.edges += 4 * all - one;
    }
    return report;
}
