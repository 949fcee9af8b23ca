/*
 * One slab of a complex: brought to the device, its ranges kept, its vertices joined with those of the slabs before.
 */
#include "tetrahedra/complex_run.h"

#include "failure.h"

#include <stdlib.h>
#include <string.h>

uint32_t slab_first_cluster(const struct complex_slabs *slabs, uint32_t slab_index) {
    return slab_index * slabs->slab_clusters;
}

uint32_t slab_cluster_count(const complex_grid *c, const struct complex_slabs *slabs, uint32_t slab_index) {
    const uint32_t rest = complex_cluster_count(c->tetrahedron_count) - slab_first_cluster(slabs, slab_index);
    return rest < slabs->slab_clusters ? rest : slabs->slab_clusters;
}

static uint32_t slab_tetrahedron_count(const complex_grid *c, const struct complex_slabs *slabs, uint32_t slab_index) {
    const uint64_t first = (uint64_t)CLUSTER_TETRAHEDRA * slab_first_cluster(slabs, slab_index);
    const uint64_t rest = c->tetrahedron_count - first;
    const uint64_t most = (uint64_t)CLUSTER_TETRAHEDRA * slabs->slab_clusters;
    return (uint32_t)(rest < most ? rest : most);
}

tc_status complex_slabs_open(const tc_grid *grid, const struct complex_slabs *slabs, local_points *local) {
    if (slabs->points_whole) return TC_OK;
    return local_points_allocate(grid, slab_tetrahedron_count(grid->complex, slabs, 0), local);
}

void complex_slabs_close(tc_grid *grid, const struct complex_slabs *slabs, local_points *local) {
    part_tetrahedra_release(grid);
    if (!slabs->points_whole) part_points_release(grid);
    local_points_release(local);
}

/* ---------------------------------------------------------------------------------------------------------- arrays */

static tc_status points_load(tc_grid *grid, const struct complex_slabs *slabs, local_points *local, uint32_t count,
                             const uint32_t **tetrahedra) {
    const complex_grid *c = grid->complex;
    uint32_t point_count;
    if (slabs->points_whole)
        return c->part.points.memory ? TC_OK : part_points_provide(grid, c->points, grid->samples, c->point_count);
    part_points_release(grid); /* a buffer in place uses the memory in which the next slab is gathered */
    tc_status status = local_points_gather(grid, *tetrahedra, count, local, &point_count);
    *tetrahedra = local->tetrahedra;
    return status ? status : part_points_provide(grid, local->points, local->samples, point_count);
}

/* Copies the slab's ranges from the host, or to it. */
static tc_status ranges_move(tc_grid *grid, struct complex_slabs *slabs, uint32_t slab_index, bool save) {
    cl_command_queue queue = grid->context->queue;
    cl_mem memory = grid->complex->part.ranges.memory;
    brick_range *ranges = slabs->ranges + slab_first_cluster(slabs, slab_index);
    const size_t bytes = sizeof *ranges * slab_cluster_count(grid->complex, slabs, slab_index);
    cl_int error = save ? cl->EnqueueReadBuffer(queue, memory, CL_TRUE, 0, bytes, ranges, 0, NULL, NULL)
                        : cl->EnqueueWriteBuffer(queue, memory, CL_TRUE, 0, bytes, ranges, 0, NULL, NULL);
    return error ? context_fail(grid->context, "copying ranges of clusters", error) : TC_OK;
}

tc_status complex_slab_load(tc_grid *grid, struct complex_slabs *slabs, local_points *local, uint32_t slab_index,
                            bool ranges_known) {
    const uint64_t first = (uint64_t)CLUSTER_TETRAHEDRA * slab_first_cluster(slabs, slab_index);
    const uint32_t *tetrahedra = grid->complex->tetrahedra + 4 * first;
    const uint32_t count = slab_tetrahedron_count(grid->complex, slabs, slab_index);
    tc_status status = points_load(grid, slabs, local, count, &tetrahedra);
    if (!status) status = part_tetrahedra_provide(grid, tetrahedra, count);
    if (!status && ranges_known) status = ranges_move(grid, slabs, slab_index, false);
    grid->complex->part.ranges_known = ranges_known;
    return status;
}

tc_status complex_slab_ranges_keep(tc_grid *grid, struct complex_slabs *slabs, uint32_t slab_index) {
    return ranges_move(grid, slabs, slab_index, true);
}

/* -------------------------------------------------------------------------------------------------------- vertices */

static void *capacity_enlarge(void *memory, uint64_t *capacity, uint64_t count, size_t item_bytes) {
    uint64_t larger = 2 * *capacity > count ? 2 * *capacity : count;
    void *grown = realloc(memory, (size_t)larger * item_bytes);
    if (grown) *capacity = larger;
    return grown;
}

static tc_status join_fail(void) {
    return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory for the vertices of all slabs");
}

tc_status joined_edges_reserve(joined_edges *j, uint64_t vertices) {
    const uint64_t numbers = j->number_count + vertices;
    if (numbers <= j->number_capacity) return TC_OK;
    void *grown = capacity_enlarge(j->numbers, &j->number_capacity, numbers, sizeof *j->numbers);
    if (grown) j->numbers = grown;
    return grown ? TC_OK : join_fail();
}

tc_status joined_edges_add(joined_edges *j, const uint32_t *names, uint32_t a, uint32_t b) {
    const uint32_t p = names ? names[a] : a, q = names ? names[b] : b;
    tc_status status = edge_numbers_find(&j->edges, p < q ? p : q, p < q ? q : p, &j->numbers[j->number_count]);
    if (!status) j->number_count++;
    return status;
}

/* Makes room for the active tetrahedra and vertex numbers of a slab. */
static tc_status lists_reserve(joined_edges *j, uint64_t active, uint64_t vertices) {
    void *grown = j->active;
    if (active > j->active_capacity)
        grown = capacity_enlarge(j->active, &j->active_capacity, active, sizeof *j->active);
    if (grown) j->active = grown;
    return grown ? joined_edges_reserve(j, vertices) : join_fail();
}

/* Numbers the vertices that an active tetrahedron owns. */
static tc_status vertices_join(joined_edges *j, const uint32_t *names, uint8_t cases[16][CASE_BYTES],
                               const active_tetrahedron *a) {
    tc_status status = TC_OK;
    for (uint32_t rest = a->owned; rest && !status; rest &= rest - 1) {
        const uint8_t *ends = cases[a->pattern] + CASE_ENDS + 2 * __builtin_ctz(rest);
        status = joined_edges_add(j, names, a->points[ends[0]], a->points[ends[1]]);
    }
    return status;
}

tc_status complex_slab_edges_join(const complex_run *r, const uint32_t *names, joined_edges *j) {
    const uint32_t count = r->job.active_count;
    uint8_t cases[16][CASE_BYTES];
    tc_status status = lists_reserve(j, count, r->head[HEAD_VERTICES]);
    if (status) return status;
    complex_cases(cases);
    cl_int error = cl->EnqueueReadBuffer(r->context->queue, r->work->active.memory, CL_TRUE, 0,
                                         count * sizeof *j->active, j->active, 0, NULL, NULL);
    if (error) return context_fail(r->context, "reading the active tetrahedra back", error);
    for (uint32_t n = 0; n < count && !status; n++) status = vertices_join(j, names, cases, &j->active[n]);
    return status;
}

uint64_t positions_append(const uint32_t *numbers, uint32_t count, const float *from, float *to, uint64_t done) {
    for (uint32_t n = 0; n < count; n++)
        if (numbers[n] == done) memcpy(to + 3 * done++, from + 3 * (size_t)n, CHANNEL_BYTES);
    return done;
}

void joined_edges_release(joined_edges *j) {
    edge_numbers_release(&j->edges);
    free(j->active);
    free(j->numbers);
    *j = (joined_edges){0};
}
