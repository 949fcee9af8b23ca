/*
 * whole_cut.cl - which crossed diagonals of quadrilaterals are edges of other cells, once all edges are in the table
 *
 * Such a face is cut into two triangles, and the diagonal has a vertex; the host chooses another case for the cell
 * then.
 */
#ifndef WHOLE_CUT_CL
#define WHOLE_CUT_CL

#include "complex_join.cl"

/* Prefetches where the search for the diagonals of a cell begins. */
inline_always void diagonals_prefetch(const complex_job *c, uint a, global const active_cell *active,
                                      global const uchar *cases, volatile global uint *table) {
    for (uint rest = diagonals_of(a, active, cases); rest; rest &= rest - 1)
        line_prefetch(table + (edge_hash(candidate_points(active + a, lowest_bit(rest), cases)) & c->table_mask));
}

/* Looks up the diagonals of a cell in the table of edges, and stores their entries; an entry that is found has the
 * earliest of its slots. Bit n of the result: candidate n is an edge. */
inline_always uint diagonals_find(const complex_job *c, uint a, global const active_cell *active,
                                  global const uchar *cases, volatile global uint *table, global uint *entries) {
    uint found = 0;
    for (uint rest = diagonals_of(a, active, cases); rest; rest &= rest - 1) {
        const uint n = lowest_bit(rest), slot = slot_of(c, a, n);
        const uint2 edge = candidate_points(active + a, n, cases);
        const uint entry = edge_find(c, edge, edge_hash(edge) & c->table_mask, active, cases, table);
        entries[slot] = entry;
        if (entry == EDGE_NONE) continue;
        if (slot < table[entry]) atomic_min(&table[entry], slot);
        found |= 1u << n;
    }
    return found;
}

kernel void whole_cut(complex_job c, global active_cell *active, global const uchar *cases, global uint *state,
                      global uint *table, global uint *entries) {
    local uint shared[4];
    uint tile_index = 0, cut = 0;
    if (state[HEAD_FULL]) return; /* the table is incomplete */
    while (tile_index < c.active_tiles) {
        tile_index = ticket_take(&state[HEAD_TICKETS + KERNEL_CUT], shared);
        uint first = tile_index * c.tile_actives, count = 0;
        if (tile_index < c.active_tiles) count = min(c.tile_actives, c.active_count - first);
        for (uint n = (uint)get_local_id(0); n < count; n += WORK_ITEMS) {
            if (WORK_ITEMS == 1 && n + FETCH_AHEAD / 2 < count)
                diagonals_prefetch(&c, first + n + FETCH_AHEAD / 2, active, cases, table);
            const uint found = diagonals_find(&c, first + n, active, cases, table, entries);
            active[first + n].owned = found;
            cut += found != 0;
        }
    }
    if (cut) atomic_add(&state[HEAD_CUT], cut);
}

#endif
