/*
 * Kernel 2 over all slabs, into windows of the mesh: one window where the device's buffers can hold the mesh, else one
 * after the other, each a run of whole layers. On devices that share the host's memory a window lies in the mesh
 * itself.
 */
#include "structured_run.h"

#include "failure.h"
#include "tables.h"

#include <stdlib.h>
#include <string.h>

static const uint64_t page_bytes = 4096;

/* Vertices [vertex0, vertex1) and triangles [triangle0, triangle1) of the mesh. */
typedef struct mesh_window {
    uint64_t vertex0, vertex1, triangle0, triangle1;
    uint32_t position_offset, triangle_offset; /* 32-bit items before them in the buffers */
} mesh_window;

/* Bytes [first, end) of a block: wrapped from the page that they begin in, or a buffer of their own. */
static tc_status part_open(run *r, device_buffer *buffer, const host_block *block, uint64_t first, uint64_t end,
                           uint32_t *offset, const char *name) {
    *offset = 0;
    if (first == end) return buffer_reserve(r->context, buffer, 4, name);
    if (!r->context->in_place) return buffer_reserve(r->context, buffer, end - first, name);
    uint64_t start = first & ~(page_bytes - 1);
    *offset = (uint32_t)((first - start) / 4);
    return buffer_wrap(r->context, buffer, (char *)block->memory + start, end - start, CL_MEM_READ_WRITE, name);
}

static tc_status window_open(run *r, tc_mesh *mesh, mesh_window *w) {
    workspace *work = &r->context->work;
    uint64_t v0 = w->vertex0 * MESH_BYTES_PER_VERTEX, v1 = w->vertex1 * MESH_BYTES_PER_VERTEX;
    uint64_t t0 = w->triangle0 * MESH_BYTES_PER_TRIANGLE, t1 = w->triangle1 * MESH_BYTES_PER_TRIANGLE;
    tc_status status = part_open(r, &work->positions, &mesh->positions, v0, v1, &w->position_offset, "vertices");
    if (!status && r->normals)
        status = part_open(r, &work->normals, &mesh->normals, v0, v1, &w->position_offset, "normals");
    if (!status) status = part_open(r, &work->triangles, &mesh->triangles, t0, t1, &w->triangle_offset, "triangles");
    return status;
}

/* Brings bytes [first, end) of a block to the host: a map and unmap where memory is shared, else a copy. */
static tc_status part_close(run *r, device_buffer *buffer, const host_block *block, uint64_t first, uint64_t end) {
    cl_command_queue queue = r->context->queue;
    cl_int error = CL_SUCCESS;
    if (first < end && !r->context->in_place) {
        error = cl->EnqueueReadBuffer(queue, buffer->memory, CL_FALSE, 0, end - first, (char *)block->memory + first, 0,
                                      NULL, NULL);
    } else if (first < end) {
        void *mapped =
            cl->EnqueueMapBuffer(queue, buffer->memory, CL_TRUE, CL_MAP_READ, 0, buffer->bytes, 0, NULL, NULL, &error);
        if (!error) error = cl->EnqueueUnmapMemObject(queue, buffer->memory, mapped, 0, NULL, NULL);
    }
    if (r->context->in_place) buffer_release(r->context, buffer);
    return error ? opencl_fail("reading the mesh back", error) : TC_OK;
}

static tc_status window_close(run *r, tc_mesh *mesh, const mesh_window *w) {
    workspace *work = &r->context->work;
    uint64_t v0 = w->vertex0 * MESH_BYTES_PER_VERTEX, v1 = w->vertex1 * MESH_BYTES_PER_VERTEX;
    uint64_t t0 = w->triangle0 * MESH_BYTES_PER_TRIANGLE, t1 = w->triangle1 * MESH_BYTES_PER_TRIANGLE;
    tc_status status = part_close(r, &work->positions, &mesh->positions, v0, v1);
    if (!status && r->normals) status = part_close(r, &work->normals, &mesh->normals, v0, v1);
    if (!status) status = part_close(r, &work->triangles, &mesh->triangles, t0, t1);
    return status;
}

static uint64_t window_bytes(const run *r, uint64_t vertices, uint64_t triangles) {
    return vertices * MESH_BYTES_PER_VERTEX * (r->normals ? 2 : 1) + triangles * MESH_BYTES_PER_TRIANGLE;
}

static bool window_fits(const run *r, uint64_t vertices, uint64_t triangles) {
    uint64_t most = r->context->info.max_buffer_bytes - page_bytes;
    return vertices * MESH_BYTES_PER_VERTEX <= most && triangles * MESH_BYTES_PER_TRIANGLE <= most &&
           triangles <= UINT32_MAX && window_bytes(r, vertices, triangles) <= r->plan->mesh_bytes;
}

/* How kernel 2 finds the vertex on an edge of a cube: by its place in cube_edges, or, where a work-item has a brick to
 * itself, in the brick's table of numbers, seen from the cube's. */
static uint16_t edge_item(const run *r, uint8_t edge) {
    const owned_edge e = cube_edges[edge];
    if (r->context->options.work_items > 1) return edge;
    return (uint16_t)(((e.dz * NUMBER_ROWS + e.dy) * NUMBER_COLUMNS + e.dx) * NUMBER_TYPES + e.type);
}

/* Per case the number of triangles, then their edges; the rest is never used, but read. */
static void cases_write(const run *r, uint16_t items[2][256][CASE_ITEMS]) {
    cube_case cases[2][256];
    cube_cases_derive(cases, r->grid->mirrored);
    memset(items, 0, CASES_BYTES);
    for (int n = 0; n < 2 * 256; n++) {
        const cube_case *c = &cases[n / 256][n % 256];
        uint16_t *item = items[n / 256][n % 256];
        *item++ = c->triangle_count;
        for (int triangle = 0; triangle < c->triangle_count; triangle++)
            for (int corner = 0; corner < 3; corner++) *item++ = edge_item(r, c->edges[triangle][corner]);
    }
}

/* The cube table, uploaded once per context and winding. */
static tc_status cases_provide(run *r, device_buffer **out) {
    device_buffer *buffer = &r->context->work.cases[r->grid->mirrored];
    uint16_t items[2][256][CASE_ITEMS];
    *out = buffer;
    if (buffer->memory) return TC_OK;
    tc_status status = buffer_reserve(r->context, buffer, sizeof items, "the case table");
    if (status) return status;
    cases_write(r, items);
    cl_int error =
        cl->EnqueueWriteBuffer(r->context->queue, buffer->memory, CL_TRUE, 0, sizeof items, items, 0, NULL, NULL);
    return error ? opencl_fail("uploading the case table", error) : TC_OK;
}

/* Emits the active bricks of s among [brick_first, brick_last). */
static tc_status bricks_emit(run *r, slab s, const mesh_window *w, uint64_t slab_triangle) {
    workspace *work = &r->context->work;
    device_buffer *cases;
    tc_status status = cases_provide(r, &cases);
    if (status) return status;
    const cl_uint zero = 0;
    cl_int error = cl->EnqueueFillBuffer(r->context->queue, work->state.memory, &zero, sizeof zero,
                                         (s.head_offset + STATE_EMIT_TICKET) * sizeof zero, sizeof zero, 0, NULL, NULL);
    if (error) return opencl_fail("clearing the ticket of kernel 2", error);
    s.vertex_window = (uint32_t)w->vertex0;
    s.triangle_window = (uint32_t)(w->triangle0 - slab_triangle);
    s.position_offset = w->position_offset;
    s.triangle_offset = w->triangle_offset;
    const kernel_argument arguments[] = {ARGUMENT(s),
                                         ARGUMENT(r->samples->memory),
                                         ARGUMENT(work->cells.memory),
                                         ARGUMENT(work->words.memory),
                                         ARGUMENT(work->offsets.memory),
                                         ARGUMENT(work->triangle_offsets.memory),
                                         ARGUMENT(work->bricks.memory),
                                         ARGUMENT(work->active.memory),
                                         ARGUMENT(work->state.memory),
                                         ARGUMENT(cases->memory),
                                         ARGUMENT(work->positions.memory),
                                         ARGUMENT(work->normals.memory),
                                         ARGUMENT(work->triangles.memory)};
    return kernel_launch(r, r->kernels.emit, "kernel emit", arguments, sizeof arguments / sizeof *arguments);
}

/* Where the layers of a slab begin in it: layer_count + 1 pairs of vertices and triangles. */
static tc_status layers_read(run *r, const slab *s, uint32_t layer_count, uint64_t (*begins)[2]) {
    uint64_t bricks = plan_bricks_per_layer(r->plan), first = (s->z0 - s->word_z) / BRICK_PLANES * bricks;
    const uint32_t *head = r->heads + s->head_offset;
    for (uint32_t n = 0; n < layer_count; n++) {
        brick_state brick;
        cl_int error = cl->EnqueueReadBuffer(r->context->queue, r->context->work.bricks.memory, CL_TRUE,
                                             sizeof brick * (first + n * bricks), sizeof brick, &brick, 0, NULL, NULL);
        if (error) return opencl_fail("reading sums of layers", error);
        begins[n][0] = brick.vertices, begins[n][1] = brick.triangles;
    }
    begins[layer_count][0] = head[STATE_VERTICES];
    begins[layer_count][1] = head[STATE_TRIANGLES];
    return TC_OK;
}

/* A slab in as few windows as memory allows; `first` are the vertices and triangles before it. */
static tc_status slab_emit_windows(run *r, tc_mesh *mesh, const slab *s, const uint64_t first[2]) {
    uint32_t layer_count = (s->z1 - s->z0 + BRICK_PLANES - 1) / BRICK_PLANES;
    uint32_t bricks = (uint32_t)plan_bricks_per_layer(r->plan);
    uint64_t(*begins)[2] = malloc((layer_count + 1) * sizeof *begins);
    if (!begins) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the sums of layers");
    tc_status status = layers_read(r, s, layer_count, begins);
    for (uint32_t from = 0, to; from < layer_count && !status; from = to) {
        for (to = from + 1; to < layer_count; to++)
            if (!window_fits(r, begins[to + 1][0] - begins[from][0], begins[to + 1][1] - begins[from][1])) break;
        mesh_window w = {first[0] + begins[from][0],
                         first[0] + begins[to][0],
                         first[1] + begins[from][1],
                         first[1] + begins[to][1],
                         0,
                         0};
        if (!window_fits(r, w.vertex1 - w.vertex0, w.triangle1 - w.triangle0)) {
            uint64_t bytes = window_bytes(r, w.vertex1 - w.vertex0, w.triangle1 - w.triangle0);
            status = (tc_status)fail(TC_ERROR_MEMORY,
                                     "a layer of this surface has %llu bytes, more than the memory "
                                     "budget leaves (%llu) or a buffer may have (%llu)",
                                     (unsigned long long)bytes, (unsigned long long)r->plan->mesh_bytes,
                                     (unsigned long long)r->context->info.max_buffer_bytes);
            break;
        }
        slab part = *s;
        part.brick_first = (s->z0 - s->word_z) / BRICK_PLANES * bricks + from * bricks;
        part.brick_last = part.brick_first + (to - from) * bricks;
        status = window_open(r, mesh, &w);
        if (!status) status = bricks_emit(r, part, &w, first[1]);
        if (!status) status = window_close(r, mesh, &w);
    }
    free(begins);
    return status;
}

tc_status slabs_emit(run *r, tc_mesh *mesh) {
    mesh_window whole = {0, r->vertex_count, 0, r->triangle_count, 0, 0};
    bool one_window = window_fits(r, r->vertex_count, r->triangle_count);
    uint64_t first[2] = {0, 0};
    double readback = 0;
    tc_status status = one_window ? window_open(r, mesh, &whole) : TC_OK;
    for (uint32_t n = 0; n < r->plan->slab_count && !status; n++) {
        const uint32_t *head = r->heads + n * STATE_WORDS;
        slab s;
        if (head[STATE_ACTIVE_BRICKS]) {
            status = slab_prepare(r, n, &s);
            if (!status) status = slab_restore(r, n);
            s.vertex_base = (uint32_t)first[0];
            s.vertex_base_next = (uint32_t)(first[0] + head[STATE_VERTICES]);
            s.brick_last = UINT32_MAX;
            if (!status)
                status = one_window ? bricks_emit(r, s, &whole, first[1]) : slab_emit_windows(r, mesh, &s, first);
        }
        first[0] += head[STATE_VERTICES];
        first[1] += head[STATE_TRIANGLES];
        if (!status) status = context_progress(r->context, "emit", 0.5 + 0.5 * (n + 1) / r->plan->slab_count);
    }
    cl_int error = cl->Finish(r->context->queue);
    if (!status && error) status = opencl_fail("kernel emit", error);
    if (one_window && !status) {
        readback = clock_ms();
        status = window_close(r, mesh, &whole);
        error = cl->Finish(r->context->queue);
        if (!status && error) status = opencl_fail("reading the mesh back", error);
        mesh->timings.readback_ms = r->context->in_place ? 0 : clock_ms() - readback;
    }
    return status;
}
