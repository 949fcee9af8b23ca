/*
 * complex_edges.cl - crossed edges of active items: their slots and points, their entries in the hash table that joins
 * them (complex_join.cl), the numbers of their vertices
 */
#ifndef COMPLEX_EDGES_CL
#define COMPLEX_EDGES_CL

#include "complex_tile.cl"

#if WHOLE
#include "whole_edges.cl"
#else

inline_always uint slot_of(const complex_job *c, uint a, uint n) { return 4 * a + n; }
inline_always uint slot_item(const complex_job *c, uint slot) { return slot / 4; }
inline_always uint slot_edge(const complex_job *c, uint slot) { return slot % 4; }

/* The two points of an edge, the lower first. */
inline_always uint2 edge_points(const complex_job *c, global const active_tetrahedron *active, uint slot,
                                global const uchar *cases) {
    global const active_tetrahedron *t = active + slot / 4;
    global const uchar *ends = cases + CASE_BYTES * t->pattern + CASE_ENDS + 2 * (slot % 4);
    uint a = t->points[ends[0]], b = t->points[ends[1]];
    return (uint2)(min(a, b), max(a, b));
}

inline_always uint edges_of(uint a, global const active_tetrahedron *active, global const uchar *cases) {
    return cases[CASE_BYTES * active[a].pattern + CASE_EDGES];
}

/* Bit n: edge n is there. */
inline_always uint own_edges(uint a, global const active_tetrahedron *active, global const uchar *cases) {
    return (1u << edges_of(a, active, cases)) - 1;
}

#endif

inline_always uint edge_hash(uint2 edge) {
    uint x = edge.x * 0x9e3779b1u ^ (edge.y + 0x7f4a7c15u) * 0x85ebca6bu;
    x ^= x >> 15;
    x *= 0x2c1b3c6du;
    return x ^ x >> 13;
}

/* The index of an edge's entry, EDGE_NONE where it has none. */
inline_always uint edge_find(const complex_job *c, uint2 edge, uint entry, global const active_item *active,
                             global const uchar *cases, volatile global uint *table) {
    for (uint probe = 0; probe <= c->probe_limit; probe++) {
        uint there = table[entry];
        if (there == EDGE_NONE) return EDGE_NONE;
        uint2 other = edge_points(c, active, there, cases);
        if (other.x == edge.x && other.y == edge.y) return entry;
        entry = (entry + 1) & c->table_mask;
    }
    return EDGE_NONE;
}

/* The number of the vertex in slot `owner`, whose item owns it. */
inline_always uint edge_number(const complex_job *c, uint owner, global const active_item *active,
                               global const uint *tiles) {
    global const active_item *t = active + slot_item(c, owner);
    uint lower = t->owned & ((1u << slot_edge(c, owner)) - 1);
    return tile_before(tiles, slot_item(c, owner) / c->tile_actives, TILE_SUM_X) + t->vertex + (uint)popcount(lower);
}

#endif
