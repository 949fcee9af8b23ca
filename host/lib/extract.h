/*
 * extract.h - what the public calls that work on a surface begin with
 */
#ifndef EXTRACT_H
#define EXTRACT_H

#include "grid/grid.h"

/* The caller's options, complete and checked. */
tc_status extract_options_take(tc_extract_options *o, const tc_extract_options *options);

/* As surface_count (surface/surface.h), by kernels that are vetted and tried first. */
tc_status surface_count_vetted(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts);

/* Whether a field of the caller's can be carried on the grid (carry.c). */
tc_status field_check(const tc_grid *grid, const tc_field *field, const float *out, uint64_t value_count);

#endif
