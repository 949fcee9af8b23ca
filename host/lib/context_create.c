/*
 * The public calls on contexts: they choose and open a device, and choose launch parameters.
 */
#include "context_create.h"

#include "opencl/device.h"
#include "failure.h"
#include "base/float_environment.h"
#include "opencl/program.h"
#include "base/structs.h"
#include "opencl/vetting.h"
#include "tetrahedra/whole_cases.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *tc_message(void) { return failure_text(); }

void tc_context_options_init(tc_context_options *options) {
    if (!options) return;
    *options = (tc_context_options){.struct_size = sizeof *options, .engine = TC_ENGINE_OPENCL};
}

void tc_expert_options_init(tc_expert_options *options) {
    if (!options) return;
    *options = (tc_expert_options){.struct_size = sizeof *options};
}

/* The caller's queue has to execute in order: each command relies on those before it. */
static tc_status queue_check(tc_context *context, cl_context theirs, cl_command_queue queue) {
    cl_context of_queue = NULL;
    cl_command_queue_properties properties = 0;
    cl_int error = cl->GetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof of_queue, &of_queue, NULL);
    if (!error) error = cl->GetCommandQueueInfo(queue, CL_QUEUE_PROPERTIES, sizeof properties, &properties, NULL);
    if (!error) error = cl->GetCommandQueueInfo(queue, CL_QUEUE_DEVICE, sizeof context->device, &context->device, NULL);
    if (error) return context_fail(context, "asking the given queue for its context, properties and device", error);
    if (of_queue != theirs)
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "cl_queue is a queue of another OpenCL context than cl_context: give one made for it");
    if (properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "cl_queue runs its commands out of order: give a queue without "
                                                  "CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE");
    return TC_OK;
}

static tc_status device_adopt(tc_context *context, cl_context theirs, cl_command_queue queue) {
    if (!queue) return (tc_status)fail(TC_ERROR_ARGUMENT, "a cl_context needs a cl_queue with it");
    tc_status status = queue_check(context, theirs, queue);
    if (status) return status;
    cl_int error = cl->RetainContext(theirs);
    if (error) return context_fail(context, "retaining the given context", error);
    context->context = theirs;
    error = cl->RetainCommandQueue(queue);
    if (error) return context_fail(context, "retaining the given queue", error);
    context->queue = queue;
    return TC_OK;
}

static tc_status device_open(tc_context *context, const char *specification) {
    device_choice choice;
    cl_int error;
    tc_status status = device_choose(specification, &choice);
    if (status) return status;
    context->device = choice.device;
    status = device_describe(choice.device, &context->info);
    context->info.platform_index = choice.platform_index;
    context->info.device_index = choice.device_index;
    if (!status) status = device_vet(context);
    if (status) return status;
    cl_context_properties properties[] = {CL_CONTEXT_PLATFORM, (cl_context_properties)choice.platform, 0};
    context->context = cl->CreateContext(properties, 1, &choice.device, NULL, NULL, &error);
    if (error) return context_fail(context, "making a context", error);
    context->queue = cl->CreateCommandQueue(context->context, choice.device, 0, &error);
    return error ? context_fail(context, "making a command queue", error) : TC_OK;
}

static tc_status opencl_begin(tc_context *context, const tc_context_options *o) {
    tc_status status = opencl_lock();
    if (status) return status;
    if (o->cl_context) opencl_awake();
    status = o->cl_context ? device_adopt(context, o->cl_context, o->cl_queue) : device_open(context, o->device);
    opencl_unlock();
    if (!status && o->cl_context) status = device_describe(context->device, &context->info);
    context->in_place = context->info.shares_host_memory && !context->expert.always_copy;
    return status ? status : tuning_choose(&context->expert, &context->info, &context->launch);
}

static tc_status context_make(const tc_context_options *options, bool for_trial, tc_context **out) {
    tc_context_options o;
    tc_expert_options expert;
    if (!out) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_context_create needs a place for the context");
    *out = NULL;
    tc_context_options_init(&o);
    tc_expert_options_init(&expert);
    tc_status status = struct_copy_in(&o, sizeof o, options, "context options");
    if (!status && o.expert) status = struct_copy_in(&expert, sizeof expert, o.expert, "expert options");
    if (status) return status;
    if (o.engine != TC_ENGINE_OPENCL && o.engine != TC_ENGINE_REFERENCE)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "%d is no engine", (int)o.engine);
    tc_context *context = calloc(1, sizeof *context);
    if (!context) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a context");
    if (!o.max_memory_bytes) context->spare = spare_blocks_create();
    context->process = getpid();
    context->options = o;
    context->progress_share = 1;
    context->expert = expert;
    context->for_trial = for_trial;
    context->options.device = NULL;
    context->options.cl_context = NULL;
    context->options.cl_queue = NULL;
    context->options.expert = NULL;
    if (o.engine == TC_ENGINE_OPENCL) status = opencl_begin(context, &o);
    if (status) {
        tc_context_destroy(context);
        return status;
    }
    *out = context;
    return TC_OK;
}

tc_status tc_context_create(const tc_context_options *options, tc_context **out) {
    FLOAT_ENVIRONMENT_DEFAULT;
    return context_make(options, false, out);
}

tc_status context_create_for_trial(const tc_context_options *options, tc_context **out) {
    return context_make(options, true, out);
}

static void objects_release(tc_context *context) {
    if (context_is_inherited(context) || opencl_lock()) return;
    if (context->copies) cl->ReleaseCommandQueue(context->copies);
    if (context->queue) cl->ReleaseCommandQueue(context->queue);
    cl->ReleaseContext(context->context);
    opencl_unlock();
}

void tc_context_destroy(tc_context *context) {
    if (!context) return;
    FLOAT_ENVIRONMENT_DEFAULT;
    if (context->context) {
        context_finish(context);
        workspace_release(context);
        programs_release(context);
        objects_release(context);
    }
    whole_cases_release(context->whole_cases);
    for (int n = 0; n < SMOOTHING_BLOCKS; n++) host_block_release(&context->smoothing[n]);
    spare_blocks_close(context->spare);
    free(context);
}

tc_status tc_context_device(const tc_context *context, tc_device_info *info) {
    tc_status status = struct_clear(info, sizeof *info, "tc_context_device: info");
    if (status) return status;
    if (!context) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_context_device needs a context");
    if (context->options.engine == TC_ENGINE_REFERENCE)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the reference engine has no device");
    struct_copy_out(info, &context->info);
    return TC_OK;
}

tc_status tc_context_tuning(const tc_context *context, tc_tuning *tuning) {
    tc_status status = struct_clear(tuning, sizeof *tuning, "tc_context_tuning: tuning");
    if (status) return status;
    if (!context) return (tc_status)fail(TC_ERROR_ARGUMENT, "tuning is that of a context: none given");
    if (context->options.engine == TC_ENGINE_REFERENCE)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the reference engine launches nothing");
    const launch_parameters *p = &context->launch;
    const tc_tuning found = {sizeof found, p->work_items, p->work_groups, p->scan.tile_bricks};
    struct_copy_out(tuning, &found);
    return TC_OK;
}

tc_status tc_context_tuning_save(const tc_context *context) {
    tc_tuning tuning = {.struct_size = sizeof tuning};
    tc_status status = tc_context_tuning(context, &tuning);
    return status ? status : tuning_keep(&context->info, &tuning);
}

struct _cl_context *tc_context_cl_context(const tc_context *context) {
    return context ? context->context : NULL;
}

struct _cl_command_queue *tc_context_cl_queue(const tc_context *context) {
    return context ? context->queue : NULL;
}

double tc_context_build_ms(const tc_context *context) { return context ? context->build_ms : 0; }

uint64_t tc_context_device_bytes(const tc_context *context, uint64_t *peak) {
    if (peak) *peak = context ? context->device_bytes_peak : 0;
    return context ? context->device_bytes : 0;
}
