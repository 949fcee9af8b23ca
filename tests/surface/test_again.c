/*
 * test_again.c - further isovalues of a grid, which a device meets knowing the range of every brick
 *
 * One grid is extracted at one isovalue after the other, some of them twice, and each mesh compared with that of the
 * reference: every sample type, ties, missing samples, slabs, work-items alone and in groups. Where the device uses the
 * samples in place, those that no isovalue needs are made unreadable after the first visit.
 *
 * Usage: test_again [always_copy]: with it, samples and meshes are copied even where the device shares the memory.
 */
#include "engines.h"
#include "random.h"
#include "samples.h"

#include <math.h>
#include <sys/mman.h>

static uint32_t slab_count_most;
static int always_copy; /* whether contexts on the device copy samples and meshes */

/* Calm in most bricks, waves in some, so that both kinds occur and isovalues fall between. */
static double sample_value(tc_type type, const int64_t p[3], bool missing) {
    double wave = 25 * sin(0.21 * (double)p[0]) * cos(0.17 * (double)p[1]);
    double value = floor(60 + (p[2] > 14 ? wave + 0.5 * (double)p[2] : 0) + (p[0] > 120 ? 20 : 0));
    if (type == TC_F32 || type == TC_F64) value = 0.001 * (value - 60) * (value > 70 ? 1e6 : 1);
    return missing && random_below(900) == 0 ? (double)NAN : value;
}

static void *samples_make(tc_type type, const int64_t dims[3], bool missing) {
    int64_t n = 0, p[3];
    void *samples = malloc((size_t)(dims[0] * dims[1] * dims[2]) * tc_type_bytes(type));
    if (!samples) exit(EXIT_FAILURE);
    for (p[2] = 0; p[2] < dims[2]; p[2]++)
        for (p[1] = 0; p[1] < dims[1]; p[1]++)
            for (p[0] = 0; p[0] < dims[0]; p[0]++) sample_set(samples, type, n++, sample_value(type, p, missing));
    return samples;
}

/* The isovalue on both engines, on grids that live on. */
static void expect_same(tc_grid *grids[2], tc_mesh *meshes[2], double isovalue, int normals, const char *name) {
    tc_mesh_data data[2] = {{.struct_size = sizeof data[0]}, {.struct_size = sizeof data[0]}};
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = isovalue;
    how.normals = normals;
    for (int n = 0; n < 2; n++) {
        tc_status status = tc_extract(grids[n], &how, &meshes[n]);
        if (!status) status = tc_mesh_get(meshes[n], &data[n]);
        EXPECT(!status, "%s, isovalue %g: %s", name, isovalue, tc_message());
    }
    slab_count_most = data[0].slab_count > slab_count_most ? data[0].slab_count : slab_count_most;
    const char *difference = mesh_difference(&data[0], &data[1]);
    EXPECT(!difference, "%s, isovalue %g: %s", name, isovalue, difference);
}

static void test_isovalues(tc_type type, bool missing, uint32_t work_items, bool slabs) {
    static const double whole[] = {60, 71.5, 60, 1e9, 60.5, 40, 75, 71.5, 35.2, 90, 61};
    static const double real[] = {0, 0.0005, -0.01, 5000, 1e300, 0, 12000.5, -0.02, 15000, 1e-45};
    const int count = type >= TC_F32 ? (int)(sizeof real / sizeof *real) : (int)(sizeof whole / sizeof *whole);
    tc_context_options options;
    tc_expert_options expert;
    tc_grid_options grid;
    tc_grid *grids[2] = {NULL, NULL};
    tc_mesh *meshes[2] = {NULL, NULL};
    char name[120];
    snprintf(name, sizeof name, "%s%s, %u work-items%s", tc_type_name(type), missing ? " with missing" : "", work_items,
             slabs ? ", slabs" : "");
    if (!test_chosen(name)) return;
    options_init(&options, &expert);
    expert.always_copy = always_copy;
    expert.work_items = work_items;
    if (slabs) options.max_memory_bytes = (missing ? 240000 : 150000) + 300000 * tc_type_bytes(type);
    tc_context *contexts[2] = {context_open(&options), reference_open()};
    tc_grid_options_init(&grid);
    const int64_t dims[3] = {150, 21, 90};
    memcpy(grid.dims, dims, sizeof dims);
    grid.type = type;
    void *samples = samples_make(type, dims, missing && type >= TC_F32);
    grid.samples = samples;
    grid.has_nodata = missing;
    grid.nodata = type >= TC_F32 ? 0 : 80;
    for (int n = 0; n < 2; n++) EXPECT(!tc_grid_create(contexts[n], &grid, &grids[n]), "%s: %s", name, tc_message());
    for (int n = 0; n < count && grids[0] && grids[1]; n++)
        expect_same(grids, meshes, type >= TC_F32 ? real[n] : whole[n], missing, name);
    for (int n = 0; n < 2; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_grid_destroy(grids[n]);
        tc_context_destroy(contexts[n]);
    }
    free(samples);
}

/* Planes up to 63 are 10, then the values rise; the isovalues lie above. */
static void test_unread(void) {
    const int64_t dims[3] = {256, 64, 128};
    const size_t plane = 256 * 64, unread = 60 * plane;
    tc_context_options options;
    tc_expert_options expert;
    tc_grid_options grid_options;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_device_info info = {.struct_size = sizeof info};
    tc_extract_options how;
    options_init(&options, &expert);
    expert.always_copy = always_copy;
    tc_context *context = context_open(&options);
    uint8_t *samples = mmap(NULL, 128 * plane, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (samples == MAP_FAILED) exit(EXIT_FAILURE);
    for (size_t n = 0; n < 128 * plane; n++) samples[n] = (uint8_t)(n < 64 * plane ? 10 : n / plane + n % 7);
    tc_grid_options_init(&grid_options);
    memcpy(grid_options.dims, dims, sizeof dims);
    grid_options.type = TC_U8;
    grid_options.samples = samples;
    tc_extract_options_init(&how);
    how.isovalue = 90;
    EXPECT(!tc_grid_create(context, &grid_options, &grid), "%s", tc_message());
    EXPECT(!tc_context_device(context, &info), "%s", tc_message());
    EXPECT(!tc_extract(grid, &how, &mesh), "%s", tc_message());
    if (info.shares_host_memory && !always_copy) EXPECT(!mprotect(samples, unread, PROT_NONE), "mprotect fails");
    for (how.isovalue = 100; how.isovalue < 120; how.isovalue += 5)
        EXPECT(!tc_extract(grid, &how, &mesh), "%s", tc_message());
    mprotect(samples, unread, PROT_READ);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    munmap(samples, 128 * plane);
}

int main(int argc, char **argv) {
    always_copy = argc > 1 && !strcmp(argv[1], "always_copy");
    if (!device_exists()) return SKIPPED;
    random_state = 3;
    /* each type with missing samples and without; in the quick tier either of these in slabs */
    for (tc_type type = TC_U8; type <= TC_F64; type++)
        for (int n = 0; n < 4; n++)
            if (!tier_is_quick() || (n == 1 || n == 2) == ((int)type & 1)) test_isovalues(type, n & 1, 1, n & 2);
    if (test_chosen("unread")) test_unread();
    test_isovalues(TC_U8, false, 64, true);
    test_isovalues(TC_F32, true, 32, false);
    EXPECT(slab_count_most > 2 || !test_chosen("slabs"), "no more than %u slabs", slab_count_most);
    return EXPECT_DONE();
}
