/*
 * complex_join.cl - one vertex for each crossed edge: edges of active tetrahedra that have the same two points are
 * joined, and the first tetrahedron with an edge owns its vertex
 *
 * The edges go into a hash table with open addressing, whose size is proportional to their number. An entry of the
 * table is the slot of an edge in the list of active tetrahedra, from which its points are read, so 32-bit atomics
 * suffice. Once taken, an entry only changes to an earlier slot of the same edge: in the end it holds the first slot,
 * whatever the order of insertions.
 */
#ifndef COMPLEX_JOIN_CL
#define COMPLEX_JOIN_CL

#include "complex_edges.cl"

/* Enters an edge; `entry` is the index at which the search begins. Returns the index of the edge's entry. Where none
 * was free within probe_limit, *full is set, and the result means nothing: the host starts again with a larger table.
 */
inline_always uint edge_enter(const complex_job *c, uint slot, uint entry, global const active_item *active,
                              global const uchar *cases, volatile global uint *table, global uint *full) {
    uint2 edge = edge_points(c, active, slot, cases);
    for (uint probe = 0; probe <= c->probe_limit; probe++) {
        uint there = table[entry];
        if (there == EDGE_NONE) there = atomic_cmpxchg(&table[entry], EDGE_NONE, slot);
        if (there == EDGE_NONE) return entry;
        uint2 other = edge_points(c, active, there, cases);
        if (other.x == edge.x && other.y == edge.y) {
            if (slot < there) atomic_min(&table[entry], slot);
            return entry;
        }
        entry = (entry + 1) & c->table_mask;
    }
    atomic_or(full, 1u);
    return 0;
}

#if WORK_ITEMS == 1
#include "complex_join_alone.cl"
#else
#include "complex_join_groups.cl"
#endif

#if WHOLE
#include "whole_cut.cl"
#endif

#endif
