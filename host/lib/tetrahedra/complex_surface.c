/*
 * An isovalue's surface in a part of a complex: classify and list, join and number the crossed edges, emit.
 *
 * The host waits twice: for the number of active tetrahedra, which lists and the table of edges are sized by, and for
 * that of the vertices. Everything but the part itself is proportional to the surface.
 */
#include "tetrahedra/whole_run.h"

#include "failure.h"
#include "tables/tables.h"

#include <string.h>

/* ---------------------------------------------------------------------------------------------------------- buffers */

bool surface_fits(complex_run *r, uint64_t bytes) {
    const tc_context *context = r->context;
    const uint64_t budget = context_budget(context);
    if (r->is_cut) return true; /* slabs are cut to fit */
    if (bytes > context->info.max_buffer_bytes || context->device_bytes > budget ||
        bytes > budget - context->device_bytes)
        r->too_large = true;
    return !r->too_large;
}

tc_status surface_reserve(complex_run *r, device_buffer *buffer, uint64_t bytes, const char *name) {
    if (buffer->memory && bytes <= buffer->bytes) return TC_OK;
    buffer_release(r->context, buffer);
    if (!surface_fits(r, bytes))
        return (tc_status)fail(TC_ERROR_MEMORY, "the grid of tetrahedra has no room for %llu bytes for %s",
                               (unsigned long long)bytes, name);
    return buffer_reserve(r->context, buffer, bytes, name);
}

void complex_cases(uint8_t cases[16][CASE_BYTES]) {
    memset(cases, 0, 16 * CASE_BYTES);
    for (unsigned pattern = 0; pattern < 16; pattern++) {
        const tetrahedron_case *c = &tetrahedron_cases[pattern];
        uint8_t *row = cases[pattern], slots[6] = {0};
        for (unsigned e = 0; e < 6; e++) {
            const uint8_t *ends = tetrahedron_edges[e];
            if ((pattern >> ends[0] & 1) == (pattern >> ends[1] & 1)) continue;
            slots[e] = row[CASE_EDGES]++;
            memcpy(row + CASE_ENDS + 2 * slots[e], ends, 2);
        }
        row[CASE_TRIANGLES] = c->triangle_count;
        for (unsigned n = 0; n < 3u * c->triangle_count; n++) row[CASE_CORNERS + n] = slots[c->triangles[n / 3][n % 3]];
    }
}

tc_status surface_table_provide(complex_run *r, device_buffer *buffer, const void *table, uint64_t bytes) {
    tc_status status = surface_reserve(r, buffer, bytes, "the case table");
    return status ? status : buffer_upload(r->context, buffer, table, bytes, "the case table");
}

/* Uploaded once per context. */
static tc_status cases_provide(complex_run *r) {
    uint8_t cases[16][CASE_BYTES];
    if (r->work->cases.memory) return TC_OK;
    complex_cases(cases);
    return surface_table_provide(r, &r->work->cases, cases, sizeof cases);
}

/* --------------------------------------------------------------------------------------------------------- commands */

tc_status surface_fill(const complex_run *r, const device_buffer *buffer, cl_uint value, uint64_t first,
                       uint64_t bytes) {
    cl_int error =
        cl->EnqueueFillBuffer(r->context->queue, buffer->memory, &value, sizeof value, first, bytes, 0, NULL, NULL);
    return error ? context_fail(r->context, "clearing a buffer", error) : TC_OK;
}

tc_status surface_head_read(complex_run *r) {
    cl_int error = cl->EnqueueReadBuffer(r->context->queue, r->work->state.memory, CL_TRUE, 0, sizeof r->head, r->head,
                                         0, NULL, NULL);
    return error ? context_fail(r->context, "reading totals", error) : TC_OK;
}

/* --------------------------------------------------------------------------------------------------- classification */

complex_job complex_job_of(const complex_run *r, uint32_t cluster_count) {
    const complex_part *part = r->part;
    const uint32_t tile_clusters = complex_tile_clusters(r->grid);
    return (complex_job){.test = r->test,
                         .ranges_known = part->ranges_known,
                         .spin_limit = r->grid->scan.spin_limit,
                         .sample_offset = part->sample_offset,
                         .point_offset = part->point_offset,
                         .tetrahedron_offset = part->tetrahedron_offset,
                         .point_count = part->point_count,
                         .item_count = part->tetrahedron_count,
                         .cluster_count = cluster_count,
                         .tile_clusters = tile_clusters,
                         .tile_actives = complex_tile_actives(r->grid),
                         .cluster_tiles = (cluster_count + tile_clusters - 1) / tile_clusters};
}

tc_status complex_workspace_begin(complex_run *r, tc_grid *grid, const tc_extract_options *options) {
    tc_context *context = grid->context;
    kernel_kind kind = r->interval ? complex_interval_kind(grid) : complex_kind(grid, options, false);
    r->keeps_cells = options->method == TC_METHOD_HYBRID;
    r->test = isovalue_test_of(inside_range_of(grid->type, options->isovalue), options->isovalue);
    context->counted_grid = context->classified_grid = NULL;
    tc_status status = complex_kernels_get(context, kind, r->kernels);
    r->start_ms = clock_ms();
    if (status) return status;
    if (context->workspace_grid != grid && (context->options.max_memory_bytes || r->is_cut)) {
        cl->Finish(context->queue);
        workspace_release(context);
    }
    context->workspace_grid = grid;
    return TC_OK;
}

tc_status complex_run_open(complex_run *r, const tc_extract_options *options) {
    complex_grid *c = r->complex;
    if (c->slabs) edge_numbers_release(&c->slabs->edges);
    whole_part_release(r->grid);
    tc_status status = complex_workspace_begin(r, r->grid, options);
    if (!status && !r->is_cut) status = complex_arrays_provide(r->grid);
    return status ? status : cases_provide(r);
}

tc_status complex_run_begin(complex_run *r, tc_grid *grid, const tc_extract_options *options) {
    complex_grid *c = grid->complex;
    *r = (complex_run){.grid = grid,
                       .complex = c,
                       .part = &c->part,
                       .context = grid->context,
                       .work = &grid->context->work.complex,
                       .is_cut = c->slabs != NULL};
    return complex_run_open(r, options);
}

void complex_classified_note(tc_grid *grid, const tc_extract_options *options, surface_size size) {
    grid->context->classified_grid = grid;
    grid->complex->classified_isovalue = options->isovalue;
    grid->complex->classified_method = options->method;
    grid->complex->classified_closed = options->closed;
    grid->complex->size = size;
}

tc_status surface_clusters_reserve(complex_run *r) {
    const uint64_t clusters = r->job.cluster_count;
    const uint64_t state_bytes = 4 * (HEAD_WORDS + (uint64_t)TILE_WORDS * r->job.cluster_tiles);
    tc_status status = surface_reserve(r, &r->work->clusters, sizeof(cluster_state) * clusters, "clusters");
    if (!status) status = surface_reserve(r, &r->work->active_clusters, 4 * clusters, "active clusters");
    if (!status) status = surface_reserve(r, &r->work->state, state_bytes, "the scan");
    return status ? status : surface_fill(r, &r->work->state, 0, 0, state_bytes);
}

tc_status surface_classify(complex_run *r) {
    const complex_buffers *w = r->work;
    r->job = complex_job_of(r, complex_cluster_count(r->part->tetrahedron_count));
    tc_status status = surface_clusters_reserve(r);
    if (status) return status;
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->part->samples.memory),
                                         ARGUMENT(r->part->tetrahedra.memory),
                                         ARGUMENT(r->part->ranges.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->active_clusters.memory),
                                         ARGUMENT(w->state.memory)};
    status = kernel_launch(r->context, r->kernels[KERNEL_CLASSIFY], "kernel complex_classify", arguments,
                           sizeof arguments / sizeof *arguments);
    if (!status) status = surface_head_read(r);
    if (!status && r->head[HEAD_INVALID]) status = complex_point_fail(r->complex);
    if (status) return status;
    r->part->ranges_known = true;
    r->job.active_count = r->head[HEAD_ACTIVE];
    r->job.active_tiles = (r->job.active_count + r->job.tile_actives - 1) / r->job.tile_actives;
    return TC_OK;
}

/* ------------------------------------------------------------------------------------------------------------ edges */

/* Clears the table and the tiles of the numbering, too. */
static tc_status active_list(complex_run *r) {
    complex_buffers *w = r->work;
    tc_status status =
        surface_reserve(r, &w->active, sizeof(active_tetrahedron) * (uint64_t)r->job.active_count, "active tetrahedra");
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->part->tetrahedra.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->active_clusters.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(w->active.memory),
                                         ARGUMENT(w->table.memory),
                                         ARGUMENT(w->tiles.memory)};
    return status ? status
                  : kernel_launch(r->context, r->kernels[KERNEL_LIST], "kernel complex_list", arguments,
                                  sizeof arguments / sizeof *arguments);
}

tc_status surface_table_reserve(complex_run *r, uint64_t entries) {
    r->job.table_mask = (uint32_t)(entries - 1);
    r->job.probe_limit = entries >= 2ull * r->head[HEAD_CROSSED] ? r->job.table_mask : 256;
    return surface_reserve(r, &r->work->table, 4 * entries, "the table of edges");
}

/* Enlarges the table, and resets what the attempt with the smaller table has changed. */
static tc_status table_enlarge(complex_run *r, uint64_t entries) {
    tc_status status = surface_table_reserve(r, entries);
    if (!status) status = surface_fill(r, &r->work->table, EDGE_NONE, 0, 4 * entries);
    if (!status) status = surface_fill(r, &r->work->state, 0, 4 * (HEAD_TICKETS + KERNEL_JOIN), 8);
    if (!status) status = surface_fill(r, &r->work->state, 0, 4 * HEAD_FULL, 4);
    return status ? status : surface_fill(r, &r->work->tiles, 0, 0, 4ull * TILE_WORDS * r->job.active_tiles);
}

/* Enters the crossed edges into the table and numbers their vertices. */
static tc_status edges_join(complex_run *r) {
    complex_buffers *w = r->work;
    const kernel_argument join[] = {ARGUMENT(r->job),          ARGUMENT(w->active.memory), ARGUMENT(w->cases.memory),
                                    ARGUMENT(w->state.memory), ARGUMENT(w->table.memory),  ARGUMENT(w->entries.memory)};
    const kernel_argument number[] = {ARGUMENT(r->job),           ARGUMENT(w->active.memory), ARGUMENT(w->cases.memory),
                                      ARGUMENT(w->state.memory),  ARGUMENT(w->tiles.memory),  ARGUMENT(w->table.memory),
                                      ARGUMENT(w->entries.memory)};
    tc_status status =
        kernel_launch(r->context, r->kernels[KERNEL_JOIN], "kernel complex_join", join, sizeof join / sizeof *join);
    if (!status)
        status = kernel_launch(r->context, r->kernels[KERNEL_NUMBER], "kernel complex_number", number,
                               sizeof number / sizeof *number);
    return status ? status : surface_head_read(r);
}

/* In most complexes an edge has five tetrahedra: a table half as large as the crossed edges, each counted for every
 * tetrahedron, is then less than half full. Where that overflows, a table that always suffices is used. */
tc_status surface_number(complex_run *r) {
    complex_buffers *w = r->work;
    uint64_t entries = 64;
    while (2 * entries < r->head[HEAD_CROSSED]) entries *= 2;
    tc_status status = surface_reserve(r, &w->entries, 16ull * r->job.active_count, "crossed edges");
    if (!status) status = surface_reserve(r, &w->tiles, 4ull * TILE_WORDS * r->job.active_tiles, "the scan");
    if (!status) status = surface_table_reserve(r, entries);
    if (!status) status = active_list(r);
    if (!status) status = edges_join(r);
    if (status || !r->head[HEAD_FULL]) return status;
    while (entries < 2ull * r->head[HEAD_CROSSED]) entries *= 2;
    status = table_enlarge(r, entries);
    if (!status) status = edges_join(r);
    return status;
}

/* --------------------------------------------------------------------------------------------------------- emission */

tc_status surface_emit(complex_run *r, const device_buffer *positions, const device_buffer *triangles) {
    const complex_buffers *w = r->work;
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->part->samples.memory),
                                         ARGUMENT(r->part->points.memory),
                                         ARGUMENT(w->active.memory),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->tiles.memory),
                                         ARGUMENT(w->table.memory),
                                         ARGUMENT(w->entries.memory),
                                         ARGUMENT(positions->memory),
                                         ARGUMENT(triangles->memory)};
    tc_status status = kernel_launch(r->context, r->kernels[KERNEL_EMIT], "kernel complex_emit", arguments,
                                     sizeof arguments / sizeof *arguments);
    cl_int error = cl->Finish(r->context->queue);
    return !status && error ? context_fail(r->context, "kernel complex_emit", error) : status;
}
