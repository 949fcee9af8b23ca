/*
 * Emission into buffers of the caller, after a count: nothing here waits for the device.
 */
#include "structured/structured.h"

#include "failure.h"
#include "structured/structured_run.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static tc_status counted_check(const tc_grid *grid, const tc_extract_options *options) {
    const struct device_grid *device = grid->device;
    const tc_extract_options *counted = &device->classified_options;
    const slab_plan *plan = plan_of(grid->device, options);
    if (grid->context->counted_grid != grid || counted->isovalue != options->isovalue ||
        counted->method != options->method || counted->snap != options->snap || !counted->closed != !options->closed ||
        channels_asked(counted) != channels_asked(options))
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "tc_emit emits what tc_count has counted just before: count this grid "
                               "with these options, and make no other call in between");
    if (!plan->samples_whole || !plan->words_whole)
        return (tc_status)fail(TC_ERROR_MEMORY,
                               "the device cannot hold this grid whole, as tc_emit needs it, in buffers of %llu bytes "
                               "and the memory allowed: allow %llu or more, or use tc_extract",
                               (unsigned long long)grid->context->info.max_buffer_bytes,
                               (unsigned long long)plan_budget_whole(grid->context, grid, plan->needs));
    if (!device_makes_vertices(grid->context, grid->type))
        return (tc_status)fail(TC_ERROR_DEVICE, "%s has no fp64: vertices of %s samples cannot be made there",
                               grid->context->info.name, tc_type_name(grid->type));
    return TC_OK;
}

static tc_status buffer_check(const run *r, cl_mem memory, uint64_t bytes, const char *name) {
    char whole[64];
    size_t held = 0;
    if (bytes == 0) return TC_OK;
    if (!memory) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_emit needs a buffer for %s", name);
    snprintf(whole, sizeof whole, "the buffer for %s", name);
    tc_status status = buffer_inspect(r->context, memory, CL_MEM_READ_ONLY, whole, &held);
    if (status || held >= bytes) return status;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "the buffer for %s has %llu bytes and needs %llu", name,
                           (unsigned long long)held, (unsigned long long)bytes);
}

static tc_status mesh_check(const run *r, const mesh_buffers *buffers) {
    const uint64_t vertex_bytes = r->vertex_count * CHANNEL_BYTES;
    if (r->vertex_count > UINT32_MAX || r->triangle_count > UINT32_MAX)
        return (tc_status)fail(TC_ERROR_LIMIT,
                               "%llu vertices and %llu triangles: numbers of 32 bits do not reach so far",
                               (unsigned long long)r->vertex_count, (unsigned long long)r->triangle_count);
    tc_status status = TC_OK;
    for (int n = 0; n < CHANNEL_COUNT && !status; n++)
        if (channel_in(r->made, n))
            status = buffer_check(r, buffers->channels[n].memory, vertex_bytes, mesh_channels[n].name);
    if (!status) status = buffer_check(r, buffers->triangles.memory, r->triangle_count * TRIANGLE_BYTES, "triangles");
    return status;
}

static tc_status surface_emit(tc_grid *grid, const tc_extract_options *options, const tc_device_mesh *mesh) {
    run r;
#define CHANNEL_BUFFER(NAME, member, ...) {.memory = channel_is_asked(options, CHANNEL_##NAME) ? mesh->member : NULL},
    mesh_buffers buffers = {.channels = {CHANNELS(CHANNEL_BUFFER)}, .triangles = {.memory = mesh->triangles}};
    tc_status status = run_begin(&r, grid, options, inside_range_of(grid->type, options->isovalue), true);
    if (!status) {
        memcpy(r.heads, grid->device->heads, r.plan->slab_count * STATE_WORDS * sizeof *r.heads);
        totals_add(&r);
        status = mesh_check(&r, &buffers);
    }
    if (!status && r.vertex_count) status = slabs_emit_whole(&r, &buffers);
    free(r.heads);
    return status;
}

tc_status structured_emit(tc_grid *grid, const tc_extract_options *options, const tc_device_mesh *mesh,
                          struct _cl_event **done) {
    cl_command_queue queue = grid->context->queue;
    tc_status status = counted_check(grid, options);
    if (!status && grid->device->heads) status = surface_emit(grid, options, mesh);
    cl_int error = !status && done ? cl->EnqueueMarkerWithWaitList(queue, 0, NULL, done) : CL_SUCCESS;
    if (!status && !error) error = cl->Flush(queue);
    if (!status && !error) return TC_OK;
    cl->Finish(queue); /* nothing is under way for a call that failed */
    if (done && *done) cl->ReleaseEvent(*done);
    if (done) *done = NULL;
    return status ? status : context_fail(grid->context, "marking the end of kernel emit", error);
}
