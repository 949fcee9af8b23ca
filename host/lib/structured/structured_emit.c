/*
 * Kernel 2 over all slabs, into windows of the mesh: one window where the device's buffers can hold the mesh, else one
 * after the other, each of whole layers, or of strips where a layer is too large. On devices that share the host's
 * memory a window lies in the mesh itself; else what a step has emitted is read back while the next step runs.
 */
#include "structured/structured_emission.h"

#include "kernels/structured/case_slots.h"
#include "failure.h"
#include "tables/method.h"

#include <stdlib.h>
#include <string.h>

static tc_status window_open(run *r, tc_mesh *mesh, mesh_window *w) {
    mesh_buffers *b = w->buffers;
    uint64_t v0 = w->vertex0 * CHANNEL_BYTES, v1 = w->vertex1 * CHANNEL_BYTES;
    uint64_t t0 = w->triangle0 * TRIANGLE_BYTES, t1 = w->triangle1 * TRIANGLE_BYTES;
    tc_status status = TC_OK;
    for (int n = 0; n < CHANNEL_COUNT && !status; n++)
        if (channel_in(r->made, n))
            status = mesh_part_open(r->context, &b->channels[n], &mesh->channels[n], v0, v1, &w->vertex_offset,
                                    mesh_channels[n].name);
    if (!status)
        status = mesh_part_open(r->context, &b->triangles, &mesh->triangles, t0, t1, &w->triangle_offset, "triangles");
    return status;
}

static tc_status window_sync(run *r, const mesh_window *w) {
    mesh_buffers *b = w->buffers;
    tc_status status = TC_OK;
    for (int n = 0; n < CHANNEL_COUNT && w->vertex0 < w->vertex1 && !status; n++)
        if (channel_in(r->made, n)) status = mesh_part_sync(r->context, &b->channels[n]);
    if (!status && w->triangle0 < w->triangle1) status = mesh_part_sync(r->context, &b->triangles);
    return status;
}

/* Copies bytes [first, end) of a block from a buffer that starts with byte `start` of it. */
static tc_status part_read(run *r, const device_buffer *buffer, const host_block *block, uint64_t start, uint64_t first,
                           uint64_t end) {
    if (first == end) return TC_OK;
    cl_int error = cl->EnqueueReadBuffer(r->copies, buffer->memory, CL_FALSE, first - start, end - first,
                                         (char *)block->memory + first, 0, NULL, NULL);
    return error ? context_fail(r->context, "reading the mesh back", error) : TC_OK;
}

/* Copies a part of the mesh from the window that it is in. */
static tc_status window_read(run *r, const tc_mesh *mesh, const mesh_window *w, const mesh_window *part) {
    const uint64_t bytes = CHANNEL_BYTES, start = w->vertex0 * bytes;
    const uint64_t v0 = part->vertex0 * bytes, v1 = part->vertex1 * bytes;
    tc_status status = TC_OK;
    for (int n = 0; n < CHANNEL_COUNT && !status; n++)
        if (channel_in(r->made, n)) status = part_read(r, &w->buffers->channels[n], &mesh->channels[n], start, v0, v1);
    if (!status)
        status = part_read(r, &w->buffers->triangles, &mesh->triangles, w->triangle0 * TRIANGLE_BYTES,
                           part->triangle0 * TRIANGLE_BYTES, part->triangle1 * TRIANGLE_BYTES);
    return status;
}

/* The slot of a vertex in kernel 2 where a work-item has a brick to itself. */
static uint8_t slot_of(owned_vertex v, bool of_eight) {
    static const struct {
        uint8_t slot, dx, dy, dz, type;
    } slots[2][CASE_SLOTS] = {
#define SLOT(...) {__VA_ARGS__},
        {SLOTS_OF_FOUR(SLOT)}, {SLOTS_OF_EIGHT(SLOT)}};
#undef SLOT
    for (int n = 0; n < CASE_SLOTS; n++)
        if (slots[of_eight][n].type == v.type && slots[of_eight][n].dx == v.dx && slots[of_eight][n].dy == v.dy &&
            slots[of_eight][n].dz == v.dz)
            return slots[of_eight][n].slot;
    return 0;
}

/* How kernel 2 finds a vertex of a cube: by its owner and type, or, where a work-item has a brick to itself, by its
 * slot. The type of vertices at samples follows those of edges. */
static uint8_t vertex_item(const run *r, uint8_t vertex) {
    const int types = methods[r->method].vertex_types;
    owned_vertex v = cube_vertex(vertex);
    if (v.type == VERTEX_SAMPLE && types < VERTEX_SAMPLE) v.type = (uint8_t)types;
    if (r->context->launch.work_items > 1) return (uint8_t)EDGE_ITEM(v.dx, v.dy, v.dz, v.type);
    return slot_of(v, NUMBER_TYPES(types) == 8);
}

/* Names the vertices of cases as kernel 2 does. */
static void vertices_name(const run *r, cube_case *cases, size_t count) {
    for (size_t n = 0; n < count; n++)
        for (int triangle = 0; triangle < CUBE_TRIANGLES_MAX; triangle++)
            for (int corner = 0; corner < 3; corner++)
                cases[n].vertices[triangle][corner] = vertex_item(r, cases[n].vertices[triangle][corner]);
}

/* The entries of faces on the border. */
static void caps_make(const run *r, cube_case *out) {
    cap_case caps[CAP_ENTRIES];
    methods[r->method].derive_caps(caps, r->grid->mirrored);
    for (size_t n = 0; n < CAP_ENTRIES; n++) {
        out[n] = (cube_case){.triangle_count = caps[n].triangle_count};
        memcpy(out[n].vertices, caps[n].vertices, sizeof caps[n].vertices);
    }
}

/* The table of cases of the run's method, in memory that the caller frees. */
static tc_status cases_make(const run *r, void **out, uint64_t *bytes) {
    _Static_assert(sizeof(cube_case) == CUBE_CASE_BYTES, "kernels read it so");
    _Static_assert(CASE_COUNT(VERTEX_SAMPLE) == CASES_TWO_SIGNS && CASE_COUNT(VERTEX_TYPES_MOST) == CASES_THREE_SIGNS,
                   "kernels count them so");
    _Static_assert((int)CAP_FACES == (int)CUBE_FACES && (int)CAP_FACE_CASES == (int)CAP_CASES, "kernels find them so");
    const int types = methods[r->method].vertex_types;
    const size_t count = 2 * (size_t)CASE_COUNT(types), first = (size_t)CAP_FIRST(types);
    const size_t caps = r->closed ? CAP_ENTRIES : 0;
    cube_case *cases = malloc((first + caps) * sizeof *cases);
    if (!cases) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the case table");
    methods[r->method].derive(cases, r->grid->mirrored);
    vertices_name(r, cases, count);
    uint16_t *digits = (uint16_t *)(cases + count);
    for (unsigned n = 0; n < 256; n++) digits[n] = bits_as_digits(n);
    if (r->closed) {
        caps_make(r, cases + first);
        vertices_name(r, cases + first, caps);
    }
    *out = cases;
    *bytes = (first + caps) * sizeof *cases;
    return TC_OK;
}

/* The table of cases, uploaded once per context, method and winding, with and without faces on the border. */
static tc_status cases_provide(run *r, device_buffer **out) {
    device_buffer *buffer = &r->context->work.cases[r->method][r->grid->mirrored][r->closed];
    void *cases = NULL;
    uint64_t bytes = 0;
    *out = buffer;
    if (buffer->memory) return TC_OK;
    tc_status status = cases_make(r, &cases, &bytes);
    if (!status) status = buffer_upload(r->context, buffer, cases, bytes, "the case table");
    free(cases);
    return status;
}

/* Emits the active bricks of s among [brick_first, brick_last). */
static tc_status bricks_emit(run *r, slab_ref ref, slab s, const mesh_window *w, uint64_t slab_triangle) {
    workspace *work = &r->context->work;
    const word_buffers *words = slab_words(r, ref);
    const device_buffer *coordinates =
        r->grid->kind == GRID_RECTILINEAR ? &r->grid->device->axes : slab_array(r, ref, ARRAY_POINTS);
    device_buffer *cases;
    tc_status status = cases_provide(r, &cases);
    if (status) return status;
    const cl_uint zero = 0;
    cl_int error =
        cl->EnqueueFillBuffer(r->context->queue, work->state.memory, &zero, sizeof zero,
                              (s.results.head_offset + STATE_EMIT_TICKET) * sizeof zero, sizeof zero, 0, NULL, NULL);
    if (error) return context_fail(r->context, "clearing the ticket of kernel 2", error);
    s.mesh.vertex_window = (uint32_t)w->vertex0;
    s.mesh.triangle_window = (uint32_t)(w->triangle0 - slab_triangle);
    s.mesh.vertex_offset = w->vertex_offset;
    s.mesh.triangle_offset = w->triangle_offset;
    const kernel_argument arguments[] = {ARGUMENT(s),
                                         ARGUMENT(slab_array(r, ref, ARRAY_SAMPLES)->memory),
                                         ARGUMENT(work->cells.memory),
                                         ARGUMENT(words->words.memory),
                                         ARGUMENT(words->offsets.memory),
                                         ARGUMENT(words->triangle_offsets.memory),
                                         ARGUMENT(words->bricks.memory),
                                         ARGUMENT(words->active.memory),
                                         ARGUMENT(work->state.memory),
                                         ARGUMENT(cases->memory),
                                         ARGUMENT(w->buffers->channels[CHANNEL_POSITIONS].memory),
                                         ARGUMENT(w->buffers->channels[CHANNEL_NORMALS].memory),
                                         ARGUMENT(w->buffers->triangles.memory),
                                         ARGUMENT(coordinates->memory),
                                         ARGUMENT(slab_array(r, ref, ARRAY_BLANKED_SAMPLES)->memory)};
    return kernel_launch(r->context, r->kernels.emit, "kernel emit", arguments, sizeof arguments / sizeof *arguments);
}

/* -------------------------------------------------------------------------------------------------------- emit_plan */

/* Reserves windows for the largest step at once, as a window must not grow while copies from it run. */
static tc_status windows_reserve(run *r, emit_plan *e) {
    mesh_window largest = {0};
    tc_status status = TC_OK;
    steps_largest(e, &largest.vertex1, &largest.triangle1);
    for (uint32_t n = 0; n < e->window_count && !status; n++) {
        largest.buffers = &r->context->work.mesh[n];
        status = window_open(r, e->mesh, &largest);
    }
    return status;
}

/* Releases buffers of an extraction with other windows, which would exceed the budget together with the new ones. */
static tc_status windows_begin(run *r, emit_plan *e) {
    mesh_buffers *buffers = r->context->work.mesh;
    mesh_buffers_release(r->context, &buffers[1]);
    if (e->window_count) mesh_buffers_release(r->context, &buffers[0]);
    for (uint32_t n = 0; n < e->step_count && e->window_count; n++)
        e->steps[n].part.buffers = &buffers[n % e->window_count];
    e->whole = (mesh_window){0, r->vertex_count, 0, r->triangle_count, 0, 0, &buffers[0]};
    if (!e->window_count) return window_open(r, e->mesh, &e->whole);
    return r->context->in_place ? TC_OK : windows_reserve(r, e);
}

static tc_status emit_load(run *r, uint32_t n) {
    const emit_step *step = &r->emit_plan->steps[n];
    if (!step->opens_slab) return TC_OK;
    tc_status status = slab_load(r, step->ref, true);
    return status ? status : slab_restore(r, step->ref);
}

static void step_describe(const run *r, const emit_step *step, slab *s) {
    const uint32_t bricks = (uint32_t)plan_bricks_per_layer(r->plan);
    slab_describe(r, step->ref, s);
    s->mesh.vertex_base = (uint32_t)step->slab_vertex;
    s->mesh.vertex_base_next = (uint32_t)(step->slab_vertex + r->heads[s->results.head_offset + STATE_VERTICES]);
    s->mesh.brick_first = (s->z0 - s->results.word_z) / BRICK_PLANES * bricks + step->strip0 * r->plan->words_x;
    s->mesh.brick_last = s->mesh.brick_first + (step->strip1 - step->strip0) * r->plan->words_x;
}

static tc_status step_emit(run *r, uint32_t n) {
    emit_plan *e = r->emit_plan;
    emit_step *step = &e->steps[n];
    slab s;
    step_describe(r, step, &s);
    const bool snapped_whole = r->plan->needs.zeros && r->plan->words_whole;
    const bool marked = r->plan->slab_count == 1 || snapped_whole; /* for kernel 1, and nothing has overwritten that */
    tc_status status = step->opens_slab && !marked ? slab_mark_cells(r, step->ref, &s) : TC_OK;
    if (!status && e->window_count) status = window_open(r, e->mesh, &step->part);
    if (status) return status;
    return bricks_emit(r, step->ref, s, e->window_count ? &step->part : &e->whole, step->slab_triangle);
}

/* The last copy is timed: it begins when all kernels have ended. */
static tc_status emit_unload(run *r, uint32_t n) {
    emit_plan *e = r->emit_plan;
    const emit_step *step = &e->steps[n];
    if (n + 1 == e->step_count) {
        cl_int error = cl->Finish(r->context->queue);
        if (error) return context_fail(r->context, "kernel emit", error);
        e->kernels_end_ms = clock_ms();
    }
    if (r->context->in_place) return e->window_count ? window_sync(r, &step->part) : TC_OK;
    return window_read(r, e->mesh, e->window_count ? &step->part : &e->whole, &step->part);
}

/* Steps may only overlap where what they have loaded does not share a window. */
static tc_status steps_emit(run *r, emit_plan *e) {
    const step_stages stages = {"emit", 0.5, 0.5, emit_load, step_emit, emit_unload};
    tc_status status = windows_begin(r, e);
    if (!status) status = steps_run(r, &stages, e->step_count, r->plan->overlaps && e->window_count != 1);
    if (!status && r->context->in_place && !e->window_count) status = window_sync(r, &e->whole);
    cl_int error = cl->Finish(r->context->queue);
    if (!status && error) status = context_fail(r->context, "reading the mesh back", error);
    if (!status && !r->context->in_place) e->mesh->timings.readback_ms = clock_ms() - e->kernels_end_ms;
    return status;
}

tc_status slabs_emit_whole(run *r, mesh_buffers *buffers) {
    emit_plan e = {.whole = {0, r->vertex_count, 0, r->triangle_count, 0, 0, buffers}};
    r->emit_plan = &e;
    tc_status status = steps_plan(r, &e, true);
    for (uint32_t n = 0; n < e.step_count && !status; n++) status = step_emit(r, n);
    free(e.steps);
    r->emit_plan = NULL;
    return status;
}

tc_status slabs_emit(run *r, tc_mesh *mesh) {
    emit_plan e = {.mesh = mesh};
    r->emit_plan = &e;
    tc_status status = steps_plan(r, &e, window_fits(r, r->vertex_count, r->triangle_count, 1));
    if (!status) status = steps_emit(r, &e);
    free(e.steps);
    r->emit_plan = NULL;
    return status;
}
