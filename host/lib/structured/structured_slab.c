/*
 * What a slab needs on the device before a kernel can run over it: arrays of the grid, present cells, kernel 1's
 * results.
 */
#include "structured/structured_run.h"

#include "failure.h"
#include "grid/inside.h"
#include "structured/structured.h"

#include <stdlib.h>

/* --------------------------------------------------------------------------------------------------------- arrays */

static const char *const array_names[ARRAY_COUNT] = {"samples", "points", "blanked samples", "blanked cells"};

static uint64_t array_planes(const tc_grid *grid, int array) {
    return (uint64_t)grid->dims[2] - (array == ARRAY_BLANKED_CELLS);
}

static char *array_start(const tc_grid *grid, int array, uint64_t z) {
    return (char *)(uintptr_t)grid_array_data(grid, array) + z * grid_array_plane_bytes(grid, array);
}

/* Items in the buffer before plane z, the first it holds: a buffer used in place starts at a page boundary. */
static uint64_t array_offset(const tc_grid *grid, int array, uint64_t z) {
    const uint64_t item_bytes = grid_array_item_bytes(grid, array);
    if (array == ARRAY_SAMPLES && grid->cl_samples)
        return grid->cl_samples_offset + z * (grid_array_plane_bytes(grid, array) / item_bytes);
    uintptr_t before = (uintptr_t)array_start(grid, array, z) & (PAGE_BYTES - 1);
    return grid->context->in_place ? before / item_bytes : 0;
}

struct _cl_mem *structured_samples(const tc_grid *grid, uint64_t *offset) {
    *offset = array_offset(grid, ARRAY_SAMPLES, 0);
    return grid->device->arrays[ARRAY_SAMPLES].memory;
}

tc_status grid_array_provide(tc_grid *grid, uint64_t capacity, cl_command_queue queue, device_buffer *buffer, int array,
                             uint64_t z0, uint64_t z1) {
    tc_context *context = grid->context;
    if (!grid_array_data(grid, array)) return TC_OK;
    if (z1 > array_planes(grid, array)) z1 = array_planes(grid, array);
    uint64_t bytes = (z1 - z0) * grid_array_plane_bytes(grid, array);
    char *start = array_start(grid, array, z0);
    if (context->in_place) {
        uintptr_t before = (uintptr_t)start & (PAGE_BYTES - 1);
        return buffer_wrap(context, buffer, start - before, before + bytes, CL_MEM_READ_ONLY, array_names[array]);
    }
    tc_status status = buffer_reserve(context, buffer, capacity, array_names[array]);
    if (status) return status;
    cl_int error = cl->EnqueueWriteBuffer(queue, buffer->memory, CL_FALSE, 0, bytes, start, 0, NULL, NULL);
    return error ? context_fail(context, "copying a grid to the device", error) : TC_OK;
}

/* All arrays whole. */
static tc_status arrays_provide(tc_grid *grid) {
    cl_command_queue queue = grid->context->queue;
    tc_status status = TC_OK;
    for (int array = 0; array < ARRAY_COUNT && !status; array++)
        status = grid_array_provide(grid, plan_array_bytes(&grid->device->plans[0][0], grid, array), queue,
                                    &grid->device->arrays[array], array, 0, array_planes(grid, array));
    if (status || grid->context->in_place) return status;
    cl_int error = cl->Finish(queue);
    return error ? context_fail(grid->context, "copying a grid to the device", error) : TC_OK;
}

/* Positions along x, y and z, one after the other. */
static tc_status axes_provide(tc_grid *grid) {
    device_buffer *buffer = &grid->device->axes;
    const uint64_t bytes[3] = {sizeof(float) * (uint64_t)grid->dims[0], sizeof(float) * (uint64_t)grid->dims[1],
                               sizeof(float) * (uint64_t)grid->dims[2]};
    uint64_t offset = 0;
    if (grid->kind != GRID_RECTILINEAR) return TC_OK;
    tc_status status = buffer_reserve(grid->context, buffer, bytes[0] + bytes[1] + bytes[2], "coordinates");
    for (int axis = 0; axis < 3 && !status; offset += bytes[axis++]) {
        cl_int error = cl->EnqueueWriteBuffer(grid->context->queue, buffer->memory, CL_TRUE, offset, bytes[axis],
                                              grid->axes[axis], 0, NULL, NULL);
        if (error) status = context_fail(grid->context, "copying coordinates to the device", error);
    }
    return status;
}

/* Takes the caller's buffer, which does not count as memory of the context. */
static tc_status samples_adopt(tc_grid *grid, device_buffer *buffer) {
    const uint64_t bytes = tc_type_bytes(grid->type), count = (uint64_t)grid_sample_count(grid);
    size_t held = 0;
    tc_status status = buffer_inspect(grid->context, grid->cl_samples, CL_MEM_WRITE_ONLY, "cl_samples", &held);
    if (status) return status;
    if (grid->cl_samples_offset > held / bytes || held / bytes - grid->cl_samples_offset < count)
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "cl_samples has %llu bytes, not %llu samples of %llu after the first %llu",
                               (unsigned long long)held, (unsigned long long)count, (unsigned long long)bytes,
                               (unsigned long long)grid->cl_samples_offset);
    if (!device_makes_vertices(grid->context, grid->type))
        return (tc_status)fail(TC_ERROR_DEVICE, "%s has no fp64, so samples of type %s have to be in the host's memory",
                               grid->context->info.name, tc_type_name(grid->type));
    cl_int error = cl->RetainMemObject(grid->cl_samples);
    if (error) return context_fail(grid->context, "retaining cl_samples", error);
    buffer->memory = grid->cl_samples;
    return TC_OK;
}

tc_status structured_grid_create(tc_grid *grid) {
    uint64_t ignored[2];
    struct device_grid *device = calloc(1, sizeof *device);
    if (!device) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a grid");
    slab_plan *plan = &device->plans[0][0];
    grid->device = device;
    device->missing = grid->blanked_samples || grid->blanked_cells ||
                      (grid->has_nodata && value_bits(grid->type, grid->nodata, ignored));
    tc_status status = slab_plan_make(grid->context, grid, (plan_needs){0}, SAMPLES_THAT_FIT, plan);
    uint64_t bricks = plan->layer_count * plan_bricks_per_layer(plan);
    if (!status)
        status = buffer_reserve(grid->context, &device->ranges, sizeof(brick_range) * bricks, "ranges of bricks");
    if (!status && grid->cl_samples) status = samples_adopt(grid, &device->arrays[ARRAY_SAMPLES]);
    if (!status) status = axes_provide(grid);
    if (!status && plan->samples_whole) status = arrays_provide(grid);
    if (status) cl->Finish(grid->context->queue); /* running copies read the caller's memory */
    return status;
}

void structured_grid_destroy(tc_grid *grid) {
    if (!grid->device) return;
    context_finish(grid->context); /* an emission that is under way reads arrays of the grid and of the caller's */
    if (grid->context->counted_grid == grid) grid->context->counted_grid = NULL;
    if (grid->context->classified_grid == grid) grid->context->classified_grid = NULL;
    slab_store_release(&grid->device->store);
    if (grid->context->workspace_grid == grid) grid->context->workspace_grid = NULL;
    free(grid->device->heads);
    for (int array = 0; array < ARRAY_COUNT; array++) buffer_release(grid->context, &grid->device->arrays[array]);
    buffer_release(grid->context, &grid->device->axes);
    buffer_release(grid->context, &grid->device->ranges);
    free(grid->device);
    grid->device = NULL;
}

device_buffer *slab_array(const run *r, slab_ref ref, int array) {
    return r->plan->samples_whole ? &r->grid->device->arrays[array] : &r->context->work.arrays[ref.window][array];
}

word_buffers *slab_words(const run *r, slab_ref ref) {
    return &r->context->work.words[r->plan->words_whole ? 0 : ref.window];
}

/* One bit per cube whose corners are present, for the planes that kernels look at. */
tc_status cells_launch(const tc_grid *grid, const kernels *k, const slab *s, const classify_buffers *b,
                       uint32_t planes) {
    const kernel_argument arguments[] = {ARGUMENT(*s),
                                         ARGUMENT(b->samples),
                                         ARGUMENT(b->blanked_samples),
                                         ARGUMENT(b->blanked_cells),
                                         ARGUMENT(b->cells->memory),
                                         ARGUMENT(planes)};
    return kernel_launch(grid->context, k->cells, "kernel cells_mark", arguments, sizeof arguments / sizeof *arguments);
}

tc_status classify_launch(const tc_grid *grid, const kernels *k, const slab *s, const classify_buffers *b,
                          const word_buffers *words, uint32_t scratch_words) {
    const kernel_argument arguments[] = {ARGUMENT(*s),
                                         ARGUMENT(b->samples),
                                         ARGUMENT(b->cells->memory),
                                         ARGUMENT(grid->device->ranges.memory),
                                         ARGUMENT(words->words.memory),
                                         ARGUMENT(words->offsets.memory),
                                         ARGUMENT(words->triangle_offsets.memory),
                                         ARGUMENT(words->bricks.memory),
                                         ARGUMENT(words->active.memory),
                                         ARGUMENT(b->state->memory),
                                         ARGUMENT(b->scratch->memory),
                                         ARGUMENT(scratch_words)};
    return kernel_launch(grid->context, k->classify, "kernel classify", arguments,
                         sizeof arguments / sizeof *arguments);
}

classify_buffers slab_classify_buffers(const run *r, slab_ref ref) {
    const workspace *work = &r->context->work;
    return (classify_buffers){.samples = slab_array(r, ref, ARRAY_SAMPLES)->memory,
                              .blanked_samples = slab_array(r, ref, ARRAY_BLANKED_SAMPLES)->memory,
                              .blanked_cells = slab_array(r, ref, ARRAY_BLANKED_CELLS)->memory,
                              .cells = &work->cells,
                              .state = &work->state,
                              .scratch = &work->scratch};
}

tc_status slab_mark_cells(run *r, slab_ref ref, const slab *s) {
    const classify_buffers b = slab_classify_buffers(r, ref);
    if (!r->grid->device->missing) return TC_OK;
    const uint32_t end = r->plan->needs.zeros ? slab_words_end(r->plan, r->grid, ref.slab_index)
                         : s->z1 < s->nz      ? s->z1 + 1
                                              : s->nz;
    return cells_launch(r->grid, &r->kernels, s, &b, end - s->arrays.cell_z);
}

tc_status slab_load(run *r, slab_ref ref, bool emits) {
    tc_status status = TC_OK;
    if (r->plan->samples_whole) return TC_OK;
    for (int array = 0; array < ARRAY_COUNT && !status; array++)
        if (emits || array != ARRAY_POINTS)
            status = grid_array_provide(r->grid, plan_array_bytes(r->plan, r->grid, array), r->copies,
                                        slab_array(r, ref, array), array, slab_samples_begin(r->plan, ref.slab_index),
                                        slab_samples_end(r->plan, r->grid, ref.slab_index));
    return status;
}

void slab_arrays_locate(const tc_grid *grid, uint64_t end, slab *s) {
    const uint64_t begin = s->arrays.sample_z;
    uint64_t cell_end = end < s->nz ? end : s->nz - 1;
    s->arrays.sample_offset = array_offset(grid, ARRAY_SAMPLES, begin);
    s->arrays.sample_count = (end - begin) * s->nx * s->ny;
    s->arrays.point_offset = array_offset(grid, ARRAY_POINTS, begin) - 3 * s->arrays.sample_offset;
    s->arrays.blanked_offset = array_offset(grid, ARRAY_BLANKED_SAMPLES, begin) - s->arrays.sample_offset;
    s->arrays.blanked_cell_offset = array_offset(grid, ARRAY_BLANKED_CELLS, begin);
    s->arrays.blanked_cell_count = (cell_end - begin) * (s->nx - 1) * (s->ny - 1);
}

uint32_t tile_count_of(const slab *s) {
    const uint32_t layers = (s->z1 - s->z0 + BRICK_PLANES - 1) / BRICK_PLANES;
    return (s->bricks_y + s->tiling.tile_rows - 1) / s->tiling.tile_rows *
           ((layers + s->tiling.tile_layers - 1) / s->tiling.tile_layers);
}

void slab_describe(const run *r, slab_ref ref, slab *out) {
    const uint32_t slab_index = ref.slab_index;
    slab *s = out;
    *s = r->base;
    s->z0 = slab_begin(r->plan, slab_index);
    s->z1 = slab_end(r->plan, r->grid, slab_index);
    s->results.word_z = slab_words_begin(r->plan, slab_index);
    s->results.range_offset = (uint32_t)(s->results.word_z / BRICK_PLANES * plan_bricks_per_layer(r->plan));
    s->arrays.cell_z = r->plan->needs.zeros ? s->results.word_z : s->z0 ? s->z0 - 1 : 0;
    s->arrays.sample_z = slab_samples_begin(r->plan, slab_index);
    s->results.head_offset = slab_index * STATE_WORDS;
    s->results.tiles_offset = r->plan->slab_count * STATE_WORDS + slab_index * TILE_WORDS * r->plan->slab_tiles;
    s->results.active_offset = (uint32_t)((s->z0 - s->results.word_z) / BRICK_PLANES * plan_bricks_per_layer(r->plan));
    s->tiling.tile_count = tile_count_of(s);
    s->snapping.zero_bricks = plan_zero_bricks(r->plan);
    slab_arrays_locate(r->grid, slab_samples_end(r->plan, r->grid, slab_index), s);
}

/* ----------------------------------------------------------------------------------------------------------- store */

tc_status slab_store_allocate(run *r) {
    if (r->plan->words_whole) return TC_OK;
    uint64_t bricks = r->plan->layer_count * plan_bricks_per_layer(r->plan), words = BRICK_WORDS * bricks;
    const size_t brick_bytes = sizeof(brick_state);
    slab_store *s = &r->store;
    s->words = malloc(8 * words);
    s->zeros = r->plan->needs.zeros ? malloc(8 * words) : NULL;
    s->offsets = malloc(8 * words);
    s->triangle_offsets = malloc(2 * words);
    s->bricks = malloc(brick_bytes * bricks);
    s->active = malloc(4 * bricks);
    if (s->words && (s->zeros || !r->plan->needs.zeros) && s->offsets && s->triangle_offsets && s->bricks && s->active)
        return TC_OK;
    return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory to keep the sign words of all slabs");
}

void slab_store_release(slab_store *store) {
    free(store->words);
    free(store->zeros);
    free(store->offsets);
    free(store->triangle_offsets);
    free(store->bricks);
    free(store->active);
    *store = (slab_store){0};
}

/* Moves count bytes between byte `offset` of a window's buffer and byte `first` of an array of the store. */
static tc_status window_copy(run *r, device_buffer *buffer, uint64_t offset, uint8_t *host, uint64_t first,
                             uint64_t count, bool save) {
    if (count == 0) return TC_OK;
    cl_command_queue queue = r->copies;
    cl_mem memory = buffer->memory;
    cl_int error = save ? cl->EnqueueReadBuffer(queue, memory, CL_FALSE, offset, count, host + first, 0, NULL, NULL)
                        : cl->EnqueueWriteBuffer(queue, memory, CL_FALSE, offset, count, host + first, 0, NULL, NULL);
    return error ? context_fail(r->context, save ? "reading sign words back" : "restoring sign words", error) : TC_OK;
}

/* A slab's layers, and when they are restored the others of its window, which kernel 2 looks at too. */
static tc_status slab_move(run *r, slab_ref ref, bool save) {
    if (r->plan->words_whole) return TC_OK;
    word_buffers *work = slab_words(r, ref);
    const uint32_t slab_index = ref.slab_index;
    const uint64_t own = slab_begin(r->plan, slab_index) / BRICK_PLANES;
    const uint64_t own_end = (slab_end(r->plan, r->grid, slab_index) + BRICK_PLANES - 1ull) / BRICK_PLANES;
    const uint64_t first = slab_words_begin(r->plan, slab_index) / BRICK_PLANES, begin = save ? own : first;
    const uint64_t end =
        save ? own_end : (slab_words_end(r->plan, r->grid, slab_index) + BRICK_PLANES - 1ull) / BRICK_PLANES;
    const uint64_t bricks = plan_bricks_per_layer(r->plan), constant = 8 * UNIFORM_BRICKS * BRICK_WORDS;
    const uint64_t zeros = constant + 8 * (uint64_t)BRICK_WORDS * plan_zero_bricks(r->plan);
    const struct {
        device_buffer *buffer;
        uint64_t offset; /* of the window's first layer */
        uint8_t *host;
        uint64_t begin, end, brick_bytes;
    } arrays[] = {{&work->words, constant, r->store.words, begin, end, 8 * BRICK_WORDS},
                  {&work->words, zeros, r->store.zeros, begin, r->plan->needs.zeros ? end : begin, 8 * BRICK_WORDS},
                  {&work->offsets, 0, r->store.offsets, begin, end, 8 * BRICK_WORDS},
                  {&work->triangle_offsets, 0, r->store.triangle_offsets, own, own_end, 2 * BRICK_WORDS},
                  {&work->bricks, 0, r->store.bricks, begin, end, sizeof(brick_state)},
                  {&work->active, 0, r->store.active, own, own_end, 4}};
    tc_status status = TC_OK;
    for (size_t n = 0; n < sizeof arrays / sizeof *arrays && !status; n++) {
        const uint64_t bytes = bricks * arrays[n].brick_bytes;
        status = window_copy(r, arrays[n].buffer, arrays[n].offset + (arrays[n].begin - first) * bytes, arrays[n].host,
                             arrays[n].begin * bytes, (arrays[n].end - arrays[n].begin) * bytes, save);
    }
    return status;
}

tc_status slab_save(run *r, slab_ref ref) { return slab_move(r, ref, true); }

tc_status slab_restore(run *r, slab_ref ref) { return slab_move(r, ref, false); }
