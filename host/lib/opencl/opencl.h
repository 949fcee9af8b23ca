/*
 * opencl.h - the OpenCL library, loaded when first needed: without one the reference engine still works
 */
#ifndef OPENCL_H
#define OPENCL_H

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "tetracubes.h"

#define OPENCL_FUNCTIONS(X)                                                                                            \
    X(GetPlatformIDs)                                                                                                  \
    X(GetPlatformInfo)                                                                                                 \
    X(GetDeviceIDs)                                                                                                    \
    X(GetDeviceInfo)                                                                                                   \
    X(CreateContext)                                                                                                   \
    X(RetainContext)                                                                                                   \
    X(ReleaseContext)                                                                                                  \
    X(CreateCommandQueue)                                                                                              \
    X(RetainCommandQueue)                                                                                              \
    X(ReleaseCommandQueue)                                                                                             \
    X(GetCommandQueueInfo)                                                                                             \
    X(CreateProgramWithSource)                                                                                         \
    X(CreateProgramWithBinary)                                                                                         \
    X(BuildProgram)                                                                                                    \
    X(GetProgramInfo)                                                                                                  \
    X(GetProgramBuildInfo)                                                                                             \
    X(ReleaseProgram)                                                                                                  \
    X(CreateKernel)                                                                                                    \
    X(ReleaseKernel)                                                                                                   \
    X(GetKernelWorkGroupInfo)                                                                                          \
    X(SetKernelArg)                                                                                                    \
    X(CreateBuffer)                                                                                                    \
    X(RetainMemObject)                                                                                                 \
    X(GetMemObjectInfo)                                                                                                \
    X(ReleaseMemObject)                                                                                                \
    X(EnqueueReadBuffer)                                                                                               \
    X(EnqueueWriteBuffer)                                                                                              \
    X(EnqueueFillBuffer)                                                                                               \
    X(EnqueueMapBuffer)                                                                                                \
    X(EnqueueUnmapMemObject)                                                                                           \
    X(EnqueueNDRangeKernel)                                                                                            \
    X(EnqueueMarkerWithWaitList)                                                                                       \
    X(EnqueueBarrierWithWaitList)                                                                                      \
    X(ReleaseEvent)                                                                                                    \
    X(Flush)                                                                                                           \
    X(Finish)

struct opencl_functions {
#define X(name) __typeof__(cl##name) *name;
    OPENCL_FUNCTIONS(X)
#undef X
};

/* cl->CreateBuffer is clCreateBuffer; set by opencl_load. */
extern const struct opencl_functions *cl;

/* Loads the ICD loader once per process, and takes a lock. TC_ERROR_DEVICE, with what to do and without the lock, where
 * there is none, and in a child of a process where drivers are awake: their threads are not in it.
 *
 * The lock is held where drivers are woken, and where a context's last reference may go: PoCL 3.1 puts its devices to
 * sleep with the last context, and crashes or has no devices where another thread asks for them meanwhile. */
tc_status opencl_lock(void);
void opencl_unlock(void);

/* From here on drivers are awake in this process. */
void opencl_awake(void);

/* Records "WHAT, and ...": what a forked process cannot do, and what to do; TC_ERROR_DEVICE. */
tc_status opencl_forked_fail(const char *what);

/* Records "WHAT failed: CL_...": TC_ERROR_MEMORY for allocation failures, else TC_ERROR_DEVICE. */
tc_status opencl_fail(const char *what, cl_int error);

#endif
