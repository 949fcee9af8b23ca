/*
 * warm_cache.c - builds the kernels once, so that tests find them in the cache of the OpenCL implementation
 *
 * Those that test_random, test_device, test_api, test_curvilinear, test_hybrid, test_complex and test_trial need; a
 * kernel that is not among them is built by the test itself.
 *
 * Programs of one kind of context are built in one, since PoCL reads its own library, a tenth of a short build, once
 * per context.
 *
 * Usage: warm_cache PART PARTS: so that processes with a cache each can share the work, by kernels 1: programs that
 * have the same one, as those of types of one width have, are built by one process.
 */
#include "engines.h"
#include "samples.h"

enum { PLAIN = 1, WITH_MISSING = 2, WITH_NORMALS = 4, WITH_BOTH = 8 };

static const struct {
    tc_type type;
    uint32_t work_items;
    tc_division division;
    unsigned variants[2]; /* of each method */
    int grid;             /* 1: rectilinear, 2: curvilinear */
} programs[] = {
    /* those of one kind of context follow each other, groups come last */
    {TC_U8, 0, 0, {PLAIN | WITH_NORMALS | WITH_BOTH, PLAIN | WITH_MISSING | WITH_NORMALS}, 0},
    {TC_I8, 0, 0, {PLAIN | WITH_BOTH, 0}, 0},
    {TC_U16, 0, 0, {PLAIN | WITH_BOTH, 0}, 0},
    {TC_I16, 0, 0, {PLAIN | WITH_BOTH, PLAIN}, 0},
    {TC_U32, 0, 0, {PLAIN | WITH_BOTH, PLAIN}, 0},
    {TC_I32, 0, 0, {PLAIN | WITH_BOTH, 0}, 0},
    {TC_F32, 0, 0, {15, 15}, 0},
    {TC_F64, 0, 0, {15, PLAIN | WITH_BOTH}, 0},
    {TC_F32, 0, 0, {WITH_NORMALS | WITH_BOTH, 0}, 2},
    {TC_U8, 0, 0, {WITH_NORMALS | WITH_BOTH, 0}, 2},
    {TC_U32, 0, 0, {WITH_BOTH, 0}, 2},
    {TC_F64, 0, 0, {WITH_NORMALS | WITH_BOTH, 0}, 2},
    {TC_F32, 0, 0, {WITH_NORMALS | WITH_BOTH, 0}, 1},
    {TC_F32, 0, 2, {WITH_NORMALS, 0}, 0},
    {TC_F32, 0, 3, {WITH_NORMALS, 0}, 0},
    {TC_F32, 32, 0, {WITH_NORMALS | WITH_BOTH, WITH_BOTH}, 0},
    {TC_U8, 32, 0, {PLAIN, 0}, 0},
    {TC_F32, 32, 0, {WITH_NORMALS | WITH_BOTH, 0}, 2},
    {TC_F32, 32, 0, {WITH_BOTH, 0}, 1},
    {TC_U8, 64, 0, {PLAIN, 0}, 0},
    {TC_F32, 256, 0, {WITH_NORMALS | WITH_BOTH, 0}, 0},
};
enum { PROGRAMS = sizeof programs / sizeof *programs };

/* The context of a program, the one before if it is of its kind; the last one is closed by n = PROGRAMS. */
static tc_context *context_for(size_t n) {
    static tc_context *context;
    static uint32_t work_items;
    static tc_division division;
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    if (context && n < PROGRAMS && work_items == programs[n].work_items && division == programs[n].division)
        return context;
    tc_context_destroy(context);
    context = NULL;
    if (n == PROGRAMS) return NULL;
    if (programs[n].work_items) groups_begin();
    expert.work_items = work_items = programs[n].work_items;
    expert.division = division = programs[n].division;
    return context = context_open(&options);
}

/* Kernel 1 as a number: of the width of samples, not their type. */
static size_t kernel_of(size_t n, unsigned method, unsigned missing) {
    const tc_type type = programs[n].type;
    return (type >= TC_F32 ? type : type / 2) + programs[n].work_items / 32 + method + missing;
}

static void program_build(size_t n, int variant, tc_method method) {
    static double memory[27]; /* aligned for every type */
    static float points[3 * 27];
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh *mesh = NULL;
    tc_mesh_data data;
    tc_grid_options_init(&grid);
    tc_extract_options_init(&how);
    for (int axis = 0; axis < 3; axis++) grid.dims[axis] = 3;
    grid.type = programs[n].type;
    grid.samples = memory;
    grid.has_nodata = variant & 1;
    grid.nodata = 100;
    for (int axis = 0; axis < 3 && programs[n].grid == 1; axis++) grid.axes[axis] = points;
    if (programs[n].grid == 2) grid.points = points;
    how.isovalue = 1;
    how.normals = variant >> 1;
    how.method = method;
    for (int m = 0; m < 27; m++) sample_set(memory, grid.type, m, m == 13 ? 2 : 0);
    extract(context_for(n), &grid, &how, &mesh, &data);
    tc_mesh_destroy(mesh);
}

/* Complexes: of every type for the default work-group, of some for others. */
enum { COMPLEX_PROGRAMS = 14 };

static void complex_build(size_t n) {
    static const float points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t tetrahedron[4] = {0, 1, 2, 3};
    static const struct {
        tc_type type;
        uint32_t work_items;
    } others[] = {{TC_U8, 32}, {TC_F32, 32}, {TC_F64, 32}, {TC_U8, 64}, {TC_F32, 64}, {TC_F64, 64}};
    double memory[4];
    tc_context_options options;
    tc_expert_options expert;
    tc_tetrahedra_grid_options complex;
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    options_init(&options, &expert);
    tc_tetrahedra_grid_options_init(&complex);
    tc_extract_options_init(&how);
    complex.type = n <= TC_F64 ? (tc_type)n : others[n - 1 - TC_F64].type;
    expert.work_items = n <= TC_F64 ? 0 : others[n - 1 - TC_F64].work_items;
    tc_context *context = context_open(&options);
    for (int m = 0; m < 4; m++) sample_set(memory, complex.type, m, m);
    complex.point_count = 4, complex.points = points, complex.samples = memory;
    complex.tetrahedron_count = 1, complex.tetrahedra = tetrahedron;
    how.isovalue = 2;
    EXPECT(!tc_tetrahedra_grid_create(context, &complex, &grid) && !tc_extract(grid, &how, &mesh), "%s", tc_message());
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
}

int main(int argc, char **argv) {
    size_t part = argc > 2 ? strtoul(argv[1], NULL, 10) : 0, parts = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
    if (!device_exists()) return SKIPPED;
    for (size_t n = 0; n < COMPLEX_PROGRAMS; n++)
        if (n % parts == part) complex_build(n);
    for (size_t n = 0; n < PROGRAMS; n++)
        for (unsigned m = 0; m < 8; m++) {
            const unsigned method = m / 4;
            if ((programs[n].variants[method] >> m % 4 & 1) && kernel_of(n, method, m % 2) % parts == part)
                program_build(n, (int)(m % 4), (tc_method)method);
        }
    context_for(PROGRAMS);
    return EXPECT_DONE();
}
