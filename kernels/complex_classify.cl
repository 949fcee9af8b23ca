/*
 * complex_classify.cl - kernel 1 of complexes: which tetrahedra the surface passes through, and prefix sums of them and
 * their triangles; then a list of them
 *
 * A first visit reads every tetrahedron once and keeps the range of its cluster's samples; later ones read only the
 * clusters whose range holds the isovalue.
 */

/* Both counts of a tile, added up over the group's work-items; clusters NULL: nothing is stored. */
inline_always uint2 tile_count(tile_tools k, uint number, complex_arrays in, global brick_range *ranges,
                               global cluster_state *clusters, global uint *active, global uint *head, uint *crossed,
                               uint *invalid) {
    uint2 running = 0;
    for (uint start = 0; start < k.c->tile_clusters; start += WORK_ITEMS) {
        uint n = number * k.c->tile_clusters + start + (uint)get_local_id(0);
        cluster_report report = {0, 0, 0};
        if (start + (uint)get_local_id(0) < k.c->tile_clusters && n < k.c->cluster_count) {
            brick_range range = {0, ~0u};
            if (k.s->ranges_known)
                range = ranges[n];
            else if (clusters)
                ranges[n] = range = cluster_range(k.s, k.c, n, in, invalid);
            else if (!cluster_valid(k.c, n, in.tetrahedra + (ulong)CLUSTER_POINTS * n))
                range.high = 0;
            if (range.low | range.high && range_sign(k.s, range) == SIGN_MIXED) report = cluster_count(k.s, k.c, n, in);
        }
        uint2 counts = (uint2)((uint)popcount(report.active), report.triangles);
        uint2 before = group_prefix(counts, &running, k.sums);
        if (clusters && report.active) {
            cluster_state state = {report.active, before.x, before.y};
            clusters[n] = state;
            active[atomic_inc(&head[HEAD_ACTIVE_CLUSTERS])] = n;
            *crossed += report.edges;
        }
    }
    return running;
}

inline_always void cluster_tile_settle(tile_tools k, uint number, complex_arrays in, global brick_range *ranges,
                                       global uint *head) {
    uint missing, none = 0;
    bool look = false;
    while (!tile_settle(k, number, look, &missing)) {
        tile_post(k, missing, tile_count(k, missing, in, ranges, NULL, NULL, NULL, &none, &none));
        look = true;
    }
    if (get_local_id(0) == 0 && number + 1 == k.c->cluster_tiles) {
        head[HEAD_ACTIVE] = tile_before(k.tiles, number + 1, TILE_VERTICES);
        head[HEAD_TRIANGLES] = tile_before(k.tiles, number + 1, TILE_TRIANGLES);
    }
}

/* state: head and tiles, cleared. active receives the clusters that have active tetrahedra. */
kernel void complex_classify(slab s, complex_job c, global const BITS *samples, global const uint *tetrahedra,
                             global brick_range *ranges, global cluster_state *clusters, global uint *active,
                             global uint *state) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    global uint *head = state;
    tile_tools k = {&s, &c, state + HEAD_WORDS, shared, sums};
    complex_arrays in = {samples + c.sample_offset, tetrahedra + c.tetrahedron_offset};
    uint number = 0, first_own = c.cluster_tiles, last_own = c.cluster_tiles, crossed = 0, invalid = 0;
    while (number < c.cluster_tiles) {
        number = ticket_take(&head[HEAD_TICKETS + KERNEL_CLASSIFY], shared);
        if (number < c.cluster_tiles) {
            tile_post(k, number, tile_count(k, number, in, ranges, clusters, active, head, &crossed, &invalid));
#if WORK_ITEMS == 1
            if (first_own == c.cluster_tiles)
                first_own = number;
            else
                k.tiles[TILE_WORDS * last_own + TILE_NEXT] = number;
            k.tiles[TILE_WORDS * number + TILE_NEXT] = c.cluster_tiles;
            last_own = number;
#else
            cluster_tile_settle(k, number, in, ranges, head);
#endif
        }
    }
#if WORK_ITEMS == 1
    for (uint own = first_own; own < c.cluster_tiles; own = k.tiles[TILE_WORDS * own + TILE_NEXT])
        cluster_tile_settle(k, own, in, ranges, head);
#endif
    if (crossed) atomic_add(&head[HEAD_CROSSED], crossed);
    if (invalid) atomic_or(&head[HEAD_INVALID], 1u);
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
        uint number = n * CLUSTER_TETRAHEDRA + (uint)popcount(~rest & (rest - 1));
        uint4 points = vload4(number, in.tetrahedra);
        active_tetrahedron t = {{points.x, points.y, points.z, points.w}, 0, triangle, 0, 0};
        for (uint v = 0; v < 4; v++)
            t.pattern |= (uint)((BITS)(in.samples[t.points[v]] - (BITS)s->inside_low) <= (BITS)s->inside_span) << v;
        out[place++] = t;
        triangle += cases[CASE_BYTES * t.pattern + CASE_TRIANGLES];
    }
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
            if (n < at_once && first + n < count)
                cluster_list(&s, &c, active[first + n], in, clusters, state + HEAD_WORDS, cases, out);
        }
    }
}
