/*
 * What a slab needs on the device before a kernel can run over it: samples, present cells, kernel 1's results.
 */
#include "structured_run.h"

#include "failure.h"
#include "inside.h"
#include "structured.h"

#include <stdlib.h>

static const uintptr_t page_bytes = 4096;

tc_status kernel_launch(const run *r, cl_kernel kernel, const char *name, const kernel_argument *arguments,
                        cl_uint argument_count) {
    const size_t local = r->context->options.work_items, global = local * r->context->options.work_groups;
    cl_int error = CL_SUCCESS;
    for (cl_uint n = 0; n < argument_count && !error; n++)
        error = cl->SetKernelArg(kernel, n, arguments[n].bytes, arguments[n].value);
    if (!error) error = cl->EnqueueNDRangeKernel(r->context->queue, kernel, 1, NULL, &global, &local, 0, NULL, NULL);
    return error ? opencl_fail(name, error) : TC_OK;
}

/* --------------------------------------------------------------------------------------------------------- samples */

/* Makes samples [first, first + count) available: in place where the device shares the host's memory (the buffer starts
 * at a page's boundary, *offset samples before the first), else by a copy that is only enqueued. */
static tc_status samples_provide(tc_grid *grid, device_buffer *buffer, uint64_t first, uint64_t count,
                                 uint64_t *offset) {
    tc_context *context = grid->context;
    size_t bytes = tc_type_bytes(grid->type);
    char *start = (char *)(uintptr_t)grid->samples + first * bytes;
    if (context->info.shares_host_memory) {
        uintptr_t before = (uintptr_t)start & (page_bytes - 1);
        *offset = before / bytes;
        return buffer_wrap(context, buffer, start - before, before + count * bytes, CL_MEM_READ_ONLY, "samples");
    }
    *offset = 0;
    tc_status status = buffer_reserve(context, buffer, count * bytes, "samples");
    if (status) return status;
    cl_int error =
        cl->EnqueueWriteBuffer(context->queue, buffer->memory, CL_FALSE, 0, count * bytes, start, 0, NULL, NULL);
    return error ? opencl_fail("copying samples to the device", error) : TC_OK;
}

tc_status structured_grid_create(tc_grid *grid) {
    uint64_t ignored[2];
    struct device_grid *device = calloc(1, sizeof *device);
    if (!device) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a grid");
    grid->device = device;
    device->missing = grid->has_nodata && sample_patterns(grid->type, grid->nodata, ignored);
    tc_status status = slab_plan_make(grid->context, grid, &device->plan);
    if (!status && device->plan.samples_whole) {
        status = samples_provide(grid, &device->samples, 0, (uint64_t)grid_sample_count(grid), &device->sample_offset);
        if (!status && !grid->context->info.shares_host_memory) {
            cl_int error = cl->Finish(grid->context->queue);
            if (error) status = opencl_fail("copying samples to the device", error);
        }
    }
    return status;
}

void structured_grid_destroy(tc_grid *grid) {
    if (!grid->device) return;
    buffer_release(grid->context, &grid->device->samples);
    free(grid->device);
    grid->device = NULL;
}

/* One bit per cube whose corners are present, for the planes that kernels 1 and 2 look at. */
static tc_status cells_make(run *r, const slab *s) {
    workspace *work = &r->context->work;
    const cl_uint planes = (s->z1 < s->nz ? s->z1 + 1 : s->nz) - s->cell_z;
    const kernel_argument arguments[] = {ARGUMENT(*s), ARGUMENT(r->samples->memory), ARGUMENT(work->cells.memory),
                                         ARGUMENT(planes)};
    return kernel_launch(r, r->kernels.cells, "kernel cells_mark", arguments, 4);
}

tc_status slab_prepare(run *r, uint32_t slab_index, slab *out) {
    struct device_grid *device = r->grid->device;
    slab *s = out;
    *s = r->base;
    s->z0 = slab_begin(r->plan, slab_index);
    s->z1 = slab_end(r->plan, r->grid, slab_index);
    s->word_z = r->plan->words_whole ? 0 : s->z0;
    s->cell_z = s->z0 ? s->z0 - 1 : 0;
    s->sample_z = slab_samples_begin(r->plan, slab_index);
    s->head_offset = slab_index * STATE_WORDS;
    s->tiles_offset = r->plan->slab_count * STATE_WORDS + slab_index * TILE_WORDS * r->plan->slab_tiles;
    s->active_offset = (uint32_t)((s->z0 - s->word_z) / BRICK_PLANES * plan_bricks_per_layer(r->plan));
    uint32_t layers = (s->z1 - s->z0 + BRICK_PLANES - 1) / BRICK_PLANES;
    s->tile_count = (s->bricks_y + s->tile_rows - 1) / s->tile_rows * ((layers + s->tile_layers - 1) / s->tile_layers);
    uint64_t plane = (uint64_t)s->nx * s->ny;
    s->sample_count = plane * (slab_samples_end(r->plan, r->grid, slab_index) - s->sample_z);
    tc_status status = TC_OK;
    if (r->plan->samples_whole) {
        r->samples = &device->samples;
        s->sample_offset = device->sample_offset;
    } else {
        r->samples = &r->context->work.samples;
        status = samples_provide(r->grid, r->samples, plane * s->sample_z, s->sample_count, &s->sample_offset);
    }
    if (!status && device->missing) status = cells_make(r, s);
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- store */

tc_status slab_store_allocate(run *r) {
    if (r->plan->words_whole) return TC_OK;
    uint64_t words = (uint64_t)r->grid->dims[2] * plan_words_per_plane(r->plan, r->grid);
    uint64_t bricks = r->plan->layer_count * plan_bricks_per_layer(r->plan);
    slab_store *s = &r->store;
    s->words = malloc(8 * words);
    s->offsets = malloc(8 * words);
    s->triangle_offsets = malloc(2 * words);
    s->bases = malloc(8 * bricks);
    s->masks = malloc(4 * bricks);
    s->active = malloc(4 * bricks);
    if (s->words && s->offsets && s->triangle_offsets && s->bases && s->masks && s->active) return TC_OK;
    return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory to keep the sign words of all slabs");
}

void slab_store_release(slab_store *store) {
    free(store->words);
    free(store->offsets);
    free(store->triangle_offsets);
    free(store->bases);
    free(store->masks);
    free(store->active);
    *store = (slab_store){0};
}

/* Moves count bytes between the start of a window's buffer and byte `first` of an array of the store. */
static tc_status window_copy(run *r, device_buffer *buffer, uint8_t *host, uint64_t first, uint64_t count, bool save) {
    if (count == 0) return TC_OK;
    cl_command_queue queue = r->context->queue;
    cl_int error = save
                       ? cl->EnqueueReadBuffer(queue, buffer->memory, CL_FALSE, 0, count, host + first, 0, NULL, NULL)
                       : cl->EnqueueWriteBuffer(queue, buffer->memory, CL_FALSE, 0, count, host + first, 0, NULL, NULL);
    return error ? opencl_fail(save ? "reading sign words back" : "restoring sign words", error) : TC_OK;
}

static tc_status slab_move(run *r, uint32_t slab_index, bool save) {
    if (r->plan->words_whole) return TC_OK;
    workspace *work = &r->context->work;
    uint64_t z0 = slab_begin(r->plan, slab_index), z1 = slab_end(r->plan, r->grid, slab_index);
    uint64_t layer0 = z0 / BRICK_PLANES, layer1 = (z1 + BRICK_PLANES - 1) / BRICK_PLANES;
    uint64_t plane_end = !save && z1 < (uint64_t)r->grid->dims[2] ? z1 + 1 : z1;
    uint64_t layer_end = !save && layer1 < r->plan->layer_count ? layer1 + 1 : layer1;
    uint64_t words = plan_words_per_plane(r->plan, r->grid), bricks = plan_bricks_per_layer(r->plan);
    const struct {
        device_buffer *buffer;
        uint8_t *host;
        uint64_t first, end, unit;
    } arrays[] = {{&work->words, r->store.words, z0, plane_end, 8 * words},
                  {&work->offsets, r->store.offsets, z0, plane_end, 8 * words},
                  {&work->triangle_offsets, r->store.triangle_offsets, z0, z1, 2 * words},
                  {&work->bases, r->store.bases, layer0, layer_end, 8 * bricks},
                  {&work->masks, r->store.masks, layer0, layer1, 4 * bricks},
                  {&work->active, r->store.active, layer0, layer1, 4 * bricks}};
    tc_status status = TC_OK;
    for (size_t n = 0; n < sizeof arrays / sizeof *arrays && !status; n++)
        status = window_copy(r, arrays[n].buffer, arrays[n].host, arrays[n].first * arrays[n].unit,
                             (arrays[n].end - arrays[n].first) * arrays[n].unit, save);
    return status;
}

tc_status slab_save(run *r, uint32_t slab_index) { return slab_move(r, slab_index, true); }

tc_status slab_restore(run *r, uint32_t slab_index) { return slab_move(r, slab_index, false); }
