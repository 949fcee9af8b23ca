/*
 * Complexes on a device: classify and list, join and number the crossed edges, allocate, emit.
 *
 * The host waits twice: for the number of active tetrahedra, which lists and the table of edges are sized by, and for
 * that of the vertices. Everything but the complex itself is proportional to the surface.
 */
#include "complex.h"

#include "failure.h"
#include "tables.h"

#include <stdlib.h>
#include <string.h>

static const uintptr_t page_bytes = 4096;

typedef struct complex_run {
    tc_grid *grid;
    complex_grid *complex;
    tc_context *context;
    complex_buffers *work;
    cl_kernel const *kernels;
    slab s; /* the isovalue's part */
    complex_job job;
    uint32_t head[HEAD_WORDS];
    double start_ms; /* kernels are built by then */
} complex_run;

/* ---------------------------------------------------------------------------------------------------------- buffers */

/* Whether so many bytes more are within what the device and the caller allow. */
static tc_status bytes_check(const tc_context *context, uint64_t bytes, const char *name) {
    const uint64_t budget = context->options.max_memory_bytes, most = context->info.max_buffer_bytes;
    if (bytes > most)
        return (tc_status)fail(TC_ERROR_MEMORY,
                               "the complex needs a device buffer of %llu bytes for %s, and %s allows %llu: cut it "
                               "into parts, or use the reference engine",
                               (unsigned long long)bytes, name, context->info.name, (unsigned long long)most);
    if (budget && context->device_bytes + bytes > budget)
        return (tc_status)fail(TC_ERROR_MEMORY,
                               "the complex needs %llu bytes for %s on top of %llu, and the memory budget is %llu; "
                               "complexes are not cut into slabs",
                               (unsigned long long)bytes, name, (unsigned long long)context->device_bytes,
                               (unsigned long long)budget);
    return TC_OK;
}

static tc_status work_reserve(tc_context *context, device_buffer *buffer, uint64_t bytes, const char *name) {
    if (buffer->memory && bytes <= buffer->bytes) return TC_OK;
    buffer_release(context, buffer);
    tc_status status = bytes_check(context, bytes, name);
    return status ? status : buffer_reserve(context, buffer, bytes, name);
}

/* An array of the caller's: in place from its page's boundary on, else copied. *offset in items. */
static tc_status array_provide(tc_context *context, device_buffer *buffer, const void *array, uint64_t bytes,
                               size_t item_bytes, uint64_t *offset, const char *name) {
    uintptr_t before = context->in_place ? (uintptr_t)array & (page_bytes - 1) : 0;
    tc_status status = bytes_check(context, before + bytes, name);
    *offset = before / item_bytes;
    if (status) return status;
    if (context->in_place)
        return buffer_wrap(context, buffer, (char *)(uintptr_t)array - before, before + bytes, CL_MEM_READ_ONLY, name);
    status = buffer_reserve(context, buffer, bytes, name);
    if (status) return status;
    cl_int error = cl->EnqueueWriteBuffer(context->queue, buffer->memory, CL_TRUE, 0, bytes, array, 0, NULL, NULL);
    return error ? context_fail(context, "copying the complex to the device", error) : TC_OK;
}

static uint32_t cluster_count(const complex_grid *c) {
    return (c->tetrahedron_count + CLUSTER_TETRAHEDRA - 1) / CLUSTER_TETRAHEDRA;
}

tc_status complex_device_create(tc_grid *grid) {
    complex_grid *c = grid->complex;
    tc_context *context = grid->context;
    const size_t sample_bytes = tc_type_bytes(grid->type);
    const uint64_t points = c->point_count, tetrahedra = c->tetrahedron_count;
    if (!device_makes_vertices(context, grid->type))
        return (tc_status)fail(TC_ERROR_DEVICE,
                               "%s has no fp64, which complexes with %s samples need: use the reference engine",
                               context->info.name, tc_type_name(grid->type));
    if (context->options.max_memory_bytes) workspace_release(context); /* what another grid has left */
    tc_status status = array_provide(context, &c->tetrahedron_buffer, c->tetrahedra, 16 * tetrahedra, 4,
                                     &c->tetrahedron_offset, "tetrahedra");
    if (!status)
        status = array_provide(context, &c->point_buffer, c->points, 12 * points, 4, &c->point_offset, "points");
    if (!status)
        status = array_provide(context, &c->sample_buffer, grid->samples, sample_bytes * points, sample_bytes,
                               &c->sample_offset, "samples");
    if (!status) status = work_reserve(context, &c->ranges, sizeof(brick_range) * (uint64_t)cluster_count(c), "ranges");
    return status;
}

/* Bytes of the table that drives the kernels, from the 16 cases. */
static void cases_write(uint8_t cases[16][CASE_BYTES]) {
    memset(cases, 0, 16 * CASE_BYTES);
    for (unsigned pattern = 0; pattern < 16; pattern++) {
        const tetrahedron_case *c = &tetrahedron_cases[pattern];
        uint8_t *row = cases[pattern], places[6] = {0};
        for (unsigned e = 0; e < 6; e++) {
            const uint8_t *ends = tetrahedron_edges[e];
            if ((pattern >> ends[0] & 1) == (pattern >> ends[1] & 1)) continue;
            places[e] = row[CASE_EDGES]++;
            memcpy(row + CASE_ENDS + 2 * places[e], ends, 2);
        }
        row[CASE_TRIANGLES] = c->triangle_count;
        for (unsigned n = 0; n < 3u * c->triangle_count; n++)
            row[CASE_CORNERS + n] = places[c->triangles[n / 3][n % 3]];
    }
}

/* Uploaded once per context. */
static tc_status cases_provide(tc_context *context, device_buffer *buffer) {
    uint8_t cases[16][CASE_BYTES];
    if (buffer->memory) return TC_OK;
    tc_status status = buffer_reserve(context, buffer, sizeof cases, "the case table");
    if (status) return status;
    cases_write(cases);
    cl_int error =
        cl->EnqueueWriteBuffer(context->queue, buffer->memory, CL_TRUE, 0, sizeof cases, cases, 0, NULL, NULL);
    return error ? context_fail(context, "uploading the case table", error) : TC_OK;
}

/* --------------------------------------------------------------------------------------------------------- commands */

typedef struct kernel_argument {
    size_t bytes;
    const void *value;
} kernel_argument;

#define ARGUMENT(x)                                                                                                    \
    { sizeof(x), &(x) }

static tc_status kernel_run(const complex_run *r, int kernel, const char *name, const kernel_argument *arguments,
                            cl_uint count) {
    const size_t local = r->context->options.work_items, global = local * r->context->options.work_groups;
    cl_int error = CL_SUCCESS;
    for (cl_uint n = 0; n < count && !error; n++)
        error = cl->SetKernelArg(r->kernels[kernel], n, arguments[n].bytes, arguments[n].value);
    if (!error)
        error =
            cl->EnqueueNDRangeKernel(r->context->queue, r->kernels[kernel], 1, NULL, &global, &local, 0, NULL, NULL);
    return error ? context_fail(r->context, name, error) : TC_OK;
}

static tc_status buffer_fill(const complex_run *r, const device_buffer *buffer, cl_uint value, uint64_t first,
                             uint64_t bytes) {
    cl_int error =
        cl->EnqueueFillBuffer(r->context->queue, buffer->memory, &value, sizeof value, first, bytes, 0, NULL, NULL);
    return error ? context_fail(r->context, "clearing a buffer", error) : TC_OK;
}

static tc_status head_read(complex_run *r) {
    cl_int error = cl->EnqueueReadBuffer(r->context->queue, r->work->state.memory, CL_TRUE, 0, sizeof r->head, r->head,
                                         0, NULL, NULL);
    return error ? context_fail(r->context, "reading totals", error) : TC_OK;
}

/* --------------------------------------------------------------------------------------------------- classification */

static void run_describe(complex_run *r, tc_grid *grid, double isovalue) {
    const complex_grid *c = grid->complex;
    const tc_context_options *o = &grid->context->options;
    const inside_range inside = inside_range_of(grid->type, isovalue);
    *r = (complex_run){.grid = grid, .complex = grid->complex, .context = grid->context};
    r->work = &grid->context->work.complex;
    r->s.inside_low = inside.low;
    r->s.inside_span = inside.span;
    r->s.key_flip = inside.key_flip;
    r->s.key_inside = inside.key_inside;
    r->s.key_outside = inside.key_outside;
    r->s.ranges_known = c->ranges_known;
    r->s.spin_limit = o->spin_limit;
    r->s.isovalue32 = (float)isovalue;
    memcpy(&r->s.isovalue64, &isovalue, sizeof isovalue);
    r->job = (complex_job){.sample_offset = c->sample_offset,
                           .point_offset = c->point_offset,
                           .tetrahedron_offset = c->tetrahedron_offset,
                           .point_count = c->point_count,
                           .tetrahedron_count = c->tetrahedron_count,
                           .cluster_count = cluster_count(c)};
    const uint32_t tile = o->tile_bricks ? o->tile_bricks : o->work_items == 1 ? 1024 : 64;
    r->job.tile_clusters = o->work_items > tile ? o->work_items : tile;
    r->job.tile_actives = o->work_items == 1 && !o->tile_bricks ? 1024 : r->job.tile_clusters;
    r->job.cluster_tiles = (r->job.cluster_count + r->job.tile_clusters - 1) / r->job.tile_clusters;
}

static tc_status run_begin(complex_run *r, tc_grid *grid, double isovalue) {
    run_describe(r, grid, isovalue);
    tc_context *context = r->context;
    context->counted = NULL;
    tc_status status = complex_kernels_get(context, grid, &r->kernels);
    r->start_ms = clock_ms();
    if (status) return status;
    if (context->served != grid && context->options.max_memory_bytes) {
        cl->Finish(context->queue);
        workspace_release(context);
    }
    context->served = grid;
    status = cases_provide(context, &r->work->cases);
    if (!status)
        status = work_reserve(context, &r->work->clusters, sizeof(cluster_state) * (uint64_t)r->job.cluster_count,
                              "clusters");
    if (!status)
        status = work_reserve(context, &r->work->active_clusters, 4ull * r->job.cluster_count, "active clusters");
    const uint64_t state_bytes = 4 * (HEAD_WORDS + (uint64_t)TILE_WORDS * r->job.cluster_tiles);
    if (!status) status = work_reserve(context, &r->work->state, state_bytes, "the scan");
    return status ? status : buffer_fill(r, &r->work->state, 0, 0, state_bytes);
}

static tc_status classify(complex_run *r) {
    const complex_buffers *w = r->work;
    const kernel_argument arguments[] = {ARGUMENT(r->s),
                                         ARGUMENT(r->job),
                                         ARGUMENT(r->complex->sample_buffer.memory),
                                         ARGUMENT(r->complex->tetrahedron_buffer.memory),
                                         ARGUMENT(r->complex->ranges.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->active_clusters.memory),
                                         ARGUMENT(w->state.memory)};
    tc_status status = kernel_run(r, KERNEL_CLASSIFY, "kernel complex_classify", arguments, 8);
    if (!status) status = head_read(r);
    if (!status && r->head[HEAD_INVALID]) status = complex_point_fail(r->complex);
    if (status) return status;
    r->complex->ranges_known = true;
    r->job.active_count = r->head[HEAD_ACTIVE];
    r->job.active_tiles = (r->job.active_count + r->job.tile_actives - 1) / r->job.tile_actives;
    return TC_OK;
}

/* ------------------------------------------------------------------------------------------------------------ edges */

/* Clears the table and the tiles of the numbering, too. */
static tc_status active_list(complex_run *r) {
    complex_buffers *w = r->work;
    tc_status status = work_reserve(r->context, &w->active, sizeof(active_tetrahedron) * (uint64_t)r->job.active_count,
                                    "active tetrahedra");
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->complex->tetrahedron_buffer.memory),
                                         ARGUMENT(w->clusters.memory),
                                         ARGUMENT(w->active_clusters.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(w->active.memory),
                                         ARGUMENT(w->table.memory),
                                         ARGUMENT(w->tiles.memory)};
    return status ? status : kernel_run(r, KERNEL_LIST, "kernel complex_list", arguments, 9);
}

static tc_status table_reserve(complex_run *r, uint64_t entries) {
    r->job.table_mask = (uint32_t)(entries - 1);
    r->job.probe_limit = entries >= 2ull * r->head[HEAD_CROSSED] ? r->job.table_mask : 256;
    return work_reserve(r->context, &r->work->table, 4 * entries, "the table of edges");
}

/* A larger table, and all else that an attempt with one too small has left behind. */
static tc_status table_enlarge(complex_run *r, uint64_t entries) {
    tc_status status = table_reserve(r, entries);
    if (!status) status = buffer_fill(r, &r->work->table, EDGE_NONE, 0, 4 * entries);
    if (!status) status = buffer_fill(r, &r->work->state, 0, 4 * (HEAD_TICKETS + KERNEL_JOIN), 8);
    if (!status) status = buffer_fill(r, &r->work->state, 0, 4 * HEAD_FULL, 4);
    return status ? status : buffer_fill(r, &r->work->tiles, 0, 0, 4ull * TILE_WORDS * r->job.active_tiles);
}

/* Enters the crossed edges into the table and numbers their vertices. */
static tc_status edges_join(complex_run *r) {
    complex_buffers *w = r->work;
    const kernel_argument join[] = {ARGUMENT(r->job),          ARGUMENT(w->active.memory), ARGUMENT(w->cases.memory),
                                    ARGUMENT(w->state.memory), ARGUMENT(w->table.memory),  ARGUMENT(w->entries.memory)};
    const kernel_argument number[] = {ARGUMENT(r->s),
                                      ARGUMENT(r->job),
                                      ARGUMENT(w->active.memory),
                                      ARGUMENT(w->cases.memory),
                                      ARGUMENT(w->state.memory),
                                      ARGUMENT(w->tiles.memory),
                                      ARGUMENT(w->table.memory),
                                      ARGUMENT(w->entries.memory)};
    tc_status status = kernel_run(r, KERNEL_JOIN, "kernel complex_join", join, 6);
    if (!status) status = kernel_run(r, KERNEL_NUMBER, "kernel complex_number", number, 8);
    return status ? status : head_read(r);
}

/* In most complexes an edge has five tetrahedra: a table half as large as the crossed edges, each counted for every
 * tetrahedron, is then less than half full. Where it does not do, one that always does. */
static tc_status edges_number(complex_run *r) {
    complex_buffers *w = r->work;
    uint64_t entries = 64;
    while (2 * entries < r->head[HEAD_CROSSED]) entries *= 2;
    tc_status status = work_reserve(r->context, &w->entries, 16ull * r->job.active_count, "crossed edges");
    if (!status) status = work_reserve(r->context, &w->tiles, 4ull * TILE_WORDS * r->job.active_tiles, "the scan");
    if (!status) status = table_reserve(r, entries);
    if (!status) status = active_list(r);
    if (!status) status = edges_join(r);
    if (status || !r->head[HEAD_FULL]) return status;
    while (entries < 2ull * r->head[HEAD_CROSSED]) entries *= 2;
    status = table_enlarge(r, entries);
    if (!status) status = edges_join(r);
    return status;
}

/* What the workspace holds after a failure may not be what it is taken for. */
static tc_status run_end(const complex_run *r, tc_status status) {
    cl->Finish(r->context->queue);
    if (status) workspace_release(r->context);
    return status;
}

/* All but the mesh; head has the counts then. */
static tc_status surface_count(complex_run *r, tc_grid *grid, double isovalue, double share) {
    tc_status status = run_begin(r, grid, isovalue);
    if (!status) status = classify(r);
    if (!status) status = context_progress(r->context, "classify", 0.6 * share);
    if (!status && r->job.active_count) status = edges_number(r);
    return status ? status : context_progress(r->context, "classify", share);
}

tc_status complex_device_count(tc_grid *grid, double isovalue, tc_counts *counts) {
    complex_run r;
    tc_status status = surface_count(&r, grid, isovalue, 1);
    counts->vertex_count = r.head[HEAD_VERTICES];
    counts->triangle_count = r.head[HEAD_TRIANGLES];
    counts->active_cell_count = r.job.active_count;
    counts->classify_ms = clock_ms() - r.start_ms;
    return run_end(&r, status);
}

/* ------------------------------------------------------------------------------------------------------- extraction */

static tc_status mesh_open(complex_run *r, device_buffer *buffer, const host_block *block, uint64_t bytes,
                           const char *name) {
    buffer_release(r->context, buffer);
    tc_status status = bytes_check(r->context, bytes, name);
    if (status) return status;
    return r->context->in_place ? buffer_wrap(r->context, buffer, block->memory, bytes, CL_MEM_READ_WRITE, name)
                                : buffer_reserve(r->context, buffer, bytes, name);
}

/* Brings what the device wrote to the host: a copy, or a map that makes it seen. */
static tc_status mesh_close(complex_run *r, device_buffer *buffer, const host_block *block, uint64_t bytes) {
    cl_command_queue queue = r->context->queue;
    cl_int error = CL_SUCCESS;
    if (!r->context->in_place) {
        error = cl->EnqueueReadBuffer(queue, buffer->memory, CL_TRUE, 0, bytes, block->memory, 0, NULL, NULL);
        return error ? context_fail(r->context, "reading the mesh back", error) : TC_OK;
    }
    void *mapped = cl->EnqueueMapBuffer(queue, buffer->memory, CL_TRUE, CL_MAP_READ, 0, bytes, 0, NULL, NULL, &error);
    if (!error) error = cl->EnqueueUnmapMemObject(queue, buffer->memory, mapped, 0, NULL, NULL);
    cl->Finish(queue);
    buffer_release(r->context, buffer);
    return error ? context_fail(r->context, "reading the mesh back", error) : TC_OK;
}

static tc_status emit(complex_run *r, tc_mesh *mesh) {
    complex_buffers *w = r->work;
    mesh_buffers *m = &r->context->work.mesh[0];
    const uint64_t vertex_bytes = mesh->vertex_count * MESH_BYTES_PER_VERTEX;
    const uint64_t triangle_bytes = mesh->triangle_count * MESH_BYTES_PER_TRIANGLE;
    tc_status status = mesh_open(r, &m->positions, &mesh->positions, vertex_bytes, "vertices");
    if (!status) status = mesh_open(r, &m->triangles, &mesh->triangles, triangle_bytes, "triangles");
    const kernel_argument arguments[] = {ARGUMENT(r->s),
                                         ARGUMENT(r->job),
                                         ARGUMENT(r->complex->sample_buffer.memory),
                                         ARGUMENT(r->complex->point_buffer.memory),
                                         ARGUMENT(w->active.memory),
                                         ARGUMENT(w->cases.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->tiles.memory),
                                         ARGUMENT(w->table.memory),
                                         ARGUMENT(w->entries.memory),
                                         ARGUMENT(m->positions.memory),
                                         ARGUMENT(m->triangles.memory)};
    if (!status) status = kernel_run(r, KERNEL_EMIT, "kernel complex_emit", arguments, 12);
    cl_int error = cl->Finish(r->context->queue);
    if (!status && error) status = context_fail(r->context, "kernel complex_emit", error);
    double emitted = clock_ms();
    if (!status) status = mesh_close(r, &m->positions, &mesh->positions, vertex_bytes);
    if (!status) status = mesh_close(r, &m->triangles, &mesh->triangles, triangle_bytes);
    if (!r->context->in_place) mesh->timings.readback_ms = clock_ms() - emitted;
    return status;
}

tc_status complex_device_extract(tc_grid *grid, double isovalue, tc_mesh *mesh) {
    complex_run r;
    tc_status status = surface_count(&r, grid, isovalue, 0.8);
    double classified = clock_ms();
    if (!status) status = mesh_allocate(mesh, r.head[HEAD_VERTICES], r.head[HEAD_TRIANGLES], false);
    if (!status && r.head[HEAD_TRIANGLES]) status = emit(&r, mesh);
    if (!status) status = context_progress(r.context, "emit", 1);
    mesh->active_cell_count = r.job.active_count;
    mesh->timings.classify_ms = classified - r.start_ms;
    mesh->timings.total_ms = clock_ms() - r.start_ms - mesh->timings.readback_ms;
    mesh->timings.emit_ms = mesh->timings.total_ms - mesh->timings.classify_ms;
    return run_end(&r, status);
}
