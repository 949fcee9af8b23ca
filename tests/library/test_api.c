/*
 * test_api.c - the public functions with every argument that may be wrong, on both engines
 *
 * Statuses, messages, outputs zeroed on failure; options never initialised or of newer callers; sizes, matrices and
 * isovalues that cannot be.
 */
#include "api.h"

/* ----------------------------------------------------------------------------------------------------- small calls */

static void test_types_and_version(void) {
    static const char *const names[] = {"u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"};
    static const size_t bytes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    unsigned major, minor, patch;
    char rest;
    for (int type = TC_U8; type <= TC_F64; type++)
        EXPECT(tc_type_bytes((tc_type)type) == bytes[type] && !strcmp(tc_type_name((tc_type)type), names[type]),
               "type %d is %s of %zu bytes", type, tc_type_name((tc_type)type), tc_type_bytes((tc_type)type));
    EXPECT(tc_type_bytes((tc_type)8) == 0 && !tc_type_name((tc_type)8), "8 is a type");
    EXPECT(tc_type_bytes((tc_type)-1) == 0 && !tc_type_name((tc_type)-1), "-1 is a type");
    EXPECT(sscanf(tc_version(), "%u.%u.%u%c", &major, &minor, &patch, &rest) == 3, "version %s", tc_version());
    EXPECT(major == TC_VERSION_MAJOR && minor == TC_VERSION_MINOR && patch == TC_VERSION_PATCH,
           "the library is %s, its header %d.%d.%d", tc_version(), TC_VERSION_MAJOR, TC_VERSION_MINOR,
           TC_VERSION_PATCH);
    EXPECT(TC_VERSION_NUMBER == major * 10000 + minor * 100 + patch, "the header's number is %d", TC_VERSION_NUMBER);
}

static void test_null_everywhere(tc_context *context, tc_grid *grid) {
    tc_grid_options grid_options;
    tc_extract_options how;
    tc_mesh *mesh = NULL;
    tc_grid *none = NULL;
    tc_device_mesh device_mesh = {.struct_size = sizeof device_mesh};
    tc_context *no_context = NULL;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_device_info info = {.struct_size = sizeof info};
    uint64_t peak = 1;
    grid_describe(&grid_options);
    tc_extract_options_init(&how);
    tc_context_destroy(NULL);
    tc_grid_destroy(NULL);
    tc_mesh_destroy(NULL);
    EXPECT(!tc_context_cl_context(NULL) && !tc_context_cl_queue(NULL), "OpenCL objects of no context");
    EXPECT(tc_context_device_bytes(NULL, &peak) == 0 && peak == 0, "device bytes of no context");
    EXPECT_REFUSED(tc_device_count(NULL), TC_ERROR_ARGUMENT, "tc_device_count(NULL)");
    EXPECT_REFUSED(tc_device_get(0, NULL), TC_ERROR_ARGUMENT, "tc_device_get without info");
    EXPECT_REFUSED(tc_context_create(NULL, &no_context), TC_ERROR_ARGUMENT, "tc_context_create without options");
    EXPECT_REFUSED(tc_context_create(NULL, NULL), TC_ERROR_ARGUMENT, "tc_context_create(NULL, NULL)");
    EXPECT_REFUSED(tc_context_device(NULL, &info), TC_ERROR_ARGUMENT, "tc_context_device without context");
    EXPECT_REFUSED(tc_context_device(context, NULL), TC_ERROR_ARGUMENT, "tc_context_device without info");
    EXPECT_REFUSED(tc_grid_create(NULL, &grid_options, &none), TC_ERROR_ARGUMENT, "tc_grid_create without context");
    EXPECT_REFUSED(tc_grid_create(context, NULL, &none), TC_ERROR_ARGUMENT, "tc_grid_create without options");
    EXPECT_REFUSED(tc_grid_create(context, &grid_options, NULL), TC_ERROR_ARGUMENT, "tc_grid_create without a place");
    EXPECT_REFUSED(tc_count(NULL, &how, &counts), TC_ERROR_ARGUMENT, "tc_count without grid");
    EXPECT_REFUSED(tc_count(grid, NULL, &counts), TC_ERROR_ARGUMENT, "tc_count without options");
    EXPECT_REFUSED(tc_count(grid, &how, NULL), TC_ERROR_ARGUMENT, "tc_count without counts");
    EXPECT_REFUSED(tc_emit(NULL, &how, &device_mesh, NULL), TC_ERROR_ARGUMENT, "tc_emit without grid");
    EXPECT_REFUSED(tc_emit(grid, NULL, &device_mesh, NULL), TC_ERROR_ARGUMENT, "tc_emit without options");
    EXPECT_REFUSED(tc_emit(grid, &how, NULL, NULL), TC_ERROR_ARGUMENT, "tc_emit without mesh");
    EXPECT_REFUSED(tc_extract(NULL, &how, &mesh), TC_ERROR_ARGUMENT, "tc_extract without grid");
    EXPECT_REFUSED(tc_extract(grid, NULL, &mesh), TC_ERROR_ARGUMENT, "tc_extract without options");
    EXPECT_REFUSED(tc_extract(grid, &how, NULL), TC_ERROR_ARGUMENT, "tc_extract without a place");
    EXPECT_REFUSED(tc_mesh_get(NULL, &data), TC_ERROR_ARGUMENT, "tc_mesh_get without mesh");
    EXPECT(!none && !mesh && !no_context, "outputs are not zero after failures");
}

/* --------------------------------------------------------------------------------------------------------- options */

static void test_struct_sizes(tc_context *context, tc_grid *grid) {
    tc_context_options context_options;
    tc_grid_options grid_options;
    tc_extract_options how;
    tc_context *no_context = NULL;
    tc_grid *none = NULL;
    tc_mesh *mesh = NULL;
    static const size_t bad[] = {0, 1, 4, 1 << 20, SIZE_MAX};
    for (int n = 0; n < 5; n++) {
        tc_context_options_init(&context_options);
        grid_describe(&grid_options);
        tc_extract_options_init(&how);
        context_options.struct_size = grid_options.struct_size = how.struct_size = bad[n];
        EXPECT_REFUSED(tc_context_create(&context_options, &no_context), TC_ERROR_ARGUMENT,
                       "context options of no size");
        EXPECT_REFUSED(tc_grid_create(context, &grid_options, &none), TC_ERROR_ARGUMENT, "grid options of no size");
        EXPECT_REFUSED(tc_extract(grid, &how, &mesh), TC_ERROR_ARGUMENT, "extract options of no size");
        EXPECT(!no_context && !none && !mesh, "outputs are not zero after failures");
    }
    tc_counts counts = {.struct_size = 0};
    tc_mesh_data data = {.struct_size = 0};
    tc_device_info info = {.struct_size = 0};
    tc_extract_options_init(&how);
    how.isovalue = 127.5;
    EXPECT_REFUSED(tc_count(grid, &how, &counts), TC_ERROR_ARGUMENT, "counts of no size");
    EXPECT_REFUSED(tc_device_get(0, &info), TC_ERROR_ARGUMENT, "device info of no size");
    EXPECT(tc_extract(grid, &how, &mesh) == TC_OK, "%s", tc_message());
    EXPECT_REFUSED(tc_mesh_get(mesh, &data), TC_ERROR_ARGUMENT, "mesh data of no size");
    tc_mesh_destroy(mesh);
}

/* Options for experts, which tc_context_create alone reads. */
static void test_expert_options(void) {
    tc_context_options options;
    tc_expert_options expert = {0};
    tc_context *context = NULL;
    tc_tuning tuning = {.struct_size = sizeof tuning};
    tc_context_options_init(&options);
    EXPECT(!options.expert, "expert options that nobody gave");
    options.expert = &expert;
    EXPECT_REFUSED(tc_context_create(&options, &context), TC_ERROR_ARGUMENT, "expert options of no size");
    EXPECT(!context, "a context in spite of that");
    tc_expert_options_init(&expert);
    expert.tile_bricks = 11;
    EXPECT(tc_context_create(&options, &context) == TC_OK, "%s", tc_message());
    expert = (tc_expert_options){0};
    EXPECT(tc_context_tuning(context, &tuning) == TC_OK && tuning.tile_bricks == 11, "tiles of %u bricks, not 11",
           tuning.tile_bricks);
    tc_context_destroy(context);
}

static void test_context_options(void) {
    static const struct {
        uint32_t work_items;
        int division, engine;
        const char *device;
        tc_status status;
    } cases[] = {
        {3, 0, TC_ENGINE_OPENCL, NULL, TC_ERROR_ARGUMENT},
        {33, 0, TC_ENGINE_OPENCL, NULL, TC_ERROR_ARGUMENT},
        {2048, 0, TC_ENGINE_OPENCL, NULL, TC_ERROR_ARGUMENT},
        {UINT32_MAX, 0, TC_ENGINE_OPENCL, NULL, TC_ERROR_ARGUMENT},
        {1u << 31, 0, TC_ENGINE_OPENCL, NULL, TC_ERROR_ARGUMENT},
        {0, -1, TC_ENGINE_OPENCL, NULL, TC_ERROR_ARGUMENT},
        {0, 4, TC_ENGINE_OPENCL, NULL, TC_ERROR_ARGUMENT},
        {0, 0, 2, NULL, TC_ERROR_ARGUMENT},
        {0, 0, -1, NULL, TC_ERROR_ARGUMENT},
        {0, 0, TC_ENGINE_OPENCL, "no such device", TC_ERROR_DEVICE},
        {0, 0, TC_ENGINE_OPENCL, "99", TC_ERROR_DEVICE},
        {0, 0, TC_ENGINE_OPENCL, "99:99", TC_ERROR_DEVICE},
        {0, 0, TC_ENGINE_OPENCL, "-1", TC_ERROR_DEVICE},
        {0, 0, TC_ENGINE_OPENCL, "0:", TC_ERROR_DEVICE},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        tc_context_options options;
        tc_expert_options expert;
        tc_context *context = NULL;
        options_init(&options, &expert);
        expert.work_items = cases[n].work_items;
        expert.division = (tc_division)cases[n].division;
        options.engine = (tc_engine)cases[n].engine;
        options.device = cases[n].device;
        char what[64];
        snprintf(what, sizeof what, "context options %zu", n);
        EXPECT_REFUSED(tc_context_create(&options, &context), cases[n].status, what);
        EXPECT(!context, "%s: a context after failure", what);
        tc_context_destroy(context);
    }
}

/* ----------------------------------------------------------------------------------------------------------- grids */

static void expect_grid(tc_context *context, const tc_grid_options *options, tc_status status, const char *what) {
    tc_grid *grid = NULL;
    EXPECT_REFUSED(tc_grid_create(context, options, &grid), status, what);
    EXPECT(!grid, "%s: a grid after failure", what);
    tc_grid_destroy(grid);
}

static void test_sizes(tc_context *context) {
    static const struct {
        int64_t dims[3], first;
        tc_status status;
    } cases[] = {
        {{1, 5, 5}, 0, TC_ERROR_DATA},
        {{5, 1, 5}, 0, TC_ERROR_DATA},
        {{5, 5, 1}, 0, TC_ERROR_DATA},
        {{0, 5, 5}, 0, TC_ERROR_ARGUMENT},
        {{5, -3, 5}, 0, TC_ERROR_ARGUMENT},
        {{5, 5, INT64_MIN}, 0, TC_ERROR_ARGUMENT},
        {{INT64_MAX, 2, 2}, 0, TC_ERROR_DATA},
        {{INT64_MAX, INT64_MAX, INT64_MAX}, 0, TC_ERROR_DATA},
        {{(1 << 24) + 1, 2, 2}, 0, TC_ERROR_DATA},
        {{1 << 24, 1 << 24, 1 << 24}, 0, TC_ERROR_DATA},
        {{2, 2, 2}, INT64_MAX, TC_ERROR_DATA},
        {{2, 2, 2}, INT64_MIN, TC_ERROR_DATA},
        {{2, 2, 2}, INT32_MAX, TC_ERROR_DATA},
        {{2, 2, 2}, (int64_t)INT32_MIN - 1, TC_ERROR_DATA},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        tc_grid_options options;
        char what[64];
        grid_describe(&options);
        memcpy(options.dims, cases[n].dims, sizeof options.dims);
        options.first_index[n % 3] = cases[n].first;
        snprintf(what, sizeof what, "sizes %zu", n);
        expect_grid(context, &options, cases[n].status, what);
    }
}

static void test_grid_options(tc_context *context) {
    tc_grid_options options;
    grid_describe(&options);
    options.samples = NULL;
    expect_grid(context, &options, TC_ERROR_ARGUMENT, "no samples");
    for (int type = TC_U16; type <= TC_F64; type++) {
        grid_describe(&options);
        options.dims[0] = options.dims[1] = options.dims[2] = 2;
        options.type = (tc_type)type;
        static double aligned[9];
        options.samples = (const char *)aligned + 1;
        expect_grid(context, &options, TC_ERROR_ARGUMENT, "samples that are not aligned");
    }
    grid_describe(&options);
    options.type = (tc_type)8;
    expect_grid(context, &options, TC_ERROR_ARGUMENT, "no such type");
    options.type = (tc_type)-1;
    expect_grid(context, &options, TC_ERROR_ARGUMENT, "type -1");
    static const double bad[] = {(double)NAN, (double)INFINITY, 1e300};
    for (int n = 0; n < 12; n++)
        for (int m = 0; m < 3; m++) {
            grid_describe(&options);
            options.matrix[n / 4][n % 4] = bad[m];
            expect_grid(context, &options, TC_ERROR_ARGUMENT, "a matrix that is not finite in float32");
            EXPECT(strstr(tc_message(), "spacing, origin or direction"), "a number of the matrix is not named: %s",
                   tc_message());
        }
    grid_describe(&options);
    options.matrix[2][2] = 0;
    expect_grid(context, &options, TC_ERROR_ARGUMENT, "a matrix that flattens");
    memset(options.matrix, 0, sizeof options.matrix);
    expect_grid(context, &options, TC_ERROR_ARGUMENT, "a matrix of zeros");
    grid_describe(&options);
    memcpy(options.matrix[1], options.matrix[0], sizeof options.matrix[0]);
    expect_grid(context, &options, TC_ERROR_ARGUMENT, "a matrix with equal rows");
    grid_describe(&options);
    options.matrix[0][0] = 3e38;
    expect_grid(context, &options, TC_ERROR_ARGUMENT, "a far corner beyond float32");
}

/* ------------------------------------------------------------------------------------------------------ extraction */

static void test_isovalues(tc_grid *grid) {
    static const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    tc_extract_options how;
    tc_mesh *mesh = NULL, *kept = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_extract_options_init(&how);
    how.isovalue = 127.5;
    EXPECT(tc_extract(grid, &how, &kept) == TC_OK, "%s", tc_message());
    for (int n = 0; n < 3; n++) {
        tc_counts counts = {.struct_size = sizeof counts, .vertex_count = 99, .mesh_bytes = 99};
        how.isovalue = bad[n];
        EXPECT_REFUSED(tc_extract(grid, &how, &mesh), TC_ERROR_ARGUMENT, "an isovalue that is not finite");
        EXPECT_REFUSED(tc_extract(grid, &how, &kept), TC_ERROR_ARGUMENT, "an isovalue that is not finite");
        EXPECT_REFUSED(tc_count(grid, &how, &counts), TC_ERROR_ARGUMENT, "an isovalue that is not finite");
        EXPECT(!mesh && counts.vertex_count == 0 && counts.mesh_bytes == 0, "outputs are not zero after failure");
        EXPECT(kept && tc_mesh_get(kept, &data) == TC_OK && data.vertex_count == 0 && data.triangle_count == 0,
               "a mesh is not empty after a failed extraction");
    }
    static const double everywhere[] = {-1e300, 0, 255.5, 1e300};
    for (int n = 0; n < 4; n++) {
        how.isovalue = everywhere[n];
        EXPECT(tc_extract(grid, &how, &kept) == TC_OK && tc_mesh_get(kept, &data) == TC_OK && data.vertex_count == 0 &&
                   data.triangle_count == 0 && data.active_cell_count == 0,
               "isovalue %g, beyond all samples, has %llu vertices", how.isovalue,
               (unsigned long long)data.vertex_count);
    }
    how.isovalue = 1e300;
    EXPECT(tc_extract(grid, &how, &mesh) == TC_OK && tc_mesh_get(mesh, &data) == TC_OK && data.slab_count == 1,
           "a new empty mesh was made in %u slabs", data.slab_count);
    tc_mesh_destroy(mesh);
    tc_mesh_destroy(kept);
}

static void test_engine(tc_engine engine) {
    tc_context_options options;
    tc_grid_options grid_options;
    tc_grid *grid = NULL;
    tc_context_options_init(&options);
    options.engine = engine;
    tc_context *context = context_open(&options);
    grid_describe(&grid_options);
    EXPECT(tc_grid_create(context, &grid_options, &grid) == TC_OK, "%s", tc_message());
    test_null_everywhere(context, grid);
    test_struct_sizes(context, grid);
    test_sizes(context);
    test_grid_options(context);
    test_isovalues(grid);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
}

int main(void) {
    EXPECT(tc_message() && !*tc_message(), "a message before any call: %s", tc_message());
    samples_fill();
    test_types_and_version();
    test_engine(TC_ENGINE_REFERENCE);
    bool device = device_exists();
    if (device) {
        test_context_options();
        test_expert_options();
        test_engine(TC_ENGINE_OPENCL);
    }
    int failed = EXPECT_DONE();
    return failed || device ? failed : SKIPPED;
}
