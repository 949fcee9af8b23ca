#include "streamed.h"

#include "dataset/array_memory.h"
#include "exit_status.h"
#include "failure.h"
#include "host_memory.h"
#include "input/input.h"
#include "library_status.h"
#include "progress.h"
#include "surface_files.h"

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
    int status; /* of a callback that has ended the stream, with its message */
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
    if (o->preview) return "--preview draws the whole mesh";
    return NULL;
}

static uint64_t memory_of_stream(const options *o) {
    if (o->max_memory) return o->max_memory / 2; /* the device's buffers take the other half */
    const uint64_t share = host_memory_available() / 4;
    return share < window_least ? window_least : share < window_most ? share : window_most;
}

/* ----------------------------------------------------------------------------------------------------------- source */

/* Of an address in a mapped file, or in an array that lies in one: the bytes from there to its end; else 0. */
static uint64_t bytes_in_file(const dataset *d, const char *from) {
    const char *begin = d->mapping, *end = begin + d->mapping_bytes;
    return begin && from >= begin && from < end ? (uint64_t)(end - from) : samples_in_file(from);
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

static int take_counts(void *user, const tc_counts *counts) {
    stream_job *j = user;
    for (size_t n = 0; n < j->count; n++) {
        surface_report *s = j->surfaces[n].report;
        j->surfaces[n].counts = counts[n];
        s->vertex_count = counts[n].vertex_count;
        s->triangle_count = counts[n].triangle_count;
        s->active_cell_count = counts[n].active_cell_count;
        s->classify_ms = counts[n].classify_ms;
    }
    j->fits = !j->in->o->stream && fits_memory(j);
    return j->fits;
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
    return surface_files_open_pieces(j->in->o, j->in->data, s->iso, &whole, j->in->carried, &j->files, &to->file);
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
    const double begin = now_ms();
    int status = open_file(j, to, m->origin);
    s->piece_count++;
    s->emit_ms += m->timings.emit_ms;
    s->readback_ms += m->timings.readback_ms;
    if (!j->in->o->quiet || j->in->o->json) add_bounds(s, m);
    if (!status) status = carried_fields_of_piece(j->in->carried, piece, plane, &j->how[piece->surface]);
    progress_bytes(12 * (m->vertex_count + m->triangle_count));
    if (!status && to->file)
        status = mesh_file_add(to->file->file, piece->first_vertex, piece->first_triangle, m, j->in->carried->fields);
    s->write_ms += now_ms() - begin;
    return note(j, status ? status : progress_status());
}

/* -------------------------------------------------------------------------------------------------------------- run */

static int begin(stream_job *j, surface_report *surfaces) {
    const stream_input *in = j->in;
    const scalar_block *from = in->blocks->blocks->scalar;
    tc_grid_options whole;
    j->count = in->o->isovalue_count;
    j->how = calloc(j->count, sizeof *j->how);
    j->surfaces = calloc(j->count, sizeof *j->surfaces);
    if (!j->how || !j->surfaces) return fail(STATUS_FAILED, "out of memory for the surfaces");
    block_describe(in->blocks, 0, &j->grid, &whole);
    j->samples = from->samples;
    j->blanked_samples = from->blanked_points;
    j->blanked_cells = from->blanked_cells;
    for (size_t n = 0; n < j->count; n++) {
        surface_report *s = &surfaces[n];
        engine_options(in->o, &in->o->isovalues[n], &j->how[n]);
        *s = (surface_report){.iso = &in->o->isovalues[n], .has_mesh = 1, .is_streamed = 1};
        for (int axis = 0; axis < 3; axis++)
            s->summary.bounds[0][axis] = INFINITY, s->summary.bounds[1][axis] = -INFINITY;
        j->surfaces[n].report = s;
    }
    return 0;
}

static int run(stream_job *j, engine *e) {
    tc_stream_options o;
    tc_stream_options_init(&o);
    o.grid = &j->grid;
    o.surfaces = j->how;
    o.surface_count = j->count;
    o.max_memory_bytes = memory_of_stream(j->in->o);
    o.read = give_planes;
    o.counted = take_counts;
    o.take = take_piece;
    o.user = j;
    progress_job_begin();
    const tc_status status = tc_stream(e->context, &o);
    e->fails_alike = status == TC_ERROR_LIMIT;
    if (j->fits) return 0;
    if (j->status) return fail(j->status, "%s", j->text);
    if (status == TC_ERROR_CANCELLED && progress_status()) return progress_status();
    return status ? input_status(j->in->o, status) : 0;
}

/* All files, or none. */
static int publish(stream_job *j, int status) {
    static const double zero[3];
    for (size_t n = 0; n < j->count; n++) {
        streamed_surface *to = &j->surfaces[n];
        const double begin_ms = now_ms();
        if (!status && !to->report->piece_count) status = open_file(j, to, zero);
        const int closed = surface_files_close_pieces(to->file, status);
        if (!status) status = closed;
        if (!status && j->in->o->output)
            to->report->path = surface_files_describe(j->in->o, j->in->o->output, to->report->iso, 1);
        to->report->write_ms += now_ms() - begin_ms;
    }
    if (!status) return output_group_publish(&j->files);
    output_group_discard(&j->files);
    return status;
}

int stream_may_be_needed(const stream_input *in, int *may) {
    const char *why_not = obstacle(in);
    const options *o = in->o;
    const mesh_write_options how = {.format = o->format, .soup = o->soup};
    *may = 0;
    if (o->stream && why_not) return fail(STATUS_USAGE, "%s cannot be streamed: %s", o->operands[0], why_not);
    const int status = why_not || !o->output ? 0 : mesh_file_check(o->output, &how);
    if (o->stream && status) return status;
    const uint64_t samples = (uint64_t)in->data->blocks->point_count;
    const int is_large = samples > host_memory_available() / (MESH_MOST + ENGINE_KEEPS);
    *may = !status && !why_not && !o->count && (o->stream || is_large);
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
    free(j.surfaces);
    return status;
}
