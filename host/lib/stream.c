/*
 * stream.c - surfaces larger than memory: pieces of the grid, one after the other, each read, counted, and emitted
 *
 * A unit is a piece whose samples are in memory at once. All units are counted first; of each the counts and the seam
 * are kept. A unit whose mesh would be too large is cut in two and counted again. Then those that have a mesh are read
 * once more, and emitted with the seam of the unit behind. A grid that is one unit is made once, and kept.
 */
#include "stream.h"

#include "base/structs.h"
#include "failure.h"
#include "kernels/base/slab.h"

#include <stdlib.h>
#include <string.h>

static const uint64_t memory_default = 256 << 20;

/* --------------------------------------------------------------------------------------------------------- emission */

static bool unit_emits(const stream *s, const unit *u) {
    for (size_t n = 0; n < s->o.surface_count; n++)
        if (u->surfaces[n].vertex_count || u->surfaces[n].triangle_count) return true;
    return false;
}

static tc_status piece_take(stream *s, size_t unit_index, size_t surface, tc_mesh **mesh, const tc_mesh_piece *next) {
    const unit *u = &s->units[unit_index];
    const bool is_last = u->end == s->whole.dims[2]; /* else there is a unit behind, counted for its seam */
    const uint32_t *seam = is_last ? NULL : s->units[unit_index + 1].surfaces[surface].seam;
    const unit_surface *counted = &u->surfaces[surface];
    tc_mesh_data data = {.struct_size = sizeof data};
    if (!seam && !is_last) seam = s->no_vertices;
    tc_status status = tc_extract_piece(s->grid, &s->surfaces[surface], seam, seam ? s->seam_size : 0, mesh);
    if (!status) status = tc_mesh_get(*mesh, &data);
    if (!status && (data.vertex_count != counted->vertex_count || data.triangle_count != counted->triangle_count))
        status =
            (tc_status)fail(TC_ERROR_DATA, "samples, or what is blanked, have changed between the passes of a stream");
    if (status) return status;
    const tc_mesh_piece piece = {.struct_size = sizeof piece,
                                 .surface = surface,
                                 .first_vertex = next->first_vertex,
                                 .first_triangle = next->first_triangle,
                                 .mesh = &data,
                                 .grid = s->grid,
                                 .first_plane = s->grid_first,
                                 .plane_count = s->grid_end - s->grid_first};
    CALL_BACK(s->o.take(s->o.user, &piece));
    return TC_OK;
}

static tc_status unit_emit(stream *s, size_t unit_index, tc_mesh **mesh, tc_mesh_piece *next) {
    const unit *u = &s->units[unit_index];
    tc_status status = unit_emits(s, u) ? stream_grid_open(s, u) : TC_OK;
    for (size_t n = 0; n < s->o.surface_count && !status; n++) {
        const unit_surface *counted = &u->surfaces[n];
        if (counted->vertex_count || counted->triangle_count) status = piece_take(s, unit_index, n, mesh, &next[n]);
        next[n].first_vertex += counted->vertex_count;
        next[n].first_triangle += counted->triangle_count;
    }
    return status;
}

static tc_status units_emit(stream *s) {
    tc_mesh *mesh = NULL;
    tc_mesh_piece *next = calloc(s->o.surface_count, sizeof *next); /* of each surface */
    tc_status status = next ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the pieces of a stream");
    for (size_t u = 0; u < s->own_units && !status; u++) {
        stream_progress(s, 0.5 + 0.5 * (double)u / (double)s->own_units, 0.5 / (double)s->own_units);
        status = unit_emit(s, u, &mesh, next);
    }
    tc_mesh_destroy(mesh);
    free(next);
    return status;
}

/* ------------------------------------------------------------------------------------------------------------ calls */

void tc_stream_options_init(tc_stream_options *options) {
    if (!options) return;
    *options = (tc_stream_options){.struct_size = sizeof *options};
}

static bool is_curvilinear(const stream *s) { return s->whole.points || s->whole.points_f64; }

/* Origin and winding of a curvilinear grid follow from all of its points that are not missing. */
static tc_status curvilinear_describe(stream *s) {
    tc_grid whole = {.context = s->context};
    if (!is_curvilinear(s)) return TC_OK;
    const tc_status status = grid_describe(&s->whole, &whole);
    s->whole.has_origin = 1;
    memcpy(s->whole.origin, whole.origin, sizeof whole.origin);
    s->mirrored = whole.mirrored;
    grid_release(&whole);
    return status;
}

static tc_status options_check(const stream *s) {
    if (!s->o.grid || !s->o.surfaces || !s->o.surface_count || !s->o.read)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "a stream needs a grid, surfaces, and a source of planes");
    if (s->whole.cl_samples || s->whole.whole || (is_curvilinear(s) && !s->whole.samples))
        return (tc_status)fail(
            TC_ERROR_ARGUMENT,
            "a stream is of a whole grid whose samples come from the source; of a curvilinear one they, "
            "too, have to be in memory, or mapped");
    return grid_sizes_check(&s->whole);
}

static tc_status owned_take(stream *s) {
    int64_t *owned = s->o.owned;
    const int64_t nz = s->whole.dims[2];
    if (owned[0] == 0 && owned[1] == 0) owned[1] = nz;
    if (owned[0] >= 0 && owned[0] < owned[1] && owned[1] <= nz && owned[0] % BRICK_PLANES == 0 &&
        (owned[1] % BRICK_PLANES == 0 || owned[1] == nz))
        return TC_OK;
    return (tc_status)fail(
        TC_ERROR_ARGUMENT,
        "planes %lld to %lld of %lld: a stream's own begin at a multiple of %d and end there or with "
        "the whole",
        (long long)owned[0], (long long)owned[1] - 1, (long long)nz, BRICK_PLANES);
}

static tc_status options_take(stream *s, const tc_stream_options *options) {
    tc_stream_options_init(&s->o);
    tc_grid_options_init(&s->whole);
    tc_status status = struct_copy_in(&s->o, sizeof s->o, options, "stream options");
    if (!status && s->o.grid) status = struct_copy_in(&s->whole, sizeof s->whole, s->o.grid, "grid options");
    if (!status) status = options_check(s);
    if (!status) status = owned_take(s);
    if (!status) status = curvilinear_describe(s);
    if (status) return status;
    s->surfaces = calloc(s->o.surface_count, sizeof *s->surfaces);
    s->totals = calloc(s->o.surface_count, sizeof *s->totals);
    if (!s->surfaces || !s->totals) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the surfaces of a stream");
    const size_t each = s->o.surfaces->struct_size; /* of the caller's array */
    for (size_t n = 0; n < s->o.surface_count && !status; n++) {
        tc_extract_options_init(&s->surfaces[n]);
        s->totals[n].struct_size = sizeof s->totals[n];
        status = struct_copy_in(&s->surfaces[n], sizeof *s->surfaces, (const char *)s->o.surfaces + n * each,
                                "extract options");
        s->halo[0] = s->halo[0] == PIECE_SNAP || s->surfaces[n].method == TC_METHOD_SNAP ? PIECE_SNAP : PIECE_BEFORE;
        s->halo[1] = s->halo[0] == PIECE_SNAP ? PIECE_SNAP : PIECE_BEHIND;
    }
    return status;
}

/* Planes of a unit's own, whole layers. */
static int64_t window_planes(stream *s) {
    const tc_grid_options *w = &s->whole;
    const uint64_t plane = (uint64_t)w->dims[0] * (uint64_t)w->dims[1];
    const uint64_t budget = s->o.max_memory_bytes ? s->o.max_memory_bytes : memory_default;
    s->plane_bytes[ARRAY_SAMPLES] = plane * tc_type_bytes(w->type);
    if (w->blanked_samples) s->plane_bytes[ARRAY_BLANKED_SAMPLES] = plane;
    if (w->blanked_cells) s->plane_bytes[ARRAY_BLANKED_CELLS] = (uint64_t)(w->dims[0] - 1) * (uint64_t)(w->dims[1] - 1);
    uint64_t bytes = 0;
    for (int array = 0; array < ARRAY_COUNT; array++) bytes += s->plane_bytes[array];
    const uint64_t planes = bytes ? budget / 2 / bytes : 0;
    s->whole.blanked_samples = s->whole.blanked_cells = NULL;
    s->mesh_bytes = budget / 2;
    if (planes >= (uint64_t)(s->o.owned[1] - s->o.owned[0])) return s->o.owned[1] - s->o.owned[0];
    const int64_t own = (int64_t)planes - s->halo[0] - s->halo[1];
    return own < BRICK_PLANES ? BRICK_PLANES : own / BRICK_PLANES * BRICK_PLANES;
}

static tc_status stream_run(stream *s) {
    s->seam_size =
        ((uint64_t)s->whole.dims[0] + 63) / 64 * (((uint64_t)s->whole.dims[1] + BRICK_ROWS - 1) / BRICK_ROWS);
    s->no_vertices = calloc(s->seam_size, sizeof *s->no_vertices);
    if (!s->no_vertices) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the seams of a stream");
    tc_status status = stream_count(s, window_planes(s));
    if (status) return status;
    for (size_t n = 0; n < s->o.surface_count && s->o.counted; n++)
        CALL_BACK(s->o.counted(s->o.user, n, &s->totals[n]));
    return s->o.take ? units_emit(s) : TC_OK;
}

tc_status tc_stream(tc_context *context, const tc_stream_options *options) {
    FLOAT_ENVIRONMENT_DEFAULT;
    stream s = {.context = context};
    if (!context) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_stream needs a context");
    tc_status status = options_take(&s, options);
    if (!status) status = context_check(context);
    if (!status) status = stream_run(&s);
    stream_progress(&s, 0, 1);
    stream_units_release(&s);
    free(s.no_vertices);
    free(s.totals);
    free(s.surfaces);
    return status;
}
