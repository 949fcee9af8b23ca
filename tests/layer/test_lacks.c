/*
 * test_lacks.c - a device without double precision: 32-bit integers and doubles have their vertices made on the host,
 * of triangles that the device has numbered; fields are carried all the same; what cannot be so is refused. And kernels
 * that a device runs with fewer work-items than were asked for: they are built again for as many as it allows
 */
#define CL_TARGET_OPENCL_VERSION 120

#include "engines.h"
#include "layer_find.h"
#include "random.h"
#include "samples.h"

#include <math.h>

enum { NX = 70, NY = 13, NZ = 9, SAMPLES = NX * NY * NZ };

static union {
    uint32_t u32[SAMPLES];
    int32_t i32[SAMPLES];
    float f32[SAMPLES];
    double f64[SAMPLES];
} samples;
static tc_context *reference;

static void grid_describe(tc_grid_options *grid, tc_type type) {
    tc_grid_options_init(grid);
    grid->dims[0] = NX, grid->dims[1] = NY, grid->dims[2] = NZ;
    grid->type = type;
    grid->samples = &samples;
    for (int n = 0; n < SAMPLES; n++) sample_set(&samples, type, n, (double)(random_below(1000)));
    if (type == TC_F64) samples.f64[SAMPLES / 2] = NAN;
}

/* The values of a field on the surface, by both engines. */
static void test_carry(tc_context *context, const tc_grid_options *grid, const tc_extract_options *options,
                       uint64_t vertex_count) {
    static float field[SAMPLES], values[2][6 * SAMPLES];
    const tc_field carried = {sizeof carried, TC_F32, 1, field};
    tc_context *contexts[2] = {reference, context};
    for (int n = 0; n < SAMPLES; n++) field[n] = (float)random_between(0, 1);
    for (int n = 0; n < 2; n++) {
        tc_grid *g = NULL;
        EXPECT(!tc_grid_create(contexts[n], grid, &g) &&
                   !tc_interpolate_field(g, options, &carried, values[n], vertex_count),
               "%s", tc_message());
        tc_grid_destroy(g);
    }
    EXPECT(memcmp(values[0], values[1], sizeof *field * (size_t)vertex_count) == 0, "%s samples: carried values differ",
           tc_type_name(grid->type));
}

static void test_extract(tc_context *context, uint32_t work_items, tc_type type, tc_method method, bool normals) {
    tc_grid_options grid;
    tc_extract_options options;
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2];
    grid_describe(&grid, type);
    tc_extract_options_init(&options);
    options.isovalue = 500.25;
    options.method = method;
    options.normals = normals;
    if (extract(reference, &grid, &options, &meshes[0], &data[0]) &&
        extract(context, &grid, &options, &meshes[1], &data[1])) {
        const char *differs = mesh_difference(&data[0], &data[1]);
        EXPECT(!differs, "%s, %u work-items: %s", tc_type_name(type), work_items, differs);
        EXPECT(data[0].triangle_count > 1000, "%llu triangles", (unsigned long long)data[0].triangle_count);
        test_carry(context, &grid, &options, data[0].vertex_count);
    }
    tc_mesh_destroy(meshes[0]);
    tc_mesh_destroy(meshes[1]);
}

static void test_refusals(tc_context *context) {
    static const float points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t corners[4] = {0, 1, 2, 3};
    tc_tetrahedra_grid_options complex;
    tc_grid_options options;
    tc_extract_options extraction;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_grid *grid = NULL;
    tc_tetrahedra_grid_options_init(&complex);
    complex.points = &points[0][0], complex.point_count = 4;
    complex.tetrahedra = corners, complex.tetrahedron_count = 1;
    complex.type = TC_F64, complex.samples = samples.f64;
    EXPECT_REFUSED(tc_tetrahedra_grid_create(context, &complex, &grid), TC_ERROR_DEVICE, "a complex of doubles");
    EXPECT(strstr(tc_message(), "fp64"), "the message says nothing of fp64: %s", tc_message());

    grid_describe(&options, TC_F64);
    tc_extract_options_init(&extraction);
    extraction.isovalue = 500.25;
    EXPECT(tc_grid_create(context, &options, &grid) == TC_OK && tc_count(grid, &extraction, &counts) == TC_OK,
           "counting triangles of doubles: %s", tc_message());
    EXPECT(counts.triangle_count > 1000, "%llu triangles", (unsigned long long)counts.triangle_count);
    tc_grid_destroy(grid);
}

/* Method snap needs samples where vertices are made: of wide types it is refused, with the way out. */
static void test_snap_refused(tc_context *context) {
    static const tc_type wide[] = {TC_U32, TC_I32, TC_F64};
    for (size_t n = 0; n < sizeof wide / sizeof *wide; n++) {
        tc_grid_options options;
        tc_extract_options how;
        tc_counts counts = {.struct_size = sizeof counts};
        tc_grid *grid = NULL;
        tc_mesh *mesh = NULL;
        grid_describe(&options, wide[n]);
        tc_extract_options_init(&how);
        how.isovalue = 500.25;
        how.method = TC_METHOD_SNAP;
        EXPECT(tc_grid_create(context, &options, &grid) == TC_OK, "a grid of %s: %s", tc_type_name(wide[n]),
               tc_message());
        EXPECT_REFUSED(tc_extract(grid, &how, &mesh), TC_ERROR_DEVICE, "snap without fp64");
        EXPECT(!mesh && strstr(tc_message(), "fp64") && strstr(tc_message(), "reference") &&
                   strstr(tc_message(), tc_type_name(wide[n])),
               "%s", tc_message());
        EXPECT_REFUSED(tc_count(grid, &how, &counts), TC_ERROR_DEVICE, "a count by snap without fp64");
        how.method = TC_METHOD_TETRA;
        EXPECT(tc_count(grid, &how, &counts) == TC_OK && counts.triangle_count > 1000, "after that: %s", tc_message());
        tc_grid_destroy(grid);
    }
}

/* The structured grid's own tetrahedra. */
static void test_complex(tc_context *context) {
    static float points[3 * SAMPLES];
    tc_grid_options grid;
    tc_tetrahedra cut = {.struct_size = sizeof cut};
    tc_tetrahedra_grid_options complex;
    tc_extract_options options;
    tc_context *contexts[2] = {reference, context};
    tc_grid *grids[2] = {NULL, NULL};
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2] = {{.struct_size = sizeof *data}, {.struct_size = sizeof *data}};
    for (int n = 0; n < SAMPLES; n++)
        points[3 * n] = (float)(n % NX), points[3 * n + 1] = (float)(n / NX % NY),
                   points[3 * n + 2] = (float)(n / NX / NY);
    grid_describe(&grid, TC_F32);
    grid.points = points;
    EXPECT(tc_tetrahedralize_grid(&grid, &cut) == TC_OK, "%s", tc_message());
    tc_tetrahedra_grid_options_init(&complex);
    complex.points = points, complex.point_count = SAMPLES;
    complex.tetrahedra = cut.tetrahedra, complex.tetrahedron_count = cut.tetrahedron_count;
    complex.type = TC_F32, complex.samples = samples.f32;
    tc_extract_options_init(&options);
    options.isovalue = 500.25;
    for (int n = 0; n < 2; n++)
        EXPECT(!tc_tetrahedra_grid_create(contexts[n], &complex, &grids[n]) &&
                   !tc_extract(grids[n], &options, &meshes[n]) && !tc_mesh_get(meshes[n], &data[n]),
               "a complex with few work-items: %s", tc_message());
    const char *differs = mesh_difference(&data[0], &data[1]);
    EXPECT(!differs && data[0].triangle_count > 1000, "a complex with few work-items: %s", differs);
    for (int n = 0; n < 2; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_grid_destroy(grids[n]);
    }
    tc_tetrahedra_release(&cut);
}

static void test_limits(const layer_functions *layer) {
    static const struct {
        const char *command;
        bool complex;
    } limits[] = {
        {"lacks items classify 32 32", false},    {"lacks items emit 96 64", false},
        {"lacks items * 64 32", false},           {"lacks items cells_mark 63 32", false},
        {"lacks items complex_join 32 32", true},
    };
    for (size_t n = 0; n < sizeof limits / sizeof *limits; n++) {
        tc_context_options options;
        tc_expert_options expert;
        options_init(&options, &expert);
        expert.work_items = 128;
        EXPECT(layer->command(limits[n].command), "%s is not understood", limits[n].command);
        tc_context *context = context_open(&options);
        if (limits[n].complex)
            test_complex(context);
        else
            test_extract(context, 128, n == 3 ? TC_F64 : TC_F32, TC_METHOD_TETRA, false);
        tc_context_destroy(context);
    }
    EXPECT(layer->command("lacks off"), "the layer goes on");
}

/* As little local memory as OpenCL allows: groups are no larger than that does for. */
static void test_local_memory(const layer_functions *layer) {
    EXPECT(layer->command("lacks local 32768"), "the layer does not know local");
    for (uint32_t work_items = 320; work_items <= 352; work_items += 32) {
        tc_context_options options;
        tc_expert_options expert;
        tc_context *context = NULL;
        options_init(&options, &expert);
        expert.work_items = work_items;
        tc_status status = tc_context_create(&options, &context);
        EXPECT(status == (work_items == 320 ? TC_OK : TC_ERROR_ARGUMENT), "%u work-items with 32 KiB: status %d",
               work_items, (int)status);
        if (status) EXPECT(strstr(tc_message(), "up to 320 on this device"), "%s", tc_message());
        tc_context_destroy(context);
    }
    layer->command("lacks off");
}

/* A platform that nobody knows gets the kernels for groups, and where it has none so large those for one work-item. */
static void test_unknown_platform(const layer_functions *layer) {
    static const struct {
        const char *command;
        uint32_t work_items;
    } platforms[] = {{"lacks name 0", 32}, {"lacks name 16", 1}};
    for (size_t n = 0; n < sizeof platforms / sizeof *platforms; n++) {
        tc_context_options options;
        tc_tuning tuning = {.struct_size = sizeof tuning};
        tc_context_options_init(&options);
        EXPECT(layer->command(platforms[n].command), "%s is not understood", platforms[n].command);
        tc_context *context = context_open(&options);
        EXPECT(tc_context_tuning(context, &tuning) == TC_OK && tuning.work_items == platforms[n].work_items,
               "%s: %u work-items", platforms[n].command, tuning.work_items);
        test_extract(context, tuning.work_items, TC_F32, TC_METHOD_TETRA, false);
        tc_context_destroy(context);
    }
    EXPECT(layer->command("lacks off"), "the layer goes on");
}

int main(void) {
    random_state = 1996;
    if (!device_exists()) return SKIPPED;
    const layer_functions *layer = layer_find();
    EXPECT(layer && layer->command("lacks fp64"), "the layer is not there");
    if (!layer) return EXPECT_DONE();
    reference = reference_open();
    for (uint32_t work_items = 1; work_items <= 32; work_items += 31) {
        tc_context_options options;
        tc_expert_options expert;
        tc_device_info info = {.struct_size = sizeof info};
        options_init(&options, &expert);
        expert.work_items = work_items;
        tc_context *context = context_open(&options);
        EXPECT(tc_context_device(context, &info) == TC_OK && !info.has_fp64, "the device has fp64 all the same");
        test_extract(context, work_items, TC_F64, TC_METHOD_TETRA, false);
        test_extract(context, work_items, TC_U32, TC_METHOD_TETRA, true);
        if (work_items == 1 || !tier_is_quick()) { /* of groups these are built for long */
            test_extract(context, work_items, TC_F64, TC_METHOD_HYBRID, false);
            test_extract(context, work_items, TC_F32, TC_METHOD_TETRA, true);
            test_extract(context, work_items, TC_F32, TC_METHOD_SNAP, true);
        }
        test_refusals(context);
        test_snap_refused(context);
        tc_context_destroy(context);
    }
    test_limits(layer);
    test_local_memory(layer);
    test_unknown_platform(layer);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
