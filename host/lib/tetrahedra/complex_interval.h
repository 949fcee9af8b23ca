/*
 * complex_interval.h - interval volumes of complexes on a device: what their stages share
 *
 * Kernels count vertices at points and tetrahedra by both bounds, number the vertices on crossed edges, and emit. What
 * does not fit the device goes in slabs, which are cut smaller than those of surfaces.
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
    complex_run run;
    isovalue_test tests[BOUND_COUNT];
    complex_job jobs[BOUND_COUNT]; /* the same but for the test */
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

/* Counts vertices at points, tetrahedra and cuts; then joins and numbers the crossed edges. head has the counts. */
tc_status volume_count(volume_run *v);
tc_status volume_number(volume_run *v);

/* Emits into the workspace's buffers of positions and tetrahedra, once job has the numbers of vertices. */
tc_status volume_emit(volume_run *v);

/* The table that drives the kernels (complex_interval_cases.c). NULL without memory; to be freed. */
uint8_t *volume_table_make(void);

/* Adds the crossed edges of a slab whose vertices are numbered to those of the slabs before (complex_interval_join.c).
 * names: the grid's numbers of the slab's points; NULL: the same. */
tc_status volume_slab_join(const volume_run *v, const uint32_t *names, joined_edges joined[BOUND_COUNT]);

/* Slab by slab (complex_interval_slabs.c); before: the part of the call that is done before, for progress. interval
 * NULL: counts. */
tc_status volume_slabs_make(tc_grid *grid, const tc_interval_volume_options *options, const bool exists[BOUND_COUNT],
                            double before, interval_size *size, double *classify_ms, tc_interval_volume *interval);

#endif
