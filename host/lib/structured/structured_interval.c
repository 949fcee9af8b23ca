/*
 * An interval volume on a device: classify by both bounds, count, sum up, allocate, emit.
 */
#include "structured/structured_interval.h"

#include "failure.h"
#include "tables/interval_cases.h"
#include "structured/structured.h"

#include <stdlib.h>
#include <string.h>

kernel_kind structured_interval_kind(const tc_grid *grid) {
    return (kernel_kind){.grid = (unsigned)grid->kind,
                         .type = grid->type,
                         .missing = grid->device && grid->device->missing,
                         .made = POSITIONS_ALONE,
                         .emits = true,
                         .interval = true};
}

/* --------------------------------------------------------------------------------------------------------- buffers */

static tc_status words_reserve(interval_run *r, word_buffers *w, uint64_t bricks) {
    const uint64_t words = BRICK_WORDS * bricks;
    tc_status status = sign_words_reserve(r->context, &w->words, 0, bricks);
    if (!status) status = buffer_reserve(r->context, &w->offsets, 8 * words, "vertex offsets");
    if (!status) status = buffer_reserve(r->context, &w->triangle_offsets, 2 * words, "triangle offsets");
    if (!status) status = buffer_reserve(r->context, &w->bricks, sizeof(brick_state) * bricks, "bricks");
    if (!status) status = buffer_reserve(r->context, &w->active, 4 * bricks, "active bricks");
    return status;
}

/* Bytes of the heads and tiles of one bound. */
static uint64_t state_bytes(const interval_run *r) {
    return 4ull * (STATE_WORDS + (uint64_t)TILE_WORDS * r->plan.tiles.slab_tiles);
}

static tc_status buffers_reserve(interval_run *r) {
    interval_buffers *b = r->buffers;
    const interval_plan *plan = &r->plan;
    const uint64_t bricks = interval_slab_window(plan, 0) * plan_bricks_per_layer(&plan->tiles);
    const uint64_t planes = interval_slab_window(plan, 0) * (uint64_t)BRICK_PLANES + 2;
    const uint64_t cells = r->missing ? 8 * planes * plan_words_per_plane(&plan->tiles, r->grid) : 0;
    tc_status status = TC_OK;
    for (int n = 0; n < BOUND_COUNT && !status; n++)
        if (r->exists[n]) status = words_reserve(r, &b->words[n], bricks);
    if (!status) status = buffer_reserve(r->context, &b->cells, cells, "present cells");
    if (!status) status = buffer_reserve(r->context, &b->state, BOUND_COUNT * state_bytes(r), "the scan");
    if (!status)
        status = buffer_reserve(r->context, &b->scratch,
                                8ull * plan->tiles.scratch_words * r->context->launch.work_groups, "halos");
    if (!status) status = buffer_reserve(r->context, &b->rows, 4ull * BRICK_WORDS * bricks, "sums of rows");
    if (!status) status = buffer_reserve(r->context, &b->bricks, sizeof(interval_brick) * bricks, "sums of bricks");
    if (!status) status = buffer_reserve(r->context, &b->ticket, 4, "a ticket");
    return status;
}

/* A vertex of a case, in a tetrahedron of a cube, as kernels name it. */
static uint8_t vertex_name(const ordered_tetrahedron *t, unsigned vertex) {
    if (vertex < INTERVAL_LOW) {
        const unsigned c = t->corners[vertex];
        return (uint8_t)INTERVAL_VERTEX(INTERVAL_SAMPLES, c >> 1, 0, c & 1);
    }
    const unsigned block = vertex < INTERVAL_HIGH ? INTERVAL_LOW_BOUND : INTERVAL_HIGH_BOUND;
    const uint8_t *ends = tetrahedron_edges[(vertex - INTERVAL_LOW) % 6];
    const owned_vertex e = edge_between(t->corners[ends[0]], t->corners[ends[1]]);
    return (uint8_t)INTERVAL_VERTEX(block, e.dy + 2u * e.dz, e.type, e.dx);
}

/* Which vertex of the entry it is; a new one is the next. */
static uint8_t vertex_enter(uint8_t *entry, uint8_t vertex) {
    uint8_t *vertices = entry + INTERVAL_ENTRY_VERTICES, n = 0;
    while (n < entry[1] && vertices[n] != vertex) n++;
    if (n == entry[1]) vertices[entry[1]++] = vertex;
    return n;
}

/* One tetrahedron of a cube: digits of patterns, then its entries. */
static void ordered_table(const interval_case cases[INTERVAL_CASES], ordered_tetrahedron t, bool mirrored,
                          uint8_t *digits, uint8_t *entries) {
    const bool is_odd = t.is_odd != mirrored;
    for (unsigned pattern = 0; pattern < 256; pattern++)
        for (unsigned n = 4; n-- > 0;) digits[pattern] = (uint8_t)(3 * digits[pattern] + (pattern >> t.corners[n] & 1));
    for (unsigned n = 0; n < INTERVAL_CASES; n++, entries += INTERVAL_ENTRY_BYTES) {
        entries[0] = cases[n].count;
        for (unsigned m = 0; m < 4u * cases[n].count; m++) {
            const unsigned corner = is_odd && m % 4 > 1 ? 5 - m % 4 : m % 4;
            entries[INTERVAL_ENTRY_CORNERS + m] = vertex_enter(entries, vertex_name(&t, cases[n].parts[m / 4][corner]));
        }
    }
}

static tc_status tables_provide(interval_run *r) {
    _Static_assert((int)INTERVAL_CASE_COUNT == (int)INTERVAL_CASES &&
                       INTERVAL_ENTRY_CORNERS + 4 * INTERVAL_PARTS_MOST <= INTERVAL_ENTRY_BYTES,
                   "kernels read them so");
    interval_case cases[INTERVAL_CASES];
    uint32_t counts[INTERVAL_COUNTS] = {0};
    uint8_t *table = calloc(1, INTERVAL_TABLE_BYTES);
    if (!table) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the cases of tetrahedra");
    interval_cases_derive(cases);
    for (unsigned n = 0; n < INTERVAL_TETRAHEDRA; n++)
        ordered_table(cases, tetrahedron_order(n / TETRAHEDRA_PER_CUBE, n % TETRAHEDRA_PER_CUBE), r->grid->mirrored,
                      table + 256 * n,
                      table + INTERVAL_DIGIT_BYTES + (size_t)INTERVAL_ENTRY_BYTES * INTERVAL_CASES * n);
    for (unsigned n = 0; n < INTERVAL_CASES; n++) {
        const unsigned where[4] = {n % 3, n / 3 % 3, n / 9 % 3, n / 27};
        unsigned not_below = 0, above = 0;
        for (unsigned c = 0; c < 4; c++) not_below += where[c] != SAMPLE_BELOW, above += where[c] == SAMPLE_ABOVE;
        counts[5 * not_below + above] = cases[n].count;
    }
    tc_status status =
        buffer_upload(r->context, &r->buffers->cases, table, INTERVAL_TABLE_BYTES, "the cases of tetrahedra");
    if (!status)
        status = buffer_upload(r->context, &r->buffers->counts, counts, sizeof counts, "numbers of tetrahedra");
    free(table);
    return status;
}

/* -------------------------------------------------------------------------------------------------- classification */

static cl_mem array_memory(const interval_run *r, int array) {
    return (r->plan.samples_whole ? r->grid->device->arrays : r->buffers->arrays)[array].memory;
}

/* The slab's window, and its samples on the device. */
static tc_status window_open(interval_run *r, uint32_t n) {
    const interval_plan *plan = &r->plan;
    const uint64_t nz = (uint64_t)r->grid->dims[2], bricks = plan_bricks_per_layer(&plan->tiles);
    const uint32_t z0 = interval_slab_first(plan, n) * BRICK_PLANES;
    uint64_t end = z0 + (uint64_t)interval_slab_window(plan, n) * BRICK_PLANES;
    slab *s = &r->window;
    *s = r->base[r->exists[BOUND_LOW] ? BOUND_LOW : BOUND_HIGH];
    s->z0 = s->results.word_z = z0;
    s->z1 = (uint32_t)(end < nz ? end : nz);
    s->results.range_offset = (uint32_t)(z0 / BRICK_PLANES * bricks);
    s->arrays.cell_z = z0 ? z0 - 1 : 0;
    s->arrays.sample_z = plan->samples_whole ? 0 : s->arrays.cell_z;
    s->results.tiles_offset = STATE_WORDS;
    s->tiling.tile_count = tile_count_of(s);
    end = s->z1 + 2ull < nz && !plan->samples_whole ? s->z1 + 2ull : nz;
    slab_arrays_locate(r->grid, end, s);
    r->job.own_bricks = (uint32_t)(interval_slab_own(plan, n) * bricks);
    r->job.all_bricks = (uint32_t)(interval_slab_window(plan, n) * bricks);
    tc_status status = TC_OK;
    for (int array = 0; array < ARRAY_COUNT && !plan->samples_whole && !status; array++)
        status = grid_array_provide(r->grid, (end - s->arrays.sample_z) * grid_array_plane_bytes(r->grid, array),
                                    r->context->queue, &r->buffers->arrays[array], array, s->arrays.sample_z, end);
    return status;
}

static classify_buffers window_buffers(const interval_run *r) {
    return (classify_buffers){.samples = array_memory(r, ARRAY_SAMPLES),
                              .blanked_samples = array_memory(r, ARRAY_BLANKED_SAMPLES),
                              .blanked_cells = array_memory(r, ARRAY_BLANKED_CELLS),
                              .cells = &r->buffers->cells,
                              .state = &r->buffers->state,
                              .scratch = &r->buffers->scratch};
}

static tc_status cells_mark(interval_run *r) {
    const slab *s = &r->window;
    const classify_buffers b = window_buffers(r);
    if (!r->missing) return TC_OK;
    return cells_launch(r->grid, &r->kernels, s, &b, (s->z1 < s->nz ? s->z1 + 1 : s->nz) - s->arrays.cell_z);
}

/* Kernel 1 by a bound. The pass for the high bound may take the ranges that the one for the low bound has stored, but
 * only where the window ends with the grid: else kernel 1 reads one layer more than it stores ranges of. */
static tc_status bound_classify(interval_run *r, int bound) {
    const classify_buffers b = window_buffers(r);
    const uint32_t offset = (uint32_t)((uint64_t)bound * (state_bytes(r) / 4));
    slab s = r->window;
    if (!r->exists[bound]) return TC_OK;
    s.test = r->base[bound].test;
    s.results.head_offset = offset;
    s.results.tiles_offset = offset + STATE_WORDS;
    s.results.ranges_known =
        r->grid->device->ranges_known || (bound == BOUND_HIGH && r->exists[BOUND_LOW] && s.z1 == s.nz);
    return classify_launch(r->grid, &r->kernels, &s, &b, &r->buffers->words[bound], r->plan.tiles.scratch_words);
}

const word_buffers *interval_words(const interval_run *r, int bound) {
    return &r->buffers->words[r->exists[bound] ? bound : !bound];
}

static tc_status window_count(interval_run *r) {
    interval_buffers *b = r->buffers;
    const word_buffers *low = interval_words(r, BOUND_LOW), *high = interval_words(r, BOUND_HIGH);
    const kernel_argument arguments[] = {ARGUMENT(r->window),           ARGUMENT(r->job),
                                         ARGUMENT(b->cells.memory),     ARGUMENT(low->words.memory),
                                         ARGUMENT(low->bricks.memory),  ARGUMENT(high->words.memory),
                                         ARGUMENT(high->bricks.memory), ARGUMENT(b->counts.memory),
                                         ARGUMENT(b->rows.memory),      ARGUMENT(b->bricks.memory)};
    return kernel_launch(r->context, r->kernels.interval_count, "kernel interval_count", arguments,
                         sizeof arguments / sizeof *arguments);
}

static tc_status results_read(interval_run *r, cl_uint heads[BOUND_COUNT][STATE_WORDS]) {
    cl_command_queue queue = r->context->queue;
    const size_t bricks = r->job.all_bricks;
    cl_int error = cl->EnqueueReadBuffer(queue, r->buffers->bricks.memory, CL_TRUE, 0, bricks * sizeof *r->bricks,
                                         r->bricks, 0, NULL, NULL);
    for (int n = 0; n < BOUND_COUNT && !error; n++) {
        if (!r->exists[n]) continue;
        error = cl->EnqueueReadBuffer(queue, r->buffers->words[n].bricks.memory, CL_TRUE, 0,
                                      bricks * sizeof *r->states[n], r->states[n], 0, NULL, NULL);
        if (!error)
            error = cl->EnqueueReadBuffer(queue, r->buffers->state.memory, CL_TRUE, (size_t)n * state_bytes(r),
                                          sizeof heads[n], heads[n], 0, NULL, NULL);
    }
    return error ? context_fail(r->context, "reading the sums of bricks", error) : TC_OK;
}

/* Makes of each brick's sums those before it, and the slab's size. */
static tc_status bricks_sum(interval_run *r, const cl_uint heads[BOUND_COUNT][STATE_WORDS]) {
    interval_brick sum = {0, 0};
    r->size = (interval_size){{0}, 0};
    for (uint32_t n = 0; n < r->job.all_bricks; n++) {
        const interval_brick own = r->bricks[n];
        if (n == r->job.own_bricks) r->size.vertices[BLOCK_SAMPLES] = sum.samples;
        r->bricks[n] = sum;
        sum.samples += own.samples, sum.tetrahedra += own.tetrahedra;
    }
    if (r->job.own_bricks == r->job.all_bricks) r->size.vertices[BLOCK_SAMPLES] = sum.samples;
    r->size.tetrahedra = sum.tetrahedra;
    for (int n = 0; n < BOUND_COUNT; n++)
        if (r->exists[n])
            r->size.vertices[BLOCK_LOW + n] = r->job.own_bricks < r->job.all_bricks
                                                  ? r->states[n][r->job.own_bricks].vertices
                                                  : heads[n][STATE_VERTICES];
    return buffer_upload(r->context, &r->buffers->bricks, r->bricks, r->job.all_bricks * sizeof *r->bricks,
                         "sums of bricks");
}

tc_status interval_classify(interval_run *r, uint32_t n) {
    const cl_uint zero = 0;
    cl_uint heads[BOUND_COUNT][STATE_WORDS] = {{0}};
    tc_status status = window_open(r, n);
    cl_int error = status ? CL_SUCCESS
                          : cl->EnqueueFillBuffer(r->context->queue, r->buffers->state.memory, &zero, sizeof zero, 0,
                                                  BOUND_COUNT * state_bytes(r), 0, NULL, NULL);
    if (error) status = context_fail(r->context, "clearing the scan", error);
    if (!status) status = cells_mark(r);
    for (int bound = 0; bound < BOUND_COUNT && !status; bound++) status = bound_classify(r, bound);
    if (!status) status = window_count(r);
    if (!status) status = results_read(r, heads);
    if (!status) status = bricks_sum(r, heads);
    for (int bound = 0; bound < BOUND_COUNT; bound++)
        if (heads[bound][STATE_NONFINITE]) r->grid->device->missing = true;
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ calls */

static tc_status host_reserve(interval_run *r) {
    const size_t bricks = interval_slab_window(&r->plan, 0) * (size_t)plan_bricks_per_layer(&r->plan.tiles);
    bool is_there = (r->bricks = malloc(bricks * sizeof *r->bricks)) != NULL;
    for (int n = 0; n < BOUND_COUNT; n++)
        is_there = (r->states[n] = malloc(bricks * sizeof *r->states[n])) != NULL && is_there;
    return is_there ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the sums of bricks");
}

static tc_status interval_begin(interval_run *r, tc_grid *grid, const tc_interval_volume_options *options,
                                const inside_range inside[BOUND_COUNT]) {
    tc_context *context = grid->context;
    tc_status status = TC_OK;
    cl->Finish(context->queue);
    if (context->options.max_memory_bytes) workspace_release(context); /* which would exceed the budget beside */
    status = interval_plan_make(context, grid, &r->plan);
    if (status) return status;
    for (int n = 0; n < BOUND_COUNT; n++) {
        tc_extract_options how = {.struct_size = sizeof how, .isovalue = n == BOUND_LOW ? options->low : options->high};
        r->base[n] = slab_base(grid, &r->plan.tiles, inside[n], &how);
    }
    r->missing = grid->device->missing;
    r->job.has_low = r->exists[BOUND_LOW], r->job.has_high = r->exists[BOUND_HIGH];
    r->job.high_isovalue64 = r->base[BOUND_HIGH].test.isovalue64;
    r->job.high_isovalue32 = r->base[BOUND_HIGH].test.isovalue32;
    status = kernels_get(context, structured_interval_kind(grid), &r->kernels);
    r->start_ms = clock_ms();
    if (!status) status = buffers_reserve(r);
    if (!status) status = tables_provide(r);
    return status ? status : host_reserve(r);
}

static void interval_end(interval_run *r, tc_status status) {
    interval_buffers *b = r->buffers;
    cl->Finish(r->context->queue);
    for (int n = 0; n < 4; n++) buffer_release(r->context, &b->parts[n]);
    for (int array = 0; array < ARRAY_COUNT; array++) buffer_release(r->context, &b->arrays[array]);
    if (status || r->context->options.max_memory_bytes || !r->context->in_place)
        for (size_t n = 0; n < sizeof *b / sizeof(device_buffer); n++)
            buffer_release(r->context, &((device_buffer *)b)[n]);
    free(r->bricks);
    for (int n = 0; n < BOUND_COUNT; n++) free(r->states[n]);
    r->bricks = NULL;
    r->states[BOUND_LOW] = r->states[BOUND_HIGH] = NULL;
}

static void size_add(interval_size *sum, const interval_size *one) {
    for (int n = 0; n < BLOCK_COUNT; n++) sum->vertices[n] += one->vertices[n];
    sum->tetrahedra += one->tetrahedra;
}

/* Sums over all slabs. */
static tc_status interval_slabs_count(interval_run *r, interval_size *size) {
    tc_status status = TC_OK;
    *size = (interval_size){{0}, 0};
    for (uint32_t n = 0; n < r->plan.slab_count && r->missing == r->grid->device->missing && !status; n++) {
        status = interval_classify(r, n);
        if (!status) size_add(size, &r->size);
        if (!status) status = context_progress(r->context, "classify", r->share * (n + 1.0) / r->plan.slab_count);
    }
    if (!status && r->missing == r->grid->device->missing) r->grid->device->ranges_known = true;
    return status;
}

/* As structured.c: where kernel 1 meets a NaN or infinity in a grid not known to miss samples, all is classified again,
 * with missing cells. Without any kernel 1 a type that has such values is taken to have them. */
static tc_status interval_run_count(interval_run *r, tc_grid *grid, const tc_interval_volume_options *options,
                                    double share, interval_size *size) {
    inside_range inside[BOUND_COUNT] = {{0}};
    *r = (interval_run){.grid = grid,
                        .context = grid->context,
                        .buffers = &grid->context->work.interval,
                        .share = share,
                        .start_ms = clock_ms()};
    *size = (interval_size){{0}, 0};
    if (!interval_bounds_find(grid->type, options, inside, r->exists)) return TC_OK;
    if (!r->exists[BOUND_LOW] && !r->exists[BOUND_HIGH] && type_is_real(grid->type)) grid->device->missing = true;
    tc_status status = interval_begin(r, grid, options, inside);
    if (!status) status = interval_slabs_count(r, size);
    if (status || grid->device->missing == r->missing) return status;
    interval_end(r, status);
    status = interval_begin(r, grid, options, inside);
    return status ? status : interval_slabs_count(r, size);
}

tc_status structured_interval_count(tc_grid *grid, const tc_interval_volume_options *options, interval_size *size,
                                    double *classify_ms) {
    interval_run r;
    tc_status status = interval_run_count(&r, grid, options, 1, size);
    *classify_ms = clock_ms() - r.start_ms;
    interval_end(&r, status);
    return status;
}

static tc_status interval_slabs_emit(interval_run *r, tc_interval_volume *interval) {
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < r->plan.slab_count && !status; n++) {
        if (r->plan.slab_count > 1) status = interval_classify(r, n);
        if (!status) status = interval_slab_emit(r, interval);
        size_add(&r->before, &r->size);
        if (!status) status = context_progress(r->context, "emit", 0.5 + 0.5 * (n + 1.0) / r->plan.slab_count);
    }
    if (!status) interval_blocks_join(r, interval);
    return status;
}

tc_status structured_interval_extract(tc_grid *grid, const tc_interval_volume_options *options,
                                      tc_interval_volume *interval) {
    interval_run r;
    interval_size size;
    tc_status status = interval_run_count(&r, grid, options, 0.5, &size);
    const double classified = clock_ms();
    if (!status) status = interval_allocate(interval, &size);
    if (!status && size.tetrahedra) status = interval_slabs_emit(&r, interval);
    interval->slab_count = r.plan.slab_count ? r.plan.slab_count : 1;
    interval->timings.classify_ms = classified - r.start_ms;
    interval->timings.total_ms = clock_ms() - r.start_ms - interval->timings.readback_ms;
    interval->timings.emit_ms = interval->timings.total_ms - interval->timings.classify_ms;
    interval_end(&r, status);
    return status;
}
