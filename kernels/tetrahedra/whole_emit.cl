/*
 * whole_emit.cl - kernel 2 of cells: a cell's vertices and triangles
 */
#ifndef WHOLE_EMIT_CL
#define WHOLE_EMIT_CL

#include "complex_vertex.cl"

/* Prefetches in two stages: the table entries of cell a; what the entries of a - FETCH_AHEAD / 2 name. */
inline_always void item_prefetch(const complex_job *c, uint a, global const BITS *samples, global const float *points,
                                 global const active_cell *active, global const uchar *cases, global const uint *table,
                                 global const uint *entries) {
    if (a < c->active_count)
        for (uint rest = own_edges(a, active, cases); rest; rest &= rest - 1)
            line_prefetch(table + entries[slot_of(c, a, lowest_bit(rest))]);
    a -= FETCH_AHEAD / 2;
    if (a >= c->active_count) return;
    for (uint rest = own_edges(a, active, cases); rest; rest &= rest - 1)
        line_prefetch(active + slot_item(c, table[entries[slot_of(c, a, lowest_bit(rest))]]));
    for (uint rest = active[a].owned; rest; rest &= rest - 1) {
        const uint2 edge = candidate_points(active + a, lowest_bit(rest), cases);
        line_prefetch(samples + edge.x);
        line_prefetch(samples + edge.y);
        line_prefetch(points + 3ul * edge.x);
        line_prefetch(points + 3ul * edge.y);
    }
}

/* A corner of a triangle is a candidate; its vertex's number is looked up where it is used, as an array of numbers
 * would have to be as long as the longest case. */
inline_always uint candidate_number(const complex_job *c, uint a, uint n, global const active_cell *active,
                                    global const uint *tiles, global const uint *table, global const uint *entries) {
    return edge_number(c, table[entries[slot_of(c, a, n)]], active, tiles);
}

inline_always void item_emit(const complex_job *c, uint a, global const BITS *samples, global const float *points,
                             global const active_cell *active, global const uchar *cases, global const uint *tiles,
                             global const uint *table, global const uint *entries, global float *positions,
                             global uint *triangles) {
    global const uchar *row = cell_case(active + a, cases), *corners = row + WHOLE_ENDS + row[WHOLE_CANDIDATES];
    const uint tile = a / c->tile_actives, vertex = tile_before(tiles, tile, TILE_SUM_X) + active[a].vertex;
    global uint *out = triangles + 3ul * (tile_before(tiles, tile, TILE_SUM_Y) + active[a].triangle);
    uint own = 0;
    for (uint rest = active[a].owned; rest; rest &= rest - 1, own++)
        edge_vertex(c, candidate_points(active + a, lowest_bit(rest), cases), samples, points,
                    positions + 3ul * (vertex + own));
    for (uint n = 0; n < 3u * row[WHOLE_TRIANGLES]; n++)
        out[n] = candidate_number(c, a, corners[n], active, tiles, table, entries);
}

#endif
