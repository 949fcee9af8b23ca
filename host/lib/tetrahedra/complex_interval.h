/*
 * complex_interval.h - interval volumes of complexes on a device: what their stages share
 *
 * The surfaces of both bounds are classified and numbered, each in a workspace of its own. complex_interval_count
 * counts vertices at points, and tetrahedra; the kernels of complex_interval_emit.cl emit. What does not fit the device
 * goes in slabs, which are cut smaller than those of surfaces.
 */
#ifndef COMPLEX_INTERVAL_H
#define COMPLEX_INTERVAL_H

#include "kernels/tetrahedra/complex_interval_job.h"
#include "grid/interval.h"
#include "tetrahedra/complex_run.h"

/* One call, or a slab of it. */
typedef struct volume_run {
    tc_grid *grid;
    tc_context *context;
    const tc_interval_volume_options *options;
    complex_run bounds[BOUND_COUNT];
    bool exists[BOUND_COUNT];
    bool is_cut; /* into slabs */
    volume_buffers *work;
    volume_job job;
    uint32_t head[VOLUME_HEAD_WORDS];
    double start_ms; /* kernels are built by then */
} volume_run;

/* Kernels and workspaces; exists: which bounds separate any samples. */
tc_status volume_begin(volume_run *v, tc_grid *grid, const tc_interval_volume_options *options,
                       const bool exists[BOUND_COUNT], bool is_cut);

/* Classifies the surface of a bound in the part that is on the device, and numbers its vertices. */
tc_status volume_bound_classify(volume_run *v, int bound);

/* Counts what lies between; head has the counts. */
tc_status volume_count(volume_run *v);

/* Vertices of a bound, once it is classified. */
uint32_t volume_bound_vertices(const volume_run *v, int bound);

/* Emits into the workspace's buffers of positions and tetrahedra, once job has the numbers of vertices. */
tc_status volume_emit(volume_run *v);

/* The table that drives the kernels (complex_interval_cases.c). NULL without memory; to be freed. */
uint8_t *volume_table_make(void);

/* Slab by slab (complex_interval_slabs.c); before: the part of the call that is done before, for progress. interval
 * NULL: counts. */
tc_status volume_slabs_make(tc_grid *grid, const tc_interval_volume_options *options, const bool exists[BOUND_COUNT],
                            double before, interval_size *size, double *classify_ms, tc_interval_volume *interval);

#endif
