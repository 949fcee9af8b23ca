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

/* Loads the ICD loader once per process. TC_ERROR_DEVICE, with what to install, where there is none. */
tc_status opencl_load(void);

/* Held where drivers are woken, and where a context's last reference may go: PoCL 3.1 puts its devices to sleep with
 * the last context, and crashes or has no devices where another thread asks for them meanwhile. */
void opencl_lock(void);
void opencl_unlock(void);

/* Records "WHAT failed: CL_...": TC_ERROR_MEMORY for allocation failures, else TC_ERROR_DEVICE. */
tc_status opencl_fail(const char *what, cl_int error);

#endif
