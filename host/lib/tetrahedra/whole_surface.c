/*
 * An isovalue's surface by method hybrid, in a part of the cells: classify and list; choose cases on the host; join
 * edges, find diagonals that are edges, choose cases again where there are such; number; emit.
 */
#include "tetrahedra/whole_run.h"

#include "failure.h"

#include <stdlib.h>

static const char *const kernel_names[WHOLE_KERNELS] = {
    [KERNEL_CLASSIFY] = "kernel complex_classify", [KERNEL_LIST] = "kernel whole_list",
    [KERNEL_JOIN] = "kernel complex_join",         [KERNEL_NUMBER] = "kernel complex_number",
    [KERNEL_EMIT] = "kernel complex_emit",         [KERNEL_CUT] = "kernel whole_cut",
    [KERNEL_CLEAR] = "kernel whole_clear"};

#define LAUNCH(r, kernel, arguments)                                                                                   \
    kernel_launch((r)->context, (r)->kernels[kernel], kernel_names[kernel], arguments,                                 \
                  sizeof(arguments) / sizeof *(arguments))

tc_status whole_run_begin(complex_run *r, tc_grid *grid, const tc_extract_options *options) {
    complex_grid *c = grid->complex;
    *r = (complex_run){.grid = grid,
                       .complex = c,
                       .context = grid->context,
                       .work = &grid->context->work.complex,
                       .is_cut = c->whole && c->whole->is_cut};
    if (c->whole) edge_numbers_release(&c->whole->edges);
    part_tetrahedra_release(grid);
    part_points_release(grid);
    tc_status status = complex_workspace_begin(r, grid, options);
    if (!status) status = whole_cells_provide(grid);
    if (!status) r->part = &c->whole->part;
    return status;
}

/* -------------------------------------------------------------------------------------------------- classification */

static void part_describe(complex_run *r) {
    const struct whole_cells *w = r->complex->whole;
    r->job = complex_job_of(r, whole_cluster_count(r->part->tetrahedron_count));
    r->job.code_offset = w->code_offset;
    r->job.begin_offset = w->begin_offset;
    r->job.word_step = w->word_step;
    r->job.cell_points = w->cell_points;
    r->job.one_code = w->one_code;
    r->job.slot_shift = w->has_prisms ? 5 : 4;
}

/* Buffers of what every cell shares stand in for those of what each has. */
static const device_buffer *begins_of(const struct whole_cells *w) {
    return w->begins_buffer.memory ? &w->begins_buffer : &w->shapes_buffer;
}

static const device_buffer *codes_of(const struct whole_cells *w) {
    return w->codes_buffer.memory ? &w->codes_buffer : &w->shapes_buffer;
}

static tc_status active_list(complex_run *r) {
    const struct whole_cells *cells = r->complex->whole;
    complex_buffers *w = r->work;
    tc_status status =
        surface_reserve(r, &w->active, sizeof(active_cell) * (uint64_t)r->job.active_count, "active cells");
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->part->samples.memory),
                                         ARGUMENT(r->part->tetrahedra.memory),
                                         ARGUMENT(begins_of(cells)->memory),
                                         ARGUMENT(codes_of(cells)->memory),
                                         ARGUMENT(cells->shapes_buffer.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->active_clusters.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->active.memory)};
    return status ? status : LAUNCH(r, KERNEL_LIST, arguments);
}

/* Records what is wrong with a point number, in the cells or in a tetrahedron. */
static tc_status point_fail(const complex_run *r) {
    tc_status status = whole_cells_gather(r->grid);
    return status ? status : complex_point_fail(r->complex);
}

tc_status whole_classify(complex_run *r) {
    const struct whole_cells *cells = r->complex->whole;
    const complex_buffers *w = r->work;
    part_describe(r);
    tc_status status = surface_clusters_reserve(r);
    if (status) return status;
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->part->samples.memory),
                                         ARGUMENT(r->part->tetrahedra.memory),
                                         ARGUMENT(r->part->ranges.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->active_clusters.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(begins_of(cells)->memory),
                                         ARGUMENT(codes_of(cells)->memory),
                                         ARGUMENT(cells->shapes_buffer.memory)};
    status = LAUNCH(r, KERNEL_CLASSIFY, arguments);
    if (!status) status = surface_head_read(r);
    if (!status && r->head[HEAD_INVALID]) status = point_fail(r);
    if (status) return status;
    r->part->ranges_known = true;
    r->job.active_count = r->head[HEAD_ACTIVE];
    r->job.active_tiles = (r->job.active_count + r->job.tile_actives - 1) / r->job.tile_actives;
    return r->job.active_count ? active_list(r) : TC_OK;
}

/* ----------------------------------------------------------------------------------------------------------- cases */

tc_status active_cells_take(complex_run *r, active_cell **cells) {
    const size_t bytes = sizeof **cells * (size_t)r->job.active_count;
    cl_command_queue queue = r->context->queue;
    cl_mem memory = r->work->active.memory;
    cl_int error = CL_SUCCESS;
    if (r->context->in_place) {
        *cells =
            cl->EnqueueMapBuffer(queue, memory, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes, 0, NULL, NULL, &error);
    } else {
        *cells = malloc(bytes);
        if (!*cells)
            return (tc_status)fail(TC_ERROR_MEMORY, "no memory for %lu active cells",
                                   (unsigned long)r->job.active_count);
        error = cl->EnqueueReadBuffer(queue, memory, CL_TRUE, 0, bytes, *cells, 0, NULL, NULL);
        if (error) free(*cells);
    }
    if (error) *cells = NULL;
    return error ? context_fail(r->context, "reading the active cells back", error) : TC_OK;
}

tc_status active_cells_give(complex_run *r, active_cell *cells) {
    const size_t bytes = sizeof *cells * (size_t)r->job.active_count;
    cl_command_queue queue = r->context->queue;
    cl_mem memory = r->work->active.memory;
    if (!cells) return TC_OK;
    if (r->context->in_place) {
        cl_int error = cl->EnqueueUnmapMemObject(queue, memory, cells, 0, NULL, NULL);
        return error ? context_fail(r->context, "giving the active cells back", error) : TC_OK;
    }
    cl_int error = cl->EnqueueWriteBuffer(queue, memory, CL_TRUE, 0, bytes, cells, 0, NULL, NULL);
    free(cells);
    return error ? context_fail(r->context, "giving the active cells back", error) : TC_OK;
}

/* Brings the table of cases to the device, where it has grown. */
static tc_status cases_upload(complex_run *r) {
    tc_context *context = r->context;
    device_buffer *buffer = &r->work->whole_cases;
    uint64_t bytes;
    const uint8_t *cases = whole_cases_bytes(context->whole_cases, &bytes);
    if (buffer->memory && context->whole_case_bytes == bytes) return TC_OK;
    tc_status status = surface_reserve(r, buffer, bytes, "the cases of cells");
    if (status) return status;
    cl_int error = cl->EnqueueWriteBuffer(context->queue, buffer->memory, CL_TRUE, 0, bytes, cases, 0, NULL, NULL);
    context->whole_case_bytes = error ? 0 : bytes;
    return error ? context_fail(context, "uploading the cases of cells", error) : TC_OK;
}

tc_status whole_choose(complex_run *r, bool *differ) {
    active_cell *cells;
    uint64_t edges = 0;
    tc_status status = active_cells_take(r, &cells);
    if (status) return status;
    status = whole_assign(r->context, r->grid, cells, r->job.active_count, NULL, &edges, differ);
    tc_status given = active_cells_give(r, cells);
    if (!status) status = given;
    if (!status && !*differ && edges > UINT32_MAX)
        status = (tc_status)fail(TC_ERROR_LIMIT, "%llu edges of active cells: cut the grid into parts",
                                 (unsigned long long)edges);
    r->head[HEAD_CROSSED] = (uint32_t)edges;
    return status || *differ ? status : cases_upload(r);
}

/* ----------------------------------------------------------------------------------------------------------- edges */

/* Enters all edges, and then the diagonals that are edges, in a cleared table. */
static tc_status edges_enter(complex_run *r, uint64_t entries) {
    complex_buffers *w = r->work;
    tc_status status = surface_table_reserve(r, entries);
    if (status) return status;
    const kernel_argument clear[] = {ARGUMENT(r->job), ARGUMENT(w->table.memory), ARGUMENT(w->tiles.memory)};
    const kernel_argument join[] = {
        ARGUMENT(r->job),          ARGUMENT(w->active.memory), ARGUMENT(w->whole_cases.memory),
        ARGUMENT(w->state.memory), ARGUMENT(w->table.memory),  ARGUMENT(w->entries.memory)};
    status = LAUNCH(r, KERNEL_CLEAR, clear);
    if (!status) status = LAUNCH(r, KERNEL_JOIN, join);
    if (!status) status = LAUNCH(r, KERNEL_CUT, join);
    const uint32_t crossed = r->head[HEAD_CROSSED];
    if (!status) status = surface_head_read(r);
    r->head[HEAD_CROSSED] = crossed;
    return status;
}

static tc_status cut_cells_choose(complex_run *r) {
    active_cell *cells;
    if (!r->head[HEAD_CUT]) return TC_OK;
    tc_status status = active_cells_take(r, &cells);
    if (status) return status;
    status = whole_assign_cut(r->context, cells, r->job.active_count);
    tc_status given = active_cells_give(r, cells);
    if (!status) status = given;
    return status ? status : cases_upload(r);
}

static tc_status vertices_number(complex_run *r) {
    complex_buffers *w = r->work;
    const kernel_argument number[] = {
        ARGUMENT(r->job),           ARGUMENT(w->active.memory), ARGUMENT(w->whole_cases.memory),
        ARGUMENT(w->state.memory),  ARGUMENT(w->tiles.memory),  ARGUMENT(w->table.memory),
        ARGUMENT(w->entries.memory)};
    tc_status status = LAUNCH(r, KERNEL_NUMBER, number);
    return status ? status : surface_head_read(r);
}

/* The table's size is chosen as for tetrahedra; most edges have four cells. */
tc_status whole_number(complex_run *r) {
    complex_buffers *w = r->work;
    uint64_t entries = 64;
    while (2 * entries < r->head[HEAD_CROSSED]) entries *= 2;
    tc_status status =
        surface_reserve(r, &w->entries, (4ull << r->job.slot_shift) * r->job.active_count, "crossed edges");
    if (!status) status = surface_reserve(r, &w->tiles, 4ull * TILE_WORDS * r->job.active_tiles, "the scan");
    if (!status) status = edges_enter(r, entries);
    if (!status && r->head[HEAD_FULL]) {
        while (entries < 2ull * r->head[HEAD_CROSSED]) entries *= 2;
        status = surface_fill(r, &w->state, 0, 4 * (HEAD_TICKETS + KERNEL_JOIN), 4 * (KERNEL_CUT - KERNEL_JOIN + 1));
        if (!status) status = surface_fill(r, &w->state, 0, 4 * HEAD_FULL, 8); /* HEAD_CUT too */
        if (!status) status = edges_enter(r, entries);
    }
    if (!status) status = cut_cells_choose(r);
    return status ? status : vertices_number(r);
}

/* -------------------------------------------------------------------------------------------------------- emission */

tc_status whole_emit(complex_run *r, const device_buffer *positions, const device_buffer *triangles) {
    const complex_buffers *w = r->work;
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->part->samples.memory),
                                         ARGUMENT(r->part->points.memory),
                                         ARGUMENT(w->active.memory),
                                         ARGUMENT(w->whole_cases.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->tiles.memory),
                                         ARGUMENT(w->table.memory),
                                         ARGUMENT(w->entries.memory),
                                         ARGUMENT(positions->memory),
                                         ARGUMENT(triangles->memory)};
    tc_status status = LAUNCH(r, KERNEL_EMIT, arguments);
    cl_int error = cl->Finish(r->context->queue);
    return !status && error ? context_fail(r->context, kernel_names[KERNEL_EMIT], error) : status;
}
