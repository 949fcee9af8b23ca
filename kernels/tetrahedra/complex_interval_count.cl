/*
 * complex_interval_count.cl - kernel complex_interval_count: which points are vertices, how many tetrahedra each
 * cluster gives, and prefix sums of both
 *
 * Words of points and clusters are counted together: item n is word n, of 64 points, and cluster n. A cluster that lies
 * on one side of a bound, by its range, has no patterns of it; of others kernel 1 has found them. So samples are read
 * again at points only, and where a bound is lacking and samples are missing.
 */
#ifndef COMPLEX_INTERVAL_COUNT_CL
#define COMPLEX_INTERVAL_COUNT_CL

#include "complex_edges.cl"
#include "complex_interval_job.h"

/* What the kernel reads and writes. */
typedef struct volume_count {
    const complex_job *low, *high; /* the jobs of the two surfaces */
    const volume_job *v;
    complex_arrays in;
    global const brick_range *ranges;
    global const ulong *used; /* a bit for each point that a present tetrahedron has */
    global const uchar *cases;
    global const cluster_state *low_clusters, *high_clusters;
    global volume_cluster *clusters;
    global volume_points *points;
    global uint *head;
} volume_count;

inline_always bool not_below(BITS bits, const volume_count *a) {
    return !a->v->has_low || bits_inside(bits, &a->low->test);
}

inline_always bool is_above(BITS bits, const volume_count *a) {
    return a->v->has_high && bits_inside(bits, &a->high->test);
}

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

/* The bits of all points of a cluster's tetrahedra. */
inline_always ulong cluster_points(uint n, const volume_count *a) { return ~0ul >> (64 - 4 * cluster_size(a->low, n)); }

/* The same of those without missing samples, by reading all of them. */
inline_always ulong cluster_present(uint n, const volume_count *a) {
    global const uint *points = a->in.tetrahedra + (ulong)CLUSTER_POINTS * n;
    const uint count = 4 * cluster_size(a->low, n);
    ulong missing = 0;
    for (uint m = 0; m < count; m++) missing |= (ulong)bits_missing(a->in.samples[points[m]], &a->low->test) << m;
    return cluster_points(n, a) & ~(nibbles_any(missing) * 15);
}

/* Where its points are. A surface that may pass through the cluster has told by its patterns, which are 0 of tetrahedra
 * with missing samples. */
inline_always volume_cluster cluster_sides(uint n, const volume_count *a) {
    volume_cluster found = {0, 0, 0, 0};
    uint low = SIGN_INSIDE, high = SIGN_OUTSIDE;
    if (a->v->has_low) low = range_sign(&a->low->test, a->ranges[n]);
    if (a->v->has_high) high = range_sign(&a->high->test, a->ranges[n]);
    if (low == SIGN_OUTSIDE || high == SIGN_INSIDE) return found;
    if (high == SIGN_MIXED) found.high = a->high_clusters[n].patterns;
    if (low == SIGN_MIXED)
        found.low = a->low_clusters[n].patterns;
    else if (a->low->ranges_known && range_finite(a->ranges[n]))
        found.low = cluster_points(n, a);
    else
        found.low = cluster_present(n, a);
    return found;
}

/* The pattern of tetrahedron m of a cluster, as the table of cases has it. */
inline_always uint pattern_of(const volume_cluster *c, uint m) {
    return (uint)(c->low >> 4 * m & 15) << 4 | (uint)(c->high >> 4 * m & 15);
}

/* Tetrahedra with a point that is above and below: the caller has changed them or samples in between. They are left
 * out. The lowest bit of four for each, here and in what follows. */
inline_always ulong cluster_changed(const volume_cluster *c) { return nibbles_any(c->high & ~c->low); }

/* The tetrahedra of a cluster that lie within in part. */
inline_always ulong cluster_reached(const volume_cluster *c) {
    return nibbles_any(c->low) & nibbles_any(~c->high) & ~cluster_changed(c);
}

inline_always uint cluster_tetrahedra(const volume_cluster *c, global const uchar *cases) {
    uint sum = 0;
    if (!nibbles_mixed(c->low) && !c->high) return (uint)popcount(nibbles_any(c->low));
    for (ulong rest = cluster_reached(c); rest; rest &= rest - 1) sum += cases[pattern_of(c, lowest_bit(rest) / 4)];
    return sum;
}

/* Vertices at points and tetrahedra of a tile; recount: nothing is stored. */
inline_always uint2 volume_tile_count(tile_tools tools, uint number, const volume_count *a, bool recount) {
    const uint items = 1u << a->v->tile_shift;
    uint2 running = 0;
    for (uint start = 0; start < items; start += WORK_ITEMS) {
        const uint m = start + (uint)get_local_id(0), n = number * items + m;
        const bool has_points = m < items && n < a->v->word_count, has_cluster = m < items && n < a->low->cluster_count;
        volume_points points = {0, 0, 0};
        volume_cluster cluster = {0, 0, 0, 0};
        if (has_points) points.within = points_within(n, a);
        if (has_cluster) cluster = cluster_sides(n, a);
        const uint2 own = (uint2)((uint)popcount(points.within), cluster_tetrahedra(&cluster, a->cases));
        const uint2 before = group_prefix(own, &running, tools.scan.sums);
        points.before = before.x, cluster.tetrahedra = before.y;
        if (has_points && !recount) a->points[n] = points;
        if (has_cluster && !recount) a->clusters[n] = cluster;
    }
    return running;
}

inline_always void volume_tile_settle(tile_tools tools, uint number, const volume_count *a) {
    uint unposted;
    bool look = false;
    while (!tile_settle(tools.scan, number, look, &unposted)) {
        tile_post(tools.scan, unposted, volume_tile_count(tools, unposted, a, true));
        look = true;
    }
    if (get_local_id(0) == 0 && number + 1 == a->v->tile_count) {
        a->head[VOLUME_SAMPLES] = tile_before(tools.scan.tiles, number + 1, TILE_VERTICES);
        a->head[VOLUME_TETRAHEDRA] = tile_before(tools.scan.tiles, number + 1, TILE_TRIANGLES);
    }
}

/* state: head and tiles, cleared. */
kernel void complex_interval_count(complex_job low, complex_job high, volume_job v, global const BITS *samples,
                                   global const uint *tetrahedra, global const brick_range *ranges,
                                   global const ulong *used, global const uchar *cases,
                                   global const cluster_state *low_clusters, global const cluster_state *high_clusters,
                                   global volume_cluster *clusters, global volume_points *points, global uint *state) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    tile_tools tools = {&low, {low.spin_limit, state + VOLUME_HEAD_WORDS, shared, sums}};
    const volume_count a = {
        &low,          &high,    &v,     {samples + low.sample_offset, tetrahedra + low.tetrahedron_offset},
        ranges,        used,     cases,  low_clusters,
        high_clusters, clusters, points, state};
    own_tiles own = {NO_TILE, NO_TILE};
    uint number = 0;
    while (number < v.tile_count) {
        number = ticket_take(&state[VOLUME_TICKET_COUNT], shared);
        if (number < v.tile_count) {
            tile_post(tools.scan, number, volume_tile_count(tools, number, &a, false));
            if (SETTLES_LATER)
                own_append(&own, number, tools.scan.tiles);
            else
                volume_tile_settle(tools, number, &a);
        }
    }
    for (uint n = own.first; SETTLES_LATER && n != NO_TILE; n = tools.scan.tiles[TILE_WORDS * n + TILE_NEXT])
        volume_tile_settle(tools, n, &a);
}

#endif
