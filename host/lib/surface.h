/*
 * surface.h - an isovalue's surface of any grid, by the engine of its context: arguments are checked, drivers are not
 */
#ifndef SURFACE_H
#define SURFACE_H

#include "grid/grid.h"
#include "opencl/kernel_kind.h"
#include "grid/mesh.h"

/* The kernels that make it; emits: kernel 2 too. */
kernel_kind surface_kind(const tc_grid *grid, const tc_extract_options *options, bool emits);

/* False where the isovalue, or the grid, is such that nothing runs. */
bool surface_needs_kernels(const tc_grid *grid, const tc_extract_options *options);

tc_status surface_count(tc_grid *grid, const tc_extract_options *options, tc_counts *counts);
tc_status surface_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh);

#endif
