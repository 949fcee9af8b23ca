/*
 * Units of a stream: their samples are read, grids made of them, and their surfaces counted.
 */
#include "stream.h"

#include "failure.h"
#include "kernels/base/slab.h"

#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------------------------- windows */

static int64_t min_i64(int64_t a, int64_t b) { return a < b ? a : b; }

/* Planes that are read for a unit. */
static int64_t window_first(const stream *s, const unit *u) { return u->first - min_i64(u->first, s->halo[0]); }

static int64_t window_end(const stream *s, const unit *u) {
    return u->end + min_i64(s->whole.dims[2] - u->end, s->halo[1]);
}

void stream_grid_close(stream *s) {
    tc_grid_destroy(s->grid);
    s->grid = NULL;
}

static tc_status planes_read(stream *s, int64_t first, int64_t end, tc_planes *planes) {
    void *memory[ARRAY_COUNT] = {NULL};
    for (int array = 0; array < ARRAY_COUNT; array++) {
        tc_status status = host_block_reserve(&s->held[array], (uint64_t)(end - first) * s->plane_bytes[array]);
        if (status) return status;
        if (s->plane_bytes[array]) memory[array] = s->held[array].memory;
    }
    *planes = (tc_planes){.struct_size = sizeof *planes,
                          .first = first,
                          .count = end - first,
                          .samples = memory[ARRAY_SAMPLES],
                          .blanked_samples = memory[ARRAY_BLANKED_SAMPLES],
                          .blanked_cells = memory[ARRAY_BLANKED_CELLS]};
    CALL_BACK(s->o.read(s->o.user, planes));
    return TC_OK;
}

tc_status stream_grid_open(stream *s, const unit *u) {
    const int64_t first = window_first(s, u), end = window_end(s, u);
    tc_grid_options o = s->whole;
    tc_planes planes;
    if (s->grid && s->own_first == u->first && s->own_end == u->end) return TC_OK;
    stream_grid_close(s);
    tc_status status = planes_read(s, first, end, &planes);
    if (status) return status;
    o.whole = &s->whole;
    o.dims[2] = end - first;
    o.first_index[2] += first;
    o.owned[0] = u->first - first;
    o.owned[1] = u->end - first;
    o.samples = planes.samples;
    o.blanked_samples = planes.blanked_samples;
    o.blanked_cells = planes.blanked_cells;
    if (o.axes[2]) o.axes[2] += first;
    if (o.axes_f64[2]) o.axes_f64[2] += first;
    if (o.points) o.points += 3 * first * o.dims[0] * o.dims[1];
    if (o.points_f64) o.points_f64 += 3 * first * o.dims[0] * o.dims[1];
    s->grid_first = first;
    s->grid_end = end;
    s->own_first = u->first;
    s->own_end = u->end;
    status = tc_grid_create(s->context, &o, &s->grid);
    if (!status && s->grid->kind == GRID_CURVILINEAR) s->grid->mirrored = s->mirrored;
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ units */

static void unit_release(unit *u, size_t surface_count) {
    for (size_t n = 0; n < surface_count && u->surfaces; n++) free(u->surfaces[n].seam);
    free(u->surfaces);
    u->surfaces = NULL;
}

static tc_status unit_add(stream *s, int64_t first, int64_t end) {
    if (s->unit_count == s->unit_capacity) {
        const size_t capacity = 2 * s->unit_capacity + 16;
        unit *grown = realloc(s->units, capacity * sizeof *grown);
        if (!grown) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the pieces of a stream");
        s->units = grown;
        s->unit_capacity = capacity;
    }
    unit *u = &s->units[s->unit_count];
    *u = (unit){first, end, calloc(s->o.surface_count, sizeof *u->surfaces)};
    if (!u->surfaces) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the pieces of a stream");
    s->unit_count++;
    return TC_OK;
}

/* Keeps a seam where it has numbers. */
static tc_status seam_keep(const stream *s, const uint32_t *seam, unit_surface *to) {
    if (!memcmp(seam, s->no_vertices, s->seam_size * sizeof *seam)) return TC_OK;
    to->seam = malloc(s->seam_size * sizeof *seam);
    if (!to->seam) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the seams of a stream");
    memcpy(to->seam, seam, s->seam_size * sizeof *seam);
    return TC_OK;
}

/* Counts a unit that is in memory; *most: bytes of its largest mesh. */
static tc_status unit_count(stream *s, unit *u, uint32_t *seam, uint64_t *most) {
    tc_status status = TC_OK;
    *most = 0;
    for (size_t n = 0; n < s->o.surface_count && !status; n++) {
        tc_counts counts = {.struct_size = sizeof counts};
        status = tc_count_piece(s->grid, &s->surfaces[n], &counts, seam, s->seam_size);
        if (!status) status = seam_keep(s, seam, &u->surfaces[n]);
        u->surfaces[n].vertex_count = counts.vertex_count;
        u->surfaces[n].triangle_count = counts.triangle_count;
        if (counts.mesh_bytes > *most) *most = counts.mesh_bytes;
        s->totals[n].active_cell_count += counts.active_cell_count;
        s->totals[n].classify_ms += counts.classify_ms;
    }
    return status;
}

static void totals_take_back(stream *s, const tc_counts *before) {
    memcpy(s->totals, before, s->o.surface_count * sizeof *before);
}

/* Counts planes first to end - 1, in pieces small enough for their meshes. */
static tc_status planes_count(stream *s, int64_t first, int64_t end, uint32_t *seam, tc_counts *before) {
    uint64_t most = 0;
    memcpy(before, s->totals, s->o.surface_count * sizeof *before);
    tc_status status = unit_add(s, first, end);
    unit *u = &s->units[s->unit_count - 1];
    if (!status) status = stream_grid_open(s, u);
    if (!status) status = unit_count(s, u, seam, &most);
    if (status || most <= s->mesh_bytes || end - first <= BRICK_PLANES) return status;
    totals_take_back(s, before);
    unit_release(&s->units[--s->unit_count], s->o.surface_count);
    const int64_t layers = (end - first + BRICK_PLANES - 1) / BRICK_PLANES, middle = first + layers / 2 * BRICK_PLANES;
    status = planes_count(s, first, middle, seam, before);
    return status ? status : planes_count(s, middle, end, seam, before);
}

void stream_progress(stream *s, double begin, double share) {
    s->context->progress_begin = begin;
    s->context->progress_share = share;
}

/* Of what follows the planes that are asked for, one layer tells where vertices lie in its bricks. */
static tc_status behind_count(stream *s, uint32_t *seam) {
    const int64_t first = s->o.owned[1], nz = s->whole.dims[2];
    uint64_t most;
    tc_counts *totals = s->totals, *ignored = calloc(s->o.surface_count, sizeof *ignored);
    if (first == nz || !s->o.take) {
        free(ignored);
        return TC_OK;
    }
    tc_status status = ignored ? unit_add(s, first, min_i64(first + BRICK_PLANES, nz))
                               : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the seams of a stream");
    s->totals = ignored;
    if (!status) status = stream_grid_open(s, &s->units[s->unit_count - 1]);
    if (!status) status = unit_count(s, &s->units[s->unit_count - 1], seam, &most);
    s->totals = totals;
    free(ignored);
    return status;
}

static void totals_add(stream *s) {
    for (size_t n = 0; n < s->o.surface_count; n++) {
        tc_counts *t = &s->totals[n];
        for (size_t u = 0; u < s->own_units; u++) {
            t->vertex_count += s->units[u].surfaces[n].vertex_count;
            t->triangle_count += s->units[u].surfaces[n].triangle_count;
        }
        t->mesh_bytes = channels_mesh_bytes(channels_asked(&s->surfaces[n]), t->vertex_count, t->triangle_count);
    }
}

tc_status stream_count(stream *s, int64_t window) {
    const double planes = (double)(s->o.owned[1] - s->o.owned[0]), part = s->o.take ? 0.5 : 1;
    uint32_t *seam = malloc(s->seam_size * sizeof *seam);
    tc_counts *before = calloc(s->o.surface_count, sizeof *before);
    tc_status status = seam && before ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the seams of a stream");
    for (int64_t z = s->o.owned[0]; z < s->o.owned[1] && !status; z += window) {
        const int64_t end = min_i64(z + window, s->o.owned[1]);
        stream_progress(s, part * (double)(z - s->o.owned[0]) / planes, part * (double)(end - z) / planes);
        status = planes_count(s, z, end, seam, before);
    }
    s->own_units = s->unit_count;
    if (!status) status = behind_count(s, seam);
    if (!status) totals_add(s);
    free(seam);
    free(before);
    return status;
}

void stream_units_release(stream *s) {
    stream_grid_close(s);
    for (size_t n = 0; n < s->unit_count; n++) unit_release(&s->units[n], s->o.surface_count);
    for (int array = 0; array < ARRAY_COUNT; array++) host_block_release(&s->held[array]);
    free(s->units);
}
