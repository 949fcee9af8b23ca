/*
 * reference_interval.h - interval volumes by the scalar reference
 */
#ifndef REFERENCE_INTERVAL_H
#define REFERENCE_INTERVAL_H

#include "grid/carry.h"
#include "grid/grid.h"
#include "grid/interval.h"

/* Of structured grids. *size: what there is. */
tc_status reference_interval_count(const tc_grid *grid, const tc_interval_volume_options *options, interval_size *size);
tc_status reference_interval_extract(const tc_grid *grid, const tc_interval_volume_options *options,
                                     tc_interval_volume *interval);

/* Carries a field to the vertices at samples alone, as many as there is room for; *count: how many there are. */
tc_status reference_interval_carry(const tc_grid *grid, const tc_interval_volume_options *options, const carry *c,
                                   uint64_t *count);

/* The same of grids of tetrahedra. */
tc_status reference_complex_interval_count(const tc_grid *grid, const tc_interval_volume_options *options,
                                           interval_size *size);
tc_status reference_complex_interval_extract(const tc_grid *grid, const tc_interval_volume_options *options,
                                             tc_interval_volume *interval);
tc_status reference_complex_interval_carry(const tc_grid *grid, const tc_interval_volume_options *options,
                                           const carry *c, uint64_t *count);

#endif
