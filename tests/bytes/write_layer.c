/*
 * write_layer.c - an OpenCL layer (OPENCL_LAYERS) for Oclgrind's check of uninitialised values: fills and writes of
 * parts of buffers are done by a kernel
 *
 * Oclgrind 21.10 notes which bytes have a value, but forgets the rest of a buffer, and where it ends, when the host
 * writes a part of it (Uninitialized::hostMemoryStore allocates what it notes anew, as large as the part). What kernels
 * write it notes byte by byte.
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl_layer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char source[] =
    "kernel void layer_fill(global uchar *out, ulong first, ulong bytes, global const uchar *from, ulong from_bytes) "
    "{\n"
    "    for (ulong n = get_global_id(0); n < bytes; n += get_global_size(0)) out[first + n] = from[n % from_bytes];\n"
    "}\n";

enum { CONTEXTS_MOST = 4096, WORK_ITEMS = 64 };

static const cl_icd_dispatch *driver;
static cl_icd_dispatch layer;

static struct {
    cl_context context; /* retained, so that no other gets its address */
    cl_kernel kernel;
} known[CONTEXTS_MOST];

static void give_up(const char *what, cl_int error) {
    fprintf(stderr, "write_layer: %s: error %d\n", what, (int)error);
    exit(EXIT_FAILURE);
}

static cl_kernel kernel_of(cl_context context) {
    int n = 0;
    cl_int error;
    const char *text = source;
    while (n < CONTEXTS_MOST && known[n].context && known[n].context != context) n++;
    if (n == CONTEXTS_MOST) give_up("too many contexts", 0);
    if (known[n].context) return known[n].kernel;
    cl_program program = driver->clCreateProgramWithSource(context, 1, &text, NULL, &error);
    if (!error) error = driver->clBuildProgram(program, 0, NULL, "", NULL, NULL);
    if (!error) known[n].kernel = driver->clCreateKernel(program, "layer_fill", &error);
    if (error) give_up("building", error);
    driver->clRetainContext(context);
    known[n].context = context;
    return known[n].kernel;
}

/* Writes `bytes` of the buffer from `first` on, repeating what is at `from`. */
static cl_int part_write(cl_command_queue queue, cl_mem buffer, size_t first, size_t bytes, const void *from,
                         size_t from_bytes, cl_uint wait_count, const cl_event *wait, cl_event *done) {
    cl_context context;
    cl_int error = driver->clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof context, &context, NULL);
    if (error) return error;
    cl_kernel kernel = kernel_of(context);
    cl_ulong numbers[3] = {first, bytes, from_bytes};
    size_t items = WORK_ITEMS;
    cl_mem source_buffer = driver->clCreateBuffer(context, CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, from_bytes,
                                                  (void *)(size_t)from, &error);
    if (error) return error;
    driver->clSetKernelArg(kernel, 0, sizeof buffer, &buffer);
    driver->clSetKernelArg(kernel, 1, sizeof *numbers, &numbers[0]);
    driver->clSetKernelArg(kernel, 2, sizeof *numbers, &numbers[1]);
    driver->clSetKernelArg(kernel, 3, sizeof source_buffer, &source_buffer);
    driver->clSetKernelArg(kernel, 4, sizeof *numbers, &numbers[2]);
    error = driver->clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &items, NULL, wait_count, wait, done);
    if (!error) error = driver->clFinish(queue);
    driver->clReleaseMemObject(source_buffer);
    return error;
}

static cl_int CL_API_CALL buffer_fill(cl_command_queue queue, cl_mem buffer, const void *pattern, size_t pattern_bytes,
                                      size_t first, size_t bytes, cl_uint wait_count, const cl_event *wait,
                                      cl_event *done) {
    return part_write(queue, buffer, first, bytes, pattern, pattern_bytes, wait_count, wait, done);
}

static cl_int CL_API_CALL buffer_write(cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t first,
                                       size_t bytes, const void *from, cl_uint wait_count, const cl_event *wait,
                                       cl_event *done) {
    size_t whole = 0;
    driver->clGetMemObjectInfo(buffer, CL_MEM_SIZE, sizeof whole, &whole, NULL);
    if (first || bytes < whole) return part_write(queue, buffer, first, bytes, from, bytes, wait_count, wait, done);
    return driver->clEnqueueWriteBuffer(queue, buffer, blocking, first, bytes, from, wait_count, wait, done);
}

CL_API_ENTRY cl_int CL_API_CALL clGetLayerInfo(cl_layer_info name, size_t bytes, void *value, size_t *needed) {
    static const char text[] = "writes by kernels";
    cl_layer_api_version version = CL_LAYER_API_VERSION_100;
    const void *from = name == CL_LAYER_API_VERSION ? (const void *)&version : text;
    size_t size = name == CL_LAYER_API_VERSION ? sizeof version : sizeof text;
    if (name != CL_LAYER_API_VERSION && name != CL_LAYER_NAME) return CL_INVALID_VALUE;
    if (value && bytes < size) return CL_INVALID_VALUE;
    if (value) memcpy(value, from, size);
    if (needed) *needed = size;
    return CL_SUCCESS;
}

CL_API_ENTRY cl_int CL_API_CALL clInitLayer(cl_uint count, const cl_icd_dispatch *target, cl_uint *own_count,
                                            const cl_icd_dispatch **own) {
    if (!target || !own_count || !own || count < sizeof layer / sizeof(void *)) return CL_INVALID_VALUE;
    driver = target;
    memcpy(&layer, target, sizeof layer);
    layer.clEnqueueFillBuffer = buffer_fill;
    layer.clEnqueueWriteBuffer = buffer_write;
    *own_count = sizeof layer / sizeof(void *);
    *own = &layer;
    return CL_SUCCESS;
}
