#include "opencl/opencl.h"

#include "failure.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <unistd.h>

const struct opencl_functions *cl;

static struct opencl_functions functions;
static char load_error[200]; /* the system's message where the loader cannot be loaded */
static pthread_once_t load_once = PTHREAD_ONCE_INIT;

static void load(void) {
    static const struct {
        const char *name;
        size_t offset;
    } entries[] = {
#define X(name) {"cl" #name, offsetof(struct opencl_functions, name)},
        OPENCL_FUNCTIONS(X)
#undef X
    };
    void *library = dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char *error = dlerror();
        snprintf(load_error, sizeof load_error, "%s", error ? error : "");
        return;
    }
    for (size_t n = 0; n < sizeof entries / sizeof entries[0]; n++) {
        void *symbol = dlsym(library, entries[n].name);
        if (!symbol) return;
        *(void **)((char *)&functions + entries[n].offset) = symbol;
    }
    cl = &functions;
}

tc_status opencl_forked_fail(const char *what) {
    return (tc_status)fail(TC_ERROR_DEVICE,
                           "%s, and the threads of OpenCL drivers do not live on in the child: fork before OpenCL is "
                           "first used, or start the child anew (exec; multiprocessing of Python: \"spawn\"); the "
                           "reference engine works in any process",
                           what);
}

static pthread_mutex_t devices_lock = PTHREAD_MUTEX_INITIALIZER;

static atomic_int awake_in; /* the process; 0: none yet */

void opencl_awake(void) {
    int none = 0;
    atomic_compare_exchange_strong(&awake_in, &none, (int)getpid());
}

/* Checks for a fork first: a thread that does not exist in the child may hold the lock. */
tc_status opencl_lock(void) {
    const int process = atomic_load(&awake_in);
    if (process && process != getpid()) return opencl_forked_fail("this process was forked from one that uses OpenCL");
    pthread_once(&load_once, load);
    if (!cl)
        return (tc_status)fail(
            TC_ERROR_DEVICE,
            "no OpenCL: the loader libOpenCL.so.1 is not installed or does not load%s%s (Debian: apt "
            "install ocl-icd-libopencl1 pocl-opencl-icd); the reference engine needs none",
            *load_error ? ": " : "", load_error);
    pthread_mutex_lock(&devices_lock);
    return TC_OK;
}

void opencl_unlock(void) { pthread_mutex_unlock(&devices_lock); }

static const char *error_name(cl_int error) {
    switch (error) {
#define NAME(code)                                                                                                     \
    case code:                                                                                                         \
        return #code;
        NAME(CL_DEVICE_NOT_FOUND)
        NAME(CL_DEVICE_NOT_AVAILABLE)
        NAME(CL_COMPILER_NOT_AVAILABLE)
        NAME(CL_MEM_OBJECT_ALLOCATION_FAILURE)
        NAME(CL_OUT_OF_RESOURCES)
        NAME(CL_OUT_OF_HOST_MEMORY)
        NAME(CL_BUILD_PROGRAM_FAILURE)
        NAME(CL_INVALID_VALUE)
        NAME(CL_INVALID_DEVICE)
        NAME(CL_INVALID_CONTEXT)
        NAME(CL_INVALID_COMMAND_QUEUE)
        NAME(CL_INVALID_HOST_PTR)
        NAME(CL_INVALID_MEM_OBJECT)
        NAME(CL_INVALID_BINARY)
        NAME(CL_INVALID_BUILD_OPTIONS)
        NAME(CL_INVALID_PROGRAM)
        NAME(CL_INVALID_PROGRAM_EXECUTABLE)
        NAME(CL_INVALID_KERNEL_NAME)
        NAME(CL_INVALID_KERNEL)
        NAME(CL_INVALID_ARG_INDEX)
        NAME(CL_INVALID_ARG_VALUE)
        NAME(CL_INVALID_ARG_SIZE)
        NAME(CL_INVALID_KERNEL_ARGS)
        NAME(CL_INVALID_WORK_GROUP_SIZE)
        NAME(CL_INVALID_WORK_ITEM_SIZE)
        NAME(CL_INVALID_EVENT)
        NAME(CL_INVALID_OPERATION)
        NAME(CL_INVALID_BUFFER_SIZE)
        NAME(CL_INVALID_GLOBAL_WORK_SIZE)
#undef NAME
    default:
        return "unknown error";
    }
}

tc_status opencl_fail(const char *what, cl_int error) {
    bool memory = error == CL_MEM_OBJECT_ALLOCATION_FAILURE || error == CL_OUT_OF_RESOURCES ||
                  error == CL_OUT_OF_HOST_MEMORY || error == CL_INVALID_BUFFER_SIZE;
    return (tc_status)fail(memory ? TC_ERROR_MEMORY : TC_ERROR_DEVICE, "%s failed: %s (%d)%s", what, error_name(error),
                           (int)error, memory ? "; a smaller memory budget makes smaller slabs" : "");
}
