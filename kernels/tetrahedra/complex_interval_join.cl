/*
 * complex_interval_join.cl - kernels complex_interval_join and complex_interval_number: one vertex for each crossed
 * edge, numbered by the first tetrahedron that has it
 *
 * The edges of the list go into a hash table with open addressing, as those of surfaces do (complex_join.cl): an entry
 * is the number of an edge, in the end that of the first one of these two points.
 */
#ifndef COMPLEX_INTERVAL_JOIN_CL
#define COMPLEX_INTERVAL_JOIN_CL

#include "complex_interval_list.cl"

/* A tile's edges in the list: the first one, and behind the last. */
typedef struct edge_span {
    uint first, end;
} edge_span;

inline_always edge_span tile_edges(uint tile_index, global uint *state, const volume_job *v) {
    const uint first = tile_slots(tile_index, state, v);
    const edge_span span = {first, first + scan_tiles(state, v, SCAN_CROSSINGS)[TILE_WORDS * tile_index + TILE_EDGES]};
    return span;
}

inline_always bool edge_exists(uint2 edge) { return WORK_ITEMS == 1 || edge.x != edge.y; }

/* ---------------------------------------------------------------------------------------------------------- joining */

/* Enters edge n; `entry` is where the search begins. Returns the edge's entry. Where none was free within probe_limit,
 * *full is set, and the result means nothing: the host starts again with a larger table. */
inline_always uint list_enter(uint n, uint entry, const volume_job *v, global const uint2 *edges,
                              volatile global uint *table, global uint *full) {
    const uint2 edge = edges[n];
    for (uint probe = 0; probe <= v->probe_limit; probe++) {
        uint there = table[entry];
        if (there == EDGE_NONE) there = atomic_cmpxchg(&table[entry], EDGE_NONE, n);
        if (there == EDGE_NONE) return entry;
        const uint2 other = edges[there];
        if (other.x == edge.x && other.y == edge.y) {
            if (n < there) atomic_min(&table[entry], n);
            return entry;
        }
        entry = (entry + 1) & v->table_mask;
    }
    atomic_or(full, 1u);
    return 0;
}

#if WORK_ITEMS == 1

/* An edge is entered JOIN_AHEAD edges after it was hashed. Prefetch has two stages: its entry in the table at once, and
 * the edge which that entry names half as many edges later. */
enum { JOIN_AHEAD = 32 };

inline_always void edge_hashed(uint n, const volume_job *v, global const uint2 *edges, volatile global uint *table,
                               global uint *entries) {
    entries[n] = edge_hash(edges[n]) & v->table_mask;
    line_prefetch(table + entries[n]);
}

inline_always void edge_prefetched(uint n, global const uint2 *edges, volatile global uint *table,
                                   global const uint *entries) {
    const uint there = table[entries[n]];
    line_prefetch(edges + (there == EDGE_NONE ? n : there));
}

inline_always void tile_join(edge_span span, const volume_job *v, global const uint2 *edges,
                             volatile global uint *table, global uint *entries, global uint *full) {
    uint hashed = span.first, prefetched = span.first;
    for (uint n = span.first; n < span.end; n++) {
        for (; hashed < min(n + JOIN_AHEAD, span.end); hashed++) edge_hashed(hashed, v, edges, table, entries);
        for (; prefetched < min(n + JOIN_AHEAD / 2, span.end); prefetched++)
            edge_prefetched(prefetched, edges, table, entries);
        entries[n] = list_enter(n, entries[n], v, edges, table, full);
    }
}

#else

inline_always void tile_join(edge_span span, const volume_job *v, global const uint2 *edges,
                             volatile global uint *table, global uint *entries, global uint *full) {
    for (uint n = span.first + (uint)get_local_id(0); n < span.end; n += WORK_ITEMS)
        if (edge_exists(edges[n]))
            entries[n] = list_enter(n, edge_hash(edges[n]) & v->table_mask, v, edges, table, full);
}

#endif

kernel void complex_interval_join(volume_job v, global const uint2 *edges, global uint *table, global uint *entries,
                                  global uint *state) {
    local uint shared[4];
    uint tile_index = 0;
    while (tile_index < v.tile_count) {
        tile_index = ticket_take(&state[VOLUME_TICKETS + KERNEL_VOLUME_JOIN], shared);
        if (tile_index < v.tile_count)
            tile_join(tile_edges(tile_index, state, &v), &v, edges, table, entries, &state[VOLUME_FULL]);
    }
}

/* --------------------------------------------------------------------------------------------------------- numbering
 */

/* The first edge of the same points as edge n, which owns the vertex. */
inline_always uint edge_owner(uint n, global const uint *table, global const uint *entries) {
    const uint entry = entries[n];
    return entry & EDGE_RESOLVED ? entry & ~EDGE_RESOLVED : table[entry];
}

/* Counts the vertices of a tile on either bound; replaces entries by owners unless `recount`. */
inline_always uint2 tile_number(tile_scan scan, uint tile_index, const volume_job *v, global const uint2 *edges,
                                global const uint *table, global uint *entries, global uint *state, bool recount) {
    const edge_span span = tile_edges(tile_index, state, v);
    uint2 sums = 0, running = 0;
    for (uint n = span.first + (uint)get_local_id(0); n < span.end; n += WORK_ITEMS) {
        if (WORK_ITEMS == 1 && n + FETCH_AHEAD < span.end && !recount) line_prefetch(table + entries[n + FETCH_AHEAD]);
        if (!edge_exists(edges[n])) continue;
        const uint owner = edge_owner(n, table, entries), owned = owner == n, is_high = edges[n].x > edges[n].y;
        sums += (uint2)(owned & ~is_high, owned & is_high);
        if (!recount) entries[n] = owner | EDGE_RESOLVED;
    }
    group_prefix(sums, &running, scan.sums);
    return running;
}

inline_always void number_tile_settle(tile_scan scan, uint tile_index, const volume_job *v, global const uint2 *edges,
                                      global const uint *table, global uint *entries, global uint *state) {
    uint unposted;
    bool look = false;
    while (!tile_settle(scan, tile_index, look, &unposted)) {
        tile_post(scan, unposted, tile_number(scan, unposted, v, edges, table, entries, state, true));
        look = true;
    }
    if (get_local_id(0) != 0 || tile_index + 1 != v->tile_count) return;
    state[VOLUME_LOW] = tile_before(scan.tiles, tile_index + 1, TILE_SUM_X);
    state[VOLUME_HIGH] = tile_before(scan.tiles, tile_index + 1, TILE_SUM_Y);
}

/* Numbers the vertices in the order of their owners. */
kernel void complex_interval_number(uint spin_limit, volume_job v, global const uint2 *edges, global const uint *table,
                                    global uint *entries, global uint *state) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    const tile_scan scan = {spin_limit, scan_tiles(state, &v, SCAN_CROSSINGS), shared, sums};
    own_tiles own = {NO_TILE, NO_TILE};
    uint tile_index = 0;
    if (state[VOLUME_FULL]) return; /* entries are incomplete */
    while (tile_index < v.tile_count) {
        tile_index = ticket_take(&state[VOLUME_TICKETS + KERNEL_VOLUME_NUMBER], shared);
        if (tile_index < v.tile_count) {
            tile_post(scan, tile_index, tile_number(scan, tile_index, &v, edges, table, entries, state, false));
            if (SETTLES_LATER)
                own_append(&own, tile_index, scan.tiles);
            else
                number_tile_settle(scan, tile_index, &v, edges, table, entries, state);
        }
    }
    for (uint n = own.first; SETTLES_LATER && n != NO_TILE; n = scan.tiles[TILE_WORDS * n + TILE_NEXT])
        number_tile_settle(scan, n, &v, edges, table, entries, state);
}

#endif
