/* surface.h - extraction by the reference engine, and what always holds of its result; shared by grid.c and cells.c */
#ifndef SURFACE_H
#define SURFACE_H

#include "tetracubes.h"

/* A context of the reference engine, made once. */
tc_context *surface_context(void);

/* Traps where the status of a call is not one that data and arguments can cause, or has no text. */
void surface_check_status(tc_status status);

/* Counts, extracts and carries a field of `type` (values: one per sample). Returns the number of triangles, 0 where the
 * extraction is refused. */
uint64_t surface_check(tc_grid *grid, const tc_extract_options *how, tc_type type, const void *values);

/* Of a complex of point_count points and cell_count cells: every number is in range. */
void surface_check_complex(const tc_tetrahedra *complex, uint64_t point_count, uint64_t cell_count);

#endif
