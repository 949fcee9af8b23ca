/*
 * complex_interval_crossings.cl - kernel complex_interval_crossings: the vertices of an interval volume, at points and
 * on crossed edges, and their numbers
 */
#ifndef COMPLEX_INTERVAL_CROSSINGS_CL
#define COMPLEX_INTERVAL_CROSSINGS_CL

#include "complex_interval_join.cl"
#include "complex_vertex.cl"

#ifdef REAL

/* What the kernel reads and writes. */
typedef struct volume_vertices {
    const complex_job *low, *high;
    const volume_job *v;
    global const BITS *samples;
    global const float *coordinates;
    global const volume_points *points;
    global uint2 *edges;
    global const uint *entries;
    global uint *numbers, *state;
    global float *positions;
} volume_vertices;

/* The number of the first vertex at a point of word n. */
inline_always uint points_before(uint n, const volume_vertices *a) {
    global const uint *tiles = scan_tiles(a->state, a->v, SCAN_VOLUME);
    return tile_before(tiles, n >> a->v->tile_shift, TILE_SUM_X) + a->points[n].before;
}

inline_always void point_store(uint point, uint vertex, const volume_vertices *a) {
    a->numbers[point] = vertex;
    vstore3(vload3(point, a->coordinates), vertex - a->v->window, a->positions);
}

/* The numbers of a tile's first vertices on edges, of the low bound and of the high one. */
inline_always uint2 crossings_before(uint tile_index, const volume_vertices *a) {
    global const uint *tiles = scan_tiles(a->state, a->v, SCAN_CROSSINGS);
    return (uint2)(a->v->low_first + tile_before(tiles, tile_index, TILE_SUM_X),
                   a->v->high_first + tile_before(tiles, tile_index, TILE_SUM_Y));
}

/* Stores the vertex of edge n, which owns it; then its number replaces the edge's first point in the list. */
inline_always void crossing_store(uint n, uint vertex, const volume_vertices *a) {
    const uint2 edge = a->edges[n];
    const complex_job *bound = edge.x > edge.y ? a->high : a->low;
    edge_vertex(bound, (uint2)(min(edge.x, edge.y), max(edge.x, edge.y)), a->samples, a->coordinates,
                a->positions + 3ul * (vertex - a->v->window));
    a->edges[n].x = vertex;
}

#if WORK_ITEMS == 1

inline_always void tile_points(uint tile_index, const volume_vertices *a) {
    const uint items = 1u << a->v->tile_shift, end = min((tile_index + 1) * items, a->v->word_count);
    for (uint n = tile_index * items; n < end; n++) {
        uint vertex = points_before(n, a);
        for (ulong rest = a->points[n].within; rest; rest &= rest - 1)
            point_store(64 * n + lowest_bit(rest), vertex++, a);
    }
}

/* Edges that own their vertex, of so many in the list. */
enum { EDGES_AT_ONCE = 64 };

typedef struct owned_edges {
    uint numbers[EDGES_AT_ONCE], count;
} owned_edges;

/* Finds them without branches, as which ones it is is hard to predict; prefetches what their vertices need. */
inline_always void owned_find(uint first, uint end, const volume_vertices *a, owned_edges *out) {
    out->count = 0;
    for (uint n = first; n < min(first + EDGES_AT_ONCE, end); n++) {
        out->numbers[out->count] = n;
        out->count += a->entries[n] == (n | EDGE_RESOLVED);
    }
    for (uint k = 0; k < out->count; k++) {
        const uint2 edge = a->edges[out->numbers[k]];
        line_prefetch(a->samples + edge.x);
        line_prefetch(a->samples + edge.y);
        line_prefetch(a->coordinates + 3ul * edge.x);
        line_prefetch(a->coordinates + 3ul * edge.y);
    }
}

inline_always void tile_crossings(uint tile_index, const volume_vertices *a, local uint2 *sums) {
    const edge_span span = tile_edges(tile_index, a->state, a->v);
    uint2 next = crossings_before(tile_index, a);
    owned_edges owned[2];
    uint turn = 0;
    owned_find(span.first, span.end, a, &owned[0]);
    for (uint first = span.first; first < span.end; first += EDGES_AT_ONCE, turn ^= 1) {
        owned_find(first + EDGES_AT_ONCE, span.end, a, &owned[turn ^ 1]);
        for (uint k = 0; k < owned[turn].count; k++) {
            const uint n = owned[turn].numbers[k], is_high = a->edges[n].x > a->edges[n].y;
            crossing_store(n, is_high ? next.y : next.x, a);
            next += (uint2)(1 - is_high, is_high);
        }
    }
}

#else

inline_always void tile_points(uint tile_index, const volume_vertices *a) {
    const uint items = 1u << a->v->tile_shift;
    for (uint m = (uint)get_local_id(0); m < 64 * items; m += WORK_ITEMS) {
        const uint n = tile_index * items + m / 64, bit = m % 64;
        if (n >= a->v->word_count || !(a->points[n].within >> bit & 1)) continue;
        point_store(64 * n + bit, points_before(n, a) + (uint)popcount(a->points[n].within & ((1ul << bit) - 1)), a);
    }
}

inline_always void tile_crossings(uint tile_index, const volume_vertices *a, local uint2 *sums) {
    const edge_span span = tile_edges(tile_index, a->state, a->v);
    const uint2 first = crossings_before(tile_index, a);
    uint2 running = 0;
    for (uint start = span.first; start < span.end; start += WORK_ITEMS) {
        const uint n = start + (uint)get_local_id(0);
        const bool owned = n < span.end && edge_exists(a->edges[n]) && a->entries[n] == (n | EDGE_RESOLVED);
        const bool is_high = owned && a->edges[n].x > a->edges[n].y;
        const uint2 before = first + group_prefix((uint2)(owned && !is_high, is_high), &running, sums);
        if (owned) crossing_store(n, is_high ? before.y : before.x, a);
    }
}

#endif

kernel void complex_interval_crossings(complex_job low, complex_job high, volume_job v, global const BITS *samples,
                                       global const float *coordinates, global const volume_points *points,
                                       global uint2 *edges, global const uint *entries, global uint *numbers,
                                       global uint *state, global float *positions) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    const volume_vertices a = {
        &low,    &high, &v,       samples + low.sample_offset, coordinates + low.point_offset, points, edges, entries,
        numbers, state, positions};
    uint tile_index = 0;
    while (tile_index < v.tile_count) {
        tile_index = ticket_take(&state[VOLUME_TICKETS + KERNEL_VOLUME_CROSSINGS], shared);
        if (tile_index >= v.tile_count) break;
        tile_points(tile_index, &a);
        tile_crossings(tile_index, &a, sums);
    }
}

#endif

#endif
