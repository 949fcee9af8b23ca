/*
 * test_own_context.c - the caller's own OpenCL context and queue: used, given back, and good for the same bytes
 */
#define CL_TARGET_OPENCL_VERSION 120

#include "engines.h"

#include <CL/cl.h>
#include <math.h>
#include <time.h>

enum { SIZE = 40 };

static cl_uint context_references(cl_context context) {
    cl_uint count = 0;
    EXPECT(!clGetContextInfo(context, CL_CONTEXT_REFERENCE_COUNT, sizeof count, &count, NULL), "no reference count");
    return count;
}

static cl_uint queue_references(cl_command_queue queue) {
    cl_uint count = 0;
    EXPECT(!clGetCommandQueueInfo(queue, CL_QUEUE_REFERENCE_COUNT, sizeof count, &count, NULL), "no reference count");
    return count;
}

static bool device_find(cl_device_id *device) {
    cl_platform_id platforms[16];
    cl_uint count = 0;
    if (clGetPlatformIDs(16, platforms, &count)) return false;
    for (cl_uint n = 0; n < count && n < 16; n++)
        if (!clGetDeviceIDs(platforms[n], CL_DEVICE_TYPE_ALL, 1, device, NULL)) return true;
    return false;
}

static void test_extraction(const tc_context_options *options, const tc_grid_options *grid,
                            const tc_mesh_data *expected) {
    tc_extract_options how;
    tc_mesh *mesh = NULL;
    tc_mesh_data data;
    tc_device_info info = {.struct_size = sizeof info};
    tc_extract_options_init(&how);
    how.isovalue = 0.25;
    tc_context *context = context_open(options);
    EXPECT(tc_context_cl_context(context) == options->cl_context && tc_context_cl_queue(context) == options->cl_queue,
           "context and queue are not those given");
    EXPECT(tc_context_device(context, &info) == TC_OK && info.name[0], "the given device is unknown: %s", tc_message());
    if (extract(context, grid, &how, &mesh, &data)) {
        const char *difference = mesh_difference(expected, &data);
        EXPECT(!difference, "in the caller's context: %s", difference);
    }
    tc_mesh_destroy(mesh);
    tc_context_destroy(context);
}

/* Queues that calls could not rely on are a mistake of the caller's, found at once. */
static void test_queues_refused(cl_context theirs, cl_device_id device) {
    cl_int errors[2];
    cl_context other = clCreateContext(NULL, 1, &device, NULL, NULL, &errors[0]);
    cl_command_queue of_other = clCreateCommandQueue(other, device, 0, &errors[1]);
    EXPECT(!errors[0] && !errors[1], "no second context: %d, %d", (int)errors[0], (int)errors[1]);
    cl_uint before = context_references(theirs);
    tc_context_options options;
    tc_context *none = NULL;
    tc_context_options_init(&options);
    options.cl_context = theirs;
    options.cl_queue = of_other;
    EXPECT(tc_context_create(&options, &none) == TC_ERROR_ARGUMENT && !none && strstr(tc_message(), "another"),
           "a queue of another context: %s", tc_message());
    clReleaseCommandQueue(of_other);
    clReleaseContext(other);
    options.cl_queue = clCreateCommandQueue(theirs, device, CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE, &errors[0]);
    if (errors[0]) {
        printf("no queue of this device runs out of order (%d)\n", (int)errors[0]);
        return;
    }
    EXPECT(tc_context_create(&options, &none) == TC_ERROR_ARGUMENT && !none && strstr(tc_message(), "out of order"),
           "a queue that runs out of order: %s", tc_message());
    clReleaseCommandQueue(options.cl_queue);
    EXPECT(context_references(theirs) == before, "a refused context is retained");
}

int main(void) {
    static float samples[SIZE * SIZE * SIZE];
    cl_device_id device;
    cl_int error;
    if (!device_exists() || !device_find(&device)) return SKIPPED;
    cl_context theirs = clCreateContext(NULL, 1, &device, NULL, NULL, &error);
    EXPECT(!error, "no context: %d", (int)error);
    cl_command_queue queue = clCreateCommandQueue(theirs, device, 0, &error);
    EXPECT(!error, "no queue: %d", (int)error);
    cl_uint context_before = context_references(theirs), queue_before = queue_references(queue);

    tc_grid_options grid;
    tc_extract_options how;
    tc_context_options options;
    tc_expert_options expert;
    tc_mesh *mesh = NULL;
    tc_mesh_data expected;
    tc_context *reference = reference_open();
    tc_grid_options_init(&grid);
    tc_extract_options_init(&how);
    for (int axis = 0; axis < 3; axis++) grid.dims[axis] = SIZE;
    for (int n = 0; n < SIZE * SIZE * SIZE; n++)
        samples[n] = (float)(sin(0.2 * (n % SIZE)) + cos(0.3 * (n / SIZE % SIZE)) + sin(0.25 * (n / SIZE / SIZE)));
    grid.type = TC_F32;
    grid.samples = samples;
    how.isovalue = 0.25;
    bool made = extract(reference, &grid, &how, &mesh, &expected);
    EXPECT(made && expected.triangle_count > 1000, "the reference has a mesh too small to tell");

    options_init(&options, &expert);
    options.cl_context = theirs;
    options.cl_queue = queue;
    for (int n = 0; n < 2 && made; n++) test_extraction(&options, &grid, &expected);
    expert.always_copy = 1; /* and slabs, which take a queue of the library's beside the caller's */
    options.max_memory_bytes = sizeof samples + 12 * (expected.vertex_count + expected.triangle_count);
    if (made) test_extraction(&options, &grid, &expected);
    for (int n = 0; n < 100 && (context_references(theirs) > context_before || queue_references(queue) > queue_before);
         n++) /* an implementation may let go of finished commands a moment later */
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    EXPECT(context_references(theirs) == context_before && queue_references(queue) == queue_before,
           "context or queue are still retained");

    test_queues_refused(theirs, device);
    tc_context *none = NULL;
    options.cl_queue = NULL;
    EXPECT(tc_context_create(&options, &none) == TC_ERROR_ARGUMENT && !none && strstr(tc_message(), "queue"),
           "a context without a queue: %s", tc_message());
    EXPECT(context_references(theirs) == context_before, "a refused context is retained");
    tc_mesh_destroy(mesh);
    tc_context_destroy(reference);
    EXPECT(!clReleaseCommandQueue(queue) && !clReleaseContext(theirs), "queue or context was gone already");
    return EXPECT_DONE();
}
