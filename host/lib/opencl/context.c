#include "opencl/context.h"

#include "failure.h"
#include "base/float_environment.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

double clock_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

tc_status context_fail(const tc_context *context, const char *what, cl_int error) {
    char whole[512];
    if (!context->info.name[0]) return opencl_fail(what, error);
    snprintf(whole, sizeof whole, "%s on %s", what, context->info.name);
    return opencl_fail(whole, error);
}

tc_status context_progress(const tc_context *context, const char *stage, double fraction) {
    if (!context->options.progress || context->trial_runs) return TC_OK;
    float_environment *lent = float_environment_lend();
    int stop = context->options.progress(context->options.progress_user, stage,
                                         context->progress_begin + context->progress_share * fraction);
    float_environment_resume(lent);
    return stop ? (tc_status)fail(TC_ERROR_CANCELLED, "cancelled") : TC_OK;
}

/* ------------------------------------------------------------------------------------------------- forked processes */

bool context_is_inherited(const tc_context *context) {
    return context->options.engine == TC_ENGINE_OPENCL && context->process != getpid();
}

tc_status context_check(const tc_context *context) {
    return context_is_inherited(context) ? opencl_forked_fail("this context was made before a fork()") : TC_OK;
}

void context_finish(const tc_context *context) {
    if (context->queue && !context_is_inherited(context)) cl->Finish(context->queue);
}

uint64_t context_budget(const tc_context *context) {
    if (context->options.max_memory_bytes) return context->options.max_memory_bytes;
    return context->in_place ? UINT64_MAX : context->info.global_memory_bytes;
}

bool device_makes_vertices(const tc_context *context, tc_type type) {
    return context->info.has_fp64 || !type_is_wide(type);
}

tc_status copies_queue_provide(tc_context *context) {
    cl_int error = CL_SUCCESS;
    if (!context->copies) context->copies = cl->CreateCommandQueue(context->context, context->device, 0, &error);
    return error ? context_fail(context, "making a command queue for copies", error) : TC_OK;
}
