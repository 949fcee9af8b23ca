/*
 * The steps of a stage, a slab or a window of the mesh each: copy to the device, kernels, copy back.
 *
 * On devices with memory of their own the copies have a queue to themselves: while the kernels of a step run, the
 * results of the step before are read back and what the next one needs is uploaded. Neighbouring steps use different
 * windows, so the only order to keep is: a step's kernels after its load and after the unload two steps before, which
 * stands before that load in the queue of copies; its unload, and the next load but one, after its kernels. The host
 * waits for nothing.
 */
#include "structured/structured_run.h"

/* Makes *event that of all commands in the queue so far. */
static tc_status queue_mark(const run *r, cl_command_queue queue, cl_event *event) {
    if (*event) cl->ReleaseEvent(*event);
    *event = NULL;
    cl_int error = cl->EnqueueMarkerWithWaitList(queue, 0, NULL, event);
    if (!error) error = cl->Flush(queue);
    return error ? context_fail(r->context, "marking a place in a queue", error) : TC_OK;
}

/* Commands put into the queue from now on wait for the event. */
static tc_status queue_await(const run *r, cl_command_queue queue, const cl_event *event) {
    cl_int error = cl->EnqueueBarrierWithWaitList(queue, 1, event, NULL);
    return error ? context_fail(r->context, "making one queue wait for the other", error) : TC_OK;
}

static tc_status queue_follow(const run *r, cl_command_queue later, cl_command_queue earlier, cl_event *event) {
    tc_status status = queue_mark(r, earlier, event);
    return status ? status : queue_await(r, later, event);
}

static tc_status step_progress(const run *r, const step_stages *stages, uint32_t step, uint32_t count) {
    return context_progress(r->context, stages->name, stages->begin + stages->share * (step + 1) / count);
}

static tc_status steps_in_turn(run *r, const step_stages *stages, uint32_t count) {
    tc_status status = TC_OK;
    for (uint32_t n = 0; n < count && !status; n++) {
        status = stages->load(r, n);
        if (!status) status = stages->compute(r, n);
        if (!status) status = stages->unload(r, n);
        if (!status) status = step_progress(r, stages, n, count);
    }
    return status;
}

/* Kernels of step n, then the copies that run beside them; *loaded and *computed are of the step before on entry. */
static tc_status step_overlap(run *r, const step_stages *stages, uint32_t n, uint32_t count, cl_event *loaded,
                              cl_event *computed) {
    tc_status status = queue_await(r, r->context->queue, loaded);
    if (!status) status = stages->compute(r, n);
    if (!status && n) status = queue_await(r, r->copies, computed);
    if (!status) status = queue_mark(r, r->context->queue, computed);
    if (!status && n) status = stages->unload(r, n - 1);
    if (!status && n + 1 < count) status = stages->load(r, n + 1);
    if (!status) status = queue_mark(r, r->copies, loaded);
    return status ? status : step_progress(r, stages, n, count);
}

static tc_status steps_overlap(run *r, const step_stages *stages, uint32_t count) {
    cl_event loaded = NULL, computed = NULL;
    tc_status status = copies_queue_provide(r->context);
    if (status) return status;
    r->copies = r->context->copies;
    status = queue_follow(r, r->copies, r->context->queue, &loaded);
    if (!status) status = stages->load(r, 0);
    if (!status) status = queue_mark(r, r->copies, &loaded);
    for (uint32_t n = 0; n < count && !status; n++) status = step_overlap(r, stages, n, count, &loaded, &computed);
    if (!status) status = queue_await(r, r->copies, &computed);
    if (!status) status = stages->unload(r, count - 1);
    if (!status) status = queue_follow(r, r->context->queue, r->copies, &loaded);
    if (status) cl->Finish(r->copies);
    r->copies = r->context->queue;
    if (loaded) cl->ReleaseEvent(loaded);
    if (computed) cl->ReleaseEvent(computed);
    return status;
}

tc_status steps_run(run *r, const step_stages *stages, uint32_t count, bool overlaps) {
    return overlaps && count > 1 ? steps_overlap(r, stages, count) : steps_in_turn(r, stages, count);
}
