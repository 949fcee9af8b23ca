#include "labels/label_run.h"

#include "failure.h"
#include "kernels/labels/label_job.h"
#include "opencl/context.h"
#include "structured/structured.h"

#include <stdlib.h>
#include <string.h>

typedef struct label_slab {
    uint32_t first, layers; /* of bricks */
    uint64_t vertices, triangles, cells;
} label_slab;

typedef struct label_run {
    const label_volume *v;
    tc_context *context;
    scan_parameters scan;
    label_buffers *work;
    cl_mem whole; /* the grid's samples, where the device has them all and they are the volume's; else NULL */
    uint64_t whole_offset;
    uint64_t held; /* bytes on the device before the run */
    sized_kernel kernels[LABEL_KERNELS];
    label_job base; /* what all slabs share */
    uint32_t layer_count;
    uint64_t layer_bricks, sample_bytes;
    label_slab *slabs;
    uint32_t slab_count;
    uint32_t head[LABEL_HEAD_WORDS];
    double start_ms; /* kernels are built by then */
} label_run;

enum { PLANES_BEHIND = BRICK_PLANES + 1 }; /* of a slab: the layer that is counted too, and a plane more */

kernel_kind labels_kind(const label_volume *volume) {
    return (kernel_kind){.grid = KIND_LABELS, .type = volume->type, .made = POSITIONS_ALONE, .emits = true};
}

/* ------------------------------------------------------------------------------------------------------------ slabs */

static int64_t lesser(int64_t a, int64_t b) { return a < b ? a : b; }

/* Planes of samples that a slab's kernels read: from its first to before this one. */
static int64_t planes_end(const label_run *r, const label_slab *part) {
    return lesser((int64_t)(part->first + part->layers) * BRICK_PLANES + PLANES_BEHIND, r->v->dims[2]);
}

static uint32_t counted_layers(const label_run *r, const label_slab *part) {
    return part->first + part->layers < r->layer_count ? part->layers + 1 : part->layers;
}

static uint32_t tiles_of(uint64_t bricks, uint32_t tile_bricks) {
    return (uint32_t)((bricks + tile_bricks - 1) / tile_bricks);
}

static label_job job_of(const label_run *r, const label_slab *part) {
    label_job job = r->base;
    job.sample_z = job.z0 = part->first * BRICK_PLANES;
    job.z1 = (uint32_t)lesser((int64_t)(part->first + counted_layers(r, part)) * BRICK_PLANES, r->v->dims[2]);
    job.brick_count = (uint32_t)(counted_layers(r, part) * r->layer_bricks);
    job.own_bricks = (uint32_t)(part->layers * r->layer_bricks);
    job.own_tiles = tiles_of(job.own_bricks, job.tile_bricks);
    job.tile_count = job.own_tiles + tiles_of(job.brick_count - job.own_bricks, job.tile_bricks);
    return job;
}

/* Device memory that a slab takes but for its mesh. */
enum {
    WORDS_BYTES = 8 * LABEL_WORDS * BRICK_WORDS,
    OFFSETS_BYTES = 2 * LABEL_OFFSETS * BRICK_WORDS,
    BASES_BYTES = (int)sizeof(label_row_base) * BRICK_WORDS,
    BRICK_BYTES = WORDS_BYTES + OFFSETS_BYTES + BASES_BYTES + 8,
    FIXED_BYTES = 1 << 16
};

static uint64_t plane_bytes(const label_run *r) {
    return (uint64_t)r->v->dims[0] * (uint64_t)r->v->dims[1] * r->sample_bytes;
}

static uint64_t slab_bytes(const label_run *r, const label_slab *part) {
    const uint64_t bricks = counted_layers(r, part) * r->layer_bricks;
    const uint64_t planes = (uint64_t)(planes_end(r, part) - (int64_t)part->first * BRICK_PLANES);
    return FIXED_BYTES + bricks * (BRICK_BYTES + 4 * TILE_WORDS) + planes * (r->whole ? 0 : plane_bytes(r));
}

static uint64_t mesh_bytes(const label_slab *part) {
    return part->vertices * CHANNEL_BYTES + part->triangles * (TRIANGLE_BYTES + LABELS_BYTES);
}

/* Whether the slab's buffers fit the device, and its sums the words of the scan. */
static bool slab_fits(const label_run *r, const label_slab *part, uint64_t more) {
    const tc_device_info *info = &r->context->info;
    const uint64_t bricks = counted_layers(r, part) * r->layer_bricks, needed = slab_bytes(r, part) + more;
    const uint64_t planes = (uint64_t)(planes_end(r, part) - (int64_t)part->first * BRICK_PLANES);
    const uint64_t budget = context_budget(r->context);
    return r->held <= budget && needed <= budget - r->held && bricks * WORDS_BYTES <= info->max_buffer_bytes &&
           planes * plane_bytes(r) <= info->max_buffer_bytes && bricks <= UINT32_MAX / BRICK_WORDS;
}

static tc_status refuse(const label_run *r, const label_slab *part) {
    return (tc_status)fail(TC_ERROR_MEMORY,
                           "%s has no room for a layer of the label map and its surfaces: allow %llu bytes "
                           "or more, or use the reference engine",
                           r->context->info.name,
                           (unsigned long long)(r->held + slab_bytes(r, part) + mesh_bytes(part)));
}

/* ---------------------------------------------------------------------------------------------------------- buffers */

static tc_status samples_load(label_run *r, const label_slab *part, label_job *job) {
    const uint64_t first = (uint64_t)part->first * BRICK_PLANES * plane_bytes(r);
    const uint64_t bytes = (uint64_t)planes_end(r, part) * plane_bytes(r) - first;
    const char *from = (const char *)r->v->samples + first;
    if (r->whole) {
        job->sample_z = 0;
        job->sample_offset = r->whole_offset;
        job->sample_count = plane_bytes(r) / r->sample_bytes * (uint64_t)r->v->dims[2];
        return TC_OK;
    }
    job->sample_count = bytes / r->sample_bytes;
    return buffer_provide(r->context, &r->work->samples, from, bytes, r->sample_bytes, &job->sample_offset, "samples");
}

static tc_status clear(const label_run *r, const device_buffer *buffer, uint64_t bytes) {
    const cl_uint zero = 0;
    cl_int error =
        cl->EnqueueFillBuffer(r->context->queue, buffer->memory, &zero, sizeof zero, 0, bytes, 0, NULL, NULL);
    return error ? context_fail(r->context, "clearing a buffer", error) : TC_OK;
}

/* All but the tables. */
static void buffers_release(const label_run *r) {
    label_buffers *w = r->work;
    device_buffer *const buffers[] = {&w->samples, &w->words, &w->offsets,   &w->bases,     &w->rows,
                                      &w->active,  &w->state, &w->positions, &w->triangles, &w->labels};
    cl->Finish(r->context->queue);
    for (size_t n = 0; n < sizeof buffers / sizeof *buffers; n++) buffer_release(r->context, buffers[n]);
}

static tc_status work_reserve(label_run *r, const label_job *job) {
    label_buffers *w = r->work;
    const uint64_t bricks = job->brick_count, state = 4 * (LABEL_HEAD_WORDS + (uint64_t)TILE_WORDS * job->tile_count);
    tc_status status = buffer_reserve(r->context, &w->words, bricks * WORDS_BYTES, "words of labels");
    if (!status) status = buffer_reserve(r->context, &w->offsets, bricks * OFFSETS_BYTES, "vertex offsets");
    if (!status) status = buffer_reserve(r->context, &w->bases, bricks * BASES_BYTES, "rows");
    if (!status) status = buffer_reserve(r->context, &w->rows, 4 * bricks, "bricks");
    if (!status) status = buffer_reserve(r->context, &w->active, 4 * bricks, "active bricks");
    if (!status) status = buffer_reserve(r->context, &w->state, state, "the scan");
    if (!status) status = clear(r, &w->rows, 4 * bricks);
    return status ? status : clear(r, &w->state, state);
}

/* Uploaded once per context. */
static tc_status tables_provide(label_run *r) {
    uint32_t words[LABEL_TABLE_WORDS];
    device_buffer *tables = &r->work->tables[r->v->grid->mirrored];
    if (tables->memory) return TC_OK;
    label_table_make(r->v->grid->mirrored, words);
    return buffer_upload(r->context, tables, words, sizeof words, "the tables of labels");
}

/* -------------------------------------------------------------------------------------------------- classification */

static tc_status read_words(const label_run *r, uint64_t first, uint64_t count, uint32_t *words) {
    cl_int error = cl->EnqueueReadBuffer(r->context->queue, r->work->state.memory, CL_TRUE, 4 * first, 4 * count, words,
                                         0, NULL, NULL);
    return error ? context_fail(r->context, "reading totals", error) : TC_OK;
}

/* Sums of the slab's own tiles: of the last one, but for their two highest bits. */
static tc_status totals_read(label_run *r, const label_job *job, label_slab *part) {
    uint32_t sums[TILE_WORDS];
    const uint64_t last = LABEL_HEAD_WORDS + (uint64_t)TILE_WORDS * (job->own_tiles - 1);
    tc_status status = read_words(r, 0, LABEL_HEAD_WORDS, r->head);
    if (!status) status = read_words(r, last, TILE_WORDS, sums);
    if (status) return status;
    part->vertices = sums[TILE_SUM_X] & (UINT32_MAX >> 2);
    part->triangles = sums[TILE_SUM_Y] & (UINT32_MAX >> 2);
    part->cells = r->head[LABEL_ACTIVE_CELLS];
    return TC_OK;
}

static tc_status slab_classify(label_run *r, label_slab *part, label_job *job) {
    const label_buffers *w = r->work;
    *job = job_of(r, part);
    if (r->context->options.max_memory_bytes) buffers_release(r); /* what another slab has left is of other sizes */
    tc_status status = samples_load(r, part, job);
    if (!status) status = work_reserve(r, job);
    if (status) return status;
    cl_mem samples = r->whole ? r->whole : w->samples.memory;
    const kernel_argument arguments[] = {ARGUMENT(*job),
                                         ARGUMENT(samples),
                                         ARGUMENT(w->words.memory),
                                         ARGUMENT(w->offsets.memory),
                                         ARGUMENT(w->bases.memory),
                                         ARGUMENT(w->rows.memory),
                                         ARGUMENT(w->active.memory),
                                         ARGUMENT(w->state.memory)};
    status = kernel_launch(r->context, r->kernels[LABEL_CLASSIFY], "kernel label_classify", arguments,
                           sizeof arguments / sizeof *arguments);
    return status ? status : totals_read(r, job, part);
}

/* Whether the slab's sums, with those of the layer behind, may be too large for the scan: each tile has added its own,
 * in units of 64. */
static bool sums_overflow(const label_run *r) {
    const uint32_t most = 1u << 24;
    return r->head[LABEL_VERTEX_UNITS] >= most || r->head[LABEL_TRIANGLE_UNITS] >= most;
}

/* The next slab: as many layers as fit, with their mesh. */
static tc_status slab_count(label_run *r, label_slab *part, label_job *job) {
    for (;; part->layers = (part->layers + 1) / 2) {
        part->vertices = part->triangles = 0;
        tc_status status = TC_OK;
        bool fits = slab_fits(r, part, 0);
        if (fits) status = slab_classify(r, part, job);
        if (status) return status;
        fits = fits && !sums_overflow(r) && slab_fits(r, part, mesh_bytes(part));
        if (fits) return TC_OK;
        if (part->layers == 1) return refuse(r, part);
    }
}

static tc_status slabs_count(label_run *r, label_job *job) {
    uint32_t layers = r->layer_count, first = 0;
    r->slabs = calloc(r->layer_count, sizeof *r->slabs);
    if (!r->slabs) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the slabs of a label map");
    while (first < r->layer_count) {
        label_slab *part = &r->slabs[r->slab_count++];
        *part =
            (label_slab){.first = first, .layers = layers < r->layer_count - first ? layers : r->layer_count - first};
        tc_status status = slab_count(r, part, job);
        layers = part->layers;
        first += layers;
        if (!status) status = context_progress(r->context, "classify", 0.5 * (double)first / (double)r->layer_count);
        if (status) return status;
    }
    return TC_OK;
}

/* --------------------------------------------------------------------------------------------------------- emission */

static tc_status emit_launch(const label_run *r, const label_job *job) {
    const label_buffers *w = r->work;
    cl_mem samples = r->whole ? r->whole : w->samples.memory;
    const kernel_argument arguments[] = {ARGUMENT(*job),
                                         ARGUMENT(samples),
                                         ARGUMENT(w->words.memory),
                                         ARGUMENT(w->offsets.memory),
                                         ARGUMENT(w->bases.memory),
                                         ARGUMENT(w->rows.memory),
                                         ARGUMENT(w->active.memory),
                                         ARGUMENT(w->state.memory),
                                         ARGUMENT(w->tables[r->v->grid->mirrored].memory),
                                         ARGUMENT(w->positions.memory),
                                         ARGUMENT(w->triangles.memory),
                                         ARGUMENT(w->labels.memory)};
    tc_status status = kernel_launch(r->context, r->kernels[LABEL_EMIT], "kernel label_emit", arguments,
                                     sizeof arguments / sizeof *arguments);
    cl_int error = status ? CL_SUCCESS : cl->Finish(r->context->queue);
    return error ? context_fail(r->context, "kernel label_emit", error) : status;
}

/* vertex, triangle: the slab's first in the mesh. */
static tc_status slab_emit(label_run *r, const label_slab *part, label_job *job, uint64_t vertex, uint64_t triangle,
                           tc_mesh *mesh) {
    label_buffers *w = r->work;
    const host_block *positions = &mesh->channels[CHANNEL_POSITIONS];
    const uint64_t p0 = vertex * CHANNEL_BYTES, p1 = p0 + part->vertices * CHANNEL_BYTES;
    const uint64_t t0 = triangle * TRIANGLE_BYTES, t1 = t0 + part->triangles * TRIANGLE_BYTES;
    const uint64_t l0 = triangle * LABELS_BYTES, l1 = l0 + part->triangles * LABELS_BYTES;
    if (!part->vertices) return TC_OK;
    job->vertex_base = (uint32_t)vertex;
    tc_context *c = r->context;
    tc_status status = mesh_part_open(c, &w->positions, positions, p0, p1, &job->position_offset, "positions");
    if (!status)
        status = mesh_part_open(c, &w->triangles, &mesh->triangles, t0, t1, &job->triangle_offset, "triangles");
    if (!status) status = mesh_part_open(c, &w->labels, &mesh->boundary_labels, l0, l1, &job->label_offset, "labels");
    if (!status) status = emit_launch(r, job);
    if (!status) status = mesh_part_close(c, &w->positions, positions, p0, p1);
    if (!status) status = mesh_part_close(c, &w->triangles, &mesh->triangles, t0, t1);
    return status ? status : mesh_part_close(c, &w->labels, &mesh->boundary_labels, l0, l1);
}

/* job: of the slab that was counted last. One slab need not be counted again. */
static tc_status slabs_emit(label_run *r, label_job *job, tc_mesh *mesh) {
    uint64_t vertex = 0, triangle = 0;
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < r->slab_count && !status; n++) {
        label_slab again = r->slabs[n];
        if (r->slab_count > 1) status = slab_classify(r, &again, job);
        if (!status && (again.vertices != r->slabs[n].vertices || again.triangles != r->slabs[n].triangles))
            status = (tc_status)fail(TC_ERROR_DATA, "samples have changed while a surface was made of them");
        if (!status) status = slab_emit(r, &again, job, vertex, triangle, mesh);
        vertex += again.vertices;
        triangle += again.triangles;
        if (!status) status = context_progress(r->context, "emit", 0.5 + 0.5 * (n + 1.0) / r->slab_count);
    }
    return status;
}

/* -------------------------------------------------------------------------------------------------------------- run */

/* Of the buffers that the run uses again. */
static uint64_t buffers_bytes(const label_buffers *w) {
    const device_buffer *buffers = (const device_buffer *)w;
    uint64_t sum = 0;
    for (size_t n = 0; n < sizeof *w / sizeof *buffers; n++) sum += buffers[n].bytes;
    return sum;
}

static tc_status run_begin(label_run *r, const label_volume *v, scan_parameters scan) {
    tc_context *context = v->grid->context;
    const uint32_t usual = context->launch.work_items == 1 ? 64 : context->launch.work_items / BRICK_WORDS * 4;
    *r = (label_run){.v = v, .context = context, .scan = scan, .work = &context->work.labels};
    r->sample_bytes = sample_bytes(v->type);
    r->base = (label_job){.nx = (uint32_t)v->dims[0],
                          .ny = (uint32_t)v->dims[1],
                          .nz = (uint32_t)v->dims[2],
                          .words_x = (uint32_t)((v->dims[0] + 63) / 64),
                          .bricks_y = (uint32_t)((v->dims[1] + BRICK_ROWS - 1) / BRICK_ROWS),
                          .parity = label_volume_parity(v),
                          .tile_bricks = scan.tile_bricks ? scan.tile_bricks : usual,
                          .spin_limit = scan.spin_limit,
                          .mirrored = v->grid->mirrored};
    for (int axis = 0; axis < 3; axis++) r->base.first[axis] = (int32_t)(v->grid->first[axis] - v->before);
    memcpy(r->base.matrix, v->grid->matrix, sizeof r->base.matrix);
    r->layer_count = (uint32_t)((v->dims[2] + BRICK_PLANES - 1) / BRICK_PLANES);
    r->layer_bricks = (uint64_t)r->base.words_x * r->base.bricks_y;
    context->counted_grid = context->classified_grid = NULL;
    context->workspace_grid = NULL; /* the next call of another kind makes room for itself */
    if (context->options.max_memory_bytes) {
        cl->Finish(context->queue);
        workspace_release(context);
    }
    if (!v->own) r->whole = structured_samples(v->grid, &r->whole_offset);
    tc_status status = label_kernels_get(context, labels_kind(v), r->kernels);
    r->start_ms = clock_ms();
    if (!status) status = tables_provide(r);
    r->held = context->device_bytes - buffers_bytes(r->work);
    return status;
}

static void run_end(label_run *r, tc_status status) {
    label_buffers *w = r->work;
    cl->Finish(r->context->queue);
    if (status || r->context->options.max_memory_bytes) workspace_release(r->context);
    if (r->context->in_place) { /* memory of the caller */
        buffer_release(r->context, &w->samples);
        buffer_release(r->context, &w->positions);
        buffer_release(r->context, &w->triangles);
        buffer_release(r->context, &w->labels);
    }
    free(r->slabs);
}

tc_status labels_extract(const label_volume *volume, scan_parameters scan, tc_mesh *mesh) {
    label_run r;
    label_job job;
    uint64_t vertices = 0, triangles = 0;
    tc_status status = run_begin(&r, volume, scan);
    if (!status) status = slabs_count(&r, &job);
    const double classified = clock_ms();
    mesh->active_cell_count = 0;
    for (uint32_t n = 0; n < r.slab_count; n++) {
        vertices += r.slabs[n].vertices;
        triangles += r.slabs[n].triangles;
        mesh->active_cell_count += r.slabs[n].cells;
    }
    if (!status) status = mesh_allocate_labelled(mesh, vertices, triangles);
    if (!status) status = slabs_emit(&r, &job, mesh);
    mesh->slab_count = r.slab_count;
    mesh->timings.classify_ms = classified - r.start_ms;
    mesh->timings.emit_ms = clock_ms() - classified;
    mesh->timings.total_ms = clock_ms() - r.start_ms;
    run_end(&r, status);
    return status;
}
