/*
 * complex_classify.cl - kernel 1 of complexes: which items are active (complex_count.cl), prefix sums of active
 * tetrahedra and their triangles; then the list of active tetrahedra (of cells: whole_list.cl)
 */
#ifndef COMPLEX_CLASSIFY_CL
#define COMPLEX_CLASSIFY_CL

#include "complex_count.cl"

inline_always void cluster_tile_settle(tile_tools tools, uint tile_index, cluster_arrays a) {
    uint unposted;
    bool look = false;
    cluster_sums none = {0};
    while (!tile_settle(tools.scan, tile_index, look, &unposted)) {
        tile_post(tools.scan, unposted, tile_count(tools, unposted, a, true, &none));
        look = true;
    }
    if (get_local_id(0) == 0 && tile_index + 1 == tools.c->cluster_tiles) {
        a.head[HEAD_ACTIVE] = tile_before(tools.scan.tiles, tile_index + 1, TILE_SUM_X);
        a.head[HEAD_TRIANGLES] = tile_before(tools.scan.tiles, tile_index + 1, TILE_SUM_Y);
    }
}

#if WHOLE
#define CELL_ARGUMENTS , global const ulong *begins, global const uchar *codes, global const uchar *shapes
#define CELL_ARRAYS    , begins + c.begin_offset, codes + c.code_offset, shapes
#else
#define CELL_ARGUMENTS
#define CELL_ARRAYS
#endif

/* state: head and tiles, cleared. active receives the clusters that have active items. */
kernel void complex_classify(complex_job c, global const BITS *samples, global const uint *tetrahedra,
                             global brick_range *ranges, global cluster_state *clusters, global uint *active,
                             global uint *state CELL_ARGUMENTS) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    tile_tools tools = {&c, {c.spin_limit, state + HEAD_WORDS, shared, sums}};
    cluster_arrays a = {
        {samples + c.sample_offset, tetrahedra + c.tetrahedron_offset CELL_ARRAYS}, ranges, clusters, active, state};
    cluster_sums found = {0};
    own_tiles own = {NO_TILE, NO_TILE};
    uint tile_index = 0;
    while (tile_index < c.cluster_tiles) {
        tile_index = ticket_take(&state[HEAD_TICKETS + KERNEL_CLASSIFY], shared);
        if (tile_index < c.cluster_tiles) {
            tile_post(tools.scan, tile_index, tile_count(tools, tile_index, a, false, &found));
            if (SETTLES_LATER)
                own_append(&own, tile_index, tools.scan.tiles);
            else
                cluster_tile_settle(tools, tile_index, a);
        }
    }
    if (LIST_BATCH > 1) clusters_append(a, &found);
    for (uint n = own.first; SETTLES_LATER && n != NO_TILE; n = tools.scan.tiles[TILE_WORDS * n + TILE_NEXT])
        cluster_tile_settle(tools, n, a);
    if (found.crossed) atomic_add(&state[HEAD_CROSSED], found.crossed);
}

/* Fills an array of `count` words; each group fills its part. */
inline_always void words_fill(global uint *words, uint count, uint value) {
    uint part = count / (uint)get_num_groups(0) + 1, first = min(part * (uint)get_group_id(0), count);
    uint end = first + min(part, count - first);
    for (uint n = first + (uint)get_local_id(0); n < end; n += WORK_ITEMS) words[n] = value;
}

#if !WHOLE

/* The active tetrahedra of one cluster, in order. */
inline_always void cluster_list(const complex_job *c, uint n, global const uint *tetrahedra,
                                global const cluster_state *clusters, global const uint *tiles,
                                global const uchar *cases, global active_tetrahedron *out) {
    cluster_state cluster = clusters[n];
    uint tile = n / c->tile_clusters;
    uint first = tile_before(tiles, tile, TILE_SUM_X) + cluster.active_before;
    uint triangle = tile_before(tiles, tile, TILE_SUM_Y) + cluster.triangles_before;
    for (ulong rest = nibbles_mixed(cluster.patterns); rest; rest &= rest - 1) {
        uint bit = lowest_bit(rest), pattern = (uint)(cluster.patterns >> bit) & 15;
        uint4 points = vload4(n * CLUSTER_TETRAHEDRA + bit / 4, tetrahedra);
        active_tetrahedron t = {{points.x, points.y, points.z, points.w}, pattern, triangle, 0, 0};
        out[first++] = t;
        triangle += cases[CASE_BYTES * pattern + CASE_TRIANGLES];
    }
}

/* Prefetches the tetrahedra of cluster n that will be read; a cache line holds four. */
inline_always void active_prefetch(global const cluster_state *clusters, uint n, global const uint *tetrahedra) {
    ulong active = nibbles_mixed(clusters[n].patterns);
    for (uint m = 0; m < CLUSTER_POINTS; m += 16, active >>= 16)
        if (active & 0xffff) line_prefetch(tetrahedra + (ulong)CLUSTER_POINTS * n + m);
}

/* Lists the active tetrahedra, and clears `table` and `tiles` for the kernels that follow. */
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

#endif

#endif
