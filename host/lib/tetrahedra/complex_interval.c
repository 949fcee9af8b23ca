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
    tc_status status = surface_table_provide(&v->bounds[BOUND_LOW], &v->work->cases, table, VOLUME_TABLE_BYTES);
    free(table);
    return status;
}

static tc_status bound_begin(volume_run *v, int bound) {
    complex_grid *c = v->grid->complex;
    workspace *work = &v->context->work;
    tc_extract_options surface;
    tc_extract_options_init(&surface);
    if (v->exists[bound]) surface.isovalue = bound == BOUND_LOW ? v->options->low : v->options->high;
    v->bounds[bound] = (complex_run){.grid = v->grid,
                                     .complex = c,
                                     .part = &c->part,
                                     .context = v->context,
                                     .work = bound == BOUND_LOW ? &work->complex : &work->complex_high,
                                     .interval = true,
                                     .is_cut = v->is_cut};
    return complex_run_open(&v->bounds[bound], &surface);
}

tc_status volume_begin(volume_run *v, tc_grid *grid, const tc_interval_volume_options *options,
                       const bool exists[BOUND_COUNT], bool is_cut) {
    *v = (volume_run){.grid = grid,
                      .context = grid->context,
                      .options = options,
                      .exists = {exists[BOUND_LOW], exists[BOUND_HIGH]},
                      .is_cut = is_cut,
                      .work = &grid->context->work.volume};
    tc_status status = TC_OK;
    for (int n = 0; n < BOUND_COUNT && !status; n++) status = bound_begin(v, n);
    v->start_ms = clock_ms();
    return status ? status : table_provide(v);
}

/* ------------------------------------------------------------------------------------------------------------ count */

tc_status volume_bound_classify(volume_run *v, int bound) {
    complex_run *r = &v->bounds[bound];
    r->job = complex_job_of(r, complex_cluster_count(r->part->tetrahedron_count));
    r->head[HEAD_VERTICES] = 0;
    if (!v->exists[bound]) return TC_OK;
    tc_status status = surface_classify(r);
    return !status && r->job.active_count ? surface_number(r) : status;
}

uint32_t volume_bound_vertices(const volume_run *v, int bound) { return v->bounds[bound].head[HEAD_VERTICES]; }

/* Sizes of the kernels' work; points of a slab keep their numbers. */
static void job_describe(volume_run *v) {
    const complex_job *low = &v->bounds[BOUND_LOW].job;
    const uint64_t words = v->is_cut ? 0 : point_word_count(v->grid->complex);
    const uint64_t items = words > low->cluster_count ? words : low->cluster_count;
    v->job = (volume_job){.has_low = v->exists[BOUND_LOW], .has_high = v->exists[BOUND_HIGH]};
    v->job.word_count = (uint32_t)words;
    while (UINT32_C(1) << v->job.tile_shift < low->tile_clusters) v->job.tile_shift++;
    v->job.tile_count = (uint32_t)((items + (UINT64_C(1) << v->job.tile_shift) - 1) >> v->job.tile_shift);
}

static uint64_t state_bytes(const volume_run *v) {
    return 4 * (VOLUME_HEAD_WORDS + (uint64_t)TILE_WORDS * v->job.tile_count);
}

/* A buffer of a surface; where there is no such surface another one, which nothing is read from. */
static const cl_mem *memory_of(const volume_run *v, const device_buffer *buffer) {
    return buffer->memory ? &buffer->memory : &v->work->state.memory;
}

static tc_status buffers_reserve(volume_run *v) {
    complex_run *r = &v->bounds[BOUND_LOW];
    volume_buffers *w = v->work;
    const complex_grid *c = v->grid->complex;
    tc_status status =
        surface_reserve(r, &w->clusters, sizeof(volume_cluster) * (uint64_t)r->job.cluster_count, "clusters");
    if (!status) status = surface_reserve(r, &w->points, sizeof(volume_points) * (uint64_t)v->job.word_count, "points");
    if (!status) status = surface_reserve(r, &w->state, state_bytes(v), "the scan");
    if (!status && !v->is_cut) status = surface_reserve(r, &w->used, 8 * (uint64_t)v->job.word_count, "points");
    if (status || v->is_cut) return status;
    return buffer_upload(v->context, &w->used, c->used_points, 8 * (uint64_t)v->job.word_count, "points");
}

static tc_status count_launch(volume_run *v) {
    volume_buffers *w = v->work;
    const complex_run *low = &v->bounds[BOUND_LOW], *high = &v->bounds[BOUND_HIGH];
    const complex_part *part = low->part;
    const kernel_argument arguments[] = {ARGUMENT(low->job),
                                         ARGUMENT(high->job),
                                         ARGUMENT(v->job),
                                         ARGUMENT(part->samples.memory),
                                         ARGUMENT(part->tetrahedra.memory),
                                         ARGUMENT(part->ranges.memory),
                                         ARGUMENT(*memory_of(v, &w->used)),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(*memory_of(v, &low->work->clusters)),
                                         ARGUMENT(*memory_of(v, &high->work->clusters)),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->points.memory),
                                         ARGUMENT(w->state.memory)};
    tc_status status = kernel_launch(v->context, low->kernels[KERNEL_VOLUME_COUNT], "kernel complex_interval_count",
                                     arguments, sizeof arguments / sizeof *arguments);
    cl_int error = status ? CL_SUCCESS
                          : cl->EnqueueReadBuffer(v->context->queue, w->state.memory, CL_TRUE, 0, sizeof v->head,
                                                  v->head, 0, NULL, NULL);
    return error ? context_fail(v->context, "reading totals", error) : status;
}

tc_status volume_count(volume_run *v) {
    for (int n = 0; n < BOUND_COUNT; n++) v->bounds[n].job.ranges_known = v->bounds[n].part->ranges_known;
    job_describe(v);
    tc_status status = buffers_reserve(v);
    if (!status) status = surface_fill(&v->bounds[BOUND_LOW], &v->work->state, 0, 0, state_bytes(v));
    if (!status) status = count_launch(v);
    const uint64_t vertices =
        (uint64_t)v->head[VOLUME_SAMPLES] + volume_bound_vertices(v, BOUND_LOW) + volume_bound_vertices(v, BOUND_HIGH);
    if (status || vertices || v->is_cut || !v->head[VOLUME_TETRAHEDRA]) return status;
    return (tc_status)fail(TC_ERROR_DATA, "the samples or tetrahedra have changed while they were extracted");
}

/* -------------------------------------------------------------------------------------------------------- emission */

static tc_status crossings_launch(volume_run *v, int bound) {
    const complex_run *r = &v->bounds[bound];
    const complex_buffers *w = r->work;
    const cl_uint first = bound == BOUND_LOW ? v->job.low_first : v->job.high_first;
    const cl_ulong offset = 3 * (cl_ulong)(first - v->job.window);
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(first),
                                         ARGUMENT(offset),
                                         ARGUMENT(r->part->samples.memory),
                                         ARGUMENT(r->part->points.memory),
                                         ARGUMENT(w->active.memory),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->tiles.memory),
                                         ARGUMENT(w->table.memory),
                                         ARGUMENT(w->entries.memory),
                                         ARGUMENT(v->work->positions.memory)};
    if (!v->exists[bound] || !r->job.active_count) return TC_OK;
    return kernel_launch(v->context, r->kernels[KERNEL_VOLUME_CROSSINGS], "kernel complex_interval_crossings",
                         arguments, sizeof arguments / sizeof *arguments);
}

tc_status volume_emit(volume_run *v) {
    const volume_buffers *w = v->work;
    const complex_run *low = &v->bounds[BOUND_LOW], *high = &v->bounds[BOUND_HIGH];
    const kernel_argument arguments[] = {ARGUMENT(low->job),
                                         ARGUMENT(high->job),
                                         ARGUMENT(v->job),
                                         ARGUMENT(low->part->tetrahedra.memory),
                                         ARGUMENT(low->part->points.memory),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->points.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(*memory_of(v, &low->work->clusters)),
                                         ARGUMENT(*memory_of(v, &low->work->state)),
                                         ARGUMENT(*memory_of(v, &low->work->entries)),
                                         ARGUMENT(*memory_of(v, &low->work->table)),
                                         ARGUMENT(*memory_of(v, &high->work->clusters)),
                                         ARGUMENT(*memory_of(v, &high->work->state)),
                                         ARGUMENT(*memory_of(v, &high->work->entries)),
                                         ARGUMENT(*memory_of(v, &high->work->table)),
                                         ARGUMENT(w->positions.memory),
                                         ARGUMENT(w->tetrahedra.memory)};
    tc_status status = TC_OK;
    for (int n = 0; n < BOUND_COUNT && !status; n++) status = crossings_launch(v, n);
    if (!status)
        status = kernel_launch(v->context, low->kernels[KERNEL_VOLUME_EMIT], "kernel complex_interval_emit", arguments,
                               sizeof arguments / sizeof *arguments);
    cl_int error = cl->Finish(v->context->queue);
    return !status && error ? context_fail(v->context, "kernel complex_interval_emit", error) : status;
}

/* Whether a buffer has room on the device; else the complex is cut. */
static tc_status room_check(volume_run *v, uint64_t bytes, const char *name) {
    if (surface_fits(&v->bounds[BOUND_LOW], bytes)) return TC_OK;
    return (tc_status)fail(TC_ERROR_MEMORY, "the grid of tetrahedra has no room for the %s of its interval volume",
                           name);
}

static tc_status volume_open(volume_run *v, const tc_interval_volume *interval, uint64_t bytes[2]) {
    volume_buffers *w = v->work;
    uint32_t offset; /* 0, as blocks begin with a page */
    bytes[0] = CHANNEL_BYTES * interval_first(&interval->size, BLOCK_COUNT);
    bytes[1] = TETRAHEDRON_BYTES * interval->size.tetrahedra;
    tc_status status = room_check(v, bytes[0], "vertices");
    if (!status)
        status = mesh_part_open(v->context, &w->positions, &interval->positions, 0, bytes[0], &offset, "vertices");
    if (!status) status = room_check(v, bytes[1], "tetrahedra");
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
    return (interval_size){
        {v->head[VOLUME_SAMPLES], volume_bound_vertices(v, BOUND_LOW), volume_bound_vertices(v, BOUND_HIGH)},
        v->head[VOLUME_TETRAHEDRA]};
}

/* share: of the whole call, for progress. */
static tc_status one_piece_count(volume_run *v, tc_grid *grid, const tc_interval_volume_options *options,
                                 const bool exists[BOUND_COUNT], double share) {
    tc_status status = volume_begin(v, grid, options, exists, false);
    for (int n = 0; n < BOUND_COUNT && !status; n++) {
        status = volume_bound_classify(v, n);
        if (!status) status = context_progress(v->context, "classify", share * (n + 1) / 3);
    }
    if (!status) status = volume_count(v);
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
    *too_large = v.bounds[BOUND_LOW].too_large || v.bounds[BOUND_HIGH].too_large;
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
