#include "context.h"

#include "device.h"
#include "failure.h"
#include "float_environment.h"
#include "tuning.h"
#include "vetting.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define TEXT2(x) #x
#define TEXT(x)  TEXT2(x)

const char *tc_message(void) { return failure_text(); }

const char *tc_version(void) { return TEXT(TC_VERSION); }

double clock_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

/* A size that a header of this library or of an older one gave the struct at `at`. Sizes end on the boundaries that
 * pointers keep, so that none is ever cut. */
static tc_status struct_size_get(const void *at, size_t known_bytes, const char *what, size_t *bytes) {
    *bytes = 0;
    if (at) memcpy(bytes, at, sizeof *bytes);
    if (*bytes >= sizeof *bytes && *bytes % sizeof *bytes == 0 && *bytes <= known_bytes) return TC_OK;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "%s: %s", what,
                           !at                    ? "none given"
                           : *bytes > known_bytes ? "made for a newer library, or never initialised"
                                                  : "never initialised: call its _init function, or set struct_size");
}

tc_status options_take(void *to, size_t to_bytes, const void *from, const char *what) {
    size_t bytes;
    tc_status status = struct_size_get(from, to_bytes, what, &bytes);
    if (status) return status;
    memcpy(to, from, bytes);
    memcpy(to, &to_bytes, sizeof to_bytes);
    return TC_OK;
}

tc_status context_fail(const tc_context *context, const char *what, cl_int error) {
    char whole[512];
    if (!context->info.name[0]) return opencl_fail(what, error);
    snprintf(whole, sizeof whole, "%s on %s", what, context->info.name);
    return opencl_fail(whole, error);
}

tc_status result_begin(void *out, size_t known_bytes, const char *what) {
    size_t bytes;
    tc_status status = struct_size_get(out, known_bytes, what, &bytes);
    if (!status) memset((char *)out + sizeof bytes, 0, bytes - sizeof bytes);
    return status;
}

void result_give(void *out, const void *from) {
    size_t bytes;
    memcpy(&bytes, out, sizeof bytes);
    memcpy((char *)out + sizeof bytes, (const char *)from + sizeof bytes, bytes - sizeof bytes);
}

tc_status context_progress(const tc_context *context, const char *stage, double fraction) {
    if (!context->options.progress) return TC_OK;
    float_environment *lent = float_environment_lend();
    int stop = context->options.progress(context->options.progress_user, stage, fraction);
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

/* --------------------------------------------------------------------------------------------------------- buffers */

static void bytes_count(tc_context *context, uint64_t bytes) {
    context->device_bytes += bytes;
    if (context->device_bytes > context->device_bytes_peak) context->device_bytes_peak = context->device_bytes;
}

static tc_status buffer_create(tc_context *context, device_buffer *buffer, uint64_t bytes, cl_mem_flags flags,
                               void *memory, const char *name) {
    cl_int error = CL_INVALID_BUFFER_SIZE;
    buffer_release(context, buffer);
    if (bytes <= SIZE_MAX) buffer->memory = cl->CreateBuffer(context->context, flags, (size_t)bytes, memory, &error);
    if (error) {
        char what[128];
        snprintf(what, sizeof what, "a device buffer of %llu bytes for %s", (unsigned long long)bytes, name);
        buffer->memory = NULL;
        return context_fail(context, what, error);
    }
    buffer->bytes = bytes;
    bytes_count(context, bytes);
    return TC_OK;
}

tc_status buffer_wrap(tc_context *context, device_buffer *buffer, void *memory, uint64_t bytes, cl_mem_flags access,
                      const char *name) {
    return buffer_create(context, buffer, bytes, access | CL_MEM_USE_HOST_PTR, memory, name);
}

tc_status buffer_reserve(tc_context *context, device_buffer *buffer, uint64_t bytes, const char *name) {
    if (buffer->memory && bytes <= buffer->bytes) return TC_OK;
    if (!bytes) bytes = 1;
    if (!context->in_place) return buffer_create(context, buffer, bytes, CL_MEM_READ_WRITE, NULL, name);
    host_block block = {0};
    if (buffer->memory) cl->Finish(context->queue); /* commands under way may use the memory that goes */
    buffer_release(context, buffer);
    tc_status status = host_block_reserve(&block, bytes);
    if (status) return status;
    status = buffer_wrap(context, buffer, block.memory, bytes, CL_MEM_READ_WRITE, name);
    if (status)
        host_block_release(&block);
    else
        buffer->block = block;
    return status;
}

void buffer_release(tc_context *context, device_buffer *buffer) {
    if (!buffer->memory) return;
    if (!context_is_inherited(context)) cl->ReleaseMemObject(buffer->memory);
    context->device_bytes -= buffer->bytes;
    host_block_release(&buffer->block);
    *buffer = (device_buffer){0};
}

tc_status buffer_inspect(const tc_context *context, cl_mem memory, cl_mem_flags unfit, const char *name,
                         size_t *bytes) {
    char what[96];
    cl_context of_memory = NULL;
    cl_mem_flags flags = 0;
    cl_mem_object_type type = 0;
    cl_int error = cl->GetMemObjectInfo(memory, CL_MEM_CONTEXT, sizeof of_memory, &of_memory, NULL);
    if (!error) error = cl->GetMemObjectInfo(memory, CL_MEM_FLAGS, sizeof flags, &flags, NULL);
    if (!error) error = cl->GetMemObjectInfo(memory, CL_MEM_TYPE, sizeof type, &type, NULL);
    if (!error) error = cl->GetMemObjectInfo(memory, CL_MEM_SIZE, sizeof *bytes, bytes, NULL);
    snprintf(what, sizeof what, "asking %s for what it is", name);
    if (error) return context_fail(context, what, error);
    const char *wrong = of_memory != context->context  ? "belongs to another OpenCL context than this one's"
                        : type != CL_MEM_OBJECT_BUFFER ? "is no buffer"
                        : !(flags & unfit)             ? NULL
                        : unfit == CL_MEM_WRITE_ONLY   ? "was made with CL_MEM_WRITE_ONLY, and kernels read it"
                                                       : "was made with CL_MEM_READ_ONLY, and kernels write to it";
    return wrong ? (tc_status)fail(TC_ERROR_ARGUMENT, "%s %s", name, wrong) : TC_OK;
}

void workspace_release(tc_context *context) {
    device_buffer *buffers = (device_buffer *)&context->work;
    for (size_t n = 0; n < sizeof context->work / sizeof *buffers; n++) buffer_release(context, &buffers[n]);
}

/* --------------------------------------------------------------------------------------------------------- context */

void tc_context_options_init(tc_context_options *options) {
    if (!options) return;
    *options = (tc_context_options){.struct_size = sizeof *options, .engine = TC_ENGINE_OPENCL};
}

bool type_is_wide(tc_type type) { return type == TC_U32 || type == TC_I32 || type == TC_F64; }

bool device_makes_vertices(const tc_context *context, tc_type type) {
    return context->info.has_fp64 || !type_is_wide(type);
}

/* Commands are put into it one after the other, and each relies on those before. */
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
    context->in_place = context->info.shares_host_memory && !o->own_buffers;
    return status ? status : tuning_choose(context);
}

tc_status copies_queue_provide(tc_context *context) {
    cl_int error = CL_SUCCESS;
    if (!context->copies) context->copies = cl->CreateCommandQueue(context->context, context->device, 0, &error);
    return error ? context_fail(context, "making a command queue for copies", error) : TC_OK;
}

static tc_status context_make(const tc_context_options *options, bool is_trial, tc_context **out) {
    tc_context_options o;
    if (!out) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_context_create needs a place for the context");
    *out = NULL;
    tc_context_options_init(&o);
    tc_status status = options_take(&o, sizeof o, options, "context options");
    if (status) return status;
    if (o.engine != TC_ENGINE_OPENCL && o.engine != TC_ENGINE_REFERENCE)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "%d is no engine", (int)o.engine);
    tc_context *context = calloc(1, sizeof *context);
    if (!context) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a context");
    context->process = getpid();
    context->options = o;
    context->is_trial = is_trial;
    context->options.device = NULL;
    context->options.cl_context = NULL;
    context->options.cl_queue = NULL;
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
    free(context);
}

tc_status tc_context_device(const tc_context *context, tc_device_info *info) {
    tc_status status = result_begin(info, sizeof *info, "tc_context_device: info");
    if (status) return status;
    if (!context) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_context_device needs a context");
    if (context->options.engine == TC_ENGINE_REFERENCE)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the reference engine has no device");
    result_give(info, &context->info);
    return TC_OK;
}

struct _cl_context *tc_context_cl_context(const tc_context *context) {
    return context ? context->context : NULL;
}

struct _cl_command_queue *tc_context_cl_queue(const tc_context *context) {
    return context ? context->queue : NULL;
}

uint64_t tc_context_device_bytes(const tc_context *context, uint64_t *peak) {
    if (peak) *peak = context ? context->device_bytes_peak : 0;
    return context ? context->device_bytes : 0;
}
