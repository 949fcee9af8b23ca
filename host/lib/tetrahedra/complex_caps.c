/*
 * Closed surfaces of complexes by kernels: the border is brought to the device, and stays there with the other arrays.
 */
#include "tetrahedra/complex_caps.h"

#include "failure.h"
#include "tetrahedra/whole_run.h"

/* Sums of the scan take 30 bits, and a face has up to four triangles. */
static const uint64_t items_most = UINT64_C(1) << 28;

tc_status caps_border_get(tc_grid *grid, tc_method method, border_list **out) {
    const bool keeps_cells = method == TC_METHOD_HYBRID;
    tc_status status = border_list_provide(grid, keeps_cells, &grid->complex->borders[keeps_cells]);
    *out = grid->complex->borders[keeps_cells];
    return status;
}

/* Where a surface has no crossed edges, others stand in for the buffers of these, which nothing is read from. */
static const cl_mem *memory_of(const complex_run *r, const device_buffer *buffer) {
    return buffer->memory ? &buffer->memory : &r->work->state.memory;
}

static const cl_mem *cases_of(const complex_run *r) {
    return memory_of(r, r->keeps_cells ? &r->work->whole_cases : &r->work->cases);
}

static tc_status border_load(complex_run *r) {
    border_list *b = r->border;
    const uint64_t point_bytes = sizeof *b->points * b->point_count, face_bytes = sizeof *b->faces * b->face_count;
    if (b->faces_buffer.memory) return TC_OK;
    if (b->point_count > items_most || b->face_count > items_most) r->too_large = true;
    if (r->too_large || !surface_fits(r, point_bytes + face_bytes + 2 * PAGE_BYTES))
        return (tc_status)fail(TC_ERROR_MEMORY, "the grid of tetrahedra has no room for its border");
    tc_status status = buffer_provide(r->context, &b->points_buffer, b->points, point_bytes, sizeof *b->points,
                                      &b->point_offset, "points of the border");
    return status ? status
                  : buffer_provide(r->context, &b->faces_buffer, b->faces, face_bytes, sizeof *b->faces,
                                   &b->face_offset, "faces of the border");
}

static void job_describe(complex_run *r) {
    const border_list *b = r->border;
    const uint64_t most = b->point_count > b->face_count ? b->point_count : b->face_count;
    r->job.cap_point_offset = b->point_offset;
    r->job.cap_face_offset = b->face_offset;
    r->job.cap_points = (uint32_t)b->point_count;
    r->job.cap_faces = (uint32_t)b->face_count;
    r->job.tile_caps = complex_tile_actives(r->grid);
    r->job.cap_tiles = (uint32_t)((most + r->job.tile_caps - 1) / r->job.tile_caps);
}

static tc_status count_launch(complex_run *r) {
    complex_buffers *w = r->work;
    const border_list *b = r->border;
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->part->samples.memory),
                                         ARGUMENT(b->points_buffer.memory),
                                         ARGUMENT(b->faces_buffer.memory),
                                         ARGUMENT(*memory_of(r, &w->active)),
                                         ARGUMENT(*cases_of(r)),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(*memory_of(r, &w->table)),
                                         ARGUMENT(w->cap_tiles.memory),
                                         ARGUMENT(w->cap_numbers.memory),
                                         ARGUMENT(w->cap_firsts.memory)};
    tc_status status = kernel_launch(r->context, r->kernels[KERNEL_CAPS_COUNT], "kernel caps_count", arguments,
                                     sizeof arguments / sizeof *arguments);
    return status ? status : surface_head_read(r);
}

tc_status caps_count(complex_run *r, const tc_extract_options *options) {
    complex_buffers *w = r->work;
    tc_status status = caps_border_get(r->grid, options->method, &r->border);
    if (status || r->border->greatest < options->isovalue) return status;
    status = border_load(r);
    if (status) return status;
    job_describe(r);
    const uint64_t tile_bytes = 4ull * TILE_WORDS * r->job.cap_tiles;
    status = surface_reserve(r, &w->cap_tiles, tile_bytes, "the scan");
    if (!status) status = surface_reserve(r, &w->cap_numbers, 4ull * r->job.cap_points, "points of the border");
    if (!status) status = surface_reserve(r, &w->cap_firsts, 4ull * r->job.cap_faces, "faces of the border");
    if (!status) status = surface_fill(r, &w->cap_tiles, 0, 0, tile_bytes);
    return status ? status : count_launch(r);
}

tc_status caps_emit(complex_run *r, const device_buffer *positions, const device_buffer *triangles) {
    const complex_buffers *w = r->work;
    const border_list *b = r->border;
    const kernel_argument arguments[] = {ARGUMENT(r->job),
                                         ARGUMENT(r->part->points.memory),
                                         ARGUMENT(b->points_buffer.memory),
                                         ARGUMENT(b->faces_buffer.memory),
                                         ARGUMENT(*memory_of(r, &w->active)),
                                         ARGUMENT(*cases_of(r)),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(*memory_of(r, &w->tiles)),
                                         ARGUMENT(*memory_of(r, &w->table)),
                                         ARGUMENT(w->cap_tiles.memory),
                                         ARGUMENT(w->cap_numbers.memory),
                                         ARGUMENT(w->cap_firsts.memory),
                                         ARGUMENT(positions->memory),
                                         ARGUMENT(triangles->memory)};
    if (!r->head[HEAD_CAP_TRIANGLES]) return TC_OK;
    tc_status status = kernel_launch(r->context, r->kernels[KERNEL_CAPS_EMIT], "kernel caps_emit", arguments,
                                     sizeof arguments / sizeof *arguments);
    if (!status) status = surface_head_read(r);
    if (!status && r->head[HEAD_INVALID])
        status = (tc_status)fail(TC_ERROR_DATA, "the samples or tetrahedra have changed while they were extracted");
    return status;
}
