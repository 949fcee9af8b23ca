/*
 * Method hybrid slab by slab. Kernel 1 finds the active cells of one slab after the other, which is what reads all
 * cells and samples. What follows is proportional to the surface and is done on the host, over the active cells of all
 * slabs: a face may be cut because of a cell in another slab, and vertices are numbered only when that is known.
 *
 * A slab is a run of clusters. Its samples are those of its own points, numbered in the order of the grid's.
 */
#include "tetrahedra/complex_caps.h"
#include "tetrahedra/whole_run.h"

#include "failure.h"
#include "grid/carry.h"
#include "parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { SHARE_EDGES = 1 << 14 };

typedef struct slabs_run {
    complex_run r;
    struct whole_cells *w;
    uint32_t slab_clusters;
    local_points local;
    active_cell *cells; /* of all slabs */
    uint64_t cell_count, cell_capacity, triangle_count;
    edge_numbers edges;
    cap_sizes caps; /* of the border */
} slabs_run;

/* --------------------------------------------------------------------------------------------------------- memory */

/* Device memory of a slab, every cell of it active. */
static uint64_t slab_bytes(const tc_grid *grid, uint64_t clusters) {
    const struct whole_cells *w = grid->complex->whole;
    const uint64_t page = grid->context->in_place ? PAGE_BYTES : 0, cells = CLUSTER_CELLS * clusters;
    uint64_t points = cells * w->cell_points;
    if (points > grid->complex->point_count) points = grid->complex->point_count;
    const uint64_t of_cells = 4 * (uint64_t)w->cell_points + 1 + sizeof(active_cell);
    const uint64_t of_clusters = sizeof(brick_range) + sizeof(cluster_state) + 4;
    const uint64_t tiles = clusters / complex_tile_clusters(grid) + 1;
    return of_cells * cells + of_clusters * clusters + tc_type_bytes(grid->type) * points + 3 * page +
           sizeof w->shapes + 4 * (HEAD_WORDS + TILE_WORDS * tiles);
}

/* No buffer is larger than a slab. */
static bool slab_fits(const tc_grid *grid, uint64_t clusters) {
    const uint64_t bytes = slab_bytes(grid, clusters);
    return bytes <= context_budget(grid->context) && bytes <= grid->context->info.max_buffer_bytes &&
           clusters <= UINT32_MAX >> 8;
}

static uint32_t clusters_fit(const tc_grid *grid) {
    uint32_t low = 0, high = whole_cluster_count(grid->complex->whole->cell_count);
    while (low < high) {
        const uint32_t middle = high - (high - low) / 2;
        if (slab_fits(grid, middle))
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

tc_status whole_cut_into_slabs(tc_grid *grid) {
    struct whole_cells *w = grid->complex->whole;
    tc_status status = whole_cells_gather(grid);
    if (status) return status;
    whole_part_release(grid);
    const uint64_t least = slab_bytes(grid, 1), clusters = whole_cluster_count(w->cell_count);
    if (!clusters_fit(grid))
        return (tc_status)fail(TC_ERROR_MEMORY,
                               "the smallest slab of these cells needs %llu bytes of device memory, and the budget is "
                               "%llu: allow %llu or, to be faster, much more",
                               (unsigned long long)least, (unsigned long long)context_budget(grid->context),
                               (unsigned long long)least);
    if (!w->ranges) w->ranges = malloc(sizeof *w->ranges * (size_t)clusters + 1);
    if (!w->ranges) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the ranges of clusters");
    w->is_cut = true;
    w->ranges_known = false;
    return TC_OK;
}

/* ---------------------------------------------------------------------------------------------------------- slabs */

static tc_status slabs_begin(slabs_run *t, tc_grid *grid, const tc_extract_options *options) {
    *t = (slabs_run){.w = grid->complex->whole};
    tc_status status = whole_run_begin(&t->r, grid, options);
    t->slab_clusters = clusters_fit(grid);
    if (status) return status;
    /* four points for each of so many tetrahedra: those of the cells of a slab */
    const uint64_t points = (uint64_t)t->slab_clusters * CLUSTER_CELLS * t->w->cell_points;
    return local_points_allocate(grid, (uint32_t)(points / 4), &t->local);
}

static void slabs_end(slabs_run *t) {
    cl->Finish(t->r.context->queue);
    whole_part_release(t->r.grid);
    local_points_release(&t->local);
    edge_numbers_release(&t->edges);
    free(t->cells);
}

static uint32_t slab_count(const slabs_run *t) {
    return (whole_cluster_count(t->w->cell_count) + t->slab_clusters - 1) / t->slab_clusters;
}

/* Copies the slab's ranges from the host, or to it. */
static tc_status ranges_move(slabs_run *t, uint32_t first, uint32_t count, bool save) {
    cl_command_queue queue = t->r.context->queue;
    cl_mem memory = t->r.part->ranges.memory;
    brick_range *ranges = t->w->ranges + first / CLUSTER_CELLS;
    const size_t bytes = sizeof *ranges * whole_cluster_count(count);
    cl_int error = save ? cl->EnqueueReadBuffer(queue, memory, CL_TRUE, 0, bytes, ranges, 0, NULL, NULL)
                        : cl->EnqueueWriteBuffer(queue, memory, CL_TRUE, 0, bytes, ranges, 0, NULL, NULL);
    return error ? context_fail(t->r.context, "copying ranges of clusters", error) : TC_OK;
}

/* The slab's cells, with points of their own, and these points' samples. */
static tc_status slab_load(slabs_run *t, uint32_t first, uint32_t count) {
    tc_grid *grid = t->r.grid;
    complex_part *part = t->r.part;
    const uint32_t *words = t->w->own_words + (uint64_t)t->w->cell_points * first;
    const size_t sample_bytes = tc_type_bytes(grid->type);
    cl->Finish(t->r.context->queue);
    whole_part_release(grid); /* buffers in place use the memory in which the next slab is gathered */
    tc_status status = local_points_gather(grid, words, (uint32_t)((uint64_t)t->w->cell_points * count / 4), &t->local,
                                           &part->point_count);
    if (!status) status = whole_part_provide(grid, t->local.tetrahedra, first, count);
    if (!status)
        status =
            buffer_provide(grid->context, &part->samples, t->local.samples, sample_bytes * (uint64_t)part->point_count,
                           sample_bytes, &part->sample_offset, "samples");
    if (!status && t->w->ranges_known) status = ranges_move(t, first, count, false);
    part->ranges_known = t->w->ranges_known;
    return status;
}

/* Whether the slab may have a surface, by the ranges of its clusters. */
static bool slab_possible(const slabs_run *t, uint32_t first, uint32_t count) {
    const isovalue_test *test = &t->r.test;
    const brick_range *ranges = t->w->ranges + first / CLUSTER_CELLS;
    for (uint32_t n = 0; n < whole_cluster_count(count) && t->w->ranges_known; n++)
        if (ranges[n].low < test->key_inside && ranges[n].high >= test->key_outside) return true;
    return !t->w->ranges_known;
}

static tc_status cells_append(slabs_run *t) {
    const uint32_t count = t->r.job.active_count;
    const uint64_t all = t->cell_count + count;
    active_cell *found;
    uint64_t edges;
    bool differ;
    if (all > t->cell_capacity) {
        const uint64_t capacity = 2 * all;
        active_cell *grown = realloc(t->cells, (size_t)capacity * sizeof *grown);
        if (!grown) return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory for the active cells of all slabs");
        t->cells = grown;
        t->cell_capacity = capacity;
    }
    tc_status status = active_cells_take(&t->r, &found);
    if (status) return status;
    memcpy(t->cells + t->cell_count, found, count * sizeof *found);
    status = active_cells_give(&t->r, found);
    if (!status)
        status =
            whole_assign(t->r.context, t->r.grid, t->cells + t->cell_count, count, t->local.numbers, &edges, &differ);
    t->cell_count = all;
    return status;
}

static tc_status slab_classify(slabs_run *t, uint32_t slab_index) {
    const uint64_t first = (uint64_t)CLUSTER_CELLS * t->slab_clusters * slab_index, rest = t->w->cell_count - first;
    const uint64_t most = (uint64_t)CLUSTER_CELLS * t->slab_clusters;
    const uint32_t begin = (uint32_t)first, count = (uint32_t)(rest < most ? rest : most);
    if (!slab_possible(t, begin, count)) return TC_OK;
    tc_status status = slab_load(t, begin, count);
    const bool known = t->w->ranges_known;
    if (!status) status = whole_classify(&t->r);
    if (!status && !known) status = ranges_move(t, begin, count, true);
    return !status && t->r.job.active_count ? cells_append(t) : status;
}

/* ----------------------------------------------------------------------------------------------- edges on the host */

static const uint8_t *case_of(const slabs_run *t, const active_cell *cell) {
    uint64_t bytes;
    return whole_case_at(whole_cases_bytes(t->r.context->whole_cases, &bytes), cell->pattern);
}

/* The ends of a candidate, the lower point first. */
static void candidate_ends(const active_cell *cell, const uint8_t *c, uint32_t n, uint32_t ends[2]) {
    const uint32_t a = cell->points[c[WHOLE_ENDS + n] & 15], b = cell->points[c[WHOLE_ENDS + n] >> 4];
    ends[0] = a < b ? a : b;
    ends[1] = a < b ? b : a;
}

/* Numbers the edges of all cells in their order. */
static tc_status edges_number(slabs_run *t) {
    uint32_t ends[2], number;
    tc_status status = TC_OK;
    edge_numbers_release(&t->edges);
    for (uint64_t n = 0; n < t->cell_count && !status; n++) {
        const uint8_t *c = case_of(t, &t->cells[n]);
        for (uint32_t rest = whole_case_edges(c); rest && !status; rest &= rest - 1) {
            candidate_ends(&t->cells[n], c, (uint32_t)__builtin_ctz(rest), ends);
            status = edge_numbers_find(&t->edges, ends[0], ends[1], &number);
        }
    }
    return status;
}

/* Notes which diagonals are edges, and how many cells have such. */
static uint64_t diagonals_find(slabs_run *t) {
    uint64_t cut = 0;
    uint32_t ends[2];
    for (uint64_t n = 0; n < t->cell_count; n++) {
        const uint8_t *c = case_of(t, &t->cells[n]);
        for (uint32_t m = 0; m < c[WHOLE_CANDIDATES]; m++) {
            if (whole_case_edges(c) >> m & 1) continue;
            candidate_ends(&t->cells[n], c, m, ends);
            if (edge_numbers_get(&t->edges, ends[0], ends[1]) != UINT32_MAX) t->cells[n].owned |= 1u << m;
        }
        cut += t->cells[n].owned != 0;
    }
    return cut;
}

/* before, after: where this stage begins and ends in the whole call, for progress. */
static tc_status surface_find(slabs_run *t, const tc_extract_options *options, double before, double after) {
    const uint32_t count = slab_count(t);
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < count && !status; n++) {
        status = slab_classify(t, n);
        if (!status) status = context_progress(t->r.context, "classify", before + (after - before) * (n + 1) / count);
    }
    if (status) return status;
    t->w->ranges_known = true;
    status = edges_number(t);
    if (!status && t->cell_count && diagonals_find(t)) {
        status = whole_assign_cut(t->r.context, t->cells, t->cell_count);
        if (!status) status = edges_number(t);
    }
    for (uint64_t n = 0; n < t->cell_count && !status; n++)
        t->triangle_count += case_of(t, &t->cells[n])[WHOLE_TRIANGLES];
    return status ? status : caps_host_count(t->r.grid, options, &t->edges, &t->caps);
}

/* Keeps the edges, from which fields are carried. */
static void edges_keep(slabs_run *t, const tc_extract_options *options) {
    complex_classified_note(
        t->r.grid, options,
        (surface_size){.vertex_count = t->edges.count + t->caps.vertices, .cap_vertices = t->caps.vertices});
    if (!t->r.complex->carries) return;
    t->w->edges = t->edges;
    t->edges = (edge_numbers){0};
}

tc_status whole_slabs_count(tc_grid *grid, const tc_extract_options *options, double before, double share,
                            tc_counts *counts) {
    slabs_run t;
    tc_status status = slabs_begin(&t, grid, options);
    if (!status) status = surface_find(&t, options, before, share);
    counts->vertex_count = t.edges.count + t.caps.vertices;
    counts->triangle_count = t.triangle_count + t.caps.triangles;
    counts->active_cell_count = t.cell_count;
    counts->classify_ms = clock_ms() - t.r.start_ms;
    if (!status) edges_keep(&t, options);
    slabs_end(&t);
    return status;
}

/* -------------------------------------------------------------------------------------------------------- emission */

typedef struct vertex_job {
    const tc_grid *grid;
    const edge_numbers *edges;
    double isovalue;
    float *positions;
    _Atomic uint64_t next;
} vertex_job;

static void batch_emit(const vertex_job *j, uint64_t first, uint32_t count) {
    edge_batch batch = {.count = count};
    const float *points = j->grid->complex->points;
    float t[BATCH_EDGES];
    for (uint32_t n = 0; n < count; n++) {
        batch.low[n] = (int64_t)(j->edges->edges[first + n] >> 32);
        batch.high[n] = (int64_t)(uint32_t)j->edges->edges[first + n];
    }
    carry_crossings(j->grid, j->isovalue, &batch, t);
    for (uint32_t n = 0; n < count; n++) {
        const float *p0 = points + 3 * batch.low[n], *p1 = points + 3 * batch.high[n];
        float *out = j->positions + 3 * (first + n);
        for (int axis = 0; axis < 3; axis++) out[axis] = t[n] == 1 ? p1[axis] : p0[axis] + t[n] * (p1[axis] - p0[axis]);
    }
}

static void shares_emit(void *shared) {
    vertex_job *j = shared;
    uint64_t n;
    while ((n = BATCH_EDGES * atomic_fetch_add(&j->next, 1)) < j->edges->count)
        batch_emit(j, n, (uint32_t)(j->edges->count - n > BATCH_EDGES ? BATCH_EDGES : j->edges->count - n));
}

static tc_status cell_emit(slabs_run *t, const active_cell *cell, uint32_t **out) {
    const uint8_t *c = case_of(t, cell), *corners = c + WHOLE_ENDS + c[WHOLE_CANDIDATES];
    uint32_t ends[2];
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < 3u * c[WHOLE_TRIANGLES] && !status; n++) {
        candidate_ends(cell, c, corners[n], ends);
        status = edge_numbers_find(&t->edges, ends[0], ends[1], (*out)++);
    }
    return status;
}

static tc_status surface_emit_all(slabs_run *t, const tc_extract_options *options, tc_mesh *mesh) {
    tc_status status =
        mesh_allocate(mesh, t->edges.count + t->caps.vertices, t->triangle_count + t->caps.triangles, POSITIONS_ALONE);
    if (!status) status = caps_host_emit(t->r.grid, options, &t->edges, t->caps, mesh);
    if (status || !t->triangle_count) return status;
    vertex_job j = {.grid = t->r.grid, .edges = &t->edges, .isovalue = options->isovalue};
    j.positions = mesh->channels[CHANNEL_POSITIONS].memory;
    parallel_run((t->edges.count + BATCH_EDGES - 1) / BATCH_EDGES, shares_emit, &j);
    uint32_t *out = mesh->triangles.memory;
    for (uint64_t n = 0; n < t->cell_count && !status; n++) status = cell_emit(t, &t->cells[n], &out);
    return status ? status : context_progress(t->r.context, "emit", 1);
}

tc_status whole_slabs_extract(tc_grid *grid, const tc_extract_options *options, double before, tc_mesh *mesh) {
    slabs_run t;
    tc_status status = slabs_begin(&t, grid, options);
    if (!status) status = surface_find(&t, options, before, before + 0.9 * (1 - before));
    double classified = clock_ms();
    if (!status) status = surface_emit_all(&t, options, mesh);
    mesh->active_cell_count = t.cell_count;
    mesh->slab_count = t.slab_clusters ? slab_count(&t) : 0;
    mesh->timings.classify_ms = classified - t.r.start_ms;
    mesh->timings.total_ms = clock_ms() - t.r.start_ms;
    mesh->timings.emit_ms = mesh->timings.total_ms - mesh->timings.classify_ms;
    if (!status) edges_keep(&t, options);
    slabs_end(&t);
    return status;
}
