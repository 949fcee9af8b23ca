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

static char *samples_start(const tc_grid *grid, uint64_t first) {
    return (char *)(uintptr_t)grid->samples + first * tc_type_bytes(grid->type);
}

/* Samples in the buffer before sample `first`: one that is used in place starts at a page's boundary. */
static uint64_t samples_offset(const tc_grid *grid, uint64_t first) {
    if (grid->cl_samples) return grid->cl_samples_offset + first;
    uintptr_t before = (uintptr_t)samples_start(grid, first) & (page_bytes - 1);
    return grid->context->in_place ? before / tc_type_bytes(grid->type) : 0;
}

/* Makes samples [first, first + count) available: in place where the device can, else by a copy, only enqueued. */
static tc_status samples_provide(tc_grid *grid, cl_command_queue queue, device_buffer *buffer, uint64_t first,
                                 uint64_t count) {
    tc_context *context = grid->context;
    size_t bytes = tc_type_bytes(grid->type);
    char *start = samples_start(grid, first);
    if (context->in_place) {
        uintptr_t before = (uintptr_t)start & (page_bytes - 1);
        return buffer_wrap(context, buffer, start - before, before + count * bytes, CL_MEM_READ_ONLY, "samples");
    }
    tc_status status = buffer_reserve(context, buffer, plan_sample_bytes(&grid->device->plan, grid), "samples");
    if (status) return status;
    cl_int error = cl->EnqueueWriteBuffer(queue, buffer->memory, CL_FALSE, 0, count * bytes, start, 0, NULL, NULL);
    return error ? opencl_fail("copying samples to the device", error) : TC_OK;
}

/* The caller's buffer, not counted as ours. */
static tc_status samples_adopt(tc_grid *grid, device_buffer *buffer) {
    const uint64_t bytes = tc_type_bytes(grid->type), count = (uint64_t)grid_sample_count(grid);
    size_t held = 0;
    cl_int error = cl->GetMemObjectInfo(grid->cl_samples, CL_MEM_SIZE, sizeof held, &held, NULL);
    if (error) return opencl_fail("asking cl_samples for its size", error);
    if (grid->cl_samples_offset > held / bytes || held / bytes - grid->cl_samples_offset < count)
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "cl_samples has %llu bytes, not %llu samples of %llu after the first %llu",
                               (unsigned long long)held, (unsigned long long)count, (unsigned long long)bytes,
                               (unsigned long long)grid->cl_samples_offset);
    if (!device_makes_vertices(grid->context, grid->type))
        return (tc_status)fail(TC_ERROR_DEVICE, "%s has no fp64, so samples of type %s have to be in the host's memory",
                               grid->context->info.name, tc_type_name(grid->type));
    error = cl->RetainMemObject(grid->cl_samples);
    if (error) return opencl_fail("retaining cl_samples", error);
    buffer->memory = grid->cl_samples;
    return TC_OK;
}

tc_status structured_grid_create(tc_grid *grid) {
    uint64_t ignored[2];
    struct device_grid *device = calloc(1, sizeof *device);
    if (!device) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a grid");
    grid->device = device;
    device->missing = grid->has_nodata && sample_patterns(grid->type, grid->nodata, ignored);
    tc_status status = slab_plan_make(grid->context, grid, &device->plan);
    uint64_t bricks = device->plan.layer_count * plan_bricks_per_layer(&device->plan);
    if (!status)
        status = buffer_reserve(grid->context, &device->ranges, sizeof(brick_range) * bricks, "ranges of bricks");
    if (!status && grid->cl_samples) {
        status = samples_adopt(grid, &device->samples);
    } else if (!status && device->plan.samples_whole) {
        status = samples_provide(grid, grid->context->queue, &device->samples, 0, (uint64_t)grid_sample_count(grid));
        if (!status && !grid->context->in_place) {
            cl_int error = cl->Finish(grid->context->queue);
            if (error) status = opencl_fail("copying samples to the device", error);
        }
    }
    return status;
}

void structured_grid_destroy(tc_grid *grid) {
    if (!grid->device) return;
    if (grid->context->counted == grid) grid->context->counted = NULL;
    if (grid->context->served == grid) grid->context->served = NULL;
    free(grid->device->heads);
    buffer_release(grid->context, &grid->device->samples);
    buffer_release(grid->context, &grid->device->ranges);
    free(grid->device);
    grid->device = NULL;
}

device_buffer *place_samples(const run *r, slab_place place) {
    return r->plan->samples_whole ? &r->grid->device->samples : &r->context->work.samples[place.window];
}

word_buffers *place_words(const run *r, slab_place place) {
    return &r->context->work.words[r->plan->words_whole ? 0 : place.window];
}

/* One bit per cube whose corners are present, for the planes that kernels 1 and 2 look at. */
tc_status slab_mark_cells(run *r, slab_place place, const slab *s) {
    workspace *work = &r->context->work;
    if (!r->grid->device->missing) return TC_OK;
    const cl_uint planes = (s->z1 < s->nz ? s->z1 + 1 : s->nz) - s->cell_z;
    const kernel_argument arguments[] = {ARGUMENT(*s), ARGUMENT(place_samples(r, place)->memory),
                                         ARGUMENT(work->cells.memory), ARGUMENT(planes)};
    return kernel_launch(r, r->kernels.cells, "kernel cells_mark", arguments, 4);
}

static uint64_t slab_first_sample(const run *r, uint32_t slab_index) {
    return (uint64_t)r->base.nx * r->base.ny * slab_samples_begin(r->plan, slab_index);
}

static uint64_t slab_sample_count(const run *r, uint32_t slab_index) {
    uint64_t end = (uint64_t)r->base.nx * r->base.ny * slab_samples_end(r->plan, r->grid, slab_index);
    return end - slab_first_sample(r, slab_index);
}

tc_status slab_load(run *r, slab_place place) {
    if (r->plan->samples_whole) return TC_OK;
    return samples_provide(r->grid, r->copies, place_samples(r, place), slab_first_sample(r, place.slab_index),
                           slab_sample_count(r, place.slab_index));
}

void slab_describe(const run *r, slab_place place, slab *out) {
    const uint32_t slab_index = place.slab_index;
    slab *s = out;
    *s = r->base;
    s->z0 = slab_begin(r->plan, slab_index);
    s->z1 = slab_end(r->plan, r->grid, slab_index);
    s->word_z = r->plan->words_whole ? 0 : s->z0;
    s->range_offset = (uint32_t)(s->word_z / BRICK_PLANES * plan_bricks_per_layer(r->plan));
    s->cell_z = s->z0 ? s->z0 - 1 : 0;
    s->sample_z = slab_samples_begin(r->plan, slab_index);
    s->head_offset = slab_index * STATE_WORDS;
    s->tiles_offset = r->plan->slab_count * STATE_WORDS + slab_index * TILE_WORDS * r->plan->slab_tiles;
    s->active_offset = (uint32_t)((s->z0 - s->word_z) / BRICK_PLANES * plan_bricks_per_layer(r->plan));
    uint32_t layers = (s->z1 - s->z0 + BRICK_PLANES - 1) / BRICK_PLANES;
    s->tile_count = (s->bricks_y + s->tile_rows - 1) / s->tile_rows * ((layers + s->tile_layers - 1) / s->tile_layers);
    s->sample_offset = samples_offset(r->grid, slab_first_sample(r, slab_index));
    s->sample_count = slab_sample_count(r, slab_index);
}

/* ----------------------------------------------------------------------------------------------------------- store */

tc_status slab_store_allocate(run *r) {
    if (r->plan->words_whole) return TC_OK;
    uint64_t bricks = r->plan->layer_count * plan_bricks_per_layer(r->plan), words = BRICK_WORDS * bricks;
    slab_store *s = &r->store;
    s->words = malloc(8 * words);
    s->offsets = malloc(8 * words);
    s->triangle_offsets = malloc(2 * words);
    s->bricks = malloc(sizeof(brick_state) * bricks);
    s->active = malloc(4 * bricks);
    if (s->words && s->offsets && s->triangle_offsets && s->bricks && s->active) return TC_OK;
    return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory to keep the sign words of all slabs");
}

void slab_store_release(slab_store *store) {
    free(store->words);
    free(store->offsets);
    free(store->triangle_offsets);
    free(store->bricks);
    free(store->active);
    *store = (slab_store){0};
}

/* Moves count bytes between byte `place` of a window's buffer and byte `first` of an array of the store. */
static tc_status window_copy(run *r, device_buffer *buffer, uint64_t place, uint8_t *host, uint64_t first,
                             uint64_t count, bool save) {
    if (count == 0) return TC_OK;
    cl_command_queue queue = r->copies;
    cl_mem memory = buffer->memory;
    cl_int error = save ? cl->EnqueueReadBuffer(queue, memory, CL_FALSE, place, count, host + first, 0, NULL, NULL)
                        : cl->EnqueueWriteBuffer(queue, memory, CL_FALSE, place, count, host + first, 0, NULL, NULL);
    return error ? opencl_fail(save ? "reading sign words back" : "restoring sign words", error) : TC_OK;
}

/* A slab's layers, and when they are restored the one after, which kernel 2 looks at too. */
static tc_status slab_move(run *r, slab_place place, bool save) {
    if (r->plan->words_whole) return TC_OK;
    word_buffers *work = place_words(r, place);
    const uint32_t slab_index = place.slab_index;
    uint64_t layer0 = slab_begin(r->plan, slab_index) / BRICK_PLANES;
    uint64_t layer1 = (slab_end(r->plan, r->grid, slab_index) + BRICK_PLANES - 1ull) / BRICK_PLANES;
    uint64_t layer_end = !save && layer1 < r->plan->layer_count ? layer1 + 1 : layer1;
    uint64_t bricks = plan_bricks_per_layer(r->plan), constant = 8 * UNIFORM_BRICKS * BRICK_WORDS;
    const struct {
        device_buffer *buffer;
        uint64_t place;
        uint8_t *host;
        uint64_t end, brick_bytes;
    } arrays[] = {{&work->words, constant, r->store.words, layer_end, 8 * BRICK_WORDS},
                  {&work->offsets, 0, r->store.offsets, layer_end, 8 * BRICK_WORDS},
                  {&work->triangle_offsets, 0, r->store.triangle_offsets, layer1, 2 * BRICK_WORDS},
                  {&work->bricks, 0, r->store.bricks, layer_end, sizeof(brick_state)},
                  {&work->active, 0, r->store.active, layer1, 4}};
    tc_status status = TC_OK;
    for (size_t n = 0; n < sizeof arrays / sizeof *arrays && !status; n++)
        status =
            window_copy(r, arrays[n].buffer, arrays[n].place, arrays[n].host, layer0 * bricks * arrays[n].brick_bytes,
                        (arrays[n].end - layer0) * bricks * arrays[n].brick_bytes, save);
    return status;
}

tc_status slab_save(run *r, slab_place place) { return slab_move(r, place, true); }

tc_status slab_restore(run *r, slab_place place) { return slab_move(r, place, false); }
