/*
 * structured_run.h - one extraction on a device: what its stages share
 */
#ifndef STRUCTURED_RUN_H
#define STRUCTURED_RUN_H

#include "opencl/context.h"
#include "grid/grid.h"
#include "grid/inside.h"
#include "opencl/kernels.h"
#include "grid/mesh.h"
#include "tables/method.h"
#include "kernels/base/slab.h"
#include "structured/slab_plan.h"

/* Kernel 1's results kept on the host while the device holds only a window of them. */
typedef struct slab_store {
    uint8_t *words, *zeros, *offsets, *triangle_offsets, *bricks, *active;
} slab_store;

/* What an OpenCL context adds to a grid. */
struct device_grid {
    slab_plan plans[2][2]; /* [zeros][closed]; all but [0][0] are made when first needed, until then layer_count is 0 */
    device_buffer arrays[ARRAY_COUNT]; /* the whole grid, where plans have samples_whole */
    device_buffer axes;                /* of a rectilinear grid: positions along x, y, z */
    device_buffer ranges;              /* of all bricks, made at the first visit */
    bool ranges_known;
    tc_extract_options classified_options; /* of what kernel 1 left, where context->classified_grid is this grid: */
    uint32_t *heads;                       /* of all slabs; NULL: there is no surface */
    slab_store store;                      /* where the workspace holds a window, and fields are carried */
    bool carries;                          /* a field was carried to a surface of the grid */
    bool missing; /* some sample is missing: known from the start with nodata or blanks, else found by kernel 1 */
};

typedef struct run {
    tc_grid *grid;
    tc_context *context;
    const slab_plan *plan;
    kernels kernels;
    tc_method method;
    bool closed;
    channel_set made;
    slab base;       /* the fields that all slabs share */
    uint32_t *heads; /* per slab: STATE_WORDS words, after classification */
    slab_store store;
    cl_command_queue copies; /* takes copies to and from the device; may be the queue of kernels */
    struct emit_plan *emit_plan;
    uint64_t vertex_count, triangle_count, active_cell_count;
    double classify_share; /* of the whole call, for progress */
    double start_ms;       /* kernels are built by then */
} run;

static inline slab_plan *plan_of(struct device_grid *device, const tc_extract_options *options) {
    return &device->plans[method_has_zeros(options->method)][options->closed != 0];
}

/* Of a structured grid what kernel 1 reads and writes, but for the words. */
typedef struct classify_buffers {
    cl_mem samples, blanked_samples, blanked_cells;
    const device_buffer *cells, *state, *scratch;
} classify_buffers;

/* Enqueues the kernel that marks `planes` planes of present cubes, where samples may be missing; kernel 1. */
tc_status cells_launch(const tc_grid *grid, const kernels *k, const slab *s, const classify_buffers *b,
                       uint32_t planes);
tc_status classify_launch(const tc_grid *grid, const kernels *k, const slab *s, const classify_buffers *b,
                          const word_buffers *words, uint32_t scratch_words);

/* A slab and the window that it is in: below plan_window_count. */
typedef struct slab_ref {
    uint32_t slab_index, window;
} slab_ref;

/* The buffers of a slab, which are those of all slabs where they are whole. */
device_buffer *slab_array(const run *r, slab_ref ref, int array);
word_buffers *slab_words(const run *r, slab_ref ref);

/* Brings the slab's samples and the arrays of blanked items to the device; for kernel 2 its points too. */
tc_status slab_load(run *r, slab_ref ref, bool emits);

/* The tiles of kernel 1 in planes z0 <= z < z1, shaped as the slab's are. */
uint32_t tile_count_of(const slab *s);

/* The slab's parameters; its samples are loaded. */
void slab_describe(const run *r, slab_ref ref, slab *out);

/* Marks the slab's present cells, where samples may be missing. */
tc_status slab_mark_cells(run *r, slab_ref ref, const slab *s);

/* Of the slab's window. */
classify_buffers slab_classify_buffers(const run *r, slab_ref ref);

/* Method snap: marks the samples of the slab's window that become vertices, before kernel 1 counts (structured_snap.c).
 */
tc_status window_snap(run *r, slab_ref ref, const slab *s);

/* Moves kernel 1's results of a slab from or to the store, where windows are in use. */
tc_status slab_save(run *r, slab_ref ref);
tc_status slab_restore(run *r, slab_ref ref);
tc_status slab_store_allocate(run *r);
void slab_store_release(slab_store *store);

/* What a stage does in each of its steps (structured_steps.c). */
typedef struct step_stages {
    const char *name;    /* for progress */
    double begin, share; /* of the whole call */
    tc_status (*load)(run *r, uint32_t step);
    tc_status (*compute)(run *r, uint32_t step);
    tc_status (*unload)(run *r, uint32_t step);
} step_stages;

/* All steps, in order; overlaps: copies run beside the kernels of other steps, which use other windows. */
tc_status steps_run(run *r, const step_stages *stages, uint32_t count, bool overlaps);

/* Describes an extraction, builds its kernels and reserves their buffers except the mesh; run_end releases these, and
 * after a failure all buffers that the context keeps. */
tc_status run_begin(run *r, tc_grid *grid, const tc_extract_options *options, inside_range inside, bool emits);
void run_end(run *r, tc_status status);

/* The fields that all slabs of a plan share. */
slab slab_base(const tc_grid *grid, const slab_plan *plan, inside_range inside, const tc_extract_options *options);

/* Makes planes z0 <= z < z1 of an array available, in a buffer of `room` bytes: in place where the device can, else by
 * a copy, only enqueued. */
tc_status grid_array_provide(tc_grid *grid, uint64_t capacity, cl_command_queue queue, device_buffer *buffer, int array,
                             uint64_t z0, uint64_t z1);

/* Where the first planes of the slab's arrays are in their buffers; they have planes up to before `end`. */
void slab_arrays_locate(const tc_grid *grid, uint64_t end, slab *s);

/* Reserves the two bricks of constant words and the sign words; then two bricks without zeros and the words of zeros.
 */
tc_status sign_words_reserve(tc_context *context, device_buffer *words, uint64_t zero_bricks, uint64_t brick_count);

/* Adds up the heads of all slabs. */
void totals_add(run *r);

/* Enqueues kernel 2 over all slabs, the whole mesh going to these buffers; samples and sign words are whole. */
tc_status slabs_emit_whole(run *r, mesh_buffers *buffers);

/* Emits all slabs into the mesh, which is allocated (structured_emit.c). */
tc_status slabs_emit(run *r, tc_mesh *mesh);

#endif
