/*
 * The device path over structured grids: classify and scan, totals, allocate, emit (kernels/README.md).
 */
#include "structured/structured.h"

#include "failure.h"
#include "grid/inside.h"
#include "reference/reference.h"
#include "structured/structured_run.h"

#include <stdlib.h>
#include <string.h>

slab slab_base(const tc_grid *grid, const slab_plan *plan, inside_range inside, const tc_extract_options *options) {
    slab s = {.test = isovalue_test_of(inside, options->isovalue),
              .snapping = {.threshold = (float)options->snap},
              .arrays = {.has_blanked_samples = grid->blanked_samples != NULL,
                         .has_blanked_cells = grid->blanked_cells != NULL},
              .nx = (uint32_t)grid->dims[0],
              .ny = (uint32_t)grid->dims[1],
              .nz = (uint32_t)grid->dims[2],
              .words_x = plan->words_x,
              .bricks_y = plan->bricks_y,
              .parity = grid_parity(grid),
              .first = {(int32_t)grid->first[0], (int32_t)grid->first[1], (int32_t)grid->first[2]},
              .results = {.ranges_known = grid->device->ranges_known},
              .tiling = {
                  .tile_rows = plan->tile_rows, .tile_layers = plan->tile_layers, .spin_limit = grid->scan.spin_limit}};
    s.test.has_nodata = grid->has_nodata && value_bits(grid->type, grid->nodata, s.test.nodata_bits);
    memcpy(s.space.matrix, grid->matrix, sizeof s.space.matrix);
    memcpy(s.space.normal_matrix, grid->normal_matrix, sizeof s.space.normal_matrix);
    return s;
}

static uint64_t state_bytes(const run *r) {
    return 4ull * r->plan->slab_count * (STATE_WORDS + (uint64_t)TILE_WORDS * r->plan->slab_tiles);
}

static tc_status brick_fill(tc_context *context, const device_buffer *words, uint64_t brick, cl_ulong word) {
    const size_t brick_bytes = 8 * BRICK_WORDS;
    cl_int error = cl->EnqueueFillBuffer(context->queue, words->memory, &word, sizeof word, brick * brick_bytes,
                                         brick_bytes, 0, NULL, NULL);
    return error ? context_fail(context, "filling constant sign words", error) : TC_OK;
}

tc_status sign_words_reserve(tc_context *context, device_buffer *words, uint64_t zeros, uint64_t brick_count) {
    const uint64_t bricks = zeros + UNIFORM_BRICKS + brick_count;
    const bool had = words->memory && 8 * BRICK_WORDS * bricks <= words->bytes;
    tc_status status = buffer_reserve(context, words, 8 * BRICK_WORDS * bricks, "sign words");
    for (uint64_t sign = 0; sign < UNIFORM_BRICKS && !status && !had; sign++)
        status = brick_fill(context, words, sign, sign == SIGN_INSIDE ? UINT64_MAX : 0);
    for (uint64_t sign = 0; sign < UNIFORM_BRICKS && !status && zeros; sign++)
        status = brick_fill(context, words, zeros + sign, 0);
    return status;
}

typedef struct reservation {
    device_buffer *buffer;
    uint64_t bytes;
    const char *name;
} reservation;

static tc_status buffers_reserve(tc_context *context, const reservation *buffers, size_t count) {
    tc_status status = TC_OK;
    for (size_t n = 0; n < count && !status; n++)
        status = buffer_reserve(context, buffers[n].buffer, buffers[n].bytes, buffers[n].name);
    return status;
}

static tc_status word_buffers_reserve(run *r, word_buffers *w) {
    uint64_t bricks = plan_window_layers(r->plan) * plan_bricks_per_layer(r->plan), words = BRICK_WORDS * bricks;
    const reservation buffers[] = {{&w->offsets, 8 * words, "vertex offsets"},
                                   {&w->triangle_offsets, 2 * words, "triangle offsets"},
                                   {&w->bricks, sizeof(brick_state) * bricks, "bricks"},
                                   {&w->active, 4 * bricks, "active bricks"}};
    tc_status status = sign_words_reserve(r->context, &w->words, plan_zero_bricks(r->plan), bricks);
    return status ? status : buffers_reserve(r->context, buffers, sizeof buffers / sizeof *buffers);
}

/* Releases windows of another grid, which would exceed the budget together with those of this grid. */
static void windows_trim(run *r) {
    workspace *w = &r->context->work;
    uint32_t windows = plan_window_count(r->plan);
    for (uint32_t n = r->plan->samples_whole ? 0 : windows; n < 2; n++)
        for (int array = 0; array < ARRAY_COUNT; array++) buffer_release(r->context, &w->arrays[n][array]);
    if (windows == 2 && !r->plan->words_whole) return;
    device_buffer *words = (device_buffer *)&w->words[1];
    for (size_t n = 0; n < sizeof w->words[1] / sizeof *words; n++) buffer_release(r->context, &words[n]);
}

static tc_status workspace_reserve(run *r) {
    workspace *w = &r->context->work;
    const slab_plan *plan = r->plan;
    uint64_t cells = plan_cell_planes(plan, r->grid) * plan_words_per_plane(plan, r->grid);
    const reservation buffers[] = {{&w->cells, r->grid->device->missing ? 8 * cells : 0, "present cells"},
                                   {&w->state, state_bytes(r), "the scan"},
                                   {&w->scratch, 8ull * plan->scratch_words * r->context->launch.work_groups, "halos"}};
    uint32_t word_windows = plan->words_whole ? 1 : plan_window_count(plan);
    const bool known = r->context->workspace_grid == r->grid && r->context->workspace_plan == plan;
    if (!known && r->context->options.max_memory_bytes) {
        cl->Finish(r->context->queue);
        workspace_release(r->context); /* with buffers of another plan it could exceed the budget */
    }
    r->context->workspace_grid = r->grid;
    r->context->workspace_plan = plan;
    windows_trim(r);
    tc_status status = buffers_reserve(r->context, buffers, sizeof buffers / sizeof *buffers);
    for (uint32_t n = 0; n < word_windows && !status; n++) status = word_buffers_reserve(r, &w->words[n]);
    return status;
}

void structured_reshape(tc_grid *grid) {
    for (int n = 0; n < 4; n++) {
        slab_plan *plan = &grid->device->plans[n / 2][n % 2];
        if (plan->layer_count) slab_plan_reshape(grid->context, grid, plan);
    }
}

/* Takes the whole arrays from the device: all plans have windows of them from now on, and are made again. */
static tc_status arrays_withdraw(tc_grid *grid) {
    struct device_grid *device = grid->device;
    slab_plan plan;
    tc_status status = slab_plan_make(grid->context, grid, (plan_needs){0}, SAMPLES_IN_WINDOWS, &plan);
    if (status) return status;
    cl->Finish(grid->context->queue);
    for (int array = 0; array < ARRAY_COUNT; array++) buffer_release(grid->context, &device->arrays[array]);
    grid->context->workspace_grid = NULL; /* its buffers are those of the plan before */
    for (int n = 0; n < 4; n++) device->plans[n / 2][n % 2].layer_count = 0;
    device->plans[0][0] = plan;
    return TC_OK;
}

/* Where the words of snap, or the tables of closed surfaces, do not fit beside the whole arrays they may fit beside
 * windows of them. */
static tc_status plan_provide(tc_grid *grid, const tc_extract_options *options) {
    struct device_grid *device = grid->device;
    const bool whole = device->plans[0][0].samples_whole;
    const plan_needs needs = {method_has_zeros(options->method), options->closed};
    slab_plan plan;
    if (plan_of(device, options)->layer_count) return TC_OK;
    tc_status status = slab_plan_make(grid->context, grid, needs, whole ? SAMPLES_WHOLE : SAMPLES_IN_WINDOWS, &plan);
    if (status == TC_ERROR_MEMORY && whole && !grid->cl_samples) {
        status = slab_plan_make(grid->context, grid, needs, SAMPLES_IN_WINDOWS, &plan);
        if (!status) status = arrays_withdraw(grid);
    }
    if (!status) *plan_of(device, options) = plan;
    return status;
}

kernel_kind structured_kind(const tc_grid *grid, const tc_extract_options *options, bool emits) {
    const kernel_kind kind = {.grid = (unsigned)grid->kind,
                              .type = grid->type,
                              .method = options->method,
                              .missing = grid->device && grid->device->missing,
                              .made = channels_asked(options),
                              .emits = true,
                              .closed = options->closed};
    return emits ? kind : kind_of_classify(kind);
}

tc_status run_begin(run *r, tc_grid *grid, const tc_extract_options *options, inside_range inside, bool emits) {
    const slab_plan *plan = plan_of(grid->device, options);
    tc_status status = plan_provide(grid, options);
    *r = (run){.grid = grid,
               .context = grid->context,
               .plan = plan,
               .method = options->method,
               .closed = options->closed,
               .made = channels_asked(options),
               .base = slab_base(grid, plan, inside, options)};
    r->copies = r->context->queue;
    if (!status) status = kernels_get(r->context, structured_kind(grid, options, emits), &r->kernels);
    r->start_ms = clock_ms();
    if (!status) status = workspace_reserve(r);
    if (!status) status = slab_store_allocate(r);
    if (status) return status;
    r->heads = calloc(r->plan->slab_count, STATE_WORDS * sizeof *r->heads);
    return r->heads ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the totals of slabs");
}

void run_end(run *r, tc_status status) {
    workspace *w = &r->context->work;
    cl->Finish(r->context->queue);
    if (status) workspace_release(r->context); /* its state is undefined after a failure */
    if (r->context->in_place) {                /* windows in memory of the caller */
        mesh_buffers_release(r->context, &w->mesh[0]);
        for (int array = 0; array < ARRAY_COUNT; array++) buffer_release(r->context, &w->arrays[0][array]);
    }
    slab_store_release(&r->store);
    free(r->heads);
}

/* -------------------------------------------------------------------------------------------------- classification */

static slab_ref classify_ref(const run *r, uint32_t slab_index) {
    return (slab_ref){slab_index, slab_index % plan_window_count(r->plan)};
}

static tc_status classify_load(run *r, uint32_t slab_index) { return slab_load(r, classify_ref(r, slab_index), false); }

static tc_status classify_save(run *r, uint32_t slab_index) { return slab_save(r, classify_ref(r, slab_index)); }

static tc_status slab_classify(run *r, uint32_t slab_index) {
    slab_ref ref = classify_ref(r, slab_index);
    slab s;
    slab_describe(r, ref, &s);
    const bool snapped = r->plan->words_whole && slab_index > 0; /* with all of the grid */
    tc_status status = r->plan->needs.zeros && snapped ? TC_OK : slab_mark_cells(r, ref, &s);
    if (!status && r->plan->needs.zeros && !snapped) status = window_snap(r, ref, &s);
    if (status) return status;
    const classify_buffers b = slab_classify_buffers(r, ref);
    return classify_launch(r->grid, &r->kernels, &s, &b, slab_words(r, ref), r->plan->scratch_words);
}

void totals_add(run *r) {
    r->vertex_count = r->triangle_count = r->active_cell_count = 0;
    for (uint32_t n = 0; n < r->plan->own_slabs; n++) {
        const uint32_t *head = r->heads + n * STATE_WORDS;
        r->vertex_count += head[STATE_VERTICES];
        r->triangle_count += head[STATE_TRIANGLES];
        r->active_cell_count += head[STATE_ACTIVE_CELLS];
    }
}

/* The one point where the host waits before the mesh can be allocated. */
static tc_status totals_read(run *r) {
    uint32_t slabs = r->plan->slab_count;
    cl_int error = cl->EnqueueReadBuffer(r->context->queue, r->context->work.state.memory, CL_TRUE, 0,
                                         slabs * STATE_WORDS * sizeof *r->heads, r->heads, 0, NULL, NULL);
    if (error) return context_fail(r->context, "reading the totals of kernel classify", error);
    totals_add(r);
    for (uint32_t n = 0; n < slabs; n++)
        if (r->heads[n * STATE_WORDS + STATE_NONFINITE]) r->grid->device->missing = true;
    r->grid->device->ranges_known = true;
    return TC_OK;
}

static tc_status slabs_classify(run *r) {
    const cl_uint zero = 0;
    cl_int error = cl->EnqueueFillBuffer(r->context->queue, r->context->work.state.memory, &zero, sizeof zero, 0,
                                         state_bytes(r), 0, NULL, NULL);
    if (error) return context_fail(r->context, "clearing the scan", error);
    const step_stages stages = {"classify", 0, r->classify_share, classify_load, slab_classify, classify_save};
    tc_status status = steps_run(r, &stages, r->plan->slab_count, plan_window_count(r->plan) > 1);
    return status ? status : totals_read(r);
}

/* Where kernel 1 meets a NaN or infinity in a grid not known to miss samples, the grid is classified again, with
 * missing cells, and remembered as such. */
static tc_status classify(run *r, tc_grid *grid, const tc_extract_options *options, inside_range inside, bool emits,
                          double share) {
    grid->context->counted_grid = grid->context->classified_grid = NULL; /* the workspace is overwritten from here on */
    slab_store_release(&grid->device->store);
    tc_status status = run_begin(r, grid, options, inside, emits);
    if (status) return status;
    r->classify_share = share;
    bool missing = grid->device->missing;
    status = slabs_classify(r);
    if (status || grid->device->missing == missing) return status;
    double start = r->start_ms;
    run_end(r, status);
    status = run_begin(r, grid, options, inside, emits);
    r->classify_share = share;
    r->start_ms = start;
    return status ? status : slabs_classify(r);
}

/* ----------------------------------------------------------------------------------------------------------- seams */

/* States of the bricks in a layer of the grid, after classification, from the device or to it. */
static tc_status layer_move(run *r, uint32_t layer, brick_state *states, bool read) {
    const uint64_t bytes = plan_bricks_per_layer(r->plan) * sizeof *states, at = layer * bytes;
    const cl_mem memory = r->context->work.words[0].bricks.memory;
    if (!r->plan->words_whole) {
        memcpy(read ? (void *)states : r->store.bricks + at, read ? r->store.bricks + at : (void *)states, bytes);
        return TC_OK;
    }
    cl_command_queue queue = r->context->queue;
    const cl_int error = read ? cl->EnqueueReadBuffer(queue, memory, CL_TRUE, at, bytes, states, 0, NULL, NULL)
                              : cl->EnqueueWriteBuffer(queue, memory, CL_TRUE, at, bytes, states, 0, NULL, NULL);
    return error ? context_fail(r->context, "moving sums of a layer", error) : TC_OK;
}

static tc_status layer_states(run *r, uint32_t layer, brick_state **states) {
    *states = malloc(plan_bricks_per_layer(r->plan) * sizeof **states);
    return *states ? layer_move(r, layer, *states, true)
                   : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the sums of a layer");
}

/* Tells the seam of the grid's first layer, where it is asked for. */
static tc_status seam_tell(run *r) {
    uint32_t *seam = r->grid->seams.own;
    brick_state *states = NULL;
    tc_status status = seam ? layer_states(r, r->plan->own_first, &states) : TC_OK;
    for (uint64_t n = 0; n < plan_bricks_per_layer(r->plan) && seam && !status; n++) seam[n] = states[n].vertices;
    free(states);
    return status;
}

/* Gives the vertices of the layer behind the numbers of the next piece. This piece has only some planes of that layer:
 * enough for where vertices of its first plane lie in their bricks, not for how many lie before. */
static tc_status seam_take(run *r) {
    const uint32_t *seam = r->grid->seams.next;
    brick_state *states = NULL;
    tc_status status = seam ? layer_states(r, r->plan->own_end, &states) : TC_OK;
    for (uint64_t n = 0; n < plan_bricks_per_layer(r->plan) && seam && !status; n++) states[n].vertices = seam[n];
    if (seam && !status) status = layer_move(r, r->plan->own_end, states, false);
    free(states);
    return status;
}

/* ------------------------------------------------------------------------------------------------------ extraction */

/* Keeps results for tc_emit and tc_interpolate_field. r NULL: there is no surface. */
static void results_keep(tc_grid *grid, const tc_extract_options *options, run *r) {
    struct device_grid *device = grid->device;
    free(device->heads);
    device->heads = r ? r->heads : NULL;
    device->classified_options = *options;
    grid->context->classified_grid = grid;
    if (!r) return;
    r->heads = NULL;
    if (!device->carries) return;
    device->store = r->store;
    r->store = (slab_store){0};
}

tc_status structured_count(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts) {
    inside_range inside = inside_range_of(grid->type, options->isovalue);
    run r;
    if (!inside_has_surface(inside, options->closed)) {
        results_keep(grid, options, NULL);
        return TC_OK;
    }
    tc_status status = classify(&r, grid, options, inside, false, share);
    counts->vertex_count = r.vertex_count;
    counts->triangle_count = r.triangle_count;
    counts->active_cell_count = r.active_cell_count;
    counts->classify_ms = clock_ms() - r.start_ms;
    if (!status) status = seam_tell(&r);
    if (!status) results_keep(grid, options, &r);
    run_end(&r, status);
    return status;
}

tc_status structured_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    inside_range inside = inside_range_of(grid->type, options->isovalue);
    double classified;
    run r;
    if (!inside_has_surface(inside, options->closed)) return TC_OK;
    tc_status status = classify(&r, grid, options, inside, true, 0.5);
    classified = clock_ms();
    if (!status) status = seam_numbers_check(grid, r.vertex_count);
    if (!status) status = mesh_allocate(mesh, r.vertex_count, r.triangle_count, r.made);
    if (!status) status = seam_take(&r);
    if (!status && r.vertex_count) status = slabs_emit(&r, mesh);
    if (!status && !device_makes_vertices(r.context, grid->type)) status = reference_vertices(grid, options, mesh);
    mesh->active_cell_count = r.active_cell_count;
    mesh->slab_count = r.plan->own_slabs;
    mesh->timings.classify_ms = classified - r.start_ms;
    mesh->timings.total_ms = clock_ms() - r.start_ms - mesh->timings.readback_ms;
    mesh->timings.emit_ms = mesh->timings.total_ms - mesh->timings.classify_ms;
    if (!status) results_keep(grid, options, &r);
    run_end(&r, status);
    return status;
}
