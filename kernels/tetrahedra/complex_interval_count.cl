/*
 * complex_interval_count.cl - kernel complex_interval_count: which points are vertices, how many tetrahedra each
 * cluster gives, where both bounds cut it, and prefix sums of these
 *
 * Words of points and clusters are counted together: item n is word n, of 64 points, and cluster n. A first visit reads
 * the samples of all clusters and keeps their ranges; later ones only those of clusters that a bound may pass through.
 */
#ifndef COMPLEX_INTERVAL_COUNT_CL
#define COMPLEX_INTERVAL_COUNT_CL

#include "complex_edges.cl"
#include "complex_interval_job.h"

/* What the kernel reads and writes. */
typedef struct volume_count {
    const complex_job *low, *high; /* of the two bounds */
    const volume_job *v;
    complex_arrays in;
    global brick_range *ranges;
    global const ulong *used; /* a bit for each point that a present tetrahedron has */
    global const uchar *cases;
    global volume_cluster *clusters;
    global volume_points *points;
    global uint *head;
} volume_count;

/* The tiles of a scan. */
inline_always global uint *scan_tiles(global uint *state, const volume_job *v, uint scan) {
    return state + VOLUME_HEAD_WORDS + TILE_WORDS * scan * v->tile_count;
}

inline_always bool not_below(BITS bits, const volume_count *a) {
    return !a->v->has_low || bits_inside(bits, &a->low->test);
}

inline_always bool is_above(BITS bits, const volume_count *a) {
    return a->v->has_high && bits_inside(bits, &a->high->test);
}

/* ----------------------------------------------------------------------------------------------------------- points */

#if WORK_ITEMS == 1

/* Which of 64 samples are within. */
inline_always ulong samples_within(global const BITS *samples, const volume_count *a) {
    ulong low = 0, high = 0;
    for (uint m = 0; m < 64; m += 16) {
        const BITS16 bits = vload16(0, samples + m);
        low |= (ulong)mask_pack(inside_mask(bits, &a->low->test)) << m;
        high |= (ulong)mask_pack(inside_mask(bits, &a->high->test)) << m;
    }
    return (a->v->has_low ? low : ~0ul) & ~(a->v->has_high ? high : 0);
}

#endif

/* Which of 64 points are vertices. Those of present tetrahedra have finite samples. */
inline_always ulong points_within(uint n, const volume_count *a) {
    ulong within = a->used[n];
#if WORK_ITEMS == 1
    if (within && 64ul * n + 64 <= a->low->point_count) return within & samples_within(a->in.samples + 64ul * n, a);
#endif
    for (ulong rest = within; rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest);
        const BITS bits = a->in.samples[64ul * n + bit];
        if (!not_below(bits, a) || is_above(bits, a)) within &= ~(1ul << bit);
    }
    return within;
}

/* --------------------------------------------------------------------------------------------------------- clusters */

/* The bits of all points of a cluster's tetrahedra. */
inline_always ulong cluster_points(uint n, const volume_count *a) { return ~0ul >> (64 - 4 * cluster_size(a->low, n)); }

/* What has been read of a cluster: which of its points are inside by either bound, or missing; the range of its
 * samples. */
typedef struct cluster_signs {
    ulong low, high, missing;
    brick_range range;
} cluster_signs;

#if WORK_ITEMS == 1

inline_always cluster_signs signs_read(uint n, const volume_count *a) {
    cluster_signs s = {0, 0, 0, {0, 0}};
    BITS16 least = (BITS) ~(BITS)0, most = 0;
    loop_unrolled for (uint m = 0; m < CLUSTER_POINTS / 16; m++) {
        const BITS16 bits = cluster_samples(a->low, n, m, a->in);
        s.low |= (ulong)mask_pack(inside_mask(bits, &a->low->test)) << (16 * m);
        s.high |= (ulong)mask_pack(inside_mask(bits, &a->high->test)) << (16 * m);
#if FLOATING
        s.missing |= (ulong)mask_pack(missing_mask(bits, &a->low->test)) << (16 * m);
#endif
        if (a->low->ranges_known) continue;
        const BITS16 keys = keys16(bits, &a->low->test);
        least = min(least, keys), most = max(most, keys);
    }
    if (!a->low->ranges_known) s.range = keys_range(least, most);
    return s;
}

#else

inline_always cluster_signs signs_read(uint n, const volume_count *a) {
    global const uint *points = a->in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    const uint count = 4 * cluster_size(a->low, n);
    cluster_signs s = {0, 0, 0, {0, 0}};
    BITS least = (BITS) ~(BITS)0, most = 0;
    for (uint m = 0; m < count; m++) {
        const BITS bits = a->in.samples[points[m]], key = key_of(bits, &a->low->test);
        s.low |= (ulong)bits_inside(bits, &a->low->test) << m;
        s.high |= (ulong)bits_inside(bits, &a->high->test) << m;
#if FLOATING
        s.missing |= (ulong)bits_missing(bits, &a->low->test) << m;
#endif
        least = min(least, key), most = max(most, key);
    }
    s.range.low = key_upper(least), s.range.high = key_upper(most);
    return s;
}

#endif

inline_always volume_cluster cluster_of(uint n, const cluster_signs *s, const volume_count *a) {
    const ulong present = cluster_points(n, a) & ~(nibbles_any(s->missing) * 15);
    const volume_cluster found = {(a->v->has_low ? s->low : ~0ul) & present, (a->v->has_high ? s->high : 0) & present,
                                  0, 0};
    return found;
}

/* The side of either bound that all of a cluster's samples are on, by their range. */
inline_always uint low_side(uint n, const volume_count *a) {
    return a->v->has_low ? range_sign(&a->low->test, a->ranges[n]) : SIGN_INSIDE;
}

inline_always uint high_side(uint n, const volume_count *a) {
    return a->v->has_high ? range_sign(&a->high->test, a->ranges[n]) : SIGN_OUTSIDE;
}

/* Checks the cluster's point numbers, and keeps its range. A recount cannot use ranges, as another group may not have
 * stored them yet. */
inline_always volume_cluster cluster_first(uint n, const volume_count *a, bool recount) {
    const volume_cluster none = {0, 0, 0, 0};
    if (!cluster_valid(a->low, n, a->in)) {
        atomic_or(&a->head[VOLUME_INVALID], 1u);
        return none;
    }
    const cluster_signs s = signs_read(n, a);
    if (!recount) a->ranges[n] = s.range;
    return cluster_of(n, &s, a);
}

/* Where a cluster's points are. */
inline_always volume_cluster cluster_sides(uint n, const volume_count *a, bool recount) {
    volume_cluster found = {0, 0, 0, 0};
    if (!a->low->ranges_known) return cluster_first(n, a, recount);
    const uint low = low_side(n, a), high = high_side(n, a);
    if (low == SIGN_OUTSIDE || high == SIGN_INSIDE) return found;
    if (low == SIGN_INSIDE && high == SIGN_OUTSIDE && range_finite(a->ranges[n])) {
        found.low = cluster_points(n, a);
        return found;
    }
    const cluster_signs s = signs_read(n, a);
    return cluster_of(n, &s, a);
}

/* The pattern of tetrahedron m of a cluster, as the table of cases has it. */
inline_always uint pattern_of(const volume_cluster *c, uint m) {
    return (uint)(c->low >> 4 * m & 15) << 4 | (uint)(c->high >> 4 * m & 15);
}

/* The tetrahedra of a cluster of which a part, or all, lies within: the lowest bit of four for each, here and below. */
inline_always ulong cluster_reached(const volume_cluster *c) { return nibbles_any(c->low) & nibbles_any(~c->high); }

/* Tetrahedra of x that have one point, two or three points in it. */
typedef struct point_counts {
    uint ones, twos, threes;
} point_counts;

inline_always point_counts counts_of(ulong x) {
    const ulong mixed = nibbles_mixed(x), odd = x ^ x >> 1, is_odd = (odd ^ odd >> 2) & mixed;
    const ulong pair = x & x >> 1, most = (pair | pair >> 2) & is_odd; /* two neighbours of four, so three */
    const point_counts counts = {(uint)popcount(is_odd & ~most), (uint)popcount(mixed & ~is_odd), (uint)popcount(most)};
    return counts;
}

/* Few clusters are cut by both bounds, and how many tetrahedra a tetrahedron gives depends only on how many of its
 * points are not below, and how many above. */
inline_always uint cluster_tetrahedra(const volume_cluster *c, global const uchar *cases) {
    const bool low_cuts = nibbles_mixed(c->low) != 0;
    uint sum = 0;
    if (!low_cuts && !c->high) return (uint)popcount(nibbles_any(c->low));
    if (low_cuts && c->high) {
        for (ulong rest = cluster_reached(c); rest; rest &= rest - 1) sum += cases[pattern_of(c, lowest_bit(rest) / 4)];
        return sum;
    }
    const point_counts n = counts_of(low_cuts ? c->low : c->high);
    const ulong whole = nibbles_any(c->low) & ~nibbles_mixed(c->low) & ~nibbles_any(c->high);
    const uint first = low_cuts ? 0x10 : 0xf1, second = low_cuts ? 0x30 : 0xf3, third = low_cuts ? 0x70 : 0xf7;
    return (uint)popcount(whole) + n.ones * cases[first] + n.twos * cases[second] + n.threes * cases[third];
}

/* The cuts of a cluster, by both bounds together, and those of them with four crossed edges, as two points are on
 * either side. */
inline_always uint2 cluster_cuts(const volume_cluster *c) {
    const point_counts low = counts_of(c->low), high = counts_of(c->high);
    return (uint2)(low.ones + low.twos + low.threes + high.ones + high.twos + high.threes, low.twos + high.twos);
}

/* ------------------------------------------------------------------------------------------------------------ tiles */

#if WORK_ITEMS == 1

/* Clusters are prefetched in two stages: their tetrahedra so many clusters before, samples half as many before. */
enum { COUNT_AHEAD = 16 };

inline_always bool is_read(uint n, const volume_count *a) {
    return n < a->low->cluster_count && (low_side(n, a) == SIGN_MIXED || high_side(n, a) == SIGN_MIXED);
}

inline_always void count_prefetch(uint n, const volume_count *a) {
    if (!a->low->ranges_known) return;
    if (is_read(n + COUNT_AHEAD, a)) points_prefetch(a->low, n + COUNT_AHEAD, a->in);
    if (is_read(n + COUNT_AHEAD / 2, a)) cluster_prefetch(a->low, n + COUNT_AHEAD / 2, a->in);
}

#else
#define count_prefetch(n, a)
#endif

/* The sums of a tile; recount: nothing is stored. */
inline_always uint4 volume_tile_count(tile_scan scan, uint tile_index, const volume_count *a, bool recount) {
    const uint items = 1u << a->v->tile_shift;
    uint2 volume = 0, cuts = 0;
    for (uint start = 0; start < items; start += WORK_ITEMS) {
        const uint m = start + (uint)get_local_id(0), n = tile_index * items + m;
        const bool has_points = m < items && n < a->v->word_count, has_cluster = m < items && n < a->low->cluster_count;
        volume_points points = {0, 0, 0};
        volume_cluster cluster = {0, 0, 0, 0};
        count_prefetch(n, a);
        if (has_points) points.within = points_within(n, a);
        if (has_cluster) cluster = cluster_sides(n, a, recount);
        const uint2 own = (uint2)((uint)popcount(points.within), cluster_tetrahedra(&cluster, a->cases));
        const uint2 before = group_prefix(own, &volume, scan.sums);
        points.before = before.x, cluster.tetrahedra = before.y;
        cluster.cuts = group_prefix(cluster_cuts(&cluster), &cuts, scan.sums).x;
        if (has_points && !recount) a->points[n] = points;
        if (has_cluster && !recount) a->clusters[n] = cluster;
    }
    return (uint4)(volume, cuts);
}

/* The scan of a tile's first two sums, or of its other two. */
inline_always tile_scan scan_of(tile_scan scan, const volume_count *a, uint which) {
    scan.tiles = scan_tiles(a->head, a->v, which);
    return scan;
}

inline_always void volume_tile_post(tile_scan scan, uint tile_index, const volume_count *a, uint4 sums) {
    tile_post(scan_of(scan, a, SCAN_VOLUME), tile_index, sums.xy);
    tile_post(scan_of(scan, a, SCAN_CUTS), tile_index, sums.zw);
}

inline_always void volume_tile_settle(tile_scan scan, uint tile_index, const volume_count *a, uint which) {
    uint unposted;
    bool look = false;
    while (!tile_settle(scan_of(scan, a, which), tile_index, look, &unposted)) {
        volume_tile_post(scan, unposted, a, volume_tile_count(scan, unposted, a, true));
        look = true;
    }
    if (get_local_id(0) != 0 || tile_index + 1 != a->v->tile_count) return;
    global const uint *tiles = scan_tiles(a->head, a->v, which);
    a->head[which == SCAN_VOLUME ? VOLUME_SAMPLES : VOLUME_CUTS] = tile_before(tiles, tile_index + 1, TILE_SUM_X);
    a->head[which == SCAN_VOLUME ? VOLUME_TETRAHEDRA : VOLUME_FOURS] = tile_before(tiles, tile_index + 1, TILE_SUM_Y);
}

inline_always void volume_tile_settle_both(tile_scan scan, uint tile_index, const volume_count *a) {
    volume_tile_settle(scan, tile_index, a, SCAN_VOLUME);
    volume_tile_settle(scan, tile_index, a, SCAN_CUTS);
}

/* state: head and tiles, cleared. */
kernel void complex_interval_count(complex_job low, complex_job high, volume_job v, global const BITS *samples,
                                   global const uint *tetrahedra, global brick_range *ranges, global const ulong *used,
                                   global const uchar *cases, global volume_cluster *clusters,
                                   global volume_points *points, global uint *state) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    const tile_scan scan = {low.spin_limit, scan_tiles(state, &v, SCAN_VOLUME), shared, sums};
    const volume_count a = {&low,   &high, &v,    {samples + low.sample_offset, tetrahedra + low.tetrahedron_offset},
                            ranges, used,  cases, clusters,
                            points, state};
    own_tiles own = {NO_TILE, NO_TILE};
    uint tile_index = 0;
    while (tile_index < v.tile_count) {
        tile_index = ticket_take(&state[VOLUME_TICKETS + KERNEL_VOLUME_COUNT], shared);
        if (tile_index < v.tile_count) {
            volume_tile_post(scan, tile_index, &a, volume_tile_count(scan, tile_index, &a, false));
            if (SETTLES_LATER)
                own_append(&own, tile_index, scan.tiles);
            else
                volume_tile_settle_both(scan, tile_index, &a);
        }
    }
    for (uint n = own.first; SETTLES_LATER && n != NO_TILE; n = scan.tiles[TILE_WORDS * n + TILE_NEXT])
        volume_tile_settle_both(scan, n, &a);
}

#endif
