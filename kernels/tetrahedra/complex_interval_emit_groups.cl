/*
 * complex_interval_emit_groups.cl - tetrahedra where the work-items of a group share a tile: each takes one at a
 * time
 */
#ifndef COMPLEX_INTERVAL_EMIT_GROUPS_CL
#define COMPLEX_INTERVAL_EMIT_GROUPS_CL

#include "complex_interval_entry.cl"

#ifdef REAL

/* The vertex of a case, as complex_interval_job.h names it; low, high: the first slots of both bounds. */
inline_always uint vertex_of(uint vertex, global const uint *points, uint low, uint high, const volume_emit *e) {
    if (vertex < VOLUME_LOW_SLOT) return point_number(points[vertex], e);
    const uint slot = vertex < VOLUME_HIGH_SLOT ? low + vertex - VOLUME_LOW_SLOT : high + vertex - VOLUME_HIGH_SLOT;
    return e->edges[e->entries[slot] & ~EDGE_RESOLVED].x;
}

/* Tetrahedron m of cluster n of a tile, if a part of it lies within. */
inline_always void own_emit(uint n, uint m, uint first, const volume_emit *e, global uint *out) {
    const volume_cluster c = e->clusters[n];
    const ulong reached = cluster_reached(&c), low = nibbles_mixed(c.low), before = (1ul << 4 * m) - 1;
    global const uint *points = e->tetrahedra + 4ul * (CLUSTER_TETRAHEDRA * n + m);
    if (!(reached >> 4 * m & 1)) return;
    out += 4ul * c.tetrahedra;
    for (ulong rest = reached & before; rest; rest &= rest - 1)
        out += 4 * (uint)e->cases[pattern_of(&c, lowest_bit(rest) / 4)];
    const uint slot =
        first + 4 * (c.cuts + (uint)popcount(low & before) + (uint)popcount(nibbles_mixed(c.high) & before));
    global const uchar *entry = entry_of(points, pattern_of(&c, m), e->cases);
    for (uint corner = 0; corner < 4 * (uint)entry[0]; corner++)
        out[corner] = vertex_of(entry[1 + corner], points, slot, slot + 4 * (uint)(low >> 4 * m & 1), e);
}

inline_always void tile_emit(uint tile_index, const volume_emit *e) {
    const uint items = 1u << e->v->tile_shift;
    for (uint m = (uint)get_local_id(0); m < CLUSTER_TETRAHEDRA * items; m += WORK_ITEMS) {
        const uint n = tile_index * items + m / CLUSTER_TETRAHEDRA;
        if (n < e->c->cluster_count)
            own_emit(n, m % CLUSTER_TETRAHEDRA, tile_slots(tile_index, e->state, e->v), e, tile_out(tile_index, e));
    }
}

#endif

#endif
