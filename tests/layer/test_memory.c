/*
 * test_memory.c - new memory full of one pattern or another, guards around buffers, a device that is late or leaves
 * groups standing: same bytes
 *
 * Each watch is first shown to catch what it is for, in a kernel or program made wrong on purpose.
 */
#define CL_TARGET_OPENCL_VERSION 120

#include "engines.h"
#include "layer_find.h"
#include "memory_fault.h"
#include "scenarios.h"

#include <string.h>

enum { BYTES = 64 };

static const layer_functions *layer;
static const memory_fault_functions *host; /* NULL where it is not preloaded */
static cl_context context;
static cl_command_queue queue;
static cl_device_id device;

/* ---------------------------------------------------------------------------------------------------------- faults */

static bool device_open(void) {
    cl_platform_id platform;
    cl_int error;
    if (clGetPlatformIDs(1, &platform, NULL) || clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL))
        return false;
    context = clCreateContext(NULL, 1, &device, NULL, NULL, &error);
    queue = error ? NULL : clCreateCommandQueue(context, device, 0, &error);
    return !error;
}

/* Writes bytes [first, end) of a buffer, and returns what is then in it. */
static void bytes_write(cl_kernel kernel, cl_int first, cl_int end, unsigned char out[BYTES]) {
    const size_t one = 1;
    cl_int error;
    cl_mem memory = clCreateBuffer(context, CL_MEM_READ_WRITE, BYTES, NULL, &error);
    if (!error) error = clSetKernelArg(kernel, 0, sizeof memory, &memory);
    if (!error) error = clSetKernelArg(kernel, 1, sizeof first, &first);
    if (!error) error = clSetKernelArg(kernel, 2, sizeof end, &end);
    if (!error) error = clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &one, &one, 0, NULL, NULL);
    if (!error) error = clEnqueueReadBuffer(queue, memory, CL_TRUE, 0, BYTES, out, 0, NULL, NULL);
    EXPECT(!error, "a kernel that writes bytes fails: %d", (int)error);
    clReleaseMemObject(memory);
}

static void test_planted_faults(cl_kernel kernel) {
    unsigned char a[BYTES], b[BYTES];
    const unsigned long before = layer->faults();
    layer->command("memory 0xA5");
    bytes_write(kernel, 0, BYTES, a);
    EXPECT(layer->faults() == before, "a kernel that is right is found to write to a guard");
    bytes_write(kernel, 0, BYTES + 1, a);
    EXPECT(layer->faults() == before + 1, "a write behind a buffer is not found");
    bytes_write(kernel, -1, BYTES, a);
    EXPECT(layer->faults() == before + 2, "a write before a buffer is not found");
    bytes_write(kernel, 1, BYTES, a);
    layer->command("memory 0x5A");
    bytes_write(kernel, 1, BYTES, b);
    EXPECT(memcmp(a, b, BYTES), "a byte that was not written is the same under either pattern");
    EXPECT(!memcmp(a + 1, b + 1, BYTES - 1), "bytes that were written differ");
    layer->command("memory off");
}

/* Without a flush nothing happens; with one, or a call that waits, it does. */
static void test_hold(void) {
    unsigned char bytes[BYTES], out[BYTES] = {0};
    cl_int error;
    memset(bytes, 7, sizeof bytes);
    cl_mem memory = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, BYTES, bytes, &error);
    layer->command("late hold");
    if (!error) error = clEnqueueReadBuffer(queue, memory, CL_FALSE, 0, BYTES, out, 0, NULL, NULL);
    EXPECT(!error && layer->pending() == 1 && out[0] == 0, "a command starts before its queue is flushed");
    EXPECT(!clFinish(queue) && layer->pending() == 0 && out[0] == 7, "clFinish does not wait for a command");
    layer->command("late off");
    clReleaseMemObject(memory);
}

static void test_the_layer(void) {
    const char *text = "__kernel void bytes_write(__global uchar *bytes, int first, int end) {\n"
                       "    for (int n = first; n < end; n++) bytes[n] = (uchar)n;\n}\n";
    cl_int error;
    cl_program program = clCreateProgramWithSource(context, 1, &text, NULL, &error);
    if (!error) error = clBuildProgram(program, 1, &device, "", NULL, NULL);
    cl_kernel kernel = error ? NULL : clCreateKernel(program, "bytes_write", &error);
    EXPECT(!error, "the kernel is not built: %d", (int)error);
    if (!error) test_planted_faults(kernel);
    test_hold();
    if (kernel) clReleaseKernel(kernel);
    clReleaseProgram(program);
}

/* --------------------------------------------------------------------------------------------- fallback of the scan */

/* The device's mesh is the reference's, and the layer finds nothing. */
static void expect_same(const tc_context_options *options, tc_status (*grid_make)(tc_context *, tc_grid **),
                        double isovalue, const char *what) {
    const unsigned long faults = layer->faults();
    tc_context *contexts[2] = {reference_open(), context_open(options)};
    tc_grid *grids[2] = {NULL, NULL};
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2] = {{.struct_size = sizeof *data}, {.struct_size = sizeof *data}};
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = isovalue;
    for (int n = 0; n < 2; n++)
        EXPECT(!grid_make(contexts[n], &grids[n]) && !tc_extract(grids[n], &how, &meshes[n]) &&
                   !tc_mesh_get(meshes[n], &data[n]),
               "%s: %s", what, tc_message());
    const char *difference = mesh_difference(&data[0], &data[1]);
    EXPECT(!difference && data[0].triangle_count, "%s: %s", what, difference ? difference : "no surface");
    for (int n = 0; n < 2; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_grid_destroy(grids[n]);
        tc_context_destroy(contexts[n]);
    }
    layer->command("memory off;corrupt off");
    EXPECT(layer->faults() == faults, "%s: faults", what);
}

static tc_status stripes_make(tc_context *of, tc_grid **grid) {
    static uint8_t samples[20 * 20 * 70];
    tc_grid_options o;
    tc_grid_options_init(&o);
    o.dims[0] = 70, o.dims[1] = o.dims[2] = 20;
    for (int n = 0; n < 20 * 20 * 70; n++) samples[n] = (uint8_t)(3 * (n % 70) + 5 * (n / 70 % 20) + 7 * (n / 1400));
    o.samples = samples;
    return tc_grid_create(of, &o, grid);
}

/* Tetrahedra all of which the surface passes through: lists of them are full. */
static tc_status crossed_make(tc_context *of, tc_grid **grid) {
    enum { POINTS = 12, TETRAHEDRA = 2000 };
    static float positions[3 * POINTS];
    static uint8_t samples[POINTS];
    static uint32_t tetrahedra[4 * TETRAHEDRA];
    tc_tetrahedra_grid_options o;
    tc_tetrahedra_grid_options_init(&o);
    for (uint32_t n = 0; n < POINTS; n++) positions[3 * n + n % 3] = (float)n, samples[n] = n >= POINTS / 2;
    for (uint32_t n = 0; n < 4 * TETRAHEDRA; n++) tetrahedra[n] = (n / 4 + 3 * (n % 4)) % POINTS;
    o.point_count = POINTS, o.points = positions, o.samples = samples;
    o.tetrahedron_count = TETRAHEDRA, o.tetrahedra = tetrahedra;
    return tc_tetrahedra_grid_create(of, &o, grid);
}

/* Sums that no group has posted are made by those that wait for them; what they belong to is not made twice. */
static void test_fallback(void) {
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    expert.work_items = expert.work_groups = expert.tile_bricks = 1;
    expert.spin_limit = 3;
    if (test_chosen("starved groups")) {
        layer->command("corrupt build starved");
        expect_same(&options, stripes_make, 99.5, "starved groups");
    }
    expert.spin_limit = 1;
    expert.work_items = 32; /* a work-item alone appends many at once, which a recount never does */
    if (test_chosen("clusters counted again")) {
        layer->command("memory 0xA5");
        expect_same(&options, crossed_make, 1, "clusters counted again");
    }
}

/* ------------------------------------------------------------------------------------------------------- scenarios */

static bool call_failed(trial *t, const char *call, tc_status status) {
    EXPECT(false, "%s: %s fails with status %d: %s", (const char *)t->user, call, (int)status, tc_message());
    return false;
}

/* host_byte: what new memory of the host is full of; -1: as it comes. */
static void test_scenarios(const char *mode, int host_byte) {
    char label[128];
    trial t = {.failed = call_failed, .user = label};
    EXPECT(layer->command(mode), "the layer does not take: %s", mode);
    if (host) host->fill(host_byte);
    for (int index = 0; index < scenario_count(); index++) {
        const unsigned long faults = layer->faults();
        if (!scenario_uses_device(index) || !test_chosen(scenario_name(index))) continue;
        snprintf(label, sizeof label, "%s, host %d, %s", mode, host_byte, scenario_name(index));
        const char *problem = scenario_run(index, &t);
        EXPECT(!problem, "%s: %s", label, problem);
        EXPECT(layer->faults() == faults, "%s: faults", label);
    }
    layer->command("memory off;late off");
    if (host) host->fill(-1);
}

int main(void) {
    static const struct {
        const char *layer;
        int host_byte;
    } modes[] = {{"memory 0xA5", -1},
                 {"memory 0x5A", -1},
                 {"late hold", 0xA5},
                 {"late 200", 0x5A},
                 {"memory 0xFF;late hold", 0xFF}};
    int devices;
    if (tc_device_count(&devices) != TC_OK || !(layer = layer_find()) || !device_open()) {
        printf("skipped: no device, or a loader without layers\n");
        return SKIPPED;
    }
    host = dlsym(RTLD_DEFAULT, "memory_fault_control");
    test_the_layer();
    test_fallback();
    clReleaseCommandQueue(queue);
    clReleaseContext(context);
    if (!scenarios_prepare()) {
        printf("no scenario: %s\n", tc_message());
        return EXIT_FAILURE;
    }
    for (size_t n = 0; n < sizeof modes / sizeof *modes; n++) test_scenarios(modes[n].layer, modes[n].host_byte);
    scenarios_release();
    EXPECT(layer->references() == 0, "%ld references are left at the end", layer->references());
    return EXPECT_DONE();
}
