#include "opencl/context.h"

#include "failure.h"

#include <stdio.h>

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

tc_status buffer_upload(tc_context *context, device_buffer *buffer, const void *data, uint64_t bytes,
                        const char *name) {
    char what[96];
    tc_status status = buffer_reserve(context, buffer, bytes, name);
    if (status) return status;
    cl_int error =
        cl->EnqueueWriteBuffer(context->queue, buffer->memory, CL_TRUE, 0, (size_t)bytes, data, 0, NULL, NULL);
    if (!error) return TC_OK;
    buffer_release(context, buffer);
    snprintf(what, sizeof what, "uploading %s", name);
    return context_fail(context, what, error);
}

tc_status buffer_provide(tc_context *context, device_buffer *buffer, const void *array, uint64_t bytes,
                         size_t item_bytes, uint64_t *offset, const char *name) {
    const uintptr_t before = context->in_place ? (uintptr_t)array & (PAGE_BYTES - 1) : 0;
    *offset = before / item_bytes;
    if (!context->in_place) return buffer_upload(context, buffer, array, bytes, name);
    return buffer_wrap(context, buffer, (char *)(uintptr_t)array - before, before + bytes, CL_MEM_READ_ONLY, name);
}

void buffer_release(tc_context *context, device_buffer *buffer) {
    if (!buffer->memory) return;
    if (!context_is_inherited(context)) cl->ReleaseMemObject(buffer->memory);
    context->device_bytes -= buffer->bytes;
    host_block_release(&buffer->block);
    *buffer = (device_buffer){0};
}

void mesh_buffers_release(tc_context *context, mesh_buffers *buffers) {
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) buffer_release(context, &buffers->channels[channel]);
    buffer_release(context, &buffers->triangles);
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

tc_status buffer_map(tc_context *context, const device_buffer *buffer, uint64_t bytes, const void **memory) {
    cl_int error = CL_SUCCESS;
    *memory = cl->EnqueueMapBuffer(context->queue, buffer->memory, CL_TRUE, CL_MAP_READ, 0, (size_t)bytes, 0, NULL,
                                   NULL, &error);
    if (!error) return TC_OK;
    *memory = NULL;
    return context_fail(context, "reading results back", error);
}

tc_status buffer_unmap(tc_context *context, const device_buffer *buffer, const void *memory) {
    if (!memory) return TC_OK;
    cl_int error = cl->EnqueueUnmapMemObject(context->queue, buffer->memory, (void *)(uintptr_t)memory, 0, NULL, NULL);
    return error ? context_fail(context, "reading results back", error) : TC_OK;
}

tc_status mesh_part_open(tc_context *context, device_buffer *buffer, const host_block *block, uint64_t first,
                         uint64_t end, uint32_t *offset, const char *name) {
    *offset = 0;
    if (first == end) return buffer_reserve(context, buffer, 4, name);
    if (!context->in_place) return buffer_reserve(context, buffer, end - first, name);
    uint64_t start = first & ~(uint64_t)(PAGE_BYTES - 1);
    *offset = (uint32_t)((first - start) / 4);
    return buffer_wrap(context, buffer, (char *)block->memory + start, end - start, CL_MEM_READ_WRITE, name);
}

tc_status mesh_part_sync(tc_context *context, device_buffer *buffer) {
    cl_command_queue queue = context->queue;
    cl_int error;
    void *mapped =
        cl->EnqueueMapBuffer(queue, buffer->memory, CL_TRUE, CL_MAP_READ, 0, buffer->bytes, 0, NULL, NULL, &error);
    if (!error) error = cl->EnqueueUnmapMemObject(queue, buffer->memory, mapped, 0, NULL, NULL);
    buffer_release(context, buffer);
    return error ? context_fail(context, "reading the mesh back", error) : TC_OK;
}

tc_status mesh_part_close(tc_context *context, device_buffer *buffer, const host_block *block, uint64_t first,
                          uint64_t end) {
    if (first == end) return TC_OK;
    if (context->in_place) return mesh_part_sync(context, buffer);
    cl_int error = cl->EnqueueReadBuffer(context->queue, buffer->memory, CL_TRUE, 0, end - first,
                                         (char *)block->memory + first, 0, NULL, NULL);
    return error ? context_fail(context, "reading the mesh back", error) : TC_OK;
}

/* Releases the workspace, with the results of kernel 1 in it. */
void workspace_release(tc_context *context) {
    context->counted_grid = context->classified_grid = NULL;
    device_buffer *buffers = (device_buffer *)&context->work;
    for (size_t n = 0; n < sizeof context->work / sizeof *buffers; n++) buffer_release(context, &buffers[n]);
}
