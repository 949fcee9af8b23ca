/*
 * The mode that keeps watch over buffers.
 *
 *     memory PATTERN     new buffers are full of the byte PATTERN (0 to 255), and have guards before and behind
 *     memory off
 *
 * A buffer is a part of one that is larger by a guard on either side, or only larger where it is one over memory of the
 * host. The guards are looked at when the program lets go
 * of the buffer and whenever it waits for a queue; a guard that was written to is a fault. A buffer over memory of the
 * host (CL_MEM_USE_HOST_PTR) becomes one with memory of its own, as OpenCL allows: what the device wrote is seen there
 * once the buffer has been mapped, and not before.
 */
#include "layer.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { GUARD_BYTES = 4096, GUARD = 0xC3, BUFFERS_MOST = 1024, QUEUES_MOST = 64 };

typedef struct buffer {
    cl_mem given, whole; /* what the program has, a part of the other; given NULL: the place is free */
    cl_context context;
    size_t bytes;
    char *host;   /* that the program named */
    void *mapped; /* where the driver has mapped it */
    size_t map_offset, map_bytes;
    cl_map_flags map_flags;
    long references;
    bool broken; /* told */
} buffer;

static cl_icd_dispatch below;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int pattern = -1;
static buffer buffers[BUFFERS_MOST];
static struct {
    cl_command_queue queue;
    long references; /* that the program holds; 0: the place is free */
} queues[QUEUES_MOST];

static buffer *buffer_find(cl_mem given) {
    for (int n = 0; n < BUFFERS_MOST; n++)
        if (buffers[n].given == given) return &buffers[n];
    return NULL;
}

/* ---------------------------------------------------------------------------------------------------------- guards */

static cl_command_queue queue_make(cl_context context) {
    cl_device_id devices[16];
    cl_int error = below.clGetContextInfo(context, CL_CONTEXT_DEVICES, sizeof devices, devices, NULL);
    cl_command_queue queue = error ? NULL : below.clCreateCommandQueue(context, devices[0], 0, &error);
    if (error) abort();
    return queue;
}

static void guard_check(buffer *b, cl_command_queue queue, size_t offset, const char *side) {
    unsigned char guard[GUARD_BYTES];
    if (below.clEnqueueReadBuffer(queue, b->whole, CL_TRUE, offset, GUARD_BYTES, guard, 0, NULL, NULL)) abort();
    for (int n = 0; n < GUARD_BYTES && !b->broken; n++)
        if (guard[n] != GUARD) {
            fault("byte %d %s a buffer of %zu bytes was written to", n, side, b->bytes);
            b->broken = true;
        }
}

/* Commands of the program have ended. */
static void guards_check(buffer *b, cl_command_queue queue) {
    if (b->whole != b->given) guard_check(b, queue, 0, "of the guard before");
    guard_check(b, queue, (b->whole == b->given ? 0 : GUARD_BYTES) + b->bytes, "behind");
}

static void queues_wait(void) {
    for (int n = 0; n < QUEUES_MOST; n++)
        if (queues[n].references) below.clFinish(queues[n].queue);
}

static void buffers_check(cl_command_queue queue) {
    cl_context context = NULL;
    pthread_mutex_lock(&lock);
    if (!below.clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof context, &context, NULL))
        for (int n = 0; n < BUFFERS_MOST; n++)
            if (buffers[n].given && buffers[n].context == context) guards_check(&buffers[n], queue);
    pthread_mutex_unlock(&lock);
}

/* --------------------------------------------------------------------------------------------------------- buffers */

/* As memcpy, but not watched by a sanitizer: buffers over a program's memory go by whole pages, as devices have it. */
__attribute__((no_sanitize_address)) static void bytes_copy(void *out, const void *in, size_t bytes) {
    for (size_t n = 0; n < bytes; n++) ((volatile char *)out)[n] = ((const volatile char *)in)[n];
}

/* The buffer with guards, the first of `before` bytes, and its first content. */
static cl_mem whole_make(cl_context context, cl_mem_flags access, size_t before, size_t bytes, const void *content,
                         cl_int *error) {
    const size_t whole_bytes = before + bytes + GUARD_BYTES;
    unsigned char *first = malloc(whole_bytes);
    if (!first) abort();
    memset(first, GUARD, whole_bytes);
    if (content)
        bytes_copy(first + before, content, bytes);
    else
        memset(first + before, pattern, bytes);
    cl_mem whole = below.clCreateBuffer(context, access | CL_MEM_COPY_HOST_PTR, whole_bytes, first, error);
    free(first);
    return whole;
}

/* Those that the program maps are no parts: PoCL 3.1 crashes when a part that has been mapped is released. */
static cl_mem CL_API_CALL CreateBuffer(cl_context context, cl_mem_flags flags, size_t bytes, void *host,
                                       cl_int *error) {
    if (pattern < 0 || bytes == 0) return below.clCreateBuffer(context, flags, bytes, host, error);
    const cl_mem_flags access = flags & (CL_MEM_READ_WRITE | CL_MEM_READ_ONLY | CL_MEM_WRITE_ONLY);
    const bool shadows = (flags & CL_MEM_USE_HOST_PTR) != 0;
    const cl_buffer_region part = {GUARD_BYTES, bytes};
    cl_int state;
    cl_mem whole = whole_make(context, access, shadows ? 0 : GUARD_BYTES, bytes, host, &state), given = whole;
    if (!state && !shadows) given = below.clCreateSubBuffer(whole, access, CL_BUFFER_CREATE_TYPE_REGION, &part, &state);
    if (error) *error = state;
    if (state) {
        if (whole) below.clReleaseMemObject(whole);
        return NULL;
    }
    pthread_mutex_lock(&lock);
    buffer *b = buffer_find(NULL);
    if (!b) abort();
    *b = (buffer){.given = given, .whole = whole, .context = context, .bytes = bytes, .references = 1};
    if (shadows) b->host = host;
    pthread_mutex_unlock(&lock);
    return given;
}

static cl_int CL_API_CALL RetainMemObject(cl_mem memory) {
    pthread_mutex_lock(&lock);
    buffer *b = buffer_find(memory);
    if (b) b->references++;
    pthread_mutex_unlock(&lock);
    return below.clRetainMemObject(memory);
}

static cl_int CL_API_CALL ReleaseMemObject(cl_mem memory) {
    pthread_mutex_lock(&lock);
    buffer *b = buffer_find(memory);
    if (b && --b->references == 0) {
        cl_command_queue queue = queue_make(b->context);
        queues_wait();
        guards_check(b, queue);
        below.clReleaseCommandQueue(queue);
        if (b->whole != memory) below.clReleaseMemObject(b->whole);
        b->given = NULL;
    }
    pthread_mutex_unlock(&lock);
    return below.clReleaseMemObject(memory);
}

/* --------------------------------------------------------------------------------------------------------- mapping */

static void *CL_API_CALL EnqueueMapBuffer(cl_command_queue queue, cl_mem memory, cl_bool blocking, cl_map_flags flags,
                                          size_t offset, size_t bytes, ENTRY_WAITS, cl_int *error) {
    pthread_mutex_lock(&lock);
    buffer *b = buffer_find(memory);
    const bool shadows = b && b->host;
    pthread_mutex_unlock(&lock);
    if (shadows && (!blocking || b->mapped)) abort(); /* more than the library does */
    void *mapped =
        below.clEnqueueMapBuffer(queue, memory, blocking, flags, offset, bytes, wait_count, waits, event, error);
    if (!shadows || !mapped) return mapped;
    bytes_copy(b->host + offset, mapped, bytes);
    b->mapped = mapped;
    b->map_flags = flags;
    b->map_offset = offset;
    b->map_bytes = bytes;
    return b->host + offset;
}

static cl_int CL_API_CALL EnqueueUnmapMemObject(cl_command_queue queue, cl_mem memory, void *mapped, ENTRY_WAITS) {
    pthread_mutex_lock(&lock);
    buffer *b = buffer_find(memory);
    if (b && b->mapped) {
        if (b->map_flags & CL_MAP_WRITE) bytes_copy(b->mapped, b->host + b->map_offset, b->map_bytes);
        mapped = b->mapped;
        b->mapped = NULL;
    }
    pthread_mutex_unlock(&lock);
    return below.clEnqueueUnmapMemObject(queue, memory, mapped, wait_count, waits, event);
}

/* ---------------------------------------------------------------------------------------------------------- queues */

static void queue_count(cl_command_queue queue, long change) {
    int place = -1;
    pthread_mutex_lock(&lock);
    for (int n = QUEUES_MOST - 1; n >= 0; n--)
        if (queues[n].references ? queues[n].queue == queue : place < 0 && change > 0) place = n;
    if (place >= 0) queues[place].queue = queue;
    if (place >= 0) queues[place].references += change;
    pthread_mutex_unlock(&lock);
}

static cl_command_queue CL_API_CALL CreateCommandQueue(cl_context context, cl_device_id device,
                                                       cl_command_queue_properties properties, cl_int *error) {
    cl_command_queue queue = below.clCreateCommandQueue(context, device, properties, error);
    if (queue) queue_count(queue, 1);
    return queue;
}

static cl_int CL_API_CALL RetainCommandQueue(cl_command_queue queue) {
    queue_count(queue, 1);
    return below.clRetainCommandQueue(queue);
}

static cl_int CL_API_CALL ReleaseCommandQueue(cl_command_queue queue) {
    queue_count(queue, -1);
    return below.clReleaseCommandQueue(queue);
}

static cl_int CL_API_CALL Finish(cl_command_queue queue) {
    const cl_int error = below.clFinish(queue);
    if (!error && pattern >= 0) buffers_check(queue);
    return error;
}

static void install(cl_icd_dispatch *table) {
    below = *table;
    table->clCreateBuffer = CreateBuffer;
    table->clRetainMemObject = RetainMemObject;
    table->clReleaseMemObject = ReleaseMemObject;
    table->clEnqueueMapBuffer = EnqueueMapBuffer;
    table->clEnqueueUnmapMemObject = EnqueueUnmapMemObject;
    table->clCreateCommandQueue = CreateCommandQueue;
    table->clRetainCommandQueue = RetainCommandQueue;
    table->clReleaseCommandQueue = ReleaseCommandQueue;
    table->clFinish = Finish;
}

static bool command(char *const *words, int count) {
    pattern = -1;
    if (count != 2) return false;
    if (!strcmp(words[1], "off")) return true;
    pattern = (int)strtol(words[1], NULL, 0) & 0xFF;
    return true;
}

const layer_mode memory_mode = {"memory", install, command};
