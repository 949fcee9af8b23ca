#include "engine.h"

#include "drivers/driver_trial.h"
#include "exit_status.h"
#include "failure.h"
#include "far.h"
#include "input/cell_sizes.h"
#include "library_status.h"
#include "progress.h"
#include "terminal/notice.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* library_status, with the way out where a device computes wrongly. */
static int engine_status(tc_status status) {
    if (status != TC_ERROR_WRONG_RESULT) return library_status(status);
    return fail(STATUS_FAILED, "%s (--engine reference, or auto)", tc_message());
}

int engine_open(const options *o, tc_engine kind, engine *e) {
    tc_context_options device;
    tc_expert_options expert;
    *e = (engine){0};
    tc_context_options_init(&device);
    tc_expert_options_init(&expert);
    device.expert = &expert;
    device.engine = kind;
    device.device = o->device;
    device.max_memory_bytes = kind == TC_ENGINE_OPENCL ? o->max_memory : 0;
    device.progress = progress_update;
    device.check_device = 1; /* also with --verify, so that no compiler runs while kernels are timed */
    expert.child_trial = trial_in_child;
    return engine_status(tc_context_create(&device, &e->context));
}

void engine_options(const options *o, const typed_isovalue *iso, tc_extract_options *how) {
    tc_extract_options_init(how);
    how->isovalue = iso->value;
    how->normals = o->normals;
    how->method = (tc_method)o->method;
    if (o->snap >= 0) how->snap = o->snap;
    how->closed = o->closed;
}

void engine_close(engine *e) {
    tc_mesh_destroy(e->mesh);
    for (int n = 0; n < e->block_count; n++) tc_grid_destroy(e->grids[n]);
    free(e->grids);
    free(e->parts);
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) free(e->joined.values[channel]);
    free(e->joined.triangles);
    tc_context_destroy(e->context);
    *e = (engine){0};
}

int engine_gives_way(const options *o, tc_engine kind, engine *e, int status) {
    if (status != STATUS_FAILED || e->fails_alike || progress_cancelled()) return 0;
    if (o->engine != ENGINE_AUTO || kind == TC_ENGINE_REFERENCE) return 0;
    notice("%s", failure_text());
    notice("the reference engine takes over");
    engine_close(e);
    return 1;
}

/* Whether positions relative to that point keep the shapes of the cells in float32 (far.h). */
static int origin_suits(const cell_range *cells, const double origin[3]) {
    for (int axis = 0; axis < 3; axis++)
        if (lies_far(cells->low[axis], cells->high[axis], cells->least[axis], origin[axis])) return 0;
    return 1;
}

static int origins_are_same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Gives block n, which has an origin of its own, the origin of the first block before it that suits it too. */
static int share_origin(const options *o, const block_list *blocks, int n, engine *e) {
    double *own = e->parts[n].origin;
    cell_range cells;
    int first = 0;
    cell_range_find(&blocks->blocks[n], 0, &cells);
    while (first < n && (!e->grids[first] || !origin_suits(&cells, e->parts[first].origin))) first++;
    if (origins_are_same(own, e->parts[first].origin)) return 0;
    memcpy(own, e->parts[first].origin, sizeof e->parts[first].origin);
    tc_grid_destroy(e->grids[n]);
    e->grids[n] = NULL;
    return block_grid(o, blocks, n, e->context, own, &e->grids[n]);
}

int engine_upload(const options *o, const block_list *blocks, engine *e) {
    e->grids = calloc((size_t)blocks->count + 1, sizeof *e->grids);
    e->parts = calloc((size_t)blocks->count + 1, sizeof *e->parts);
    if (!e->grids || !e->parts) return fail(STATUS_FAILED, "out of memory for %d blocks", blocks->count);
    e->block_count = blocks->count;
    e->suits_world = blocks_suit_world(blocks);
    for (int n = 0; n < blocks->count; n++) {
        int status = block_grid(o, blocks, n, e->context, NULL, &e->grids[n]);
        if (!status && e->grids[n]) status = library_status(tc_grid_origin(e->grids[n], e->parts[n].origin));
        if (!status && e->grids[n] && n) status = share_origin(o, blocks, n, e);
        if (status) return status;
    }
    return 0;
}

int engine_origins_differ(const engine *e, block_range blocks) {
    const mesh_part *first = NULL;
    for (int n = blocks.first; n < blocks.first + blocks.count; n++) {
        if (!e->parts[n].vertex_count) continue;
        if (first && !origins_are_same(first->origin, e->parts[n].origin)) return 1;
        first = &e->parts[n];
    }
    return 0;
}

int engine_count(engine *e, const tc_extract_options *how, tc_counts *counts) {
    *counts = (tc_counts){.struct_size = sizeof *counts};
    for (int n = 0; n < e->block_count; n++) {
        tc_counts one = {.struct_size = sizeof one};
        tc_status status = e->grids[n] ? tc_count(e->grids[n], how, &one) : TC_OK;
        e->fails_alike = status == TC_ERROR_LIMIT;
        if (status) return engine_status(status);
        counts->vertex_count += one.vertex_count;
        counts->triangle_count += one.triangle_count;
        counts->active_cell_count += one.active_cell_count;
        counts->mesh_bytes += one.mesh_bytes;
        counts->classify_ms += one.classify_ms;
    }
    return 0;
}

/* --------------------------------------------------------------------------------------------------------- joining */

enum { TRIANGLE_BYTES = 3 * sizeof(uint32_t) };

static size_t tuple_bytes(int channel) { return (size_t)mesh_channels[channel].components * sizeof(float); }

/* The memory with room for count tuples, moved where it has to be. NULL where there is no room; the memory is then as
 * it was. */
static void *resized(void *memory, uint64_t count, size_t tuple) {
    return count <= SIZE_MAX / tuple ? realloc(memory, (size_t)count * tuple) : NULL;
}

static int reserve_vertices(joined_mesh *j, uint64_t capacity, const tc_extract_options *how) {
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) {
        if (!channel_is_asked(how, channel)) continue;
        float *values = resized(j->values[channel], capacity, tuple_bytes(channel));
        if (!values) return 0;
        j->values[channel] = values;
    }
    j->vertex_capacity = capacity;
    return 1;
}

static int reserve_triangles(joined_mesh *j, uint64_t capacity) {
    uint32_t *triangles = resized(j->triangles, capacity, TRIANGLE_BYTES);
    if (!triangles) return 0;
    j->triangles = triangles;
    j->triangle_capacity = capacity;
    return 1;
}

/* Room for at least so many, and half as many more: later blocks then rarely move what is there. */
static int reserve_memory(joined_mesh *j, uint64_t vertices, uint64_t triangles, const tc_extract_options *how) {
    int is_there = vertices <= j->vertex_capacity || reserve_vertices(j, vertices + vertices / 2, how);
    if (is_there) is_there = triangles <= j->triangle_capacity || reserve_triangles(j, triangles + triangles / 2);
    return is_there ? 0 : fail(STATUS_FAILED, "out of memory for the surface of all blocks");
}

static void append_values(joined_mesh *j, const tc_mesh_data *part, int channel, uint64_t first) {
    const size_t tuple = tuple_bytes(channel), components = tuple / sizeof(float);
    memcpy(j->values[channel] + components * first, mesh_values(part, channel), part->vertex_count * tuple);
}

static int join(joined_mesh *j, const tc_mesh_data *part, const tc_extract_options *how, tc_mesh_data *sum) {
    uint64_t vertices = sum->vertex_count + part->vertex_count, triangles = sum->triangle_count + part->triangle_count;
    if (vertices > UINT32_MAX)
        return fail(STATUS_FAILED,
                    "the blocks' surfaces have %" PRIu64 " vertices together, more than the 2^32 - 1 that one mesh "
                    "holds; extract the blocks from files of their own",
                    vertices);
    int status = reserve_memory(j, vertices, triangles, how);
    if (status) return status;
    for (int channel = 0; channel < CHANNEL_COUNT && part->vertex_count; channel++)
        if (channel_is_asked(how, channel)) append_values(j, part, channel, sum->vertex_count);
    uint32_t first = (uint32_t)sum->vertex_count, *to = j->triangles + 3 * sum->triangle_count;
    for (uint64_t n = 0; n < 3 * part->triangle_count; n++) to[n] = part->triangles[n] + first;
    if (!sum->vertex_count) memcpy(sum->origin, part->origin, sizeof sum->origin);
    sum->vertex_count = vertices;
    sum->triangle_count = triangles;
    sum->active_cell_count += part->active_cell_count;
    sum->timings.classify_ms += part->timings.classify_ms;
    sum->timings.emit_ms += part->timings.emit_ms;
    sum->timings.readback_ms += part->timings.readback_ms;
    sum->timings.total_ms += part->timings.total_ms;
    if (part->slab_count > sum->slab_count) sum->slab_count = part->slab_count;
    return 0;
}

static int extract_block(engine *e, int n, const tc_extract_options *how, tc_mesh_data *data) {
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    tc_status status = e->grids[n] ? tc_extract(e->grids[n], how, &e->mesh) : TC_OK;
    if (!status && e->grids[n]) status = tc_mesh_get(e->mesh, data);
    e->fails_alike = status == TC_ERROR_LIMIT;
    e->parts[n].vertex_count = data->vertex_count;
    e->parts[n].triangle_count = data->triangle_count;
    return engine_status(status);
}

int engine_extract(engine *e, block_range blocks, const tc_extract_options *how, tc_mesh_data *data) {
    tc_mesh_data part;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    if (blocks.count == 1 && e->grids[blocks.first]) return extract_block(e, blocks.first, how, data);
    int status = reserve_memory(&e->joined, 1, 1, how);
    e->fails_alike = status != 0;
    for (int n = blocks.first; n < blocks.first + blocks.count && !status; n++) {
        if ((status = extract_block(e, n, how, &part))) break;
        status = join(&e->joined, &part, how, data);
        e->fails_alike = status != 0;
    }
    for (int channel = 0; channel < CHANNEL_COUNT; channel++)
        mesh_values_set(data, channel, channel_is_asked(how, channel) ? e->joined.values[channel] : NULL);
    data->triangles = e->joined.triangles;
    return status;
}

int engine_carry(engine *e, block_range blocks, const tc_extract_options *how, const point_field *field,
                 float *values) {
    for (int n = blocks.first; n < blocks.first + blocks.count; n++) {
        const dataset_field *from = &field->blocks[n];
        const tc_field carried = {sizeof carried, from->type, from->components, from->values};
        uint64_t count = e->parts[n].vertex_count * (uint64_t)from->components;
        int status = count ? engine_status(tc_interpolate_field(e->grids[n], how, &carried, values, count)) : 0;
        if (status) return status;
        values += count;
    }
    return 0;
}
