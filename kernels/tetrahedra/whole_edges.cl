/*
 * whole_edges.cl - candidates of active cells: their crossed edges, and crossed diagonals that may be edges
 */
#ifndef WHOLE_EDGES_CL
#define WHOLE_EDGES_CL

#include "complex_tile.cl"

inline_always uint slot_of(const complex_job *c, uint a, uint n) { return (a << c->slot_shift) + n; }
inline_always uint slot_item(const complex_job *c, uint slot) { return slot >> c->slot_shift; }
inline_always uint slot_edge(const complex_job *c, uint slot) { return slot & ((1u << c->slot_shift) - 1); }

inline_always global const uchar *cell_case(global const active_cell *cell, global const uchar *cases) {
    return cases + (ulong)CASE_UNIT * cell->pattern;
}

/* The two points of candidate n, the lower first. */
inline_always uint2 candidate_points(global const active_cell *cell, uint n, global const uchar *cases) {
    const uint ends = cell_case(cell, cases)[WHOLE_ENDS + n];
    const uint a = cell->points[ends & 15], b = cell->points[ends >> 4];
    return (uint2)(min(a, b), max(a, b));
}

inline_always uint2 edge_points(const complex_job *c, global const active_cell *active, uint slot,
                                global const uchar *cases) {
    return candidate_points(active + slot_item(c, slot), slot_edge(c, slot), cases);
}

inline_always uint edges_of(uint a, global const active_cell *active, global const uchar *cases) {
    return cell_case(active + a, cases)[WHOLE_CANDIDATES];
}

/* Bit n: candidate n is a diagonal. */
inline_always uint diagonals_of(uint a, global const active_cell *active, global const uchar *cases) {
    global const uchar *d = cell_case(active + a, cases) + WHOLE_DIAGONALS;
    return d[0] | (uint)d[1] << 8 | (uint)d[2] << 16 | (uint)d[3] << 24;
}

/* Bit n: candidate n is an edge of the cell. */
inline_always uint own_edges(uint a, global const active_cell *active, global const uchar *cases) {
    return ((1u << edges_of(a, active, cases)) - 1) & ~diagonals_of(a, active, cases);
}

#endif
