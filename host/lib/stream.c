/*
 * stream.c - surfaces larger than memory: pieces of the grid, one after the other, each read, counted, and emitted
 *
 * A unit is a piece whose samples are in memory at once. All units are counted first; of each the counts and the seam
 * are kept. A unit whose mesh would be too large is cut in two and counted again. Then those that have a mesh are read
 * once more, and emitted with the seam of the unit behind. A grid that is one unit is made once, and kept.
 */
#include "base/float_environment.h"
#include "base/host_block.h"
#include "base/structs.h"
#include "failure.h"
#include "grid/grid.h"
#include "opencl/context.h"
#include "slab.h"

#include <stdlib.h>
#include <string.h>

enum { HALO_BEFORE = BRICK_PLANES, HALO_BEHIND = 2, HALO_SNAP = 2 * BRICK_PLANES };

static const uint64_t memory_default = 256 << 20;

/* What a unit gives to a surface. */
typedef struct unit_surface {
    uint64_t vertex_count, triangle_count;
    uint32_t *seam; /* NULL: no vertex has a number */
} unit_surface;

/* Planes first to end - 1 of the whole are its own. */
typedef struct unit {
    int64_t first, end;
    unit_surface *surfaces;
} unit;

typedef struct stream {
    tc_context *context;
    tc_stream_options o;
    tc_grid_options whole;
    tc_extract_options *surfaces;
    tc_counts *totals;
    uint32_t *no_vertices; /* a seam */
    uint64_t seam_size;
    unit *units;
    size_t unit_count, unit_room;
    size_t own_units; /* without the one behind */
    int64_t halo[2];
    uint64_t plane_bytes[ARRAY_COUNT];
    host_block room[ARRAY_COUNT]; /* for what the source does not have in memory */
    uint64_t mesh_bytes;          /* of a piece, at most, where that can be had */
    tc_grid *grid;                /* of the unit in memory */
    bool mirrored;                /* of a curvilinear grid: the whole */
    int64_t own_first, own_end;   /* the planes that it owns, of the whole */
    int64_t grid_first, grid_end; /* those that it has */
} stream;

/* ----------------------------------------------------------------------------------------------------------- windows
 */

/* Calls back with the caller's floating-point environment. */
#define CALL_BACK(call)                                                                                                \
    do {                                                                                                               \
        float_environment *lent = float_environment_lend();                                                            \
        const int ended = (call);                                                                                      \
        float_environment_resume(lent);                                                                                \
        if (ended) return (tc_status)fail(TC_ERROR_CANCELLED, "a callback of the stream has ended it");                \
    } while (0)

static int64_t min_i64(int64_t a, int64_t b) { return a < b ? a : b; }

/* Planes that are read for a unit. */
static int64_t window_first(const stream *s, const unit *u) { return u->first - min_i64(u->first, s->halo[0]); }

static int64_t window_end(const stream *s, const unit *u) {
    return u->end + min_i64(s->whole.dims[2] - u->end, s->halo[1]);
}

static void grid_close(stream *s) {
    tc_grid_destroy(s->grid);
    s->grid = NULL;
}

static tc_status planes_read(stream *s, int64_t first, int64_t end, tc_planes *planes) {
    void *memory[ARRAY_COUNT] = {NULL};
    for (int array = 0; array < ARRAY_COUNT; array++) {
        tc_status status = host_block_reserve(&s->room[array], (uint64_t)(end - first) * s->plane_bytes[array]);
        if (status) return status;
        if (s->plane_bytes[array]) memory[array] = s->room[array].memory;
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

/* Makes a grid of the unit, unless it is there. */
static tc_status grid_open(stream *s, const unit *u) {
    const int64_t first = window_first(s, u), end = window_end(s, u);
    tc_grid_options o = s->whole;
    tc_planes planes;
    if (s->grid && s->own_first == u->first && s->own_end == u->end) return TC_OK;
    grid_close(s);
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

/* ------------------------------------------------------------------------------------------------------------- units
 */

static void unit_release(unit *u, size_t surface_count) {
    for (size_t n = 0; n < surface_count && u->surfaces; n++) free(u->surfaces[n].seam);
    free(u->surfaces);
    u->surfaces = NULL;
}

static tc_status unit_add(stream *s, int64_t first, int64_t end) {
    if (s->unit_count == s->unit_room) {
        const size_t room = 2 * s->unit_room + 16;
        unit *grown = realloc(s->units, room * sizeof *grown);
        if (!grown) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the pieces of a stream");
        s->units = grown;
        s->unit_room = room;
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
    if (!status) status = grid_open(s, u);
    if (!status) status = unit_count(s, u, seam, &most);
    if (status || most <= s->mesh_bytes || end - first <= BRICK_PLANES) return status;
    totals_take_back(s, before);
    unit_release(&s->units[--s->unit_count], s->o.surface_count);
    const int64_t layers = (end - first + BRICK_PLANES - 1) / BRICK_PLANES, middle = first + layers / 2 * BRICK_PLANES;
    status = planes_count(s, first, middle, seam, before);
    return status ? status : planes_count(s, middle, end, seam, before);
}

/* Progress of a part of the stream is that share of the whole. */
static void progress_share(stream *s, double begin, double share) {
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
    if (!status) status = grid_open(s, &s->units[s->unit_count - 1]);
    if (!status) status = unit_count(s, &s->units[s->unit_count - 1], seam, &most);
    s->totals = totals;
    free(ignored);
    return status;
}

static tc_status units_count(stream *s, int64_t window) {
    const double planes = (double)(s->o.owned[1] - s->o.owned[0]), part = s->o.take ? 0.5 : 1;
    uint32_t *seam = malloc(s->seam_size * sizeof *seam);
    tc_counts *before = calloc(s->o.surface_count, sizeof *before);
    tc_status status = seam && before ? TC_OK : (tc_status)fail(TC_ERROR_MEMORY, "no memory for the seams of a stream");
    for (int64_t z = s->o.owned[0]; z < s->o.owned[1] && !status; z += window) {
        const int64_t end = min_i64(z + window, s->o.owned[1]);
        progress_share(s, part * (double)(z - s->o.owned[0]) / planes, part * (double)(end - z) / planes);
        status = planes_count(s, z, end, seam, before);
    }
    s->own_units = s->unit_count;
    if (!status) status = behind_count(s, seam);
    free(seam);
    free(before);
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

/* ---------------------------------------------------------------------------------------------------------- emission
 */

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
    tc_status status = unit_emits(s, u) ? grid_open(s, u) : TC_OK;
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
        progress_share(s, 0.5 + 0.5 * (double)u / (double)s->own_units, 0.5 / (double)s->own_units);
        status = unit_emit(s, u, &mesh, next);
    }
    tc_mesh_destroy(mesh);
    free(next);
    return status;
}

/* -------------------------------------------------------------------------------------------------------------- calls
 */

void tc_stream_options_init(tc_stream_options *options) {
    if (!options) return;
    *options = (tc_stream_options){.struct_size = sizeof *options};
}

static bool is_curvilinear(const stream *s) { return s->whole.points || s->whole.points_f64; }

/* Origin and winding of a curvilinear grid follow from all of its points that are not missing. */
static tc_status curvilinear_place(stream *s) {
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
    if (!status) status = curvilinear_place(s);
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
        s->halo[0] = s->halo[0] == HALO_SNAP || s->surfaces[n].method == TC_METHOD_SNAP ? HALO_SNAP : HALO_BEFORE;
        s->halo[1] = s->halo[0] == HALO_SNAP ? HALO_SNAP : HALO_BEHIND;
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
    tc_status status = units_count(s, window_planes(s));
    if (status) return status;
    totals_add(s);
    if (s->o.counted) CALL_BACK(s->o.counted(s->o.user, s->totals));
    return s->o.take ? units_emit(s) : TC_OK;
}

tc_status tc_stream(tc_context *context, const tc_stream_options *options) {
    FLOAT_ENVIRONMENT_DEFAULT;
    stream s = {.context = context};
    if (!context) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_stream needs a context");
    tc_status status = options_take(&s, options);
    if (!status) status = context_check(context);
    if (!status) status = stream_run(&s);
    progress_share(&s, 0, 1);
    grid_close(&s);
    for (size_t n = 0; n < s.unit_count; n++) unit_release(&s.units[n], s.o.surface_count);
    for (int array = 0; array < ARRAY_COUNT; array++) host_block_release(&s.room[array]);
    free(s.units);
    free(s.no_vertices);
    free(s.totals);
    free(s.surfaces);
    return status;
}
