/*
 * Cuts a surface into steps that fit windows, by the prefix sums that kernel 1 has stored with every brick.
 */
#include "structured/structured_emission.h"

#include "failure.h"

#include <stdlib.h>
#include <string.h>

bool window_fits(const run *r, uint64_t vertices, uint64_t triangles, uint32_t windows) {
    uint64_t most = r->context->info.max_buffer_bytes - PAGE_BYTES;
    return vertices * CHANNEL_BYTES <= most && triangles * TRIANGLE_BYTES <= most && triangles <= UINT32_MAX &&
           channels_mesh_bytes(r->made, vertices, triangles) <= r->plan->mesh_bytes / windows;
}

void steps_largest(const emit_plan *e, uint64_t *vertices, uint64_t *triangles) {
    *vertices = *triangles = 0;
    for (uint32_t n = 0; n < e->step_count; n++) {
        const mesh_window *part = &e->steps[n].part;
        if (part->vertex1 - part->vertex0 > *vertices) *vertices = part->vertex1 - part->vertex0;
        if (part->triangle1 - part->triangle0 > *triangles) *triangles = part->triangle1 - part->triangle0;
    }
}

/* Prefix sums in the slab before strips, taken from the first brick of a strip: of every layer the first strip, and of
 * one layer all strips. */
typedef struct strip_sums {
    brick_state *layers;
    brick_state *bricks; /* all of a layer, made when first needed */
} strip_sums;

static tc_status layers_read(run *r, brick_state *layers) {
    const uint64_t bricks = plan_bricks_per_layer(r->plan);
    const device_buffer *buffer = &r->context->work.words[0].bricks;
    cl_int error = CL_SUCCESS;
    for (uint32_t n = 0; n < r->plan->layer_count && !error; n++)
        if (!r->plan->words_whole)
            memcpy(&layers[n], r->store.bricks + n * bricks * sizeof *layers, sizeof *layers);
        else
            error = cl->EnqueueReadBuffer(r->context->queue, buffer->memory, CL_FALSE, n * bricks * sizeof *layers,
                                          sizeof *layers, &layers[n], 0, NULL, NULL);
    cl_int finish_error = cl->Finish(r->context->queue);
    if (!error) error = finish_error;
    return error ? context_fail(r->context, "reading sums of layers", error) : TC_OK;
}

/* Layer n of the grid. */
static tc_status bricks_read(const run *r, strip_sums *sums, uint32_t n) {
    const uint64_t bricks = plan_bricks_per_layer(r->plan), bytes = bricks * sizeof *sums->bricks;
    if (!sums->bricks && !(sums->bricks = malloc((size_t)bytes)))
        return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the sums of a layer");
    if (!r->plan->words_whole) {
        memcpy(sums->bricks, r->store.bricks + n * bytes, (size_t)bytes);
        return TC_OK;
    }
    cl_int error = cl->EnqueueReadBuffer(r->context->queue, r->context->work.words[0].bricks.memory, CL_TRUE, n * bytes,
                                         bytes, sums->bricks, 0, NULL, NULL);
    return error ? context_fail(r->context, "reading sums of strips", error) : TC_OK;
}

/* Vertices and triangles before a strip of the slab, or before the next slab. */
static void strip_begin(const run *r, const strip_sums *sums, uint32_t slab_index, uint32_t strip, uint64_t at[2]) {
    const uint32_t *head = r->heads + slab_index * STATE_WORDS;
    const uint32_t layer = strip / r->plan->bricks_y, in_layer = strip % r->plan->bricks_y;
    const brick_state *brick = in_layer ? &sums->bricks[in_layer * r->plan->words_x]
                                        : &sums->layers[slab_first_layer(r->plan, slab_index) + layer];
    bool end = layer == slab_layer_count(r->plan, slab_index);
    at[0] = strip == 0 ? 0 : end ? head[STATE_VERTICES] : brick->vertices;
    at[1] = strip == 0 ? 0 : end ? head[STATE_TRIANGLES] : brick->triangles;
}

/* The part of the mesh that strips [step->strip0, strip1) of the slab make. */
static void step_end(const run *r, const strip_sums *sums, emit_step *step, uint32_t strip1) {
    uint64_t from[2], to[2];
    strip_begin(r, sums, step->ref.slab_index, step->strip0, from);
    strip_begin(r, sums, step->ref.slab_index, strip1, to);
    step->strip1 = strip1;
    step->part.vertex0 = step->slab_vertex + from[0];
    step->part.vertex1 = step->slab_vertex + to[0];
    step->part.triangle0 = step->slab_triangle + from[1];
    step->part.triangle1 = step->slab_triangle + to[1];
}

/* Whether the step fits a window that is halved `shrink` times. */
static bool step_fits(const run *r, const emit_plan *e, const emit_step *step, unsigned shrink) {
    const mesh_window *part = &step->part;
    return e->window_count == 0 ||
           window_fits(r, part->vertex1 - part->vertex0, part->triangle1 - part->triangle0, e->window_count << shrink);
}

/* Windows of a device with memory of its own are as large as any step needs: one may have the most vertices, another
 * the most triangles. */
static bool windows_fit(const run *r, const emit_plan *e) {
    uint64_t vertices, triangles;
    if (e->window_count == 0 || r->context->in_place) return true;
    steps_largest(e, &vertices, &triangles);
    return window_fits(r, vertices, triangles, e->window_count);
}

static tc_status strip_refuse(const run *r, const mesh_window *part) {
    return (tc_status)fail(
        TC_ERROR_MEMORY,
        "a row of bricks of this surface has %llu bytes, more than the memory budget leaves (%llu) or a buffer may "
        "have "
        "(%llu): allow %llu or more",
        (unsigned long long)channels_mesh_bytes(r->made, part->vertex1 - part->vertex0,
                                                part->triangle1 - part->triangle0),
        (unsigned long long)r->plan->mesh_bytes, (unsigned long long)r->context->info.max_buffer_bytes,
        (unsigned long long)plan_budget(r->context, r->grid, r->plan->needs));
}

static tc_status step_add(emit_plan *e, const emit_step *step) {
    if (e->step_count == e->step_capacity) {
        const uint32_t capacity = 2 * e->step_capacity + 16;
        emit_step *grown = realloc(e->steps, capacity * sizeof *grown);
        if (!grown) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the parts of a surface");
        e->steps = grown;
        e->step_capacity = capacity;
    }
    e->steps[e->step_count++] = *step;
    return TC_OK;
}

/* Makes the step as long as fits, by `stride` strips at a time and up to strip `most`; false where not even the first
 * stride fits, with which the step then ends. */
static bool step_stretch(const run *r, const emit_plan *e, const strip_sums *sums, emit_step *step, uint32_t stride,
                         uint32_t most) {
    emit_step longer = *step;
    step_end(r, sums, step, e->window_count ? step->strip0 + stride : most);
    if (!step_fits(r, e, step, stride == 1 ? 0 : e->shrink)) return false;
    while (step->strip1 < most) {
        step_end(r, sums, &longer, step->strip1 + stride);
        if (!step_fits(r, e, &longer, e->shrink)) break;
        *step = longer;
    }
    return true;
}

/* Cuts a slab into few steps: whole layers, or strips in a layer that is too large. *fits is false where a strip is too
 * large; the last step is then that strip. */
static tc_status slab_cut(const run *r, emit_plan *e, strip_sums *sums, emit_step first, bool *fits) {
    const uint32_t strips = r->plan->bricks_y, slab_strips = slab_layer_count(r->plan, first.ref.slab_index) * strips;
    tc_status status = TC_OK;
    for (emit_step step = first; step.strip0 < slab_strips && *fits && !status; step.strip0 = step.strip1) {
        const uint32_t layer = step.strip0 / strips;
        step.opens_slab = step.strip0 == 0;
        bool whole = step.strip0 % strips == 0 && step_stretch(r, e, sums, &step, strips, slab_strips);
        if (!whole && step.strip0 % strips == 0)
            status = bricks_read(r, sums, slab_first_layer(r->plan, first.ref.slab_index) + layer);
        if (!whole && !status) *fits = step_stretch(r, e, sums, &step, 1, (layer + 1) * strips);
        if (!status) status = step_add(e, &step);
    }
    return status;
}

static tc_status slabs_cut(const run *r, emit_plan *e, strip_sums *sums, bool *fits) {
    uint32_t active = 0;
    emit_step first = {0};
    tc_status status = TC_OK;
    *fits = true;
    e->step_count = 0;
    for (uint32_t n = 0; n < r->plan->own_slabs && *fits && !status; n++) {
        const uint32_t *head = r->heads + n * STATE_WORDS;
        first.ref = (slab_ref){n, active % plan_window_count(r->plan)};
        if (head[STATE_ACTIVE_BRICKS]) {
            status = slab_cut(r, e, sums, first, fits);
            active++;
        }
        first.slab_vertex += head[STATE_VERTICES];
        first.slab_triangle += head[STATE_TRIANGLES];
    }
    return status;
}

/* Makes steps smaller, down to one strip each, while the windows for the largest step do not fit together. *fits as for
 * slab_cut. */
static tc_status windows_cut(const run *r, emit_plan *e, strip_sums *sums, bool *fits) {
    enum { SHRINK_MOST = 20 };
    e->shrink = 0;
    tc_status status = slabs_cut(r, e, sums, fits);
    while (!status && *fits && !windows_fit(r, e) && e->shrink < SHRINK_MOST) {
        e->shrink++;
        status = slabs_cut(r, e, sums, fits);
    }
    *fits = *fits && (status || windows_fit(r, e));
    return status;
}

tc_status steps_plan(run *r, emit_plan *e, bool whole) {
    strip_sums sums = {.layers = calloc(r->plan->layer_count, sizeof *sums.layers)};
    tc_status status = TC_OK;
    bool fits = false;
    if (!sums.layers) status = (tc_status)fail(TC_ERROR_MEMORY, "no memory for the sums of layers");
    e->window_count = whole ? 0 : r->plan->overlaps ? 2 : 1;
    if (!status && !whole) status = layers_read(r, sums.layers);
    if (!status) status = windows_cut(r, e, &sums, &fits);
    if (!status && !fits && e->window_count == 2) {
        e->window_count = 1;
        status = windows_cut(r, e, &sums, &fits);
    }
    if (!status && !fits) status = strip_refuse(r, &e->steps[e->step_count - 1].part);
    free(sums.layers);
    free(sums.bricks);
    return status;
}
