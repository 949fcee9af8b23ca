/*
 * reference_complex_run.h - one extraction from a complex by the scalar reference: what its stages share
 */
#ifndef REFERENCE_COMPLEX_RUN_H
#define REFERENCE_COMPLEX_RUN_H

#include "grid/complex.h"
#include "reference/carry_vertex.h"
#include "reference/complex_border.h"

typedef struct edge_entry {
    uint32_t low, high;
    uint32_t number; /* of its vertex, or NO_NUMBER */
    uint32_t taken;
} edge_entry;

#define NO_NUMBER UINT32_MAX

typedef struct reference {
    const tc_grid *grid;
    double isovalue;
    bool keeps_cells;  /* method hybrid */
    edge_entry *table; /* open addressing, half full at most */
    uint64_t table_size, entry_count;
    tc_mesh *mesh; /* NULL: count only */
    const carry *carried;
    bool closed;
    complex_border border;
    uint32_t *point_numbers; /* of the border's vertices at points, or NO_NUMBER */
    uint64_t vertex_count, triangle_count, active_count;
    uint32_t next; /* tetrahedron */
} reference;

/* A table without edges; to be ended in any case. */
tc_status reference_complex_begin(reference *r, const tc_grid *grid, const tc_extract_options *options);
void reference_complex_end(reference *r);

/* Vertices are made and numbered anew; their edges stay in the table. */
void reference_complex_restart(reference *r);

/* Numbers of the vertices on the crossed edges of a tetrahedron: those of edges that are met for the first time are
 * made. pattern: which of its points are inside, a bit each. */
tc_status reference_complex_vertices(reference *r, const uint32_t points[4], unsigned pattern, uint32_t numbers[6]);

/* Records that samples or tetrahedra are not those that were counted. */
tc_status reference_complex_change_fail(void);

#endif
