/*
 * surface.h - an isovalue's surface of any grid, by the engine of its context: arguments are checked, drivers are not
 */
#ifndef SURFACE_H
#define SURFACE_H

#include "grid/carry.h"
#include "grid/grid.h"
#include "opencl/kernel_kind.h"
#include "grid/mesh.h"

/* The kind of the kernels that make the surface; emits: kernel 2 too. */
kernel_kind surface_kind(const tc_grid *grid, const tc_extract_options *options, bool emits);

/* False under the reference engine, and where grid, sample type and isovalue allow no surface. */
bool surface_needs_kernels(const tc_grid *grid, const tc_extract_options *options);

/* share: of the whole call, for progress. */
tc_status surface_count(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts);
tc_status surface_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh);

/* Whether the results that surface_carry needs exist: for the surface counted or extracted last; on grids in slabs,
 * only after surface_keep_results. The reference engine needs none. */
bool surface_is_classified(const tc_grid *grid, const tc_extract_options *options);
void surface_keep_results(tc_grid *grid);

/* Carries a field to the vertices; *vertex_count: how many there are. */
tc_status surface_carry(tc_grid *grid, const tc_extract_options *options, const carry *c, uint64_t *vertex_count);

#endif
