/*
 * An interval volume of a complex slab by slab. First all slabs are classified by both bounds, the vertices of each
 * joined as those of surfaces are (complex_slabs.c), and what lies between is counted. Then slabs that have any of it
 * are classified again and emitted, with numbers of their own: vertices at points have the points' numbers, crossings
 * follow. The host makes the vertices at points, takes the slab's new crossings, and gives the tetrahedra the numbers
 * of the volume.
 */
#include "tetrahedra/complex_interval.h"

#include "failure.h"
#include "tetrahedra/used_points.h"

#include <stdlib.h>
#include <string.h>

typedef struct slab_size {
    uint32_t vertices[BOUND_COUNT]; /* those of earlier slabs, too */
    uint32_t tetrahedra;
} slab_size;

typedef struct volume_slabs {
    volume_run v;
    tc_grid *grid;
    struct complex_slabs *slabs;
    local_points local;
    joined_edges joined[BOUND_COUNT];
    points_within within;
    slab_size *sizes;
    uint64_t tetrahedra; /* of all slabs */

    /* While they are emitted: */
    tc_interval_volume *interval;
    float *positions; /* of a slab's crossings */
    uint64_t vertices_done[BOUND_COUNT], numbers_done[BOUND_COUNT], tetrahedra_done;
    double readback_ms;
} volume_slabs;

/* -------------------------------------------------------------------------------------------------- classification */

/* Whether a slab may have any of the volume, by the ranges of its clusters. */
static bool slab_possible(const volume_slabs *t, uint32_t slab_index) {
    const volume_run *v = &t->v;
    const brick_range *ranges = t->slabs->ranges + slab_first_cluster(t->slabs, slab_index);
    for (uint32_t n = 0; n < slab_cluster_count(t->grid->complex, t->slabs, slab_index) && t->slabs->ranges_known;
         n++) {
        const bool below = v->exists[BOUND_LOW] && ranges[n].high < v->tests[BOUND_LOW].key_outside;
        const bool above = v->exists[BOUND_HIGH] && ranges[n].low >= v->tests[BOUND_HIGH].key_inside;
        if (!below && !above) return true;
    }
    return !t->slabs->ranges_known;
}

static tc_status slab_count(volume_slabs *t, uint32_t slab_index, bool ranges_known) {
    tc_status status = complex_slab_load(t->grid, t->slabs, &t->local, slab_index, ranges_known);
    if (!status) status = volume_count(&t->v);
    if (!status && !ranges_known && t->grid->complex->part.ranges_known)
        status = complex_slab_ranges_keep(t->grid, t->slabs, slab_index);
    return status ? status : volume_number(&t->v);
}

static slab_size size_of(const volume_run *v) {
    return (slab_size){{v->head[VOLUME_LOW], v->head[VOLUME_HIGH]}, v->head[VOLUME_TETRAHEDRA]};
}

static uint64_t crossing_count(slab_size size) {
    return (uint64_t)size.vertices[BOUND_LOW] + size.vertices[BOUND_HIGH];
}

static tc_status slab_classify(volume_slabs *t, uint32_t slab_index) {
    if (!slab_possible(t, slab_index)) return TC_OK;
    tc_status status = slab_count(t, slab_index, t->slabs->ranges_known);
    if (!status) t->sizes[slab_index] = size_of(&t->v);
    t->tetrahedra += t->sizes[slab_index].tetrahedra;
    if (status || !crossing_count(t->sizes[slab_index])) return status;
    return volume_slab_join(&t->v, t->local.numbers, t->joined);
}

/* before, after: where this stage begins and ends in the whole call, for progress. */
static tc_status slabs_classify(volume_slabs *t, double before, double after) {
    const uint32_t count = t->slabs->slab_count;
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < count && !status; n++) {
        status = slab_classify(t, n);
        if (!status) status = context_progress(t->v.context, "classify", before + (after - before) * (n + 1) / count);
    }
    if (!status) t->slabs->ranges_known = true;
    return status;
}

/* -------------------------------------------------------------------------------------------------------- emission */

/* All vertices at points. */
static void points_emit(volume_slabs *t) {
    float *out = t->interval->positions.memory;
    const uint64_t words = point_word_count(t->grid->complex);
    for (uint64_t n = 0; n < words; n++)
        for (uint64_t rest = t->within.words[n]; rest; rest &= rest - 1, out += 3)
            memcpy(out, t->grid->complex->points + 3 * (64 * n + (uint64_t)__builtin_ctzll(rest)), CHANNEL_BYTES);
}

static tc_status positions_allocate(volume_slabs *t) {
    uint64_t most = 0;
    for (uint32_t n = 0; n < t->slabs->slab_count; n++)
        if (crossing_count(t->sizes[n]) > most) most = crossing_count(t->sizes[n]);
    t->positions = malloc(CHANNEL_BYTES * (size_t)most + 1);
    return t->positions ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the vertices of a slab");
}

/* Reads what the slab has emitted, tetrahedra to where they belong. */
static tc_status slab_read(volume_slabs *t, slab_size size) {
    const volume_buffers *w = t->v.work;
    cl_command_queue queue = t->v.context->queue;
    uint32_t *tetrahedra = (uint32_t *)t->interval->tetrahedra.memory + 4 * t->tetrahedra_done;
    const size_t position_bytes = CHANNEL_BYTES * (size_t)crossing_count(size);
    cl_int error = position_bytes ? cl->EnqueueReadBuffer(queue, w->positions.memory, CL_TRUE, 0, position_bytes,
                                                          t->positions, 0, NULL, NULL)
                                  : CL_SUCCESS;
    if (!error)
        error = cl->EnqueueReadBuffer(queue, w->tetrahedra.memory, CL_TRUE, 0,
                                      TETRAHEDRON_BYTES * (size_t)size.tetrahedra, tetrahedra, 0, NULL, NULL);
    return error ? context_fail(t->v.context, "reading the interval volume back", error) : TC_OK;
}

/* The number in the volume of a vertex of the slab. */
static uint32_t vertex_number(const volume_slabs *t, uint32_t vertex) {
    const volume_job *job = &t->v.job;
    if (vertex < job->low_first) {
        const uint32_t point = t->local.numbers ? t->local.numbers[vertex] : vertex;
        const uint32_t number = point_within_number(&t->within, point);
        return number < t->within.count ? number : 0; /* that of a point that is within, if none has changed */
    }
    const int bound = vertex < job->high_first ? BOUND_LOW : BOUND_HIGH;
    const uint32_t crossing = vertex - (bound == BOUND_LOW ? job->low_first : job->high_first);
    return (uint32_t)interval_first(&t->interval->size, BLOCK_LOW + bound) +
           t->joined[bound].numbers[t->numbers_done[bound] + crossing];
}

/* Puts the slab's new crossings behind those before, and gives its tetrahedra the numbers of the volume. */
static void slab_append(volume_slabs *t, slab_size size) {
    uint32_t *tetrahedra = (uint32_t *)t->interval->tetrahedra.memory + 4 * t->tetrahedra_done;
    const float *from = t->positions;
    for (uint64_t n = 0; n < 4ull * size.tetrahedra; n++) tetrahedra[n] = vertex_number(t, tetrahedra[n]);
    for (int n = 0; n < BOUND_COUNT; n++) {
        float *out = (float *)t->interval->positions.memory + 3 * interval_first(&t->interval->size, BLOCK_LOW + n);
        t->vertices_done[n] = positions_append(t->joined[n].numbers + t->numbers_done[n], size.vertices[n], from, out,
                                               t->vertices_done[n]);
        t->numbers_done[n] += size.vertices[n];
        from += 3 * (size_t)size.vertices[n];
    }
    t->tetrahedra_done += size.tetrahedra;
}

static tc_status slab_launch(volume_slabs *t, slab_size size) {
    volume_run *v = &t->v;
    complex_run *r = &v->run;
    v->job.low_first = v->job.window = r->part->point_count;
    v->job.high_first = v->job.low_first + size.vertices[BOUND_LOW];
    tc_status status = surface_reserve(r, &v->work->positions, CHANNEL_BYTES * crossing_count(size), "vertices");
    if (!status)
        status = surface_reserve(r, &v->work->tetrahedra, TETRAHEDRON_BYTES * (uint64_t)size.tetrahedra, "tetrahedra");
    return status ? status : volume_emit(v);
}

static tc_status slab_emit(volume_slabs *t, uint32_t slab_index) {
    const slab_size size = t->sizes[slab_index];
    if (!size.tetrahedra) return TC_OK;
    tc_status status = slab_count(t, slab_index, t->slabs->ranges_known);
    const slab_size found = size_of(&t->v);
    if (!status && memcmp(&found, &size, sizeof size))
        status = (tc_status)fail(TC_ERROR_DATA, "the samples or tetrahedra have changed while they were extracted");
    if (!status) status = slab_launch(t, size);
    const double emitted = clock_ms();
    if (!status) status = slab_read(t, size);
    if (!status) slab_append(t, size);
    t->readback_ms += clock_ms() - emitted;
    return status;
}

static tc_status slabs_emit(volume_slabs *t, double before, const interval_size *size) {
    const uint32_t count = t->slabs->slab_count;
    tc_status status = interval_allocate(t->interval, size);
    for (int n = 0; n < BOUND_COUNT; n++) edge_numbers_release(&t->joined[n].edges);
    if (!status) status = positions_allocate(t);
    if (!status) points_emit(t);
    for (uint32_t n = 0; n < count && !status; n++) {
        status = slab_emit(t, n);
        if (!status) status = context_progress(t->v.context, "emit", before + (1 - before) * (n + 1) / count);
    }
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ calls */

static tc_status slabs_begin(volume_slabs *t, tc_grid *grid, const tc_interval_volume_options *options,
                             const bool exists[BOUND_COUNT]) {
    struct complex_slabs *slabs = grid->complex->interval_slabs;
    *t = (volume_slabs){.grid = grid, .slabs = slabs};
    tc_status status = volume_begin(&t->v, grid, options, exists, true);
    t->sizes = calloc(slabs->slab_count, sizeof *t->sizes);
    if (!status && !t->sizes) status = (tc_status)fail(TC_ERROR_MEMORY, "no memory for the totals of slabs");
    if (!status) status = points_within_find(grid, options, &t->within);
    return status ? status : complex_slabs_open(grid, slabs, &t->local);
}

/* Points do not stay on the device, as surfaces have slabs with other points. */
static void slabs_end(volume_slabs *t) {
    cl->Finish(t->grid->context->queue);
    complex_slabs_close(t->grid, t->slabs, &t->local);
    part_points_release(t->grid);
    for (int n = 0; n < BOUND_COUNT; n++) joined_edges_release(&t->joined[n]);
    points_within_release(&t->within);
    free(t->positions);
    free(t->sizes);
}

tc_status volume_slabs_make(tc_grid *grid, const tc_interval_volume_options *options, const bool exists[BOUND_COUNT],
                            double before, interval_size *size, double *classify_ms, tc_interval_volume *interval) {
    const double middle = interval ? (before + 1) / 2 : 1;
    volume_slabs t;
    tc_status status = slabs_begin(&t, grid, options, exists);
    t.interval = interval;
    if (!status) status = slabs_classify(&t, before, middle);
    *classify_ms = clock_ms() - t.v.start_ms;
    *size = (interval_size){{t.within.count, t.joined[BOUND_LOW].edges.count, t.joined[BOUND_HIGH].edges.count},
                            t.tetrahedra};
    if (!status && interval && size->tetrahedra) status = slabs_emit(&t, middle, size);
    if (interval) {
        interval->slab_count = t.slabs->slab_count;
        interval->timings.classify_ms = *classify_ms;
        interval->timings.readback_ms = t.readback_ms;
        interval->timings.total_ms = clock_ms() - t.v.start_ms - t.readback_ms;
        interval->timings.emit_ms = interval->timings.total_ms - *classify_ms;
    }
    slabs_end(&t);
    return status;
}
