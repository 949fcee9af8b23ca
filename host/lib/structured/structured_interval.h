/*
 * structured_interval.h - interval volumes of structured grids on a device: what their stages share
 *
 * The grid is processed in slabs, runs of whole layers of bricks. The window of a slab has the layer behind it too, as
 * its last cubes have vertices there. Kernel 1 classifies the window by both bounds, interval_count counts, the host
 * sums up over bricks, interval_emit emits, in steps of as many bricks as the memory has room for. Where there are
 * several slabs each is classified twice: first for the sums of all, then to be emitted.
 */
#ifndef STRUCTURED_INTERVAL_H
#define STRUCTURED_INTERVAL_H

#include "grid/interval.h"
#include "kernels/interval/interval_job.h"
#include "structured/structured_run.h"

typedef struct interval_plan {
    slab_plan tiles; /* of kernel 1; its slabs are windows */
    uint32_t slab_layers, slab_count;
    bool samples_whole;
    uint64_t mesh_bytes;  /* bound on what a step emits */
    uint64_t least_bytes; /* of the smallest window */
    uint64_t taken;       /* by the grid and others before */
} interval_plan;

/* One call. */
typedef struct interval_run {
    tc_grid *grid;
    tc_context *context;
    interval_plan plan;
    kernels kernels;
    bool exists[BOUND_COUNT];
    bool missing; /* the kernels are those for missing samples */
    slab base[BOUND_COUNT];
    interval_buffers *buffers;
    double share;    /* of counting in the whole call, for progress */
    double start_ms; /* kernels are built by then */

    /* Of the window that was classified last, in the host's memory: */
    slab window;
    interval_job job;
    interval_brick *bricks; /* sums of each brick, then of those before it */
    brick_state *states[BOUND_COUNT];
    interval_size size;   /* of the slab */
    interval_size before; /* of the slabs before it */
} interval_run;

/* Where slab n begins, in layers; the layers that it owns, and that its window has. */
uint32_t interval_slab_first(const interval_plan *plan, uint32_t n);
uint32_t interval_slab_own(const interval_plan *plan, uint32_t n);
uint32_t interval_slab_window(const interval_plan *plan, uint32_t n);

/* TC_ERROR_MEMORY, with how much would do, where the budget does not hold two layers of bricks; TC_ERROR_LIMIT where
 * these have too many samples. */
tc_status interval_plan_make(const tc_context *context, const tc_grid *grid, interval_plan *plan);

/* TC_ERROR_MEMORY, with how much would do, where a brick emits so many bytes that there is no room for. */
tc_status interval_brick_refuse(const interval_run *r, uint64_t bytes);

/* Results of a bound; where there is none, those of the other stand in, which no kernel looks at. */
const word_buffers *interval_words(const interval_run *r, int bound);

/* Classifies and counts slab n, and sums up its bricks. */
tc_status interval_classify(interval_run *r, uint32_t n);

/* Emits the slab that was classified last. */
tc_status interval_slab_emit(interval_run *r, tc_interval_volume *interval);

/* When all slabs are there: brings the blocks of vertices together, which had pages of their own. */
void interval_blocks_join(const interval_run *r, tc_interval_volume *interval);

/* The kind of the kernels. */
kernel_kind structured_interval_kind(const tc_grid *grid);

/* As tc_count_interval_volume and tc_extract_interval_volume, with arguments checked and kernels vetted. */
tc_status structured_interval_count(tc_grid *grid, const tc_interval_volume_options *options, interval_size *size,
                                    double *classify_ms);
tc_status structured_interval_extract(tc_grid *grid, const tc_interval_volume_options *options,
                                      tc_interval_volume *interval);

#endif
