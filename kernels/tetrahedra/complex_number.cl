/*
 * complex_number.cl - vertex numbers: vertices that an item owns follow those of the items before it; and first
 * triangles of cells
 */
#ifndef COMPLEX_NUMBER_CL
#define COMPLEX_NUMBER_CL

#include "complex_join.cl"

/* Which vertices item a owns: bit n for the vertex on its crossed edge n. A diagonal that is no edge has no entry. */
inline_always uint owned_edges(const complex_job *c, uint a, global const active_item *active,
                               global const uchar *cases, global const uint *table, global const uint *entries) {
    uint owned = 0, edges = edges_of(a, active, cases), first = slot_of(c, a, 0);
    for (uint n = 0; n < edges; n++) {
        const uint entry = entries[first + n];
        if (WHOLE && entry == EDGE_NONE) continue;
        owned |= (uint)(table[entry] == first + n) << n;
    }
    return owned;
}

/* Triangles that are counted with the vertices: of cells, as cut faces are known now. */
inline_always uint triangles_of(uint a, global const active_item *active, global const uchar *cases) {
#if WHOLE
    return cell_case(active + a, cases)[WHOLE_TRIANGLES];
#else
    return 0;
#endif
}

/* Counts the vertices of a tile of active items; stores numbers and owned edges unless `out` is NULL. */
inline_always uint2 tile_number(tile_tools tools, uint tile_index, global const active_item *active,
                                global const uchar *cases, global const uint *table, global const uint *entries,
                                global active_item *out) {
    uint2 running = 0;
    for (uint start = 0; start < tools.c->tile_actives; start += WORK_ITEMS) {
        uint a = tile_index * tools.c->tile_actives + start + (uint)get_local_id(0), owned = 0;
        bool exists = start + (uint)get_local_id(0) < tools.c->tile_actives && a < tools.c->active_count;
        if (WORK_ITEMS == 1 && a + FETCH_AHEAD < tools.c->active_count)
            for (uint n = 0; n < 4; n++) line_prefetch(table + entries[slot_of(tools.c, a + FETCH_AHEAD, n)]);
        if (exists) owned = owned_edges(tools.c, a, active, cases, table, entries);
        uint triangles = exists ? triangles_of(a, active, cases) : 0;
        uint2 before = group_prefix((uint2)((uint)popcount(owned), triangles), &running, tools.scan.sums);
        if (exists && out) out[a].vertex = before.x, out[a].owned = owned;
        if (WHOLE && exists && out) out[a].triangle = before.y;
    }
    return running;
}

inline_always void active_tile_settle(tile_tools tools, uint tile_index, global const active_item *active,
                                      global const uchar *cases, global const uint *table, global const uint *entries,
                                      global uint *head) {
    uint unposted;
    bool look = false;
    while (!tile_settle(tools.scan, tile_index, look, &unposted)) {
        tile_post(tools.scan, unposted, tile_number(tools, unposted, active, cases, table, entries, NULL));
        look = true;
    }
    if (get_local_id(0) == 0 && tile_index + 1 == tools.c->active_tiles) {
        head[HEAD_VERTICES] = tile_before(tools.scan.tiles, tile_index + 1, TILE_SUM_X);
        if (WHOLE) head[HEAD_TRIANGLES] = tile_before(tools.scan.tiles, tile_index + 1, TILE_SUM_Y);
    }
}

/* Numbers the vertices in the order of their owners. `tiles` has to be cleared. */
kernel void complex_number(complex_job c, global active_item *active, global const uchar *cases, global uint *state,
                           global uint *tiles, global const uint *table, global const uint *entries) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    tile_tools tools = {&c, {c.spin_limit, tiles, shared, sums}};
    own_tiles own = {NO_TILE, NO_TILE};
    uint tile_index = 0;
    if ((WORK_ITEMS == 1 || WHOLE) && state[HEAD_FULL]) return; /* entries are incomplete */
    while (tile_index < c.active_tiles) {
        tile_index = ticket_take(&state[HEAD_TICKETS + KERNEL_NUMBER], shared);
        if (tile_index < c.active_tiles) {
            tile_post(tools.scan, tile_index, tile_number(tools, tile_index, active, cases, table, entries, active));
            if (SETTLES_LATER)
                own_append(&own, tile_index, tiles);
            else
                active_tile_settle(tools, tile_index, active, cases, table, entries, state);
        }
    }
    for (uint n = own.first; SETTLES_LATER && n != NO_TILE; n = tiles[TILE_WORDS * n + TILE_NEXT])
        active_tile_settle(tools, n, active, cases, table, entries, state);
}

#endif
