/*
 * Fields carried to the vertices of a complex. The numbered active items in the workspace name the crossed edges
 * that they own, in the order of their vertices. For a complex in slabs the host has joined the edges; it keeps them
 * after the first field has been carried. Threads of the host process shares of tetrahedra or of edges.
 */
#include "tetrahedra/complex_caps.h"
#include "tetrahedra/whole_run.h"

#include "failure.h"
#include "grid/carry.h"
#include "parallel.h"

#include <stdatomic.h>

enum { SHARE_EDGES = 1 << 14, STEPS = 8 };

typedef struct carry_job {
    const tc_grid *grid;
    const carry *carry;
    double isovalue;
    const uint64_t *edges;            /* of all vertices, where slabs have been joined; else: */
    const active_tetrahedron *active; /* by method tetra */
    const active_cell *cells;         /* by method hybrid */
    const uint32_t *tiles;
    const uint8_t *whole_cases;
    surface_size size;
    uint64_t edge_vertices; /* those that are not at points of the border */
    uint8_t cases[16][CASE_BYTES];
    _Atomic uint64_t next; /* tile, or share of edges */
    uint64_t end;
    _Atomic uint64_t vertices; /* met so far */
    atomic_bool wrong;         /* there are invalid point numbers */
} carry_job;

static void edge_add(carry_job *j, uint32_t low, uint32_t high, edge_batch *batch) {
    if (low >= j->grid->complex->point_count || high >= j->grid->complex->point_count) {
        j->wrong = true;
        return;
    }
    if (batch->count == BATCH_EDGES) carry_batch(j->carry, j->grid, j->isovalue, batch);
    batch->low[batch->count] = low;
    batch->high[batch->count++] = high;
}

static void points_add(carry_job *j, uint32_t p, uint32_t q, edge_batch *batch) {
    edge_add(j, p < q ? p : q, p < q ? q : p, batch);
}

static void tetrahedron_carry(carry_job *j, const active_tetrahedron *a, edge_batch *batch) {
    for (uint32_t rest = a->owned & 15; rest; rest &= rest - 1) {
        const uint8_t *ends = j->cases[a->pattern & 15] + CASE_ENDS + 2 * __builtin_ctz(rest);
        points_add(j, a->points[ends[0]], a->points[ends[1]], batch);
    }
}

static void cell_carry(carry_job *j, const active_cell *a, edge_batch *batch) {
    const uint8_t *ends = whole_case_at(j->whole_cases, a->pattern) + WHOLE_ENDS;
    for (uint32_t rest = a->owned; rest; rest &= rest - 1) {
        const uint8_t pair = ends[__builtin_ctz(rest)];
        points_add(j, a->points[pair & 15], a->points[pair >> 4], batch);
    }
}

static void tile_carry(carry_job *j, uint64_t tile, edge_batch *batch) {
    const uint64_t first = tile * j->size.tile_actives, end = first + j->size.tile_actives;
    const uint64_t vertex = tile ? j->tiles[TILE_WORDS * (tile - 1) + TILE_SUM_X] & SCAN_VALUE : 0;
    batch->vertex = vertex;
    for (uint64_t n = first; n < end && n < j->size.active_count; n++)
        if (j->cells)
            cell_carry(j, &j->cells[n], batch);
        else
            tetrahedron_carry(j, &j->active[n], batch);
    j->vertices += batch->vertex + batch->count - vertex;
    carry_batch(j->carry, j->grid, j->isovalue, batch);
}

static void share_carry(carry_job *j, uint64_t share, edge_batch *batch) {
    const uint64_t first = share * SHARE_EDGES, end = first + SHARE_EDGES;
    batch->vertex = first;
    for (uint64_t n = first; n < end && n < j->edge_vertices; n++)
        edge_add(j, (uint32_t)(j->edges[n] >> 32), (uint32_t)j->edges[n], batch);
    j->vertices += batch->vertex + batch->count - first;
    carry_batch(j->carry, j->grid, j->isovalue, batch);
}

static void shares_carry(void *shared) {
    carry_job *j = shared;
    edge_batch batch = {0};
    uint64_t n;
    while ((n = atomic_fetch_add(&j->next, 1)) < j->end && !j->wrong)
        if (j->edges)
            share_carry(j, n, &batch);
        else
            tile_carry(j, n, &batch);
}

static tc_status job_run(carry_job *j, uint64_t share_count) {
    tc_status status = TC_OK;
    for (uint64_t step = 0; step < STEPS && !status; step++) {
        j->next = share_count * step / STEPS;
        j->end = share_count * (step + 1) / STEPS;
        if (j->next < j->end) parallel_run(j->end - j->next, shares_carry, j);
        status = context_progress(j->grid->context, "carry", 0.5 + 0.5 * (double)(step + 1) / STEPS);
    }
    if (!status && (j->wrong || j->vertices != j->edge_vertices))
        status = (tc_status)fail(TC_ERROR_DATA, "samples or tetrahedra have changed while a field was carried, or the "
                                                "device computes wrongly");
    return status;
}

/* The results of a complex that the device has whole, while they are mapped. */
static tc_status workspace_carry(carry_job *j, bool whole) {
    tc_context *context = j->grid->context;
    const complex_buffers *w = &context->work.complex;
    const uint64_t tile_count = (j->size.active_count + j->size.tile_actives - 1ull) / j->size.tile_actives;
    const void *active = NULL, *tiles = NULL;
    const size_t item_bytes = whole ? sizeof *j->cells : sizeof *j->active;
    tc_status status = buffer_map(context, &w->active, item_bytes * j->size.active_count, &active);
    if (!status) status = buffer_map(context, &w->tiles, 4ull * TILE_WORDS * tile_count, &tiles);
    if (whole)
        j->cells = active;
    else
        j->active = active;
    j->tiles = tiles;
    if (!status) status = job_run(j, tile_count);
    tc_status ended = buffer_unmap(context, &w->active, active);
    if (!status) status = ended;
    ended = buffer_unmap(context, &w->tiles, tiles);
    cl->Finish(context->queue);
    return status ? status : ended;
}

bool complex_is_classified(const tc_grid *grid, const tc_extract_options *options) {
    const complex_grid *c = grid->complex;
    const bool whole = options->method == TC_METHOD_HYBRID;
    const bool is_cut = whole ? c->whole && c->whole->is_cut : c->slabs != NULL;
    if (grid->context->classified_grid != grid || c->classified_isovalue != options->isovalue ||
        c->classified_method != options->method || c->classified_closed != (options->closed != 0))
        return false;
    return !is_cut || c->size.vertex_count == c->size.cap_vertices ||
           (whole ? c->whole->edges.edges : c->slabs->edges.edges);
}

static tc_status surface_carry_to(carry_job *j, const edge_numbers *edges, bool whole, uint64_t *vertex_count) {
    *vertex_count = j->size.vertex_count;
    if (j->carry->capacity != *vertex_count) return TC_OK; /* the caller compares the two */
    tc_status status = TC_OK;
    j->edge_vertices = *vertex_count - j->size.cap_vertices;
    if (edges) j->edges = edges->edges;
    if (j->edge_vertices)
        status = edges ? job_run(j, (j->edge_vertices + SHARE_EDGES - 1) / SHARE_EDGES) : workspace_carry(j, whole);
    if (!status && j->size.cap_vertices)
        caps_carry(j->grid, j->grid->complex->borders[whole], j->isovalue, j->carry, j->edge_vertices);
    return status;
}

tc_status complex_device_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                               uint64_t *vertex_count) {
    const struct complex_slabs *slabs = grid->complex->slabs;
    carry_job j = {.grid = grid, .carry = c, .isovalue = options->isovalue, .size = grid->complex->size};
    complex_cases(j.cases);
    return surface_carry_to(&j, slabs ? &slabs->edges : NULL, false, vertex_count);
}

tc_status whole_device_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                             uint64_t *vertex_count) {
    const struct whole_cells *w = grid->complex->whole;
    carry_job j = {.grid = grid, .carry = c, .isovalue = options->isovalue, .size = grid->complex->size};
    uint64_t bytes;
    if (grid->context->whole_cases) j.whole_cases = whole_cases_bytes(grid->context->whole_cases, &bytes);
    return surface_carry_to(&j, w->is_cut ? &w->edges : NULL, true, vertex_count);
}
