#include "streamed.h"

#include "dataset/array_memory.h"
#include "exit_status.h"
#include "failure.h"
#include "host_memory.h"
#include "input/cell_sizes.h"
#include "input/input.h"
#include "library_status.h"
#include "part_surface.h"
#include "planes_cut.h"
#include "progress.h"
#include "surface_files.h"
#include "team_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Bytes per sample: of a mesh at most, with normals; and of what the engine keeps beside it. */
enum { MESH_MOST = 6 * 24 + 10 * 12, ENGINE_KEEPS = 1 };

static const uint64_t window_most = UINT64_C(1) << 30, window_least = 32 << 20, page = 4096;

/* A surface while its pieces come. */
typedef struct streamed_surface {
    surface_report *report;
    tc_counts counts;
    piece_file *file;
} streamed_surface;

typedef struct stream_job {
    const stream_input *in;
    tc_grid_options grid;
    const char *samples;
    const uint8_t *blanked_samples, *blanked_cells;
    tc_extract_options *how;
    streamed_surface *surfaces;
    size_t count;
    output_group files;
    team_surface *shared; /* of a team, one per surface */
    int is_counted;       /* by all of the team */
    int64_t owned[2];     /* planes */
    int status;           /* of a callback that has ended the stream, with its message */
    char text[1024];
    int fits; /* all of it fits into memory: the stream ends when it is counted */
} stream_job;

/* ----------------------------------------------------------------------------------------------------------- choice */

/* What keeps the surfaces from being streamed; NULL: nothing. */
static const char *obstacle(const stream_input *in) {
    const options *o = in->o;
    const dataset_block *b = in->data->blocks;
    if (in->blocks->count != 1) return "its blocks are extracted together";
    if (b->kind == BLOCK_UNSTRUCTURED) return "it is unstructured";
    if (b->whole) return "--roi and --step take a part of it";
    if (o->check) return "--check needs the whole mesh";
    if (o->verify) return "--verify compares whole meshes";
    if (o->drop_degenerate) return "--drop-degenerate needs the whole mesh";
    if (o->simplify > 0) return "--simplify needs the whole mesh";
    if (o->separate_blocks && in->team) return "--blocks separate names files of blocks";
    if (o->soup && (o->part[1] || in->team)) return "--soup needs the whole mesh";
    if (o->preview) return "--preview draws the whole mesh";
    return NULL;
}

static int is_asked_for(const stream_input *in) { return in->o->stream || in->o->part[1] || in->team; }

static uint64_t memory_of_stream(const stream_input *in) {
    const options *o = in->o;
    if (o->max_memory) return o->max_memory / 2; /* the device's buffers take the other half */
    const uint64_t share = host_memory_available() / 4 / (in->team ? (uint64_t)in->team->node_size : 1);
    return share < window_least ? window_least : share < window_most ? share : window_most;
}

/* ----------------------------------------------------------------------------------------------------------- source */

/* Of an address in a mapped file, or in an array that lies in one: the bytes from there to its end; else 0. */
static uint64_t bytes_in_file(const dataset *d, const char *from) {
    const uintptr_t begin = (uintptr_t)d->mapping, at = (uintptr_t)from;
    return at >= begin && at - begin < d->mapping_bytes ? d->mapping_bytes - (at - begin) : samples_in_file(from);
}

/* Says which pages of the file come next, and which have been used. */
static void advise(const dataset *d, const char *from, uint64_t bytes, int advice) {
    const uint64_t most = bytes_in_file(d, from), before = (uintptr_t)from % page;
    if (most) (void)madvise((void *)(uintptr_t)(from - before), (bytes < most ? bytes : most) + before, advice);
}

static int give_planes(void *user, tc_planes *planes) {
    stream_job *j = user;
    const tc_grid_options *g = &j->grid;
    const uint64_t plane = (uint64_t)g->dims[0] * (uint64_t)g->dims[1], first = (uint64_t)planes->first;
    const uint64_t bytes = plane * tc_type_bytes(g->type),
                   cells = (uint64_t)(g->dims[0] - 1) * (uint64_t)(g->dims[1] - 1);
    const uint64_t window = (uint64_t)planes->count * bytes;
    progress_bytes(window);
    const char *at = j->samples + first * bytes;
    advise(j->in->data, at > j->samples + window ? at - window : j->samples,
           at > j->samples + window ? window : (uint64_t)(at - j->samples), MADV_DONTNEED);
    advise(j->in->data, at, 2 * window, MADV_WILLNEED);
    if (g->points) advise(j->in->data, (const char *)g->points, 12 * plane * first, MADV_DONTNEED);
    planes->samples = (void *)(uintptr_t)at;
    if (j->blanked_samples) planes->blanked_samples = (uint8_t *)(uintptr_t)(j->blanked_samples + first * plane);
    if (j->blanked_cells) planes->blanked_cells = (uint8_t *)(uintptr_t)(j->blanked_cells + first * cells);
    return progress_cancelled();
}

/* ------------------------------------------------------------------------------------------------------------- sink */

/* Keeps the message of a failure of this thread, as the library's is told after it. */
static int note(stream_job *j, int status) {
    if (status && !j->status) {
        j->status = status;
        snprintf(j->text, sizeof j->text, "%s", failure_text());
    }
    return status;
}

/* Whether the engine can make the meshes in memory, one after the other. */
static int fits_memory(const stream_job *j) {
    const uint64_t available = host_memory_available(), most = available - available / 8;
    const uint64_t keeps = ENGINE_KEEPS * (uint64_t)j->in->data->blocks->point_count;
    uint64_t vertex_bytes = 0, mesh = 0;
    for (int n = 0; n < j->in->carried->count; n++) vertex_bytes += 4 * (uint64_t)j->in->carried->from[n].components;
    for (size_t n = 0; n < j->count; n++) {
        const tc_counts *c = &j->surfaces[n].counts;
        const uint64_t bytes = c->mesh_bytes + vertex_bytes * c->vertex_count;
        if (c->vertex_count > UINT32_MAX) return 0;
        if (bytes > mesh) mesh = bytes;
    }
    return mesh <= most && keeps <= most - mesh;
}

/* Between the passes of all members of a team: how many vertices and triangles lie before this one's, and the files. */
static int count_together(stream_job *j) {
    team *t = j->in->team;
    int status = 0;
    team_surfaces_count(t, j->surfaces->report, j->shared, j->count);
    j->is_counted = 1;
    for (size_t n = 0; n < j->count && j->in->o->output && !status; n++) {
        char *path = surface_file_name(j->in->o, j->in->o->output, j->surfaces[n].report->iso, 0);
        status = team_surface_open(t, path, &j->shared[n]);
        free(path);
    }
    return note(j, status);
}

static int take_counts(void *user, size_t surface, const tc_counts *counts) {
    stream_job *j = user;
    surface_report *s = j->surfaces[surface].report;
    j->surfaces[surface].counts = *counts;
    s->vertex_count = counts->vertex_count;
    s->triangle_count = counts->triangle_count;
    s->active_cell_count = counts->active_cell_count;
    s->classify_ms = counts->classify_ms;
    if (surface + 1 < j->count) return 0;
    if (j->in->team) return count_together(j);
    j->fits = !is_asked_for(j->in) && fits_memory(j);
    return j->fits;
}

static int open_part(stream_job *j, streamed_surface *to, const tc_mesh_data *whole) {
    part_header header = {.number = j->in->o->part[0],
                          .count = j->in->o->part[1],
                          .planes = {j->owned[0], j->owned[1]},
                          .vertex_count = whole->vertex_count,
                          .triangle_count = whole->triangle_count,
                          .has_origin = to->report->piece_count > 0};
    memcpy(header.origin, whole->origin, sizeof header.origin);
    header.surface =
        part_surface_make(j->in->o, j->in->data, j->in->field, j->in->carried, &j->grid, &j->how[to - j->surfaces],
                          j->samples, j->blanked_samples, blocks_suit_world(j->in->blocks));
    int status = header.surface ? 0 : STATUS_FAILED;
    if (!status)
        status = surface_files_open_pieces(j->in->o, j->in->data, blocks_suit_world(j->in->blocks), to->report->iso,
                                           whole, &header, NULL, j->in->carried, &j->files, &to->file);
    part_header_release(&header);
    return status;
}

/* Opens the surface's file, now that its size, and the point that its positions are relative to, are known. */
static int open_file(stream_job *j, streamed_surface *to, const double origin[3]) {
    static const float none;
    const surface_report *s = to->report;
    tc_mesh_data whole = {.struct_size = sizeof whole,
                          .vertex_count = s->vertex_count,
                          .triangle_count = s->triangle_count,
                          .positions = &none,
                          .normals = j->in->o->normals && s->vertex_count ? &none : NULL};
    memcpy(whole.origin, origin, sizeof whole.origin);
    memcpy(to->report->origin, origin, sizeof whole.origin);
    to->report->has_origin = 1;
    if (!j->in->o->output || to->file) return 0;
    if (j->in->o->part[1]) return open_part(j, to, &whole);
    const output_shared *shared = j->in->team ? &j->shared[to - j->surfaces].shared : NULL;
    return surface_files_open_pieces(j->in->o, j->in->data, blocks_suit_world(j->in->blocks), s->iso, &whole, NULL,
                                     shared, j->in->carried, &j->files, &to->file);
}

static void add_bounds(surface_report *s, const tc_mesh_data *m) {
    mesh_summary own;
    mesh_summarize(m->positions, m->vertex_count, NULL, 0, &own);
    s->summary.nonfinite_vertices += own.nonfinite_vertices;
    for (int axis = 0; axis < 3 && m->vertex_count > own.nonfinite_vertices; axis++) {
        s->summary.bounds[0][axis] = fmin(s->summary.bounds[0][axis], own.bounds[0][axis] + m->origin[axis]);
        s->summary.bounds[1][axis] = fmax(s->summary.bounds[1][axis], own.bounds[1][axis] + m->origin[axis]);
    }
}

static int take_piece(void *user, const tc_mesh_piece *piece) {
    stream_job *j = user;
    streamed_surface *to = &j->surfaces[piece->surface];
    const tc_mesh_data *m = piece->mesh;
    surface_report *s = to->report;
    const uint64_t plane = (uint64_t)(j->grid.dims[0] * j->grid.dims[1]);
    const team_surface none = {0}, *before = j->in->team ? &j->shared[piece->surface] : &none;
    const double begin = now_ms();
    s->piece_count++;
    int status = open_file(j, to, m->origin);
    s->emit_ms += m->timings.emit_ms;
    s->readback_ms += m->timings.readback_ms;
    if (!j->in->o->quiet || j->in->o->json || j->in->team) add_bounds(s, m);
    if (!status) status = carried_fields_of_piece(j->in->carried, piece, plane, &j->how[piece->surface]);
    progress_bytes(12 * (m->vertex_count + m->triangle_count));
    if (!status && to->file)
        status = surface_files_add_piece(to->file, before->first_vertex + piece->first_vertex,
                                         before->first_triangle + piece->first_triangle, m, j->in->carried);
    s->write_ms += now_ms() - begin;
    return note(j, status ? status : progress_status());
}

/* -------------------------------------------------------------------------------------------------------------- run */

static int begin(stream_job *j, surface_report *surfaces) {
    const stream_input *in = j->in;
    const scalar_block *from = in->blocks->blocks->scalar;
    tc_grid_options whole;
    const size_t count = in->o->isovalue_count;
    j->how = calloc(count, sizeof *j->how);
    j->surfaces = calloc(count, sizeof *j->surfaces);
    j->shared = calloc(count, sizeof *j->shared);
    if (!j->how || !j->surfaces || !j->shared) return fail(STATUS_FAILED, "out of memory for the surfaces");
    j->count = count;
    block_describe(in->blocks, 0, &j->grid, &whole);
    j->samples = from->samples;
    j->blanked_samples = from->blanked_points;
    j->blanked_cells = from->blanked_cells;
    j->owned[1] = j->grid.dims[2];
    if (in->o->part[1]) planes_cut_of(in->o, NULL, j->grid.dims[2], in->o->part[0], in->o->part[1], j->owned);
    for (size_t n = 0; n < j->count; n++) {
        surface_report *s = &surfaces[n];
        engine_options(in->o, &in->o->isovalues[n], &j->how[n]);
        *s = (surface_report){.iso = &in->o->isovalues[n], .has_mesh = !in->o->count, .is_streamed = 1};
        for (int axis = 0; axis < 3; axis++)
            s->summary.bounds[0][axis] = INFINITY, s->summary.bounds[1][axis] = -INFINITY;
        j->surfaces[n].report = s;
    }
    return 0;
}

/* Of more parts than layers some have nothing. */
static int run_without_planes(stream_job *j) {
    const tc_counts none = {.struct_size = sizeof none};
    for (size_t n = 0; n < j->count; n++) take_counts(j, n, &none);
    return j->status ? fail(j->status, "%s", j->text) : 0;
}

static int take_corners(void *user, const tc_mesh_piece *piece) {
    stream_job *j = user;
    const piece_file *file = j->surfaces[piece->surface].file;
    return file ? note(j, mesh_file_complete(file->file, piece->mesh)) : 0;
}

/* In a format without numbers of vertices (STL), triangles wait for vertices that the next member of the team makes.
 * Those are of the layer behind this one's planes: it is made here once more. */
static tc_status complete_triangles(stream_job *j, engine *e, const tc_stream_options *how) {
    tc_stream_options o = *how;
    const int64_t nz = j->grid.dims[2], end = j->owned[1] + LAYER_PLANES;
    int waits = 0;
    for (size_t n = 0; n < j->count; n++) waits |= j->surfaces[n].file && mesh_file_waits(j->surfaces[n].file->file);
    if (!waits) return TC_OK;
    o.owned[0] = j->owned[1];
    o.owned[1] = end < nz ? end : nz;
    o.counted = NULL;
    o.take = take_corners;
    return tc_stream(e->context, &o);
}

/* A member's planes. What was measured before is kept, as others do not measure again. */
static tc_status share_out(stream_job *j, engine *e, const tc_stream_options *how) {
    team *t = j->in->team;
    tc_status status = TC_OK;
    if (!t) return TC_OK;
    if (j->in->o->cut.kind == CUT_COST && !t->begins) status = planes_cut_by_cost(t, e->context, how, &t->begins);
    planes_cut_of(j->in->o, t->begins, j->grid.dims[2], t->rank, t->size, j->owned);
    return status;
}

static int run(stream_job *j, engine *e) {
    tc_stream_options o;
    tc_stream_options_init(&o);
    o.grid = &j->grid;
    o.surfaces = j->how;
    o.surface_count = j->count;
    o.max_memory_bytes = memory_of_stream(j->in);
    o.read = give_planes;
    o.counted = take_counts;
    o.take = j->in->o->count ? NULL : take_piece;
    o.user = j;
    progress_job_begin();
    tc_status status = share_out(j, e, &o);
    memcpy(o.owned, j->owned, sizeof o.owned);
    if (!status && j->owned[0] == j->owned[1]) return run_without_planes(j);
    if (!status) status = tc_stream(e->context, &o);
    if (!status && j->in->team) status = complete_triangles(j, e, &o);
    e->fails_alike = status == TC_ERROR_LIMIT;
    if (j->fits) return 0;
    if (j->status) return fail(j->status, "%s", j->text);
    if (status == TC_ERROR_CANCELLED && progress_status()) return progress_status();
    return status ? input_status(j->in->o, status) : 0;
}

/* The files of a team appear when those of all members are closed. */
static int publish_together(stream_job *j, int status) {
    team *t = j->in->team;
    if (status && !t->has_failed) t->leave(t, status);
    if (t->has_failed)
        team_surfaces_discard(t, j->shared, j->count);
    else
        status = team_surfaces_close(t, j->shared, j->count, &j->files);
    if (!status) team_surfaces_report(t, j->surfaces->report, j->count);
    if (!status) status = t->agree(t, output_group_publish(&j->files));
    output_group_discard(&j->files);
    return status;
}

/* Whether this process has to open the surface's file although it has nothing to put there. */
static int writes_frame(const stream_job *j, const streamed_surface *s) {
    return !j->in->team || j->shared[s - j->surfaces].shared.writes_frame;
}

/* All files, or none. */
static int publish(stream_job *j, int status) {
    static const double zero[3];
    for (size_t n = 0; n < j->count; n++) {
        streamed_surface *to = &j->surfaces[n];
        const double begin_ms = now_ms();
        if (!status && !to->report->piece_count && writes_frame(j, to)) status = open_file(j, to, zero);
        const int closed = surface_files_close_pieces(to->file, status);
        if (!status) status = closed;
        if (!status && j->in->o->output)
            status = surface_files_name(j->in->o, j->in->o->output, to->report->iso, 1, &to->report->outputs);
        to->report->write_ms += now_ms() - begin_ms;
    }
    if (j->is_counted) return publish_together(j, status);
    if (!status) return output_group_publish(&j->files);
    output_group_discard(&j->files);
    return status;
}

int stream_may_be_needed(const stream_input *in, int *may) {
    const char *why_not = obstacle(in);
    const options *o = in->o;
    const mesh_write_options how = {.format = o->format, .soup = o->soup};
    *may = 0;
    if (is_asked_for(in) && why_not)
        return fail(STATUS_USAGE, "%s cannot be %s: %s", o->operands[0],
                    in->team     ? "made by several ranks"
                    : o->part[1] ? "made in parts (--part)"
                                 : "streamed",
                    why_not);
    const int64_t nz = in->data->blocks->dims[2];
    int status = planes_cut_check(o, in->team, nz, in->team ? in->team->size : o->part[1]);
    if (status) return status;
    if (!why_not && o->output && !o->part[1]) status = mesh_file_check(o->output, &how);
    if (is_asked_for(in) && status) return status;
    const uint64_t samples = (uint64_t)in->data->blocks->point_count;
    const int is_large = samples > host_memory_available() / (MESH_MOST + ENGINE_KEEPS);
    *may = !status && !why_not && (!o->count || in->team) && (is_asked_for(in) || is_large);
    return 0;
}

int stream_surfaces(const stream_input *in, engine *e, surface_report *surfaces, int *made) {
    stream_job j = {.in = in};
    int status = begin(&j, surfaces);
    carried_fields_begin(in->carried);
    if (!status) status = run(&j, e);
    *made = !j.fits;
    status = publish(&j, j.fits ? STATUS_FAILED : status);
    if (j.fits) status = 0;
    if (!status && *made) carried_fields_tell(in->carried);
    free(j.how);
    free(j.shared);
    free(j.surfaces);
    return status;
}
