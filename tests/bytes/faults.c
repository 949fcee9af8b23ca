/*
 * faults.c - kernels with one fault each, which Oclgrind or valgrind has to report: so that a clean log means something
 *
 * Usage: faults none|bounds|race|groups|uninitialised|unset|api. Exit status 0 where the kernel ran; what was found is
 * in the log. uninitialised: an array in the kernel; unset: a buffer that nobody wrote.
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { ITEMS = 16, WORDS = 32 };

static const char source[] =
    "kernel void none(global uint *out) {\n"
    "    atomic_cmpxchg(&out[0], 0u, 1u);\n"
    "    if (atomic_or(&out[0], 0u)) out[16 + get_global_id(0)] = 1;\n"
    "}\n"
    "kernel void bounds(global uint *out) { out[17 + get_global_id(0)] = 1; }\n"
    "kernel void race(global uint *out) { out[get_global_id(0) / 2] = (uint)get_global_id(0); }\n"
    "kernel void groups(global uint *out) { out[get_local_id(0)] = (uint)get_global_id(0); }\n"
    "kernel void uninitialised(global uint *out) {\n"
    "    uint some[2];\n"
    "    some[0] = 1;\n"
    "    out[get_global_id(0)] = some[get_global_id(0) & 1];\n"
    "}\n"
    "kernel void unset(global uint *out) {\n"
    "    if (out[get_global_id(0)] == 7) out[16 + get_global_id(0)] = 1;\n"
    "}\n"
    "kernel void api(global uint *out) { out[get_global_id(0)] = 1; }\n";

static cl_int run(const char *fault) {
    cl_platform_id platform;
    cl_device_id device;
    cl_int error = clGetPlatformIDs(1, &platform, NULL);
    if (!error) error = clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL);
    if (error) return error;
    static cl_uint words[WORDS];
    const size_t items = ITEMS, group = ITEMS / 4;
    const char *text = source;
    cl_context context = clCreateContext(NULL, 1, &device, NULL, NULL, NULL);
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, NULL);
    cl_program program = clCreateProgramWithSource(context, 1, &text, NULL, NULL);
    const bool is_set = strcmp(fault, "unset") != 0;
    cl_mem buffer = clCreateBuffer(context, CL_MEM_READ_WRITE | (is_set ? CL_MEM_COPY_HOST_PTR : 0), sizeof words,
                                   is_set ? words : NULL, &error);
    if (!error) error = clBuildProgram(program, 1, &device, "-cl-std=CL1.2", NULL, NULL);
    cl_kernel kernel = clCreateKernel(program, fault, error ? NULL : &error);
    if (!error) error = clSetKernelArg(kernel, 0, sizeof buffer, &buffer);
    if (!error && !strcmp(fault, "api")) clSetKernelArg(kernel, 1, sizeof buffer, &buffer); /* there is no such one */
    if (!error) error = clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &items, &group, 0, NULL, NULL);
    if (!error) error = clFinish(queue);
    clReleaseKernel(kernel);
    clReleaseMemObject(buffer);
    clReleaseProgram(program);
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    return error;
}

int main(int argc, char **argv) {
    cl_int error = run(argc > 1 ? argv[1] : "none");
    if (error) printf("OpenCL fails with %d\n", (int)error);
    return error != 0;
}
