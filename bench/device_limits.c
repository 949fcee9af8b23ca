/*
 * device_limits.c - runs the kernels of bandwidth.cl in a few access shapes and keeps the fastest
 *
 * The buffer is far larger than any cache. Where the device shares the host's memory it lies in huge pages, so that the
 * limit does not depend on page tables. All of it is written before anything is timed, as untouched pages read too fast
 * and write too slowly. A pass is as many launches as take PASS_MS, timed by the host's clock; the best of PASSES
 * counts. The contents do not matter.
 */
#include "device_limits.h"

#include "exit_status.h"
#include "failure.h"
#include "progress.h"

#include <CL/cl.h>
#include <stdio.h>
#include <sys/mman.h>

#define BUFFER_BYTES ((uint64_t)512 << 20)
#define PASSES       7
#define PASS_MS      10.0
#define LAUNCHES_MAX 64
#define HOPELESS     2.0 /* a shape this many times slower than another is not timed */

extern const char kernel_bandwidth[]; /* bandwidth.cl, embedded at build time */

typedef struct shape {
    unsigned width; /* 32-bit words per access */
    size_t items;   /* per work-group */
    size_t groups;  /* per compute unit */
    int streaming;  /* stores that pass the caches by; not every compiler has them */
} shape;

static const shape shapes[] = {{16, 1, 8, 0}, {16, 1, 8, 1}, {4, 64, 32, 0}, {4, 256, 16, 0}};

typedef struct bench_memory {
    cl_context context;
    cl_command_queue queue;
    cl_device_id device;
    tc_device_info info;
    uint64_t bytes;
    void *host; /* mapped, where the device shares the host's memory */
    cl_mem buffer, sink;
} bench_memory;

static int cl_failed(const char *what, cl_int error) {
    return fail(STATUS_FAILED, "measuring the device's bandwidth: %s failed (OpenCL error %d); free some of its memory",
                what, error);
}

static uint64_t least(uint64_t a, uint64_t b) { return a < b ? a : b; }

static void memory_close(bench_memory *m) {
    if (m->sink) clReleaseMemObject(m->sink);
    if (m->buffer) clReleaseMemObject(m->buffer);
    if (m->host) munmap(m->host, m->bytes);
    *m = (bench_memory){0};
}

static int memory_open(tc_context *context, bench_memory *m) {
    cl_int error;
    *m = (bench_memory){.context = tc_context_cl_context(context), .queue = tc_context_cl_queue(context)};
    m->info.struct_size = sizeof m->info;
    if (tc_context_device(context, &m->info)) return fail(STATUS_FAILED, "%s", tc_message());
    error = clGetCommandQueueInfo(m->queue, CL_QUEUE_DEVICE, sizeof m->device, &m->device, NULL);
    if (error) return cl_failed("asking the queue for its device", error);
    m->bytes = least(BUFFER_BYTES, least(m->info.max_buffer_bytes, m->info.global_memory_bytes / 4));
    if (m->info.shares_host_memory) {
        m->host = mmap(NULL, m->bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (m->host == MAP_FAILED) {
            m->host = NULL;
            return fail(STATUS_FAILED, "no %llu MB of memory to measure its bandwidth in",
                        (unsigned long long)(m->bytes >> 20));
        }
        madvise(m->host, m->bytes, MADV_HUGEPAGE);
    }
    cl_mem_flags flags = CL_MEM_READ_WRITE | (m->host ? CL_MEM_USE_HOST_PTR : 0);
    m->buffer = clCreateBuffer(m->context, flags, m->bytes, m->host, &error);
    if (error) return cl_failed("a buffer", error);
    m->sink = clCreateBuffer(m->context, CL_MEM_READ_WRITE, sizeof(cl_uint), NULL, &error);
    return error ? cl_failed("a buffer", error) : 0;
}

/* NULL where the device's compiler does not take it. */
static cl_program program_build(const bench_memory *m, const shape *s) {
    char options[128];
    cl_int error;
    snprintf(options, sizeof options, "-cl-std=CL1.2 -DVECTOR=uint%u -DWIDTH=%u%s", s->width, s->width,
             s->streaming ? " -DSTREAMING" : "");
    const char *source = kernel_bandwidth;
    cl_program program = clCreateProgramWithSource(m->context, 1, &source, NULL, &error);
    if (error) return NULL;
    if (clBuildProgram(program, 1, &m->device, options, NULL, NULL) == CL_SUCCESS) return program;
    clReleaseProgram(program);
    return NULL;
}

/* Launches the kernel some times over; *ms is the time of one launch. */
static cl_int pass_time(const bench_memory *m, cl_kernel kernel, size_t global, size_t local, int launches,
                        double *ms) {
    cl_int error = clFinish(m->queue);
    double begin = now_ms();
    for (int n = 0; n < launches && !error; n++)
        error = clEnqueueNDRangeKernel(m->queue, kernel, 1, NULL, &global, &local, 0, NULL, NULL);
    if (!error) error = clFinish(m->queue);
    *ms = (now_ms() - begin) / launches;
    return error;
}

/* *best becomes the GB/s of the kernel in this shape where that is more. */
static cl_int kernel_measure(const bench_memory *m, const shape *s, cl_kernel kernel, double *best) {
    const size_t groups = s->groups * m->info.compute_units, unit = 4 * s->items;
    const cl_ulong chunk = m->bytes / (4 * s->width) / groups / unit * unit;
    const double bytes = (double)chunk * (double)groups * 4.0 * s->width;
    double ms;
    cl_int error = clSetKernelArg(kernel, 0, sizeof m->buffer, &m->buffer);
    if (!error) error = clSetKernelArg(kernel, 1, sizeof chunk, &chunk);
    for (int warm = 0; warm < 2 && !error; warm++) error = pass_time(m, kernel, groups * s->items, s->items, 1, &ms);
    if (error || bytes / ms * 1e-6 * HOPELESS < *best) return error;
    int launches = ms * LAUNCHES_MAX < PASS_MS ? LAUNCHES_MAX : 1 + (int)(PASS_MS / ms);
    for (int pass = 0; pass < PASSES && !error; pass++) {
        error = pass_time(m, kernel, groups * s->items, s->items, launches, &ms);
        if (!error && bytes / ms * 1e-6 > *best) *best = bytes / ms * 1e-6;
    }
    return error;
}

static cl_int shape_measure(const bench_memory *m, const shape *s, cl_program program, device_limits *best) {
    const cl_uint value = 0x01020304;
    cl_int error;
    cl_kernel write = clCreateKernel(program, "bandwidth_write", &error), read = NULL;
    if (!error) error = clSetKernelArg(write, 2, sizeof value, &value);
    if (!error) error = kernel_measure(m, s, write, &best->write_gbps);
    if (!error) read = clCreateKernel(program, "bandwidth_read", &error);
    if (!error) error = clSetKernelArg(read, 2, sizeof m->sink, &m->sink);
    if (!error) error = kernel_measure(m, s, read, &best->read_gbps);
    if (write) clReleaseKernel(write);
    if (read) clReleaseKernel(read);
    return error;
}

int device_limits_measure(tc_context *context, device_limits *out) {
    bench_memory m;
    *out = (device_limits){0};
    int status = memory_open(context, &m);
    for (size_t n = 0; n < sizeof shapes / sizeof *shapes && !status; n++) {
        if (shapes[n].items > m.info.max_work_group_size) continue;
        cl_program program = program_build(&m, &shapes[n]);
        if (!program) continue;
        cl_int error = shape_measure(&m, &shapes[n], program, out);
        if (error) status = cl_failed("a kernel", error);
        clReleaseProgram(program);
    }
    memory_close(&m);
    if (!status && out->read_gbps <= 0.0)
        status = fail(STATUS_FAILED, "the device's compiler took no form of bandwidth.cl; update its driver");
    if (status) *out = (device_limits){0};
    return status;
}
