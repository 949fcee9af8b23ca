/*
 * Complexes on a device: in one go where the device has room (count, allocate the mesh, emit); else slab by slab, from
 * then on always. What methods do otherwise is in their complex_method.
 */
#include "tetrahedra/complex_caps.h"
#include "tetrahedra/whole_run.h"

#include "failure.h"

#include <stdlib.h>

tc_status complex_device_create(tc_grid *grid) {
    const complex_grid *c = grid->complex;
    tc_context *context = grid->context;
    if (!device_makes_vertices(context, grid->type))
        return (tc_status)fail(TC_ERROR_DEVICE,
                               "%s has no fp64, which tetrahedra with %s samples need: use the reference engine",
                               context->info.name, tc_type_name(grid->type));
    if (context->options.max_memory_bytes) workspace_release(context); /* what another grid has left */
    if (!complex_fits(grid)) return complex_cut(grid);
    return c->has_cells ? TC_OK : complex_arrays_provide(grid); /* by method hybrid they may not be needed */
}

tc_status complex_arrays_provide(tc_grid *grid) {
    complex_grid *c = grid->complex;
    if (c->part.tetrahedra.memory && c->part.points.memory) return TC_OK;
    c->part.ranges_known = false;
    tc_status status = part_tetrahedra_provide(grid, c->tetrahedra, c->tetrahedron_count);
    return status ? status : part_points_provide(grid, c->points, grid->samples, c->point_count);
}

void complex_device_destroy(tc_grid *grid) {
    struct complex_slabs *slabs = grid->complex->slabs;
    if (grid->context->workspace_grid == grid) grid->context->workspace_grid = NULL;
    part_tetrahedra_release(grid);
    part_points_release(grid);
    whole_cells_release(grid);
    for (int n = 0; n < 2; n++) border_list_release(grid->context, grid->complex->borders[n]);
    if (grid->context->classified_grid == grid) grid->context->classified_grid = NULL;
    if (slabs) edge_numbers_release(&slabs->edges);
    complex_slabs_release(slabs);
    complex_slabs_release(grid->complex->interval_slabs);
}

/* Cuts a complex into slabs that the device has held whole so far, as its surface does not fit. */
static tc_status tetrahedra_cut(complex_run *r) {
    cl->Finish(r->context->queue);
    tc_status status = complex_cut(r->grid);
    if (status) return status;
    part_tetrahedra_release(r->grid);
    part_points_release(r->grid);
    r->context->workspace_grid = NULL; /* the workspace is too large */
    return TC_OK;
}

/* All stages before emission; head has the counts then. */
static tc_status tetrahedra_count(complex_run *r, tc_grid *grid, const tc_extract_options *options, double share) {
    tc_status status = complex_run_begin(r, grid, options);
    if (!status) status = surface_classify(r);
    if (!status) status = context_progress(r->context, "classify", 0.6 * share);
    if (!status && r->job.active_count) status = surface_number(r);
    return status ? status : context_progress(r->context, "classify", share);
}

static bool is_cut(const tc_grid *grid) { return grid->complex->slabs != NULL; }

static const complex_method method_tetrahedra = {.method = TC_METHOD_TETRA,
                                                 .is_cut = is_cut,
                                                 .count = tetrahedra_count,
                                                 .emit = surface_emit,
                                                 .cut = tetrahedra_cut,
                                                 .slabs_count = complex_slabs_count,
                                                 .slabs_extract = complex_slabs_extract};

static const complex_method *method_of(tc_method method) {
    return method == TC_METHOD_HYBRID ? &method_cells : &method_tetrahedra;
}

/* Of the surface and, where it is closed, the border. */
static uint64_t vertex_count_of(const complex_run *r) {
    return (uint64_t)r->head[HEAD_VERTICES] + r->head[HEAD_CAP_VERTICES];
}

static uint64_t triangle_count_of(const complex_run *r) {
    return (uint64_t)r->head[HEAD_TRIANGLES] + r->head[HEAD_CAP_TRIANGLES];
}

static tc_status stages_count(complex_run *r, const complex_method *m, tc_grid *grid, const tc_extract_options *options,
                              double share) {
    tc_status status = m->count(r, grid, options, share);
    return status || !options->closed ? status : caps_count(r, options);
}

static void surface_note(const complex_run *r, const tc_extract_options *options) {
    complex_classified_note(r->grid, options,
                            (surface_size){.vertex_count = vertex_count_of(r),
                                           .cap_vertices = r->head[HEAD_CAP_VERTICES],
                                           .active_count = r->job.active_count,
                                           .tile_actives = r->job.tile_actives});
}

tc_status complex_device_count(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts) {
    const complex_method *m = method_of(options->method);
    complex_run r;
    if (m->is_cut(grid)) return m->slabs_count(grid, options, 0, share, counts);
    tc_status status = stages_count(&r, m, grid, options, share);
    if (r.too_large) {
        status = m->cut(&r);
        return status ? status : m->slabs_count(grid, options, 0.6 * share, share, counts);
    }
    counts->vertex_count = vertex_count_of(&r);
    counts->triangle_count = triangle_count_of(&r);
    counts->active_cell_count = r.job.active_count;
    counts->classify_ms = clock_ms() - r.start_ms;
    cl->Finish(r.context->queue);
    if (!status) surface_note(&r, options);
    return status;
}

/* ------------------------------------------------------------------------------------------------------- extraction */

static tc_status mesh_open(complex_run *r, device_buffer *buffer, const host_block *block, uint64_t bytes,
                           const char *name) {
    buffer_release(r->context, buffer);
    if (!surface_fits(r, bytes))
        return (tc_status)fail(TC_ERROR_MEMORY, "the grid of tetrahedra has no room for its %s", name);
    return r->context->in_place ? buffer_wrap(r->context, buffer, block->memory, bytes, CL_MEM_READ_WRITE, name)
                                : buffer_reserve(r->context, buffer, bytes, name);
}

/* Brings what the device wrote to the host: by a copy, or by a map where memory is shared. */
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

static tc_status mesh_emit(complex_run *r, const complex_method *method, tc_mesh *mesh) {
    mesh_buffers *m = &r->context->work.mesh[0];
    const uint64_t vertex_bytes = mesh->vertex_count * CHANNEL_BYTES;
    const uint64_t triangle_bytes = mesh->triangle_count * TRIANGLE_BYTES;
    tc_status status =
        mesh_open(r, &m->channels[CHANNEL_POSITIONS], &mesh->channels[CHANNEL_POSITIONS], vertex_bytes, "positions");
    if (!status) status = mesh_open(r, &m->triangles, &mesh->triangles, triangle_bytes, "triangles");
    if (!status && r->head[HEAD_TRIANGLES]) status = method->emit(r, &m->channels[CHANNEL_POSITIONS], &m->triangles);
    if (!status && r->border) status = caps_emit(r, &m->channels[CHANNEL_POSITIONS], &m->triangles);
    double emitted = clock_ms();
    if (!status)
        status = mesh_close(r, &m->channels[CHANNEL_POSITIONS], &mesh->channels[CHANNEL_POSITIONS], vertex_bytes);
    if (!status) status = mesh_close(r, &m->triangles, &mesh->triangles, triangle_bytes);
    if (!r->context->in_place) mesh->timings.readback_ms = clock_ms() - emitted;
    return status;
}

tc_status complex_device_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh) {
    const complex_method *m = method_of(options->method);
    complex_run r;
    if (m->is_cut(grid)) return m->slabs_extract(grid, options, 0, mesh);
    tc_status status = stages_count(&r, m, grid, options, 0.8);
    double classified = clock_ms();
    if (!status) status = mesh_allocate(mesh, vertex_count_of(&r), triangle_count_of(&r), POSITIONS_ALONE);
    if (!status && mesh->triangle_count) status = mesh_emit(&r, m, mesh);
    if (r.too_large) {
        status = m->cut(&r);
        return status ? status : m->slabs_extract(grid, options, 0.8, mesh);
    }
    if (!status) status = context_progress(r.context, "emit", 1);
    mesh->active_cell_count = r.job.active_count;
    mesh->timings.classify_ms = classified - r.start_ms;
    mesh->timings.total_ms = clock_ms() - r.start_ms - mesh->timings.readback_ms;
    mesh->timings.emit_ms = mesh->timings.total_ms - mesh->timings.classify_ms;
    cl->Finish(r.context->queue);
    if (!status) surface_note(&r, options);
    return status;
}
