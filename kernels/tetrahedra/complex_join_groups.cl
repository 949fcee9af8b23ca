/*
 * complex_join_groups.cl - edges joined where the work-items of a group share a tile
 */
#ifndef COMPLEX_JOIN_GROUPS_CL
#define COMPLEX_JOIN_GROUPS_CL

#include "complex_join.cl"

kernel void complex_join(complex_job c, global const active_item *active, global const uchar *cases, global uint *state,
                         global uint *table, global uint *entries) {
    local uint shared[4];
    uint tile_index = 0;
    while (tile_index < c.active_tiles) {
        tile_index = ticket_take(&state[HEAD_TICKETS + KERNEL_JOIN], shared);
        uint first = tile_index * c.tile_actives, count = 0;
        if (tile_index < c.active_tiles) count = min(c.tile_actives, c.active_count - first);
        for (uint n = (uint)get_local_id(0); n < count; n += WORK_ITEMS) {
            for (uint rest = own_edges(first + n, active, cases); rest; rest &= rest - 1) {
                uint slot = slot_of(&c, first + n, lowest_bit(rest));
                uint entry = edge_hash(edge_points(&c, active, slot, cases)) & c.table_mask;
                entries[slot] = edge_enter(&c, slot, entry, active, cases, table, &state[HEAD_FULL]);
            }
        }
    }
}

#endif
