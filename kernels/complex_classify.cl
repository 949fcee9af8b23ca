/*
 * complex_classify.cl - kernel 1 of complexes: which tetrahedra the surface passes through, and prefix sums of them and
 * their triangles; then a list of them
 *
 * A first visit reads every tetrahedron once and keeps the range of its cluster's samples; later ones read only the
 * clusters whose range holds the isovalue.
 */

/* What kernel 1 works on. */
typedef struct cluster_arrays {
    complex_arrays in;
    global brick_range *ranges;
    global cluster_state *clusters;
    global uint *active, *head;
} cluster_arrays;

/* Sums over the clusters that a work-item has seen. */
typedef struct cluster_sums {
    uint crossed, invalid;
} cluster_sums;

/* Whether the surface may pass through a cluster; the first visit keeps its range. A recount does not know whether that
 * is there yet. */
inline_always bool cluster_mixed(tile_tools k, uint n, cluster_arrays a, bool recount, cluster_sums *sums) {
    if (k.s->ranges_known) return range_sign(k.s, a.ranges[n]) == SIGN_MIXED;
    if (recount) return cluster_valid(k.c, n, a.in.tetrahedra + (ulong)CLUSTER_POINTS * n);
    uint invalid = 0;
    brick_range range = cluster_range(k.s, k.c, n, a.in, &invalid);
    a.ranges[n] = range;
    sums->invalid |= invalid;
    return !invalid && range_sign(k.s, range) == SIGN_MIXED;
}

/* Counts a cluster for the whole group's sums *running; none: the work-item has no cluster. */
inline_always void cluster_add(tile_tools k, uint n, bool none, cluster_arrays a, bool recount, uint2 *running,
                               cluster_sums *sums) {
    cluster_report report = {0, 0, 0};
    if (!none) report = cluster_count(k.s, k.c, n, a.in);
    uint2 before = group_prefix((uint2)((uint)popcount(report.active), report.triangles), running, k.sums);
    if (recount || !report.active) return;
    cluster_state state = {report.active, before.x, before.y};
    a.clusters[n] = state;
    a.active[atomic_inc(&a.head[HEAD_ACTIVE_CLUSTERS])] = n;
    sums->crossed += report.edges;
}

#if WORK_ITEMS == 1

/* Bit m: cluster first + m is below end and mixed by its range, which is known; its tetrahedra are asked for. */
inline_always ulong mixed_prefetch(tile_tools k, uint first, uint end, cluster_arrays a) {
    ulong mixed = 0;
    for (uint m = 0; m < 64 && first + m < end; m++)
        mixed |= (ulong)(range_sign(k.s, a.ranges[first + m]) == SIGN_MIXED) << m;
    for (ulong rest = mixed; rest; rest &= rest - 1) {
        global const uint *points = a.in.tetrahedra + (ulong)CLUSTER_POINTS * (first + lowest_bit(rest));
        for (uint m = 0; m < CLUSTER_POINTS; m += 16) line_prefetch(points + m);
    }
    return mixed;
}

/* Active tetrahedra and triangles of a tile; recount: nothing is stored. */
inline_always uint2 tile_count(tile_tools k, uint number, cluster_arrays a, bool recount, cluster_sums *sums) {
    uint first = number * k.c->tile_clusters, end = min(first + k.c->tile_clusters, k.c->cluster_count);
    uint2 running = 0;
    if (!k.s->ranges_known) {
        for (uint n = first; n < end; n++)
            if (cluster_mixed(k, n, a, recount, sums)) cluster_add(k, n, false, a, recount, &running, sums);
        return running;
    }
    ulong next = mixed_prefetch(k, first, end, a);
    for (uint start = first; start < end; start += 64) {
        ulong mixed = next;
        next = mixed_prefetch(k, start + 64, end, a);
        for (; mixed; mixed &= mixed - 1) cluster_add(k, start + lowest_bit(mixed), false, a, recount, &running, sums);
    }
    return running;
}

#else

/* Active tetrahedra and triangles of a tile, for the whole group; recount: nothing is stored. */
inline_always uint2 tile_count(tile_tools k, uint number, cluster_arrays a, bool recount, cluster_sums *sums) {
    uint2 running = 0;
    for (uint start = 0; start < k.c->tile_clusters; start += WORK_ITEMS) {
        uint m = start + (uint)get_local_id(0), n = number * k.c->tile_clusters + m;
        bool mixed = m < k.c->tile_clusters && n < k.c->cluster_count && cluster_mixed(k, n, a, recount, sums);
        cluster_add(k, n, !mixed, a, recount, &running, sums);
    }
    return running;
}

#endif

inline_always void cluster_tile_settle(tile_tools k, uint number, cluster_arrays a) {
    uint missing;
    bool look = false;
    cluster_sums none = {0, 0};
    while (!tile_settle(k, number, look, &missing)) {
        tile_post(k, missing, tile_count(k, missing, a, true, &none));
        look = true;
    }
    if (get_local_id(0) == 0 && number + 1 == k.c->cluster_tiles) {
        a.head[HEAD_ACTIVE] = tile_before(k.tiles, number + 1, TILE_VERTICES);
        a.head[HEAD_TRIANGLES] = tile_before(k.tiles, number + 1, TILE_TRIANGLES);
    }
}

/* state: head and tiles, cleared. active receives the clusters that have active tetrahedra. */
kernel void complex_classify(slab s, complex_job c, global const BITS *samples, global const uint *tetrahedra,
                             global brick_range *ranges, global cluster_state *clusters, global uint *active,
                             global uint *state) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    tile_tools k = {&s, &c, state + HEAD_WORDS, shared, sums};
    cluster_arrays a = {
        {samples + c.sample_offset, tetrahedra + c.tetrahedron_offset}, ranges, clusters, active, state};
    cluster_sums found = {0, 0};
    uint number = 0, first_own = c.cluster_tiles, last_own = c.cluster_tiles;
    while (number < c.cluster_tiles) {
        number = ticket_take(&state[HEAD_TICKETS + KERNEL_CLASSIFY], shared);
        if (number < c.cluster_tiles) {
            tile_post(k, number, tile_count(k, number, a, false, &found));
#if WORK_ITEMS == 1
            if (first_own == c.cluster_tiles)
                first_own = number;
            else
                k.tiles[TILE_WORDS * last_own + TILE_NEXT] = number;
            k.tiles[TILE_WORDS * number + TILE_NEXT] = c.cluster_tiles;
            last_own = number;
#else
            cluster_tile_settle(k, number, a);
#endif
        }
    }
#if WORK_ITEMS == 1
    for (uint own = first_own; own < c.cluster_tiles; own = k.tiles[TILE_WORDS * own + TILE_NEXT])
        cluster_tile_settle(k, own, a);
#endif
    if (found.crossed) atomic_add(&state[HEAD_CROSSED], found.crossed);
    if (found.invalid) atomic_or(&state[HEAD_INVALID], 1u);
}

/* The active tetrahedra of one cluster, in order. */
inline_always void cluster_list(const slab *s, const complex_job *c, uint n, complex_arrays in,
                                global const cluster_state *clusters, global const uint *tiles,
                                global const uchar *cases, global active_tetrahedron *out) {
    cluster_state cluster = clusters[n];
    uint tile = n / c->tile_clusters;
    uint place = tile_before(tiles, tile, TILE_VERTICES) + cluster.active_before;
    uint triangle = tile_before(tiles, tile, TILE_TRIANGLES) + cluster.triangles_before;
    for (ulong rest = cluster.active; rest; rest &= rest - 1) {
        uint number = n * CLUSTER_TETRAHEDRA + lowest_bit(rest);
        uint4 points = vload4(number, in.tetrahedra);
        active_tetrahedron t = {{points.x, points.y, points.z, points.w}, 0, triangle, 0, 0};
        for (uint v = 0; v < 4; v++)
            t.pattern |= (uint)((BITS)(in.samples[t.points[v]] - (BITS)s->inside_low) <= (BITS)s->inside_span) << v;
        out[place++] = t;
        triangle += cases[CASE_BYTES * t.pattern + CASE_TRIANGLES];
    }
}

/* Those of its tetrahedra that will be read, four to a cache line. */
inline_always void active_prefetch(global const cluster_state *clusters, uint n, complex_arrays in) {
    ulong active = clusters[n].active;
    for (uint m = 0; m < CLUSTER_POINTS; m += 16, active >>= 4)
        if (active & 15) line_prefetch(in.tetrahedra + (ulong)CLUSTER_POINTS * n + m);
}

kernel void complex_list(slab s, complex_job c, global const BITS *samples, global const uint *tetrahedra,
                         global const cluster_state *clusters, global const uint *active, global uint *state,
                         global const uchar *cases, global active_tetrahedron *out) {
    local uint shared[4];
    complex_arrays in = {samples + c.sample_offset, tetrahedra + c.tetrahedron_offset};
    const uint count = state[HEAD_ACTIVE_CLUSTERS], at_once = 64;
    uint first = 0;
    while (first < count) {
        first = at_once * ticket_take(&state[HEAD_TICKETS + KERNEL_LIST], shared);
        for (uint start = 0; start < at_once; start += WORK_ITEMS) {
            uint n = start + (uint)get_local_id(0);
            if (WORK_ITEMS == 1 && first + n + 2 < count) active_prefetch(clusters, active[first + n + 2], in);
            if (WORK_ITEMS == 1 && first + n + 4 < count) line_prefetch(clusters + active[first + n + 4]);
            if (n < at_once && first + n < count)
                cluster_list(&s, &c, active[first + n], in, clusters, state + HEAD_WORDS, cases, out);
        }
    }
}
