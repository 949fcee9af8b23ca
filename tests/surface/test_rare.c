/*
 * test_rare.c - fields that random ones hardly ever are, on both engines: each mesh whole against its grid
 * (mesh_walk.h), and the device's against the reference's, byte for byte
 *
 * Samples that alternate along one axis, two or all three: whole rows of crossed edges, the most that a row of 64 may
 * have of each type. One sample on the other side than all others, at every place around the point where eight bricks
 * of 64 x 8 x 4 samples meet, at two isovalues one after the other: bricks that have nothing to emit but for a far
 * neighbour. Slopes along ten bricks, at several isovalues: runs of eight bricks whose range is looked at as a whole.
 * Zeros of both signs, where zero stands for missing. One sample that is not finite.
 */
#include "engines.h"

#include <math.h>

enum { LOW = 50, HIGH = 200, SAMPLES_MAX = 140 * 20 * 12 };

enum { CONTEXTS = 3 };

/* Reference; device, and the same with all bricks in one tile: NULL where there is none. */
static tc_context *contexts[CONTEXTS];
static float memory[SAMPLES_MAX];

/* The isovalues one after the other, on a grid of each engine that lives on. */
static void expect_same(const tc_grid_options *options, const double *isovalues, int count, const char *name) {
    tc_grid *grids[CONTEXTS] = {NULL};
    tc_mesh *meshes[CONTEXTS] = {NULL};
    if (!test_chosen(name)) return;
    for (int n = 0; n < CONTEXTS && contexts[n]; n++)
        EXPECT(!tc_grid_create(contexts[n], options, &grids[n]), "%s: %s", name, tc_message());
    for (int i = 0; i < count; i++) {
        tc_mesh_data data[CONTEXTS];
        tc_extract_options how;
        tc_extract_options_init(&how);
        how.isovalue = isovalues[i];
        for (int n = 0; n < CONTEXTS && grids[n]; n++) {
            data[n] = (tc_mesh_data){.struct_size = sizeof data[n]};
            tc_status status = tc_extract(grids[n], &how, &meshes[n]);
            if (!status) status = tc_mesh_get(meshes[n], &data[n]);
            EXPECT(!status, "%s, isovalue %g: %s", name, how.isovalue, tc_message());
        }
        const char *fault = mesh_fault(options, how.isovalue, &data[0]);
        EXPECT(!fault, "%s, isovalue %g: reference: %s", name, how.isovalue, fault);
        for (int n = 1; n < CONTEXTS && grids[n]; n++) {
            const char *difference = mesh_difference(&data[0], &data[n]);
            EXPECT(!difference, "%s, isovalue %g: device %d and reference: %s", name, how.isovalue, n, difference);
        }
    }
    for (int n = 0; n < CONTEXTS; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_grid_destroy(grids[n]);
    }
}

/* Bytes of a grid of u8; value is called with x, y, z. */
static void bytes_fill(tc_grid_options *grid, const int64_t dims[3], int (*value)(const int64_t p[3])) {
    uint8_t *bytes = (uint8_t *)memory;
    int64_t p[3];
    tc_grid_options_init(grid);
    memcpy(grid->dims, dims, sizeof grid->dims);
    grid->samples = memory;
    for (p[2] = 0; p[2] < dims[2]; p[2]++)
        for (p[1] = 0; p[1] < dims[1]; p[1]++)
            for (p[0] = 0; p[0] < dims[0]; p[0]++) *bytes++ = (uint8_t)value(p);
}

/* ------------------------------------------------------------------------------------------------------ alternating */

static int alternating_axes;

static int alternating(const int64_t p[3]) {
    int64_t sum = 0;
    for (int axis = 0; axis < 3; axis++) sum += alternating_axes >> axis & 1 ? p[axis] : 0;
    return sum & 1 ? HIGH : LOW;
}

static void test_alternating(void) {
    static const double isovalues[] = {127.5, HIGH};
    tc_grid_options grid;
    for (alternating_axes = 1; alternating_axes < 8; alternating_axes++)
        for (int parity = 0; parity < 2; parity++) {
            char name[80];
            snprintf(name, sizeof name, "alternating along axes %d, parity %d", alternating_axes, parity);
            bytes_fill(&grid, (int64_t[3]){131, 10, 6}, alternating);
            grid.first_index[1] = parity;
            expect_same(&grid, isovalues, 2, name);
        }
}

/* ------------------------------------------------------------------------------------------------------- one sample */

static int64_t single_place[3];
static int single_value;

static int single(const int64_t p[3]) {
    return memcmp(p, single_place, sizeof single_place) ? LOW + HIGH - single_value : single_value;
}

static void test_single_samples(void) {
    static const double isovalues[] = {100, 150, 100.5};
    tc_grid_options grid;
    for (int n = 0; n < 32; n++) {
        const int64_t corner = n < 16 ? 64 : 512; /* of a brick; of a run of eight */
        char name[80];
        for (int axis = 0; axis < 3; axis++) single_place[axis] = (axis ? 16 >> axis : corner) - 1 + (n >> axis & 1);
        single_value = n & 8 ? LOW : HIGH;
        snprintf(name, sizeof name, "one sample %s at %d, %d, %d", n & 8 ? "outside" : "inside", (int)single_place[0],
                 (int)single_place[1], (int)single_place[2]);
        bytes_fill(&grid, (int64_t[3]){corner + 66, 17, 9}, single);
        expect_same(&grid, isovalues, 3, name);
    }
}

/* ----------------------------------------------------------------------------------------------------------- slopes */

static int slope_kind;

/* Rising, falling, highest or lowest in the middle. */
static int slope(const int64_t p[3]) {
    const int64_t x = slope_kind & 1 ? 579 - p[0] : p[0], height = slope_kind < 2 ? x / 3 : (x < 290 ? x : 579 - x) / 2;
    return (int)(10 + (slope_kind < 3 ? height : 145 - height) + (p[1] + p[2]) % 3);
}

static void test_slopes(void) {
    static const double isovalues[] = {100.5, 30.5, 150, 60.5, 11};
    tc_grid_options grid;
    for (slope_kind = 0; slope_kind < 4; slope_kind++) {
        char name[80];
        snprintf(name, sizeof name, "slope %d along ten bricks", slope_kind);
        bytes_fill(&grid, (int64_t[3]){580, 9, 6}, slope);
        expect_same(&grid, isovalues, 5, name);
    }
}

/* ------------------------------------------------------------------------------------------------------------ zeros */

static void test_zeros_missing(void) {
    static const float values[] = {1, -1, 0, 2, -0.0f, -2, 3, 0.5f, -0.25f};
    static const double isovalues[] = {0.25, 1};
    tc_grid_options grid;
    tc_grid_options_init(&grid);
    grid.dims[0] = 67, grid.dims[1] = 9, grid.dims[2] = 6;
    for (int n = 0; n < 67 * 9 * 6; n++) memory[n] = n % 13 ? values[n * 7 % 4 ? 0 : 3] : values[n / 13 % 9];
    grid.type = TC_F32;
    grid.samples = memory;
    grid.has_nodata = 1;
    expect_same(&grid, isovalues, 2, "zeros missing");
    grid.nodata = -0.0;
    expect_same(&grid, isovalues, 2, "minus zeros missing");
}

/* ------------------------------------------------------------------------------------------------------- not finite */

/* One sample, of each kind alone, among others that would leave its brick uniform and its neighbours not. */
static void test_one_not_finite(void) {
    static const float odd[] = {NAN, INFINITY, -INFINITY};
    static const double isovalues[] = {50.5, 3};
    for (int n = 0; n < 6; n++) {
        char name[80];
        tc_grid_options grid;
        tc_grid_options_init(&grid);
        grid.dims[0] = 131, grid.dims[1] = 10, grid.dims[2] = 6;
        grid.type = TC_F32;
        grid.samples = memory;
        for (int at = 0; at < 131 * 10 * 6; at++) memory[at] = n < 3 ? (float)(at % 131) : (float)(131 - at % 131);
        memory[131 * (10 * 3 + 4) + 70] = odd[n % 3];
        snprintf(name, sizeof name, "not finite: %g, %s", (double)odd[n % 3], n < 3 ? "rising" : "falling");
        expect_same(&grid, isovalues, 2, name);
    }
}

int main(void) {
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    contexts[0] = reference_open();
    if (device_exists()) {
        contexts[1] = context_open(&options);
        expert.tile_bricks = 1000;
        contexts[2] = context_open(&options);
    }
    bool skipped = !contexts[1];
    test_alternating();
    test_single_samples();
    test_slopes();
    test_zeros_missing();
    test_one_not_finite();
    for (int n = 0; n < CONTEXTS; n++) tc_context_destroy(contexts[n]);
    int failed = EXPECT_DONE();
    return failed || !skipped ? failed : SKIPPED;
}
