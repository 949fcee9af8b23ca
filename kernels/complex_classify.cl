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

#if WORK_ITEMS == 1
enum { LIST_BATCH = 64 };
#endif

/* What a work-item has seen of clusters: sums over them; where it is alone, active ones that are not listed yet. */
typedef struct cluster_sums {
    uint crossed, invalid;
#if WORK_ITEMS == 1
    uint active_count, active[LIST_BATCH];
#endif
} cluster_sums;

#if WORK_ITEMS == 1
/* Work-items meet at the list's end: many clusters at once. */
inline_always void clusters_append(cluster_arrays a, cluster_sums *sums) {
    uint place = atomic_add(&a.head[HEAD_ACTIVE_CLUSTERS], sums->active_count);
    for (uint n = 0; n < sums->active_count; n++) a.active[place + n] = sums->active[n];
    sums->active_count = 0;
}

inline_always void cluster_append(uint n, cluster_arrays a, cluster_sums *sums) {
    sums->active[sums->active_count++] = n;
    if (sums->active_count == LIST_BATCH) clusters_append(a, sums);
}
#else
inline_always void cluster_append(uint n, cluster_arrays a, cluster_sums *sums) {
    a.active[atomic_inc(&a.head[HEAD_ACTIVE_CLUSTERS])] = n;
}
#endif

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
    cluster_report report = {0, 0, 0, 0};
    if (!none) report = cluster_count(k.s, k.c, n, a.in);
    uint2 before = group_prefix((uint2)(report.active, report.triangles), running, k.sums);
    if (recount || !report.active) return;
    cluster_state state = {report.patterns, before.x, before.y};
    a.clusters[n] = state;
    cluster_append(n, a, sums);
    sums->crossed += report.edges;
}

#if WORK_ITEMS == 1

/* As range_sign() of ranges[0] to [15] is SIGN_MIXED, a bit each. */
inline_always uint ranges_mixed(const slab *s, global const brick_range *ranges) {
    uint16 first = vload16(0, (global const uint *)ranges), second = vload16(1, (global const uint *)ranges);
    uint16 low = (uint16)(first.even, second.even), high = (uint16)(first.odd, second.odd);
    int16 mixed = (low < s->key_inside) & (high >= s->key_outside);
#if FLOATING
    mixed |= (high >= KEY_INFINITY) | (low <= ~KEY_INFINITY);
#endif
    return mask_pack(convert_char16(mixed));
}

/* Bit m: cluster first + m is below end and mixed by its range, which is known; its tetrahedra are asked for. */
inline_always ulong mixed_prefetch(tile_tools k, uint first, uint end, cluster_arrays a) {
    ulong mixed = 0;
    if (first + 64 <= end)
        for (uint m = 0; m < 64; m += 16) mixed |= (ulong)ranges_mixed(k.s, a.ranges + first + m) << m;
    else
        for (uint m = 0; first + m < end; m++)
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
        for (; mixed; mixed &= mixed - 1) {
            if (mixed & (mixed - 1)) cluster_prefetch(k.c, start + lowest_bit(mixed & (mixed - 1)), a.in);
            cluster_add(k, start + lowest_bit(mixed), false, a, recount, &running, sums);
        }
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
    cluster_sums none = {0};
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
    cluster_sums found = {0};
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
    clusters_append(a, &found);
    for (uint own = first_own; own < c.cluster_tiles; own = k.tiles[TILE_WORDS * own + TILE_NEXT])
        cluster_tile_settle(k, own, a);
#endif
    if (found.crossed) atomic_add(&state[HEAD_CROSSED], found.crossed);
    if (found.invalid) atomic_or(&state[HEAD_INVALID], 1u);
}

/* The active tetrahedra of one cluster, in order. */
inline_always void cluster_list(const complex_job *c, uint n, global const uint *tetrahedra,
                                global const cluster_state *clusters, global const uint *tiles,
                                global const uchar *cases, global active_tetrahedron *out) {
    cluster_state cluster = clusters[n];
    uint tile = n / c->tile_clusters;
    uint place = tile_before(tiles, tile, TILE_VERTICES) + cluster.active_before;
    uint triangle = tile_before(tiles, tile, TILE_TRIANGLES) + cluster.triangles_before;
    for (ulong rest = nibbles_any(cluster.patterns); rest; rest &= rest - 1) {
        uint bit = lowest_bit(rest), pattern = (uint)(cluster.patterns >> bit) & 15;
        uint4 points = vload4(n * CLUSTER_TETRAHEDRA + bit / 4, tetrahedra);
        active_tetrahedron t = {{points.x, points.y, points.z, points.w}, pattern, triangle, 0, 0};
        out[place++] = t;
        triangle += cases[CASE_BYTES * pattern + CASE_TRIANGLES];
    }
}

/* Those of its tetrahedra that will be read, four to a cache line. */
inline_always void active_prefetch(global const cluster_state *clusters, uint n, global const uint *tetrahedra) {
    ulong patterns = clusters[n].patterns;
    for (uint m = 0; m < CLUSTER_POINTS; m += 16, patterns >>= 16)
        if (patterns & 0xffff) line_prefetch(tetrahedra + (ulong)CLUSTER_POINTS * n + m);
}

/* The group's part of an array of so many words. */
inline_always void words_fill(global uint *words, uint count, uint value) {
    uint part = count / (uint)get_num_groups(0) + 1, first = min(part * (uint)get_group_id(0), count);
    uint end = first + min(part, count - first);
    for (uint n = first + (uint)get_local_id(0); n < end; n += WORK_ITEMS) words[n] = value;
}

/* table and tiles are cleared for the kernels that follow. */
kernel void complex_list(complex_job c, global const uint *tetrahedra, global const cluster_state *clusters,
                         global const uint *active, global uint *state, global const uchar *cases,
                         global active_tetrahedron *out, global uint *table, global uint *tiles) {
    local uint shared[4];
    const uint count = state[HEAD_ACTIVE_CLUSTERS], at_once = 64;
    uint first = 0;
    tetrahedra += c.tetrahedron_offset;
    words_fill(table, c.table_mask + 1, EDGE_NONE);
    words_fill(tiles, TILE_WORDS * c.active_tiles, 0);
    while (first < count) {
        first = at_once * ticket_take(&state[HEAD_TICKETS + KERNEL_LIST], shared);
        for (uint start = 0; start < at_once; start += WORK_ITEMS) {
            uint n = start + (uint)get_local_id(0);
            if (WORK_ITEMS == 1 && first + n + 2 < count) active_prefetch(clusters, active[first + n + 2], tetrahedra);
            if (WORK_ITEMS == 1 && first + n + 4 < count) line_prefetch(clusters + active[first + n + 4]);
            if (n < at_once && first + n < count)
                cluster_list(&c, active[first + n], tetrahedra, clusters, state + HEAD_WORDS, cases, out);
        }
    }
}
