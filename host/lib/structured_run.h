/*
 * structured_run.h - one extraction on a device: what its stages share
 */
#ifndef STRUCTURED_RUN_H
#define STRUCTURED_RUN_H

#include "context.h"
#include "grid.h"
#include "inside.h"
#include "mesh.h"
#include "slab.h"
#include "slab_plan.h"

/* What an OpenCL context adds to a grid. */
struct device_grid {
    slab_plan plan;
    device_buffer samples; /* the whole grid, where plan.samples_whole */
    device_buffer ranges;  /* of all bricks, made at the first visit */
    bool ranges_known;
    tc_extract_options counted_options; /* what tc_count left for tc_emit, where context->counted is this grid: */
    uint32_t *heads;                    /* of all slabs */
    uint64_t sample_offset;
    bool missing; /* some sample is missing: known from the start with nodata, else found by kernel 1 */
};

/* Kernel 1's results kept on the host while the device holds only a window of them. */
typedef struct slab_store {
    uint8_t *words, *offsets, *triangle_offsets, *bricks, *active;
} slab_store;

typedef struct run {
    tc_grid *grid;
    tc_context *context;
    const slab_plan *plan;
    kernels kernels;
    bool normals;
    slab base;       /* what all slabs have in common */
    uint32_t *heads; /* per slab: STATE_WORDS words, after classification */
    slab_store store;
    struct {
        cl_mem positions, normals, triangles;
    } mesh;                 /* what kernel 2 writes to */
    device_buffer *samples; /* whole, or the window of the slab at hand */
    uint64_t vertex_count, triangle_count, active_cell_count;
    double classify_share; /* of the whole call, for progress */
    double start_ms;       /* kernels are built by then */
} run;

/* The slab's parameters; its samples and, with missing samples, its present cells are on their way to the device. */
tc_status slab_prepare(run *r, uint32_t slab_index, slab *out);

/* Moves kernel 1's results of a slab from or to the store, where windows are in use. */
tc_status slab_save(run *r, uint32_t slab_index);
tc_status slab_restore(run *r, uint32_t slab_index);
tc_status slab_store_allocate(run *r);
void slab_store_release(slab_store *store);

/* Describes an extraction, builds its kernels and provides what they work on, but for the mesh; run_end gives it back.
 */
tc_status run_begin(run *r, tc_grid *grid, const tc_extract_options *options, inside_range inside, bool emits);
void run_end(run *r);

/* Adds up the heads of all slabs. */
void totals_add(run *r);

/* Enqueues kernel 2 over all slabs, the whole mesh going to the buffers of r->mesh. */
tc_status slabs_emit_whole(run *r);

/* Emits all slabs into the mesh, which is allocated (structured_emit.c). */
tc_status slabs_emit(run *r, tc_mesh *mesh);

/* Sets one argument after the other, then launches work_groups groups of work_items. */
typedef struct kernel_argument {
    size_t bytes;
    const void *value;
} kernel_argument;

tc_status kernel_launch(const run *r, cl_kernel kernel, const char *name, const kernel_argument *arguments,
                        cl_uint argument_count);

#define ARGUMENT(x)                                                                                                    \
    { sizeof(x), &(x) }

#endif
