/*
 * reference.h - the scalar reference: plain loops over bricks, cubes, five tetrahedra and 16-case tables
 *
 * It makes the same bytes as the kernels and shares with them only the tables, the grid and the mesh.
 */
#ifndef REFERENCE_H
#define REFERENCE_H

#include "reference/carry_vertex.h"
#include "grid/grid.h"
#include "grid/mesh.h"

/* Counts only. counts->struct_size is left alone. */
tc_status reference_count(const tc_grid *grid, const tc_extract_options *options, tc_counts *counts);

/* Fills the mesh. After a failure its content is undefined: clear it. */
tc_status reference_extract(const tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh);

/* Makes the channels alone of a mesh that is already allocated, for devices that cannot (u32, i32 and f64
 * samples without fp64). */
tc_status reference_vertices(const tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh);

/* Carries a field to as many vertices as there is room for; *vertex_count: how many the surface has. */
tc_status reference_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                          uint64_t *vertex_count);

#endif
