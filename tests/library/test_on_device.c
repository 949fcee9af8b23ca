/*
 * test_on_device.c - nothing leaves the device: samples made by a kernel of the caller's, counted, and emitted into
 * buffers of the caller's; main() shows how
 *
 * The mesh is then compared with the reference's, and everything that can be asked for wrongly is.
 */
#define CL_TARGET_OPENCL_VERSION 120

#include "engines.h"

#include <CL/cl.h>

enum { NX = 90, NY = 70, NZ = 50, OFFSET = 13 };

static const char source[] = "kernel void samples_make(global ushort *out, uint offset) {\n"
                             "    uint x = get_global_id(0), y = get_global_id(1), z = get_global_id(2);\n"
                             "    uint n = (z * get_global_size(1) + y) * get_global_size(0) + x;\n"
                             "    out[offset + n] = (x * x + 2 * y * y + 3 * z * z + 40 * (x ^ y)) & 0xffff;\n"
                             "}\n";

typedef struct gpu {
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
} gpu;

static void must(cl_int error, const char *what) {
    EXPECT(!error, "%s: %d", what, (int)error);
    if (error) exit(EXIT_FAILURE);
}

static bool gpu_open(gpu *g) {
    cl_platform_id platforms[16];
    cl_uint count = 0;
    cl_int error = clGetPlatformIDs(16, platforms, &count);
    bool found = false;
    for (cl_uint n = 0; n < count && n < 16 && !error && !found; n++)
        found = !clGetDeviceIDs(platforms[n], CL_DEVICE_TYPE_ALL, 1, &g->device, NULL);
    if (!found) return false;
    g->context = clCreateContext(NULL, 1, &g->device, NULL, NULL, &error);
    must(error, "context");
    g->queue = clCreateCommandQueue(g->context, g->device, 0, &error);
    must(error, "queue");
    return true;
}

static cl_mem buffer_make_as(cl_context context, cl_mem_flags flags, size_t bytes) {
    cl_int error;
    cl_mem memory = clCreateBuffer(context, flags, bytes, NULL, &error);
    must(error, "buffer");
    return memory;
}

static cl_mem buffer_make(const gpu *g, size_t bytes) { return buffer_make_as(g->context, CL_MEM_READ_WRITE, bytes); }

/* A context that the library does not work in. */
static cl_context other_open(const gpu *g) {
    cl_int error;
    cl_context other = clCreateContext(NULL, 1, &g->device, NULL, NULL, &error);
    must(error, "another context");
    return other;
}

/* Enqueued, and not waited for. */
static cl_mem samples_make(const gpu *g) {
    const char *text = source;
    const size_t sizes[3] = {NX, NY, NZ};
    const cl_uint offset = OFFSET;
    cl_int error;
    cl_mem samples = buffer_make(g, 2 * (OFFSET + NX * NY * NZ));
    cl_program program = clCreateProgramWithSource(g->context, 1, &text, NULL, &error);
    must(error, "program");
    must(clBuildProgram(program, 1, &g->device, "-cl-std=CL1.2", NULL, NULL), "build");
    cl_kernel kernel = clCreateKernel(program, "samples_make", &error);
    must(error, "kernel");
    must(clSetKernelArg(kernel, 0, sizeof samples, &samples), "argument");
    must(clSetKernelArg(kernel, 1, sizeof offset, &offset), "argument");
    must(clEnqueueNDRangeKernel(g->queue, kernel, 3, NULL, sizes, NULL, 0, NULL, NULL), "launch");
    must(clReleaseKernel(kernel), "release");
    must(clReleaseProgram(program), "release");
    return samples;
}

static const float *points; /* of the host's; NULL: the grid is uniform */
static const uint8_t *blanked;

static void grid_describe(tc_grid_options *grid) {
    tc_grid_options_init(grid);
    grid->dims[0] = NX, grid->dims[1] = NY, grid->dims[2] = NZ;
    grid->type = TC_U16;
    grid->points = points;
    grid->blanked_samples = blanked;
}

/* The device's mesh, read back, is the reference's of the samples, read back. */
static void expect_reference(const gpu *g, cl_mem samples, const tc_extract_options *how, const tc_counts *counts,
                             const tc_device_mesh *mesh) {
    uint16_t *host = malloc(2 * NX * NY * NZ);
    float *positions = malloc(12 * counts->vertex_count), *normals = malloc(12 * counts->vertex_count);
    uint32_t *triangles = malloc(12 * counts->triangle_count);
    tc_context *reference = reference_open();
    tc_mesh *expected_mesh = NULL;
    tc_mesh_data expected, got = {.struct_size = sizeof got};
    tc_grid_options grid;
    if (!host || !positions || !normals || !triangles) exit(EXIT_FAILURE);
    must(clEnqueueReadBuffer(g->queue, samples, CL_TRUE, 2 * OFFSET, 2 * NX * NY * NZ, host, 0, NULL, NULL), "read");
    must(
        clEnqueueReadBuffer(g->queue, mesh->positions, CL_TRUE, 0, 12 * counts->vertex_count, positions, 0, NULL, NULL),
        "read");
    if (mesh->normals)
        must(
            clEnqueueReadBuffer(g->queue, mesh->normals, CL_TRUE, 0, 12 * counts->vertex_count, normals, 0, NULL, NULL),
            "read");
    must(clEnqueueReadBuffer(g->queue, mesh->triangles, CL_TRUE, 0, 12 * counts->triangle_count, triangles, 0, NULL,
                             NULL),
         "read");
    grid_describe(&grid);
    grid.samples = host;
    if (extract(reference, &grid, how, &expected_mesh, &expected)) {
        got.vertex_count = counts->vertex_count, got.triangle_count = counts->triangle_count;
        got.active_cell_count = counts->active_cell_count;
        got.positions = positions, got.normals = mesh->normals ? normals : NULL, got.triangles = triangles;
        const char *difference = mesh_difference(&expected, &got);
        EXPECT(!difference && got.triangle_count > 1000, "isovalue %g on the device: %s", how->isovalue, difference);
    }
    tc_mesh_destroy(expected_mesh);
    tc_context_destroy(reference);
    free(host), free(positions), free(normals), free(triangles);
}

/* Count, allocate, emit. */
static void test_surface(const gpu *g, tc_grid *grid, cl_mem samples, double isovalue, int normals, tc_method method) {
    tc_extract_options how;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_device_mesh mesh = {.struct_size = sizeof mesh};
    cl_event done = NULL;
    tc_extract_options_init(&how);
    how.isovalue = isovalue;
    how.normals = normals;
    how.method = method;
    EXPECT(!tc_count(grid, &how, &counts), "count: %s", tc_message());
    mesh.positions = buffer_make(g, 12 * counts.vertex_count);
    mesh.normals = normals ? buffer_make(g, 12 * counts.vertex_count) : NULL;
    mesh.triangles = buffer_make(g, 12 * counts.triangle_count);
    EXPECT(!tc_emit(grid, &how, &mesh, &done) && done, "emit: %s", tc_message());
    if (done) {
        must(clWaitForEvents(1, &done), "wait"); /* or hand the event to what uses the mesh next */
        must(clReleaseEvent(done), "release");
        expect_reference(g, samples, &how, &counts, &mesh);
    }
    clReleaseMemObject(mesh.positions);
    if (mesh.normals) clReleaseMemObject(mesh.normals);
    clReleaseMemObject(mesh.triangles);
}

static void expect_refused(tc_grid *grid, const tc_extract_options *how, const tc_device_mesh *mesh, const char *why,
                           const char *word) {
    cl_event done = (cl_event)grid;
    tc_status status = tc_emit(grid, how, mesh, &done);
    EXPECT(status == TC_ERROR_ARGUMENT && !done && strstr(tc_message(), word), "%s: status %d, %s", why, (int)status,
           tc_message());
}

static void test_refusals(const gpu *g, tc_grid *grid) {
    tc_extract_options how;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_device_mesh mesh = {.struct_size = sizeof mesh}, unset = {0};
    tc_mesh *host_mesh = NULL;
    tc_extract_options_init(&how);
    how.isovalue = 9000;
    EXPECT(!tc_count(grid, &how, &counts), "count: %s", tc_message());
    expect_refused(grid, &how, &unset, "a mesh without its size", "struct_size");
    expect_refused(grid, &how, &mesh, "no buffers", "positions");
    mesh.positions = buffer_make(g, 12 * counts.vertex_count - 1);
    mesh.triangles = buffer_make(g, 12 * counts.triangle_count);
    expect_refused(grid, &how, &mesh, "a short buffer", "positions");
    clReleaseMemObject(mesh.positions);
    cl_context other = other_open(g);
    mesh.positions = buffer_make_as(other, CL_MEM_READ_WRITE, 12 * counts.vertex_count);
    expect_refused(grid, &how, &mesh, "a buffer of another context", "another");
    clReleaseMemObject(mesh.positions);
    clReleaseContext(other);
    mesh.positions = buffer_make_as(g->context, CL_MEM_READ_ONLY, 12 * counts.vertex_count);
    expect_refused(grid, &how, &mesh, "a buffer that kernels may not write", "READ_ONLY");
    clReleaseMemObject(mesh.positions);
    mesh.positions = buffer_make(g, 12 * counts.vertex_count);
    how.isovalue = 9001;
    expect_refused(grid, &how, &mesh, "another isovalue", "tc_count");
    how.isovalue = 9000;
    how.normals = 1;
    expect_refused(grid, &how, &mesh, "other options", "tc_count");
    how.normals = 0;
    how.method = TC_METHOD_HYBRID;
    expect_refused(grid, &how, &mesh, "another method", "tc_count");
    how.method = TC_METHOD_SNAP;
    expect_refused(grid, &how, &mesh, "method snap", "tc_count");
    how.method = TC_METHOD_TETRA;
    EXPECT(!tc_emit(grid, &how, &mesh, NULL), "emission after refusals: %s", tc_message());
    EXPECT(!tc_extract(grid, &how, &host_mesh), "extraction: %s", tc_message());
    expect_refused(grid, &how, &mesh, "emission after an extraction", "tc_count");
    how.isovalue = 1e9;
    EXPECT(!tc_count(grid, &how, &counts) && counts.vertex_count == 0, "count of nothing: %s", tc_message());
    EXPECT(!tc_emit(grid, &how, &(tc_device_mesh){.struct_size = sizeof mesh}, NULL), "nothing: %s", tc_message());
    must(clFinish(g->queue), "finish");
    clReleaseMemObject(mesh.positions);
    clReleaseMemObject(mesh.triangles);
    tc_mesh_destroy(host_mesh);
}

static void test_grids_refused(const gpu *g, tc_context *context, cl_mem samples) {
    static const uint16_t host[8];
    tc_context *reference = reference_open();
    tc_grid_options options;
    tc_grid *grid;
    grid_describe(&options);
    options.cl_samples = samples;
    options.cl_samples_offset = OFFSET + 1;
    EXPECT(tc_grid_create(context, &options, &grid) == TC_ERROR_ARGUMENT && strstr(tc_message(), "cl_samples"),
           "a buffer one sample short: %s", tc_message());
    options.cl_samples_offset = UINT64_MAX;
    EXPECT(tc_grid_create(context, &options, &grid) == TC_ERROR_ARGUMENT, "an offset that overflows");
    options.cl_samples_offset = OFFSET;
    EXPECT(tc_grid_create(reference, &options, &grid) == TC_ERROR_ARGUMENT, "a buffer for the reference engine");
    cl_context other = other_open(g);
    options.cl_samples = buffer_make_as(other, CL_MEM_READ_WRITE, 2 * (OFFSET + NX * NY * NZ));
    EXPECT(tc_grid_create(context, &options, &grid) == TC_ERROR_ARGUMENT && strstr(tc_message(), "another"),
           "samples of another context: %s", tc_message());
    clReleaseMemObject(options.cl_samples);
    clReleaseContext(other);
    options.cl_samples = buffer_make_as(g->context, CL_MEM_WRITE_ONLY, 2 * (OFFSET + NX * NY * NZ));
    EXPECT(tc_grid_create(context, &options, &grid) == TC_ERROR_ARGUMENT && strstr(tc_message(), "WRITE_ONLY"),
           "samples that kernels may not read: %s", tc_message());
    clReleaseMemObject(options.cl_samples);
    options.cl_samples = samples;
    options.samples = host;
    EXPECT(tc_grid_create(context, &options, &grid) == TC_ERROR_ARGUMENT, "samples in two places");
    tc_context_destroy(reference);
}

/* Samples on the device, where they lie and which are blanked on the host. */
static void test_points(const gpu *g, tc_context *context, cl_mem samples) {
    const int64_t count = NX * NY * NZ;
    float *made = malloc(12 * (size_t)count);
    uint8_t *holes = calloc((size_t)count, 1);
    tc_grid_options volume;
    tc_grid *grid = NULL;
    if (!made || !holes) exit(EXIT_FAILURE);
    for (int64_t n = 0; n < count; n++) {
        double x = (double)(n % NX), y = (double)(n / NX % NY), z = (double)(n / NX / NY);
        double place[3] = {x + 0.01 * y * y, y - 0.02 * z * x, z + 0.3 * y};
        for (int row = 0; row < 3; row++) made[3 * n + row] = (float)place[row];
        holes[n] = n % 61 == 0;
    }
    points = made, blanked = holes;
    grid_describe(&volume);
    volume.cl_samples = samples;
    volume.cl_samples_offset = OFFSET;
    EXPECT(!tc_grid_create(context, &volume, &grid), "grid: %s", tc_message());
    for (int normals = 0; normals < 2 && grid; normals++)
        test_surface(g, grid, samples, 9000, normals, TC_METHOD_TETRA);
    tc_grid_destroy(grid);
    points = NULL, blanked = NULL;
    free(made), free(holes);
}

int main(void) {
    gpu g;
    if (!device_exists() || !gpu_open(&g)) return SKIPPED;

    /* The library works in the caller's context and queue, ... */
    tc_context_options options;
    tc_context_options_init(&options);
    options.cl_context = g.context;
    options.cl_queue = g.queue;
    tc_context *context = context_open(&options);

    /* ... on samples that an earlier command of that queue makes. */
    tc_grid_options volume;
    tc_grid *grid = NULL;
    cl_mem samples = samples_make(&g);
    grid_describe(&volume);
    volume.cl_samples = samples;
    volume.cl_samples_offset = OFFSET;
    EXPECT(!tc_grid_create(context, &volume, &grid), "grid: %s", tc_message());
    if (!grid) return EXPECT_DONE();

    test_surface(&g, grid, samples, 9000, 0, TC_METHOD_TETRA);
    test_surface(&g, grid, samples, 15000.5, 1, TC_METHOD_TETRA);
    test_surface(&g, grid, samples, 9000, 0, TC_METHOD_HYBRID);
    test_surface(&g, grid, samples, 9000, 1, TC_METHOD_SNAP);
    test_surface(&g, grid, samples, 9000, 0, TC_METHOD_TETRA);
    test_refusals(&g, grid);
    test_grids_refused(&g, context, samples);
    test_points(&g, context, samples);

    tc_grid_destroy(grid);
    cl_uint references = 0;
    must(clGetMemObjectInfo(samples, CL_MEM_REFERENCE_COUNT, sizeof references, &references, NULL), "references");
    EXPECT(references == 1, "cl_samples is retained %u times", references);
    tc_context_destroy(context);
    clReleaseMemObject(samples);
    clReleaseCommandQueue(g.queue);
    clReleaseContext(g.context);
    return EXPECT_DONE();
}
