/*
 * slab_plan.h - how a grid is cut into slabs and tiles so that counts and buffers fit the device
 *
 * A slab has whole layers of bricks, one after the other. Its counts fit the 30 bits of a scan word whatever the
 * samples are. Where memory allows, buffers hold the whole grid and slabs only bound the counts; else they hold a
 * window: the samples of a slab, and the other arrays that a grid may have, with one plane before and two after
 * (gradients and missing cells reach that far), sign words with one layer after. Devices with memory of their own hold
 * two such windows, where that fits: one is copied while kernels run over the other.
 *
 * Of a piece of a grid, slabs have its own layers, and a last one has the layer behind them: kernel 1 classifies it, so
 * that kernel 2 finds the vertices there, but it counts for nothing and is not emitted.
 *
 * Method snap has a plan of its own. Whether a sample is snapped depends on samples up to five steps away, one for each
 * colour. So windows have two layers of bricks more on either side, of which those steps use up the outer part; and
 * where buffers hold the whole grid, all of it is snapped at once. Closed surfaces may have more triangles, and so
 * smaller slabs.
 */
#ifndef SLAB_PLAN_H
#define SLAB_PLAN_H

#include "opencl/context.h"
#include "grid/grid.h"

/* What a plan has to serve beyond open surfaces on edges. */
typedef struct plan_needs {
    bool zeros;  /* method snap: words of zeros beside sign words, and windows reach further */
    bool closed; /* surfaces are closed */
} plan_needs;

typedef struct slab_plan {
    uint32_t words_x, bricks_y, layer_count;
    uint32_t own_first, own_end;     /* layers of the grid's own vertices and cells: all, unless it is a piece */
    uint32_t slab_layers;            /* of most slabs */
    uint32_t slab_count, own_slabs;  /* of a piece with a seam one more than it owns: the layer behind */
    bool samples_whole, words_whole; /* samples: with all other arrays of the grid */
    plan_needs needs;
    bool overlaps;                               /* copies and kernels run at once: windows are double */
    uint32_t tile_rows, tile_layers, slab_tiles; /* slab_tiles: at most, per slab */
    uint32_t scratch_words;                      /* per group */
    uint32_t work_items;                         /* for which tiles are shaped */
    uint64_t mesh_bytes;                         /* bound on the mesh, or all windows of it */
} slab_plan;

/* The least budget with which a grid can be extracted whatever its samples are, normals included; and with which it can
 * be whole on the device, as tc_emit needs, without the mesh. Within the device's limit on buffers. */
uint64_t plan_budget(const tc_context *context, const tc_grid *grid, plan_needs needs);
uint64_t plan_budget_whole(const tc_context *context, const tc_grid *grid, plan_needs needs);

/* Where a plan has the samples: whole where that fits; or as another plan of the grid has them. */
typedef enum sample_storage { SAMPLES_THAT_FIT, SAMPLES_WHOLE, SAMPLES_IN_WINDOWS } sample_storage;

tc_status slab_plan_make(const tc_context *context, const tc_grid *grid, plan_needs needs, sample_storage samples,
                         slab_plan *plan);

/* Shapes the tiles of a plan whose sizes are set. */
void slab_plan_tiles(const tc_context *context, const tc_grid *grid, slab_plan *plan);

/* The most samples of a slab, so that its counts fit a scan word. */
uint64_t slab_samples_most(plan_needs needs);

bool grid_can_miss_samples(const tc_grid *grid);

/* Shapes the tiles again where the context has changed to the other variant of the kernels. */
void slab_plan_reshape(const tc_context *context, const tc_grid *grid, slab_plan *plan);

/* A slab's first layer, the number of its layers, and its planes z0 <= z < z1. */
uint32_t slab_first_layer(const slab_plan *plan, uint32_t slab_index);
uint32_t slab_layer_count(const slab_plan *plan, uint32_t slab_index);
uint32_t slab_begin(const slab_plan *plan, uint32_t slab_index);
uint32_t slab_end(const slab_plan *plan, const tc_grid *grid, uint32_t slab_index);

/* Planes of sign words that a slab's window holds, whole layers of bricks. */
uint32_t slab_words_begin(const slab_plan *plan, uint32_t slab_index);
uint32_t slab_words_end(const slab_plan *plan, const tc_grid *grid, uint32_t slab_index);

/* Planes of samples that a slab needs. */
uint32_t slab_samples_begin(const slab_plan *plan, uint32_t slab_index);
uint32_t slab_samples_end(const slab_plan *plan, const tc_grid *grid, uint32_t slab_index);

/* The number of windows of samples, and of sign words that are not whole: 1 or 2. */
uint32_t plan_window_count(const slab_plan *plan);

/* Bytes of an array of the grid in one window, or of all of it; 0 where there is none, or it is the caller's buffer. */
uint64_t plan_array_bytes(const slab_plan *plan, const tc_grid *grid, int array);
uint32_t plan_window_layers(const slab_plan *plan);
uint64_t plan_words_per_plane(const slab_plan *plan, const tc_grid *grid); /* without padding to bricks */
uint64_t plan_cell_planes(const slab_plan *plan, const tc_grid *grid);
uint64_t plan_bricks_per_layer(const slab_plan *plan);

/* From the sign words of a brick to its zeros, in bricks; 0 where there are none. */
uint32_t plan_zero_bricks(const slab_plan *plan);

#endif
