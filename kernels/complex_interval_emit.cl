/*
 * complex_interval_emit.cl - kernels complex_interval_crossings and complex_interval_emit: vertices and tetrahedra of an
 * interval volume
 *
 * The first one makes the vertices on crossed edges of a bound, and leaves the number of its vertex in the slot of each
 * edge. So the second one finds the vertices of a tetrahedron by its place in the list of active ones.
 */
#ifndef COMPLEX_INTERVAL_EMIT_CL
#define COMPLEX_INTERVAL_EMIT_CL

#include "complex_interval_count.cl"
#include "complex_vertex.cl"

#ifdef REAL

/* -------------------------------------------------------------------------------------------------------- crossings */

/* Numbers of all vertices of active tetrahedron a; those that it owns are made. */
inline_always void crossings_store(const complex_job *c, uint first, uint a, global const BITS *samples,
                                   global const float *points, global const active_tetrahedron *active,
                                   global const uchar *cases, global const uint *tiles, global const uint *table,
                                   global uint *entries, global float *positions) {
    const uint edges = edges_of(a, active, cases);
    for (uint slot = 4 * a; slot < 4 * a + edges; slot++) {
        const uint owner = table[entries[slot]], number = vertex_number(c, owner, active, tiles);
        if (owner == slot)
            edge_vertex(c, edge_points(c, active, owner, cases), samples, points, positions + 3ul * number);
        entries[slot] = first + number;
    }
}

/* first: the number of the bound's first vertex. offset: floats in the buffer of positions before that. */
kernel void complex_interval_crossings(complex_job c, uint first, ulong offset, global const BITS *samples,
                                       global const float *points, global const active_tetrahedron *active,
                                       global const uchar *cases, global uint *state, global const uint *tiles,
                                       global const uint *table, global uint *entries, global float *positions) {
    local uint shared[4];
    uint number = 0;
    samples += c.sample_offset, points += c.point_offset, positions += offset;
    while (number < c.active_tiles) {
        number = ticket_take(&state[HEAD_TICKETS + KERNEL_EMIT], shared);
        for (uint start = 0; start < c.tile_actives && number < c.active_tiles; start += WORK_ITEMS) {
            const uint m = start + (uint)get_local_id(0), a = number * c.tile_actives + m;
            if (m < c.tile_actives && a < c.active_count)
                crossings_store(&c, first, a, samples, points, active, cases, tiles, table, entries, positions);
        }
    }
}

/* --------------------------------------------------------------------------------------------------------- emission */

/* A bound's active tetrahedra: where those of each cluster begin, and the numbers of their vertices. */
typedef struct bound_slots {
    global const cluster_state *clusters;
    global const uint *tiles, *numbers;
} bound_slots;

/* What the kernel that emits reads and writes. */
typedef struct volume_emit {
    const complex_job *low, *high;
    const volume_job *v;
    global const uint *tetrahedra;
    global const float *coordinates;
    global const uchar *cases;
    global const volume_cluster *clusters;
    global const volume_points *points;
    global const uint *tiles;
    bound_slots low_slots, high_slots;
    global float *positions;
    global uint *out;
} volume_emit;

/* Vertices at points before word n. */
inline_always uint points_before(uint n, const volume_emit *e) {
    return tile_before(e->tiles, n >> e->v->tile_shift, TILE_VERTICES) + e->points[n].before;
}

/* The vertex at a point; of one that is no vertex, as tetrahedra have changed, any. */
inline_always uint point_number(uint point, const volume_emit *e) {
    if (!e->v->word_count) return point;
    const uint n = point / 64;
    return min(points_before(n, e) + (uint)popcount(e->points[n].within & ((1ul << point % 64) - 1)), e->v->point_last);
}

/* The vertex at point `bit` of word n. */
inline_always void point_store(uint n, uint bit, const volume_emit *e) {
    const uint point = 64 * n + bit;
    if (!(e->points[n].within >> bit & 1)) return;
    vstore3(vload3(point, e->coordinates), point_number(point, e) - e->v->window, e->positions);
}

/* The numbers in the first slot of an active tetrahedron and after it: of tetrahedron m of cluster n. Not of others. */
inline_always global const uint *slots_of(const complex_job *c, bound_slots b, uint n, uint m) {
    const cluster_state cluster = b.clusters[n];
    const uint before = (uint)popcount(nibbles_any(cluster.patterns) & ((1ul << 4 * m) - 1));
    return b.numbers + 4ul * (tile_before(b.tiles, n / c->tile_clusters, TILE_VERTICES) + cluster.active_before + before);
}

inline_always bool is_active(uint pattern) { return pattern != 0 && pattern != 15; }

/* The order of a tetrahedron's points. */
inline_always uint order_of(uint4 p, global const uchar *cases) {
    const uint pairs = (uint)(p.x > p.y) | (uint)(p.x > p.z) << 1 | (uint)(p.x > p.w) << 2 | (uint)(p.y > p.z) << 3 |
                       (uint)(p.y > p.w) << 4 | (uint)(p.z > p.w) << 5;
    return cases[VOLUME_ORDER_OF + pairs];
}

/* Where vertices of a tetrahedron are found. */
typedef struct tetrahedron_vertices {
    global const uint *points, *low, *high;
} tetrahedron_vertices;

inline_always uint vertex_of(uint vertex, tetrahedron_vertices t, const volume_emit *e) {
    if (vertex >= VOLUME_HIGH_SLOT) return t.high[vertex - VOLUME_HIGH_SLOT];
    return vertex >= VOLUME_LOW_SLOT ? t.low[vertex - VOLUME_LOW_SLOT] : point_number(t.points[vertex], e);
}

/* Tetrahedron m of cluster n, of which a part lies within. */
inline_always global uint *tetrahedron_store(uint n, uint m, uint pattern, const volume_emit *e, global uint *out) {
    tetrahedron_vertices t = {e->tetrahedra + 4ul * (CLUSTER_TETRAHEDRA * n + m), 0, 0};
    global const uchar *entry =
        e->cases + VOLUME_ENTRIES +
        VOLUME_ENTRY_BYTES * (VOLUME_CASES * order_of(vload4(0, t.points), e->cases) + e->cases[VOLUME_CASE_OF + pattern]);
    if (is_active(pattern >> 4)) t.low = slots_of(e->low, e->low_slots, n, m);
    if (is_active(pattern & 15)) t.high = slots_of(e->high, e->high_slots, n, m);
    const uint corners = 4 * (uint)entry[0];
    for (uint corner = 0; corner < corners; corner++) out[corner] = vertex_of(entry[1 + corner], t, e);
    return out + corners;
}

inline_always global uint *cluster_out(uint n, const volume_cluster *c, const volume_emit *e) {
    return e->out + 4ul * (tile_before(e->tiles, n >> e->v->tile_shift, TILE_TRIANGLES) + c->tetrahedra);
}

#if WORK_ITEMS < 32

/* Word and cluster n. */
inline_always void item_store(uint n, const volume_emit *e) {
    if (n < e->v->word_count)
        for (ulong rest = e->points[n].within; rest; rest &= rest - 1) point_store(n, lowest_bit(rest), e);
    if (n >= e->low->cluster_count) return;
    const volume_cluster c = e->clusters[n];
    global uint *out = cluster_out(n, &c, e);
    for (ulong rest = cluster_reached(&c); rest; rest &= rest - 1) {
        const uint m = lowest_bit(rest) / 4;
        out = tetrahedron_store(n, m, pattern_of(&c, m), e, out);
    }
}

inline_always void volume_tile_emit(uint number, const volume_emit *e) {
    const uint items = 1u << e->v->tile_shift;
    for (uint m = 0; m < items; m++) item_store(number * items + m, e);
}

#else

/* Tetrahedron m of cluster n, if a part of it lies within. */
inline_always void own_store(uint n, uint m, const volume_emit *e) {
    const volume_cluster c = e->clusters[n];
    const ulong reached = cluster_reached(&c);
    global uint *out = cluster_out(n, &c, e);
    if (!(reached >> 4 * m & 1)) return;
    for (ulong rest = reached & ((1ul << 4 * m) - 1); rest; rest &= rest - 1)
        out += 4 * (uint)e->cases[pattern_of(&c, lowest_bit(rest) / 4)];
    tetrahedron_store(n, m, pattern_of(&c, m), e, out);
}

inline_always void volume_tile_emit(uint number, const volume_emit *e) {
    const uint items = 1u << e->v->tile_shift;
    for (uint m = (uint)get_local_id(0); m < 64 * items; m += WORK_ITEMS)
        if (number * items + m / 64 < e->v->word_count) point_store(number * items + m / 64, m % 64, e);
    for (uint m = (uint)get_local_id(0); m < CLUSTER_TETRAHEDRA * items; m += WORK_ITEMS) {
        const uint n = number * items + m / CLUSTER_TETRAHEDRA;
        if (n < e->low->cluster_count) own_store(n, m % CLUSTER_TETRAHEDRA, e);
    }
}

#endif

kernel void complex_interval_emit(complex_job low, complex_job high, volume_job v, global const uint *tetrahedra,
                                  global const float *coordinates, global const uchar *cases,
                                  global const volume_cluster *clusters, global const volume_points *points,
                                  global uint *state, global const cluster_state *low_clusters,
                                  global const uint *low_state, global const uint *low_numbers,
                                  global const cluster_state *high_clusters, global const uint *high_state,
                                  global const uint *high_numbers, global float *positions, global uint *out) {
    local uint shared[4];
    const volume_emit e = {&low,
                           &high,
                           &v,
                           tetrahedra + low.tetrahedron_offset,
                           coordinates + low.point_offset,
                           cases,
                           clusters,
                           points,
                           state + VOLUME_HEAD_WORDS,
                           {low_clusters, low_state + HEAD_WORDS, low_numbers},
                           {high_clusters, high_state + HEAD_WORDS, high_numbers},
                           positions,
                           out};
    uint number = 0;
    while (number < v.tile_count) {
        number = ticket_take(&state[VOLUME_TICKET_EMIT], shared);
        if (number < v.tile_count) volume_tile_emit(number, &e);
    }
}

#endif

#endif
