/*
 * An interval volume of a complex on a device: both surfaces classified and numbered, what lies between counted,
 * allocated, emitted. In one go where the device has room; else slab by slab, from then on always.
 */
#include "tetrahedra/complex_interval.h"

#include "failure.h"
#include "reference/carry_vertex.h"
#include "tetrahedra/used_points.h"

#include <stdlib.h>

/* ------------------------------------------------------------------------------------------------------------ begin */

static tc_status table_provide(volume_run *v) {
    if (v->work->cases.memory) return TC_OK;
    uint8_t *table = volume_table_make();
    if (!table) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the cases of tetrahedra");
    tc_status status = surface_table_provide(&v->run, &v->work->cases, table, VOLUME_TABLE_BYTES);
    free(table);
    return status;
}

/* The test of a bound; of one that there is not, any. */
static isovalue_test test_of(const volume_run *v, int bound) {
    const double value = bound == BOUND_LOW ? v->options->low : v->options->high;
    const double isovalue = v->exists[bound] ? value : 0;
    return isovalue_test_of(inside_range_of(v->grid->type, isovalue), isovalue);
}

tc_status volume_begin(volume_run *v, tc_grid *grid, const tc_interval_volume_options *options,
                       const bool exists[BOUND_COUNT], bool is_cut) {
    complex_grid *c = grid->complex;
    tc_context *context = grid->context;
    tc_extract_options surface;
    tc_extract_options_init(&surface);
    *v = (volume_run){.grid = grid,
                      .context = context,
                      .options = options,
                      .exists = {exists[BOUND_LOW], exists[BOUND_HIGH]},
                      .is_cut = is_cut,
                      .run = {.grid = grid,
                              .complex = c,
                              .part = &c->part,
                              .context = context,
                              .work = &context->work.complex,
                              .interval = true,
                              .is_cut = is_cut},
                      .work = &context->work.volume};
    tc_status status = complex_run_open(&v->run, &surface);
    for (int n = 0; n < BOUND_COUNT; n++) v->tests[n] = test_of(v, n);
    v->start_ms = v->run.start_ms;
    return status ? status : table_provide(v);
}

/* ------------------------------------------------------------------------------------------------------------ count */

/* Sizes of the kernels' work; points of a slab keep their numbers. */
static void jobs_describe(volume_run *v) {
    const uint64_t words = v->is_cut ? 0 : point_word_count(v->grid->complex);
    const uint32_t clusters = complex_cluster_count(v->run.part->tetrahedron_count);
    const uint64_t items = words > clusters ? words : clusters;
    v->job = (volume_job){.has_low = v->exists[BOUND_LOW], .has_high = v->exists[BOUND_HIGH]};
    for (int n = 0; n < BOUND_COUNT; n++) {
        v->jobs[n] = complex_job_of(&v->run, clusters);
        v->jobs[n].test = v->tests[n];
    }
    v->job.word_count = (uint32_t)words;
    v->job.tile_shift = complex_interval_tile_shift(v->grid);
    v->job.tile_count = (uint32_t)((items + (UINT64_C(1) << v->job.tile_shift) - 1) >> v->job.tile_shift);
}

static uint64_t state_bytes(const volume_run *v) {
    return 4 * (VOLUME_HEAD_WORDS + (uint64_t)VOLUME_SCANS * TILE_WORDS * v->job.tile_count);
}

/* A buffer; where there is none another one, which nothing is read from. */
static const cl_mem *memory_of(const volume_run *v, const device_buffer *buffer) {
    return buffer->memory ? &buffer->memory : &v->work->state.memory;
}

static tc_status count_reserve(volume_run *v) {
    complex_run *r = &v->run;
    volume_buffers *w = v->work;
    const complex_grid *c = v->grid->complex;
    const uint64_t words = v->job.word_count;
    tc_status status =
        surface_reserve(r, &w->clusters, sizeof(volume_cluster) * (uint64_t)v->jobs[0].cluster_count, "clusters");
    if (!status) status = surface_reserve(r, &w->state, state_bytes(v), "the scan");
    if (!status) status = surface_fill(r, &w->state, 0, 0, state_bytes(v));
    if (status || v->is_cut) return status;
    status = surface_reserve(r, &w->points, sizeof(volume_points) * words, "points");
    if (!status) status = surface_reserve(r, &w->numbers, 4 * 64 * words, "points");
    if (!status) status = surface_reserve(r, &w->used, 8 * words, "points");
    return status ? status : buffer_upload(v->context, &w->used, c->used_points, 8 * words, "points");
}

static tc_status volume_launch(volume_run *v, int kernel, const kernel_argument *arguments, cl_uint count) {
    static const char *const names[VOLUME_KERNELS] = {
        "kernel complex_interval_count",  "kernel complex_interval_list",      "kernel complex_interval_join",
        "kernel complex_interval_number", "kernel complex_interval_crossings", "kernel complex_interval_emit"};
    return kernel_launch(v->context, v->run.kernels[kernel], names[kernel], arguments, count);
}

static tc_status head_read(volume_run *v) {
    cl_int error = cl->EnqueueReadBuffer(v->context->queue, v->work->state.memory, CL_TRUE, 0, sizeof v->head, v->head,
                                         0, NULL, NULL);
    return error ? context_fail(v->context, "reading totals", error) : TC_OK;
}

static tc_status count_launch(volume_run *v) {
    volume_buffers *w = v->work;
    const complex_part *part = v->run.part;
    const kernel_argument arguments[] = {
        ARGUMENT(v->jobs[BOUND_LOW]),        ARGUMENT(v->jobs[BOUND_HIGH]),     ARGUMENT(v->job),
        ARGUMENT(part->samples.memory),      ARGUMENT(part->tetrahedra.memory), ARGUMENT(part->ranges.memory),
        ARGUMENT(*memory_of(v, &w->used)),   ARGUMENT(w->cases.memory),         ARGUMENT(w->clusters.memory),
        ARGUMENT(*memory_of(v, &w->points)), ARGUMENT(w->state.memory)};
    tc_status status = volume_launch(v, KERNEL_VOLUME_COUNT, arguments, sizeof arguments / sizeof *arguments);
    if (!status) status = head_read(v);
    if (!status && v->head[VOLUME_INVALID]) status = complex_point_fail(v->grid->complex);
    if (!status) v->run.part->ranges_known = true;
    return status;
}

tc_status volume_count(volume_run *v) {
    jobs_describe(v);
    tc_status status = count_reserve(v);
    return status ? status : count_launch(v);
}

/* ------------------------------------------------------------------------------------------------------------ edges */

/* Crossed edges of both bounds, counted once for each tetrahedron. */
static uint64_t crossed_count(const volume_run *v) { return 3ull * v->head[VOLUME_CUTS] + v->head[VOLUME_FOURS]; }

static tc_status table_reserve(volume_run *v, uint64_t entries) {
    v->job.table_mask = (uint32_t)(entries - 1);
    v->job.probe_limit = entries >= 2 * crossed_count(v) ? v->job.table_mask : 256;
    return surface_reserve(&v->run, &v->work->table, 4 * entries, "the table of edges");
}

static tc_status edges_reserve(volume_run *v) {
    complex_run *r = &v->run;
    volume_buffers *w = v->work;
    const uint64_t slots = 4ull * v->head[VOLUME_CUTS];
    tc_status status = surface_reserve(r, &w->edges, VOLUME_EDGE_BYTES * slots, "crossed edges");
    if (!status) status = surface_reserve(r, &w->entries, 4 * slots, "crossed edges");
    if (status || v->context->launch.work_items > 1) return status;
    return surface_reserve(r, &w->slots, VOLUME_SLOT_BYTES * slots, "crossed edges");
}

static tc_status edges_list(volume_run *v) {
    volume_buffers *w = v->work;
    const kernel_argument arguments[] = {ARGUMENT(v->jobs[BOUND_LOW]),
                                         ARGUMENT(v->job),
                                         ARGUMENT(v->run.part->tetrahedra.memory),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->edges.memory),
                                         ARGUMENT(*memory_of(v, &w->slots)),
                                         ARGUMENT(w->table.memory),
                                         ARGUMENT(w->state.memory)};
    return volume_launch(v, KERNEL_VOLUME_LIST, arguments, sizeof arguments / sizeof *arguments);
}

/* Enters the edges of the list into the table, and numbers their vertices. */
static tc_status edges_join(volume_run *v) {
    volume_buffers *w = v->work;
    const kernel_argument join[] = {ARGUMENT(v->job), ARGUMENT(w->edges.memory), ARGUMENT(w->table.memory),
                                    ARGUMENT(w->entries.memory), ARGUMENT(w->state.memory)};
    const kernel_argument number[] = {ARGUMENT(v->jobs[0].spin_limit), ARGUMENT(v->job),
                                      ARGUMENT(w->edges.memory),       ARGUMENT(w->table.memory),
                                      ARGUMENT(w->entries.memory),     ARGUMENT(w->state.memory)};
    tc_status status = volume_launch(v, KERNEL_VOLUME_JOIN, join, sizeof join / sizeof *join);
    if (!status) status = volume_launch(v, KERNEL_VOLUME_NUMBER, number, sizeof number / sizeof *number);
    return status ? status : head_read(v);
}

/* Enlarges the table, and resets what the attempt with the smaller table has changed. */
static tc_status table_enlarge(volume_run *v, uint64_t entries) {
    const volume_buffers *w = v->work;
    tc_status status = table_reserve(v, entries);
    if (!status) status = surface_fill(&v->run, &w->table, EDGE_NONE, 0, 4 * entries);
    if (!status) status = surface_fill(&v->run, &w->state, 0, 4 * (VOLUME_TICKETS + KERNEL_VOLUME_JOIN), 8);
    return status ? status : surface_fill(&v->run, &w->state, 0, 4 * VOLUME_FULL, 4);
}

/* In most complexes an edge has five tetrahedra: a table three eighths as large as the crossed edges, each counted for
 * every tetrahedron, is then little more than half full. Where that overflows, a table that always suffices is used. */
tc_status volume_number(volume_run *v) {
    uint64_t entries = 64;
    while (8 * entries < 3 * crossed_count(v)) entries *= 2;
    if (!v->head[VOLUME_CUTS]) return TC_OK;
    tc_status status = edges_reserve(v);
    if (!status) status = table_reserve(v, entries);
    if (!status) status = edges_list(v);
    if (!status) status = edges_join(v);
    if (status || !v->head[VOLUME_FULL]) return status;
    while (entries < 2 * crossed_count(v)) entries *= 2;
    status = table_enlarge(v, entries);
    return status ? status : edges_join(v);
}

/* -------------------------------------------------------------------------------------------------------- emission */

static tc_status vertices_launch(volume_run *v) {
    const volume_buffers *w = v->work;
    const complex_part *part = v->run.part;
    const kernel_argument arguments[] = {
        ARGUMENT(v->jobs[BOUND_LOW]),       ARGUMENT(v->jobs[BOUND_HIGH]),         ARGUMENT(v->job),
        ARGUMENT(part->samples.memory),     ARGUMENT(part->points.memory),         ARGUMENT(*memory_of(v, &w->points)),
        ARGUMENT(*memory_of(v, &w->edges)), ARGUMENT(*memory_of(v, &w->entries)),  ARGUMENT(*memory_of(v, &w->numbers)),
        ARGUMENT(w->state.memory),          ARGUMENT(*memory_of(v, &w->positions))};
    return volume_launch(v, KERNEL_VOLUME_CROSSINGS, arguments, sizeof arguments / sizeof *arguments);
}

tc_status volume_emit(volume_run *v) {
    const volume_buffers *w = v->work;
    const kernel_argument arguments[] = {ARGUMENT(v->jobs[BOUND_LOW]),
                                         ARGUMENT(v->job),
                                         ARGUMENT(v->run.part->tetrahedra.memory),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(*memory_of(v, &w->numbers)),
                                         ARGUMENT(*memory_of(v, &w->slots)),
                                         ARGUMENT(*memory_of(v, &w->entries)),
                                         ARGUMENT(*memory_of(v, &w->edges)),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->tetrahedra.memory)};
    tc_status status = vertices_launch(v);
    if (!status) status = volume_launch(v, KERNEL_VOLUME_EMIT, arguments, sizeof arguments / sizeof *arguments);
    cl_int error = cl->Finish(v->context->queue);
    return !status && error ? context_fail(v->context, "kernel complex_interval_emit", error) : status;
}

/* Whether a buffer has room on the device; else the complex is cut. */
static tc_status size_check(volume_run *v, uint64_t bytes, const char *name) {
    if (surface_fits(&v->run, bytes)) return TC_OK;
    return (tc_status)fail(TC_ERROR_MEMORY, "the grid of tetrahedra has no room for the %s of its interval volume",
                           name);
}

static tc_status volume_open(volume_run *v, const tc_interval_volume *interval, uint64_t bytes[2]) {
    volume_buffers *w = v->work;
    uint32_t offset; /* 0, as blocks begin with a page */
    bytes[0] = CHANNEL_BYTES * interval_first(&interval->size, BLOCK_COUNT);
    bytes[1] = TETRAHEDRON_BYTES * interval->size.tetrahedra;
    tc_status status = size_check(v, bytes[0], "vertices");
    if (!status)
        status = mesh_part_open(v->context, &w->positions, &interval->positions, 0, bytes[0], &offset, "vertices");
    if (!status) status = size_check(v, bytes[1], "tetrahedra");
    return status
               ? status
               : mesh_part_open(v->context, &w->tetrahedra, &interval->tetrahedra, 0, bytes[1], &offset, "tetrahedra");
}

static tc_status one_piece_emit(volume_run *v, tc_interval_volume *interval) {
    uint64_t bytes[2];
    volume_buffers *w = v->work;
    v->job.point_last = v->head[VOLUME_SAMPLES] ? v->head[VOLUME_SAMPLES] - 1 : 0;
    v->job.low_first = (uint32_t)interval_first(&interval->size, BLOCK_LOW);
    v->job.high_first = (uint32_t)interval_first(&interval->size, BLOCK_HIGH);
    tc_status status = volume_open(v, interval, bytes);
    if (!status) status = volume_emit(v);
    const double emitted = clock_ms();
    if (!status) status = mesh_part_close(v->context, &w->positions, &interval->positions, 0, bytes[0]);
    if (!status) status = mesh_part_close(v->context, &w->tetrahedra, &interval->tetrahedra, 0, bytes[1]);
    if (!v->context->in_place) interval->timings.readback_ms = clock_ms() - emitted;
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ calls */

static interval_size size_of(const volume_run *v) {
    return (interval_size){{v->head[VOLUME_SAMPLES], v->head[VOLUME_LOW], v->head[VOLUME_HIGH]},
                           v->head[VOLUME_TETRAHEDRA]};
}

/* share: of the whole call, for progress. */
static tc_status one_piece_count(volume_run *v, tc_grid *grid, const tc_interval_volume_options *options,
                                 const bool exists[BOUND_COUNT], double share) {
    tc_status status = volume_begin(v, grid, options, exists, false);
    if (!status) status = volume_count(v);
    if (!status) status = context_progress(v->context, "classify", 0.4 * share);
    if (!status) status = volume_number(v);
    const interval_size size = size_of(v);
    if (!status && size.tetrahedra && !interval_first(&size, BLOCK_COUNT))
        status = (tc_status)fail(TC_ERROR_DATA, "the samples or tetrahedra have changed while they were extracted");
    return status ? status : context_progress(v->context, "classify", share);
}

/* In one piece; *too_large: it does not fit the device. interval NULL: counts. */
static tc_status one_piece_make(tc_grid *grid, const tc_interval_volume_options *options,
                                const bool exists[BOUND_COUNT], interval_size *size, double *classify_ms,
                                tc_interval_volume *interval, bool *too_large) {
    volume_run v;
    tc_status status = one_piece_count(&v, grid, options, exists, interval ? 0.5 : 1);
    if (!status) *size = size_of(&v);
    *classify_ms = clock_ms() - v.start_ms;
    if (!status && interval) status = interval_allocate(interval, size);
    if (!status && interval && size->tetrahedra) status = one_piece_emit(&v, interval);
    if (!status && interval) status = context_progress(v.context, "emit", 1);
    if (interval) {
        interval->timings.classify_ms = *classify_ms;
        interval->timings.total_ms = clock_ms() - v.start_ms - interval->timings.readback_ms;
        interval->timings.emit_ms = interval->timings.total_ms - *classify_ms;
    }
    *too_large = v.run.too_large;
    return status;
}

/* Ends a call, or the attempt to do without slabs. What of the workspace surfaces do not use goes where memory is
 * bounded; after a failure all of it. */
static void device_end(tc_context *context, tc_status status) {
    cl->Finish(context->queue);
    buffer_release(context, &context->work.volume.positions);
    buffer_release(context, &context->work.volume.tetrahedra);
    if (status || context->options.max_memory_bytes) workspace_release(context);
}

static tc_status slabs_provide(tc_grid *grid) {
    tc_status status = grid->complex->interval_slabs ? TC_OK : complex_interval_cut(grid);
    if (status) return status;
    part_tetrahedra_release(grid);
    part_points_release(grid);
    return TC_OK;
}

static tc_status volume_make(tc_grid *grid, const tc_interval_volume_options *options, interval_size *size,
                             double *classify_ms, tc_interval_volume *interval) {
    complex_grid *c = grid->complex;
    inside_range inside[BOUND_COUNT];
    bool exists[BOUND_COUNT], too_large = c->slabs || c->interval_slabs || !complex_interval_sums_fit(grid);
    const double before = too_large ? 0 : 0.7; /* of the call, where it goes slab by slab */
    tc_status status = used_points_provide(grid);
    *size = (interval_size){{0}, 0};
    *classify_ms = 0;
    if (status || !interval_bounds_find(grid->type, options, inside, exists)) return status;
    device_end(grid->context, TC_OK);
    if (!too_large) {
        status = one_piece_make(grid, options, exists, size, classify_ms, interval, &too_large);
        device_end(grid->context, status);
        if (!too_large) return status;
    }
    status = slabs_provide(grid);
    if (!status) status = volume_slabs_make(grid, options, exists, before, size, classify_ms, interval);
    device_end(grid->context, status);
    return status;
}

tc_status complex_interval_count(tc_grid *grid, const tc_interval_volume_options *options, interval_size *size,
                                 double *classify_ms) {
    return volume_make(grid, options, size, classify_ms, NULL);
}

tc_status complex_interval_extract(tc_grid *grid, const tc_interval_volume_options *options,
                                   tc_interval_volume *interval) {
    interval_size size;
    double classify_ms;
    return volume_make(grid, options, &size, &classify_ms, interval);
}

tc_status complex_interval_carry(tc_grid *grid, const tc_interval_volume_options *options, const carry *c,
                                 uint64_t *count) {
    points_within within;
    tc_status status = points_within_find(grid, options, &within);
    const uint64_t words = point_word_count(grid->complex);
    uint64_t vertex = 0;
    for (uint64_t n = 0; n < words && !status; n++)
        for (uint64_t rest = within.words[n]; rest; rest &= rest - 1) {
            const int64_t point = (int64_t)(64 * n) + __builtin_ctzll(rest);
            carry_vertex(c, vertex++, point, point, 0);
        }
    *count = within.count;
    points_within_release(&within);
    return status ? status : context_progress(grid->context, "carry", 1);
}
