/*
 * complex_emit.cl - kernel 2 of complexes: every active item makes the vertices that it owns and its triangles
 */
#ifndef COMPLEX_EMIT_CL
#define COMPLEX_EMIT_CL

#include "complex_vertex.cl"

#if WHOLE
#include "whole_emit.cl"
#else

/* Prefetches in two stages: the table entries of tetrahedron a; what the entries of a - FETCH_AHEAD / 2 name, and its
 * samples and points. */
inline_always void item_prefetch(const complex_job *c, uint a, global const BITS *samples, global const float *points,
                                 global const active_tetrahedron *active, global const uchar *cases,
                                 global const uint *table, global const uint *entries) {
    for (uint n = 0; n < 4 && a < c->active_count; n++) line_prefetch(table + entries[4 * a + n]);
    a -= FETCH_AHEAD / 2;
    if (a >= c->active_count) return;
    for (uint n = 0; n < 4; n++) {
        line_prefetch(active + table[entries[4 * a + n]] / 4);
        if (!active[a].owned) continue;
        line_prefetch(samples + active[a].points[n]);
        line_prefetch(points + 3ul * active[a].points[n]);
    }
}

/* Element n, selected: with a variable index the compiler would put the numbers into memory. */
inline_always uint number_at(uint4 numbers, uint n) {
    const uint2 pair = n & 2 ? numbers.hi : numbers.lo;
    return n & 1 ? pair.y : pair.x;
}

inline_always void item_emit(const complex_job *c, uint a, global const BITS *samples, global const float *points,
                             global const active_tetrahedron *active, global const uchar *cases,
                             global const uint *tiles, global const uint *table, global const uint *entries,
                             global float *positions, global uint *triangles) {
    global const uchar *row = cases + CASE_BYTES * active[a].pattern;
    const uint edges = row[CASE_EDGES];
    uint numbers[4] = {0, 0, 0, 0};
#pragma unroll
    for (uint n = 0; n < 4; n++) {
        if (n >= edges) break;
        uint owner = table[entries[4 * a + n]];
        numbers[n] = edge_number(c, owner, active, tiles);
        if (owner == 4 * a + n)
            edge_vertex(c, edge_points(c, active, owner, cases), samples, points, positions + 3ul * numbers[n]);
    }
    const uint4 all = (uint4)(numbers[0], numbers[1], numbers[2], numbers[3]);
    global uint *out = triangles + 3ul * active[a].triangle;
    for (uint n = 0; n < 3u * row[CASE_TRIANGLES]; n++) out[n] = number_at(all, row[CASE_CORNERS + n]);
}

#endif

kernel void complex_emit(complex_job c, global const BITS *samples, global const float *points,
                         global const active_item *active, global const uchar *cases, global uint *state,
                         global const uint *tiles, global const uint *table, global const uint *entries,
                         global float *positions, global uint *triangles) {
    local uint shared[4];
    uint tile_index = 0;
    samples += c.sample_offset, points += c.point_offset;
    while (tile_index < c.active_tiles) {
        tile_index = ticket_take(&state[HEAD_TICKETS + KERNEL_EMIT], shared);
        for (uint start = 0; start < c.tile_actives; start += WORK_ITEMS) {
            uint a = tile_index * c.tile_actives + start + (uint)get_local_id(0);
            if (WORK_ITEMS == 1 && tile_index < c.active_tiles)
                item_prefetch(&c, a + FETCH_AHEAD, samples, points, active, cases, table, entries);
            if (tile_index < c.active_tiles && start + (uint)get_local_id(0) < c.tile_actives && a < c.active_count)
                item_emit(&c, a, samples, points, active, cases, tiles, table, entries, positions, triangles);
        }
    }
}

#endif
