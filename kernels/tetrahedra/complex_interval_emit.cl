/*
 * complex_interval_emit.cl - kernels complex_interval_crossings and complex_interval_emit: vertices and tetrahedra of
 * an interval volume
 *
 * The first one makes the vertices on crossed edges of a bound, and leaves their numbers in the table of edges. The
 * second one finds those of a tetrahedron by its place in the list of active ones, whose slots name entries of the
 * table.
 */
#ifndef COMPLEX_INTERVAL_EMIT_CL
#define COMPLEX_INTERVAL_EMIT_CL

#include "complex_interval_count.cl"
#include "complex_vertex.cl"

#ifdef REAL

/* -------------------------------------------------------------------------------------------------------- crossings */

/* The vertices that active tetrahedron a owns. Where the table has named the owner of an edge it then names the vertex.
 */
inline_always void crossings_store(const complex_job *c, uint first, uint a, global const BITS *samples,
                                   global const float *points, global const active_tetrahedron *active,
                                   global const uchar *cases, global const uint *tiles, global const uint *entries,
                                   global uint *table, global float *positions) {
    uint number = tile_before(tiles, a / c->tile_actives, TILE_VERTICES) + active[a].vertex;
    for (uint rest = active[a].owned; rest; rest &= rest - 1, number++) {
        const uint slot = 4 * a + lowest_bit(rest);
        edge_vertex(c, edge_points(c, active, slot, cases), samples, points, positions + 3ul * number);
        table[entries[slot]] = first + number;
    }
}

/* Prefetches the samples and points of an active tetrahedron that owns vertices. */
inline_always void crossings_prefetch(const complex_job *c, uint a, global const BITS *samples,
                                      global const float *points, global const active_tetrahedron *active) {
    if (a >= c->active_count || !active[a].owned) return;
    for (uint n = 0; n < 4; n++) {
        line_prefetch(samples + active[a].points[n]);
        line_prefetch(points + 3ul * active[a].points[n]);
    }
}

/* first: the number of the bound's first vertex. offset: floats in the buffer of positions before that. */
kernel void complex_interval_crossings(complex_job c, uint first, ulong offset, global const BITS *samples,
                                       global const float *points, global const active_tetrahedron *active,
                                       global const uchar *cases, global uint *state, global const uint *tiles,
                                       global uint *table, global const uint *entries, global float *positions) {
    local uint shared[4];
    uint number = 0;
    samples += c.sample_offset, points += c.point_offset, positions += offset;
    while (number < c.active_tiles) {
        number = ticket_take(&state[HEAD_TICKETS + KERNEL_EMIT], shared);
        for (uint start = 0; start < c.tile_actives && number < c.active_tiles; start += WORK_ITEMS) {
            const uint m = start + (uint)get_local_id(0), a = number * c.tile_actives + m;
#if WORK_ITEMS == 1
            crossings_prefetch(&c, a + FETCH_AHEAD, samples, points, active);
#endif
            if (m < c.tile_actives && a < c.active_count)
                crossings_store(&c, first, a, samples, points, active, cases, tiles, entries, table, positions);
        }
    }
}

/* --------------------------------------------------------------------------------------------------------- emission */

/* A bound's active tetrahedra: where those of each cluster begin, the entries of their slots, the numbers there. */
typedef struct bound_slots {
    global const cluster_state *clusters;
    global const uint *tiles, *entries, *table;
} bound_slots;

/* Where a work-item is alone, it prefetches what clusters need so many before it comes to them. */
enum { CLUSTERS_AHEAD = 3 };

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

inline_always bool is_active(uint pattern) { return pattern != 0 && pattern != 15; }

/* The slots of a bound that the active tetrahedra of cluster n have, from the first on or behind so many. Not of
 * clusters without any. */
inline_always global const uint *slots_of(const complex_job *c, bound_slots b, uint n, uint before) {
    return b.entries +
           4ul * (tile_before(b.tiles, n / c->tile_clusters, TILE_VERTICES) + b.clusters[n].active_before + before);
}

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

/* What its case gives of a tetrahedron, of which a part lies within. */
inline_always global const uchar *entry_of(global const uint *points, uint pattern, global const uchar *cases) {
    return cases + VOLUME_ENTRIES +
           VOLUME_ENTRY_BYTES * (VOLUME_CASES * order_of(vload4(0, points), cases) + cases[VOLUME_CASE_OF + pattern]);
}

inline_always global uint *cluster_out(uint n, const volume_cluster *c, const volume_emit *e) {
    return e->out + 4ul * (tile_before(e->tiles, n >> e->v->tile_shift, TILE_TRIANGLES) + c->tetrahedra);
}

#if WORK_ITEMS == 1

/* Brings two numbers into order; whether they were not. */
inline_always uint pair_order(uint *a, uint *b) {
    const uint low = min(*a, *b), high = max(*a, *b);
    const uint exchanged = *a > *b;
    *a = low, *b = high;
    return exchanged;
}

/* A tetrahedron that lies within whole: its points by number, the last two exchanged where that takes an odd number of
 * exchanges. Numbers of vertices are in the order of the points. */
inline_always void within_store(global const uint *points, const volume_emit *e, global uint *out) {
    uint a = point_number(points[0], e), b = point_number(points[1], e);
    uint c = point_number(points[2], e), d = point_number(points[3], e);
    uint odd = pair_order(&a, &b) ^ pair_order(&c, &d);
    odd ^= pair_order(&a, &c) ^ pair_order(&b, &d);
    odd ^= pair_order(&b, &c);
    vstore4((uint4)(a, b, odd ? d : c, odd ? c : d), 0, out);
}

/* Numbers of the vertices on a tetrahedron's crossed edges of a bound: three, or four where two and two points are on
 * either side. */
inline_always void slots_read(global const uint *slots, uint pattern, bound_slots b, uint *numbers) {
    if (!is_active(pattern)) return;
    for (uint n = 0; n < 3; n++) numbers[n] = b.table[slots[n]];
    if (popcount(pattern) == 2) numbers[3] = b.table[slots[3]];
}

/* What lies within of a tetrahedron, of which a part does. All numbers that it may take come first, as which ones it
 * takes is hard to predict. */
inline_always global uint *part_store(tetrahedron_vertices t, uint pattern, const volume_emit *e, global uint *out) {
    global const uchar *entry = entry_of(t.points, pattern, e->cases);
    const uint count = entry[0];
    uint numbers[VOLUME_HIGH_SLOT + 4];
    for (uint n = 0; n < 4; n++) numbers[n] = point_number(t.points[n], e);
    slots_read(t.low, pattern >> 4, e->low_slots, numbers + VOLUME_LOW_SLOT);
    slots_read(t.high, pattern & 15, e->high_slots, numbers + VOLUME_HIGH_SLOT);
    for (uint n = 0; n < count; n++) {
        const uchar4 at = vload4(n, entry + 1);
        vstore4((uint4)(numbers[at.x], numbers[at.y], numbers[at.z], numbers[at.w]), n, out);
    }
    return out + 4 * count;
}

/* Prefetches the entries of the table that the slots of cluster n name. */
inline_always void bound_prefetch(const complex_job *c, bound_slots b, uint n, ulong sides) {
    const uint active = (uint)popcount(nibbles_mixed(sides));
    if (!active) return;
    global const uint *slots = slots_of(c, b, n, 0);
    for (uint m = 0; m < 4 * active; m++) line_prefetch(b.table + slots[m]);
}

/* The same of its tetrahedra, and of the slots themselves. */
inline_always void tetrahedra_prefetch(uint n, const volume_emit *e) {
    if (n >= e->low->cluster_count) return;
    const volume_cluster c = e->clusters[n];
    for (uint m = 0; m < CLUSTER_POINTS && c.low; m += 16) line_prefetch(e->tetrahedra + (ulong)CLUSTER_POINTS * n + m);
    if (nibbles_mixed(c.low)) line_prefetch(slots_of(e->low, e->low_slots, n, 0));
    if (nibbles_mixed(c.high)) line_prefetch(slots_of(e->high, e->high_slots, n, 0));
}

inline_always void slots_prefetch(uint n, const volume_emit *e) {
    if (n >= e->low->cluster_count) return;
    bound_prefetch(e->low, e->low_slots, n, e->clusters[n].low);
    bound_prefetch(e->high, e->high_slots, n, e->clusters[n].high);
}

/* Word and cluster n. Active tetrahedra of a cluster have slots one after the other. */
inline_always void item_store(uint n, const volume_emit *e) {
    if (n < e->v->word_count)
        for (ulong rest = e->points[n].within; rest; rest &= rest - 1) point_store(n, lowest_bit(rest), e);
    if (n >= e->low->cluster_count) return;
    const volume_cluster c = e->clusters[n];
    const ulong changed = cluster_changed(&c), reached = cluster_reached(&c);
    if (!reached) return;
    global const uint *points = e->tetrahedra + (ulong)CLUSTER_POINTS * n;
    tetrahedron_vertices t = {points, 0, 0};
    global uint *out = cluster_out(n, &c, e);
    if (nibbles_mixed(c.low)) t.low = slots_of(e->low, e->low_slots, n, 0);
    if (nibbles_mixed(c.high)) t.high = slots_of(e->high, e->high_slots, n, 0);
    for (ulong rest = reached | changed; rest; rest &= rest - 1) {
        const uint m = lowest_bit(rest) / 4, pattern = pattern_of(&c, m);
        t.points = points + 4 * m;
        if (pattern == VOLUME_WITHIN) {
            within_store(t.points, e, out);
            out += 4;
            continue;
        }
        if (reached >> 4 * m & 1) out = part_store(t, pattern, e, out);
        if (is_active(pattern >> 4)) t.low += 4;
        if (is_active(pattern & 15)) t.high += 4;
    }
}

inline_always void volume_tile_emit(uint number, const volume_emit *e) {
    const uint items = 1u << e->v->tile_shift;
    for (uint m = 0; m < items; m++) {
        tetrahedra_prefetch(number * items + m + 2 * CLUSTERS_AHEAD, e);
        slots_prefetch(number * items + m + CLUSTERS_AHEAD, e);
        item_store(number * items + m, e);
    }
}

#else

inline_always uint vertex_of(uint vertex, tetrahedron_vertices t, const volume_emit *e) {
    if (vertex >= VOLUME_HIGH_SLOT) return e->high_slots.table[t.high[vertex - VOLUME_HIGH_SLOT]];
    if (vertex >= VOLUME_LOW_SLOT) return e->low_slots.table[t.low[vertex - VOLUME_LOW_SLOT]];
    return point_number(t.points[vertex], e);
}

/* Tetrahedron m of cluster n, if a part of it lies within. */
inline_always void own_store(uint n, uint m, const volume_emit *e) {
    const volume_cluster c = e->clusters[n];
    const ulong reached = cluster_reached(&c), before = (1ul << 4 * m) - 1;
    const uint pattern = pattern_of(&c, m);
    tetrahedron_vertices t = {e->tetrahedra + 4ul * (CLUSTER_TETRAHEDRA * n + m), 0, 0};
    global uint *out = cluster_out(n, &c, e);
    if (!(reached >> 4 * m & 1)) return;
    for (ulong rest = reached & before; rest; rest &= rest - 1)
        out += 4 * (uint)e->cases[pattern_of(&c, lowest_bit(rest) / 4)];
    if (is_active(pattern >> 4))
        t.low = slots_of(e->low, e->low_slots, n, (uint)popcount(nibbles_mixed(c.low) & before));
    if (is_active(pattern & 15))
        t.high = slots_of(e->high, e->high_slots, n, (uint)popcount(nibbles_mixed(c.high) & before));
    global const uchar *entry = entry_of(t.points, pattern, e->cases);
    for (uint corner = 0; corner < 4 * (uint)entry[0]; corner++) out[corner] = vertex_of(entry[1 + corner], t, e);
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
                                  global const uint *low_state, global const uint *low_entries,
                                  global const uint *low_table, global const cluster_state *high_clusters,
                                  global const uint *high_state, global const uint *high_entries,
                                  global const uint *high_table, global float *positions, global uint *out) {
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
                           {low_clusters, low_state + HEAD_WORDS, low_entries, low_table},
                           {high_clusters, high_state + HEAD_WORDS, high_entries, high_table},
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
