/*
 * grids.h - making and destroying grids of either kind, from complete options
 */
#ifndef GRIDS_H
#define GRIDS_H

#include "grid/grid.h"

/* As tc_grid_create and tc_tetrahedra_grid_create. */
tc_status grid_create(tc_context *context, const tc_grid_options *options, scan_parameters scan, tc_grid **out);
tc_status complex_create(tc_context *context, const tc_tetrahedra_grid_options *options, scan_parameters scan,
                         tc_grid **out);

/* NULL is accepted. */
void grid_destroy(tc_grid *grid);

#endif
