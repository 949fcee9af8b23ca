/*
 * A complex slab by slab. First all slabs are classified and their vertices joined, with 64-bit totals. Then slabs with
 * triangles are classified again, which is quick by the known ranges of their clusters, and emitted.
 *
 * A slab's vertices are numbered by the first of its tetrahedra that has the edge. The host goes through them in this
 * order and gives each the number that its edge has in the mesh: what an earlier slab has given it, else the next. That
 * is the order of a complex in one piece. The slab's triangles are then renumbered in the mesh; of its positions the
 * mesh takes those that are new.
 */
#include "tetrahedra/complex_caps.h"

#include "failure.h"

#include <stdlib.h>
#include <string.h>

typedef struct slab_totals {
    uint32_t vertices, triangles; /* vertices: those of earlier slabs, too */
} slab_totals;

typedef struct slabs_run {
    complex_run r;
    struct complex_slabs *slabs;
    slab_totals *totals;
    local_points local; /* where slabs have points of their own */
    joined_edges joined;
    uint64_t triangle_count, active_count;
    cap_sizes caps; /* of the border */
} slabs_run;

static tc_status slabs_begin(slabs_run *t, tc_grid *grid, const tc_extract_options *options) {
    struct complex_slabs *slabs = grid->complex->slabs;
    *t = (slabs_run){.slabs = slabs};
    tc_status status = complex_run_begin(&t->r, grid, options);
    t->totals = calloc(slabs->slab_count, sizeof *t->totals);
    if (!status && !t->totals) status = (tc_status)fail(TC_ERROR_MEMORY, "no memory for the totals of slabs");
    return status ? status : complex_slabs_open(grid, slabs, &t->local);
}

static void slabs_end(slabs_run *t) {
    cl->Finish(t->r.context->queue);
    complex_slabs_close(t->r.grid, t->slabs, &t->local);
    joined_edges_release(&t->joined);
    free(t->totals);
}

static tc_status slab_count(slabs_run *t, uint32_t slab_index, bool ranges_known) {
    tc_status status = complex_slab_load(t->r.grid, t->slabs, &t->local, slab_index, ranges_known);
    if (!status) status = surface_classify(&t->r);
    if (!status && !ranges_known) status = complex_slab_ranges_keep(t->r.grid, t->slabs, slab_index);
    return !status && t->r.job.active_count ? surface_number(&t->r) : status;
}

/* -------------------------------------------------------------------------------------------------- classification */

/* Whether the slab may have a surface, by the ranges of its clusters. */
static bool slab_possible(const slabs_run *t, uint32_t slab_index) {
    const isovalue_test *test = &t->r.test;
    const brick_range *ranges = t->slabs->ranges + slab_first_cluster(t->slabs, slab_index);
    for (uint32_t n = 0; n < slab_cluster_count(t->r.complex, t->slabs, slab_index); n++)
        if (ranges[n].low < test->key_inside && ranges[n].high >= test->key_outside) return true;
    return !t->slabs->ranges_known;
}

static tc_status slab_classify(slabs_run *t, uint32_t slab_index) {
    if (!slab_possible(t, slab_index)) return TC_OK;
    tc_status status = slab_count(t, slab_index, t->slabs->ranges_known);
    if (status || !t->r.job.active_count) return status;
    t->totals[slab_index] = (slab_totals){t->r.head[HEAD_VERTICES], t->r.head[HEAD_TRIANGLES]};
    t->triangle_count += t->r.head[HEAD_TRIANGLES];
    t->active_count += t->r.job.active_count;
    return complex_slab_edges_join(&t->r, t->local.numbers, &t->joined);
}

/* before, after: where this stage begins and ends in the whole call, for progress. */
static tc_status slabs_classify(slabs_run *t, const tc_extract_options *options, double before, double after) {
    const uint32_t count = t->slabs->slab_count;
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < count && !status; n++) {
        status = slab_classify(t, n);
        if (!status) status = context_progress(t->r.context, "classify", before + (after - before) * (n + 1) / count);
    }
    if (!status) t->slabs->ranges_known = true;
    return status ? status : caps_host_count(t->r.grid, options, &t->joined.edges, &t->caps);
}

static uint64_t vertex_count_of(const slabs_run *t) { return t->joined.edges.count + t->caps.vertices; }

/* Keeps the joined edges, from which fields are carried. */
static void edges_keep(slabs_run *t, const tc_extract_options *options, uint64_t vertex_count) {
    complex_classified_note(t->r.grid, options,
                            (surface_size){.vertex_count = vertex_count, .cap_vertices = t->caps.vertices});
    if (!t->r.complex->carries) return;
    t->slabs->edges = t->joined.edges;
    t->joined.edges = (edge_numbers){0};
}

tc_status complex_slabs_count(tc_grid *grid, const tc_extract_options *options, double before, double share,
                              tc_counts *counts) {
    slabs_run t;
    tc_status status = slabs_begin(&t, grid, options);
    if (!status) status = slabs_classify(&t, options, before, share);
    counts->vertex_count = vertex_count_of(&t);
    counts->triangle_count = t.triangle_count + t.caps.triangles;
    counts->active_cell_count = t.active_count;
    counts->classify_ms = clock_ms() - t.r.start_ms;
    if (!status) edges_keep(&t, options, vertex_count_of(&t));
    slabs_end(&t);
    return status;
}

/* -------------------------------------------------------------------------------------------------------- emission */

/* What has been emitted of the mesh, and the positions of a slab. */
typedef struct joined_mesh {
    tc_mesh *mesh;
    const uint32_t *numbers; /* of the slab's vertices */
    uint64_t vertex_count, triangle_count;
    float *positions;
    double readback_ms;
} joined_mesh;

static tc_status positions_allocate(const slabs_run *t, joined_mesh *e) {
    uint32_t most = 0;
    for (uint32_t n = 0; n < t->slabs->slab_count; n++)
        if (t->totals[n].vertices > most) most = t->totals[n].vertices;
    e->positions = malloc(CHANNEL_BYTES * (size_t)most + 1);
    return e->positions ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the vertices of a slab");
}

/* Reads what the slab has emitted, triangles to where they belong. */
static tc_status slab_read(const slabs_run *t, slab_totals totals, joined_mesh *e) {
    const mesh_buffers *m = &t->r.context->work.mesh[0];
    cl_command_queue queue = t->r.context->queue;
    uint32_t *triangles = (uint32_t *)e->mesh->triangles.memory + 3 * e->triangle_count;
    cl_int error = cl->EnqueueReadBuffer(queue, m->channels[CHANNEL_POSITIONS].memory, CL_TRUE, 0,
                                         CHANNEL_BYTES * (size_t)totals.vertices, e->positions, 0, NULL, NULL);
    if (!error)
        error = cl->EnqueueReadBuffer(queue, m->triangles.memory, CL_TRUE, 0, TRIANGLE_BYTES * (size_t)totals.triangles,
                                      triangles, 0, NULL, NULL);
    return error ? context_fail(t->r.context, "reading the mesh back", error) : TC_OK;
}

/* Puts the slab's new vertices behind the others, and gives its triangles the numbers in the mesh. */
static void slab_append(slab_totals totals, joined_mesh *e) {
    uint32_t *triangles = (uint32_t *)e->mesh->triangles.memory + 3 * e->triangle_count;
    float *positions = e->mesh->channels[CHANNEL_POSITIONS].memory;
    e->vertex_count = positions_append(e->numbers, totals.vertices, e->positions, positions, e->vertex_count);
    for (uint64_t n = 0; n < 3ull * totals.triangles; n++) triangles[n] = e->numbers[triangles[n]];
    e->numbers += totals.vertices;
    e->triangle_count += totals.triangles;
}

static tc_status slab_emit(slabs_run *t, uint32_t slab_index, joined_mesh *e) {
    const slab_totals totals = t->totals[slab_index];
    mesh_buffers *m = &t->r.context->work.mesh[0];
    const uint64_t vertex_bytes = CHANNEL_BYTES * (uint64_t)totals.vertices;
    if (!totals.triangles) return TC_OK;
    tc_status status = slab_count(t, slab_index, true);
    if (!status && (t->r.head[HEAD_VERTICES] != totals.vertices || t->r.head[HEAD_TRIANGLES] != totals.triangles))
        status = (tc_status)fail(TC_ERROR_DATA, "the samples or tetrahedra have changed while they were extracted");
    if (!status) status = surface_reserve(&t->r, &m->channels[CHANNEL_POSITIONS], vertex_bytes, "positions");
    if (!status)
        status = surface_reserve(&t->r, &m->triangles, TRIANGLE_BYTES * (uint64_t)totals.triangles, "triangles");
    if (!status) status = surface_emit(&t->r, &m->channels[CHANNEL_POSITIONS], &m->triangles);
    double emitted = clock_ms();
    if (!status) status = slab_read(t, totals, e);
    if (!status) slab_append(totals, e);
    e->readback_ms += clock_ms() - emitted;
    return status;
}

static tc_status slabs_emit_all(slabs_run *t, const tc_extract_options *options, tc_mesh *mesh, double before) {
    const uint32_t count = t->slabs->slab_count;
    joined_mesh e = {.mesh = mesh, .numbers = t->joined.numbers};
    tc_status status = mesh_allocate(mesh, vertex_count_of(t), t->triangle_count + t->caps.triangles, POSITIONS_ALONE);
    if (!status) status = caps_host_emit(t->r.grid, options, &t->joined.edges, t->caps, mesh);
    if (!t->r.complex->carries) edge_numbers_release(&t->joined.edges);
    if (!status) status = positions_allocate(t, &e);
    for (uint32_t n = 0; n < count && !status; n++) {
        status = slab_emit(t, n, &e);
        if (!status) status = context_progress(t->r.context, "emit", before + (1 - before) * (n + 1) / count);
    }
    mesh->timings.readback_ms = e.readback_ms;
    free(e.positions);
    return status;
}

tc_status complex_slabs_extract(tc_grid *grid, const tc_extract_options *options, double before, tc_mesh *mesh) {
    const double middle = before + 0.7 * (1 - before);
    slabs_run t;
    tc_status status = slabs_begin(&t, grid, options);
    if (!status) status = slabs_classify(&t, options, before, middle);
    double classified = clock_ms();
    if (!status) status = slabs_emit_all(&t, options, mesh, middle);
    mesh->active_cell_count = t.active_count;
    mesh->slab_count = t.slabs->slab_count;
    mesh->timings.classify_ms = classified - t.r.start_ms;
    mesh->timings.total_ms = clock_ms() - t.r.start_ms - mesh->timings.readback_ms;
    mesh->timings.emit_ms = mesh->timings.total_ms - mesh->timings.classify_ms;
    if (!status) edges_keep(&t, options, mesh->vertex_count);
    slabs_end(&t);
    return status;
}
