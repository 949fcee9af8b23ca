/*
 * test_nodata.c - the missing value as people and files write it: a decimal number, which a sample need not hold
 * exactly
 *
 * Some samples of a grid are set to the value, stored in the type of the samples. The mesh then is that of the same
 * grid with these samples blanked instead, by both engines, with normals, on uniform and curvilinear grids, also cut
 * into tetrahedra. A value that no sample can have leaves the mesh as it is without one.
 */
#include "engines.h"
#include "samples.h"

#include <math.h>

enum { NX = 70, NY = 9, NZ = 6, SAMPLES = NX * NY * NZ };

typedef struct named_value {
    const char *text; /* as typed */
    tc_type type;
} named_value;

static const named_value values[] = {
    {"1e20", TC_F32},
    {"-999.9", TC_F32},
    {"-3.4028235e+38", TC_F32},
    {"0.1", TC_F32},
    {"3.4028235e38", TC_F32},
    {"-9999", TC_F32},
    {"0", TC_F32},
    {"1e-40", TC_F32},
    {"0.1", TC_F64},
    {"-1.7976931348623157e308", TC_F64},
    {"1e20", TC_F64},
    {"255", TC_U8},
    {"-128", TC_I8},
    {"65535", TC_U16},
    {"-32768", TC_I16},
    {"4294967295", TC_U32},
    {"-2147483648", TC_I32},
};

static const named_value impossible[] = {{"0.5", TC_U8},         {"-1", TC_U8},       {"256", TC_U8},
                                         {"128", TC_I8},         {"-9999.5", TC_I16}, {"65536", TC_U16},
                                         {"4294967296", TC_U32}, {"1e39", TC_F32},    {"1e300", TC_F32}};

static double memory[SAMPLES]; /* of any type */
static float points[3 * SAMPLES];
static uint8_t blanked[SAMPLES];

/* A bump of 20 to 120 everywhere; missing: the value at one sample of eleven, blanked alike. */
static void fill(tc_type type, double value, int missing) {
    for (int n = 0; n < SAMPLES; n++) {
        const int x = n % NX, y = n / NX % NY, z = n / NX / NY;
        points[3 * n] = (float)x + 0.125F * (float)y;
        points[3 * n + 1] = (float)y;
        points[3 * n + 2] = (float)z + 0.0625F * (float)x;
        blanked[n] = (uint8_t)(missing && n % 11 == 3);
        sample_set(memory, type, n, blanked[n] ? value : 20 + 10 * ((x / 3 + y + z) % 11));
    }
}

static void describe(tc_grid_options *grid, tc_type type, int curvilinear) {
    tc_grid_options_init(grid);
    grid->dims[0] = NX, grid->dims[1] = NY, grid->dims[2] = NZ;
    grid->type = type;
    grid->samples = memory;
    grid->points = curvilinear ? points : NULL;
}

static void expect_same(tc_context *context, const tc_grid_options *one, const tc_grid_options *other,
                        const char *name) {
    tc_mesh *meshes[2] = {NULL};
    tc_mesh_data data[2];
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = 65.5;
    how.normals = 1;
    bool made =
        extract(context, one, &how, &meshes[0], &data[0]) && extract(context, other, &how, &meshes[1], &data[1]);
    const char *difference = made ? mesh_difference(&data[0], &data[1]) : "no mesh";
    EXPECT(!difference, "%s: %s", name, difference);
    EXPECT(!made || data[0].triangle_count > 100, "%s: too few triangles to tell", name);
    tc_mesh_destroy(meshes[0]);
    tc_mesh_destroy(meshes[1]);
}

static void expect_same_cut(const tc_grid_options *one, const tc_grid_options *other, const char *name) {
    tc_tetrahedra a = {.struct_size = sizeof a}, b = {.struct_size = sizeof b};
    EXPECT(!tc_tetrahedralize_grid(one, &a) && !tc_tetrahedralize_grid(other, &b), "%s: %s", name, tc_message());
    EXPECT(a.tetrahedron_count == b.tetrahedron_count && a.tetrahedron_count &&
               !memcmp(a.tetrahedra, b.tetrahedra, (size_t)a.tetrahedron_count * 4 * sizeof *a.tetrahedra),
           "%s: other tetrahedra", name);
    tc_tetrahedra_release(&a);
    tc_tetrahedra_release(&b);
}

/* Each type and kind of grid has kernels of its own, whose building takes long: one integer type stands for the others.
 */
static bool is_for_device(tc_type type, int curvilinear) {
    return type == TC_F32 || (!curvilinear && (type == TC_F64 || type == TC_U8));
}

static void test_value(tc_context *const contexts[2], const named_value *v, int possible) {
    for (int curvilinear = 0; curvilinear < 2; curvilinear++) {
        char name[80];
        tc_grid_options named, masked;
        fill(v->type, strtod(v->text, NULL), possible);
        describe(&named, v->type, curvilinear);
        describe(&masked, v->type, curvilinear);
        named.has_nodata = 1;
        named.nodata = strtod(v->text, NULL);
        if (possible) masked.blanked_samples = blanked;
        snprintf(name, sizeof name, "%s %s%s", tc_type_name(v->type), v->text, curvilinear ? ", curvilinear" : "");
        if (!test_chosen(name)) continue;
        expect_same(contexts[0], &named, &masked, name);
        if (contexts[1] && is_for_device(v->type, curvilinear)) expect_same(contexts[1], &named, &masked, name);
        expect_same_cut(&named, &masked, name);
    }
}

int main(void) {
    tc_context_options options;
    tc_context_options_init(&options);
    tc_context *contexts[2] = {reference_open(), device_exists() ? context_open(&options) : NULL};
    bool skipped = !contexts[1];
    for (size_t n = 0; n < sizeof values / sizeof *values; n++) test_value(contexts, &values[n], 1);
    for (size_t n = 0; n < sizeof impossible / sizeof *impossible; n++) test_value(contexts, &impossible[n], 0);
    for (int n = 0; n < 2; n++) tc_context_destroy(contexts[n]);
    int failed = EXPECT_DONE();
    return failed || !skipped ? failed : SKIPPED;
}
