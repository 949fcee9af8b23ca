/*
 * test_interval_device.c - interval volumes by the kernels are those of the reference, byte for byte
 *
 * Random grids of sizes around words, bricks and tiles: noise, smooth fields, ties, samples all within and none;
 * samples and cells missing here and there; uniform, rectilinear and curvilinear, mirrored, from odd indices on. Of
 * each grid several ranges, so that later ones go by the ranges of bricks: counted and extracted; in place; copied,
 * with every sum of the scan made again; in slabs and steps, as little memory as goes. test_interval looks at what the
 * reference makes.
 *
 * Usage: test_interval_device [alone|groups [SEED [COUNT]]]: a failure names the seed of its grid,
 * `test_interval_device groups SEED 1` repeats it.
 */
#include "interval_engines.h"
#include "random.h"
#include "random_field.h"
#include "samples.h"

#include <math.h>

enum {
    SAMPLES_MAX = 64 * 40 * 360,
    RANGES = 3,
    ALL_WITHIN = RANDOM_FIELDS,
    FEW_WITHIN,
    ALL_WITHIN_BUT,
    BRICKS_WITHIN,
    FIELDS
};

static double memory[SAMPLES_MAX]; /* aligned for every type */
static float points[3 * SAMPLES_MAX], axes[3][400];
static uint8_t blanked[SAMPLES_MAX];
static uint64_t missing_count;

/* ----------------------------------------------------------------------------------------------------------- grids */

static void sizes_choose(int64_t dims[3]) {
    static const int64_t xs[] = {2, 3, 63, 64, 65, 66, 67, 127, 128, 129, 130, 131};
    static const int64_t ys[] = {2, 3, 7, 8, 9, 10, 16, 17}, zs[] = {2, 3, 4, 5, 6, 8, 9, 13, 24};
    dims[0] = xs[random_below(12)], dims[1] = ys[random_below(8)], dims[2] = zs[random_below(9)];
    if (random_below(3) == 0)
        for (int axis = 0; axis < 3; axis++) dims[axis] = 2 + random_below(7);
}

static double value_choose(int field, const double wave[4], double x, double y, double z) {
    if (field == ALL_WITHIN) return 60 + random_below(2);
    if (field == FEW_WITHIN) return random_below(50) ? 20 : 60;
    if (field == ALL_WITHIN_BUT) return random_below(50) ? 60 : random_below(2) ? 20 : 90;
    if (field == BRICKS_WITHIN) return y < 8 ? 63 : random_below(2) ? 20 : 90;
    return field_value(field, wave, x, y, z);
}

static void samples_choose(tc_grid_options *g, int field) {
    double wave[4];
    int64_t n = 0;
    wave_choose(wave);
    for (int axis = 0; axis < 3; axis++)
        for (int64_t m = 0; m < g->dims[axis]; m++)
            axes[axis][m] = (axis == 2 ? -1 : 1) * ((float)m + (float)random_between(-0.3, 0.3));
    for (int64_t z = 0; z < g->dims[2]; z++)
        for (int64_t y = 0; y < g->dims[1]; y++)
            for (int64_t x = 0; x < g->dims[0]; x++, n++) {
                sample_set(memory, g->type, n, value_choose(field, wave, 0.2 * (double)x, (double)y, (double)z));
                points[3 * n] = (float)x + (float)random_between(-0.2, 0.2);
                points[3 * n + 1] = -(float)y + (float)random_between(-0.2, 0.2);
                points[3 * n + 2] = (float)z + (float)random_between(-0.2, 0.2);
            }
}

static void parts_remove(tc_grid_options *g) {
    const uint32_t how = random_below(4), rarity = 2 + random_below(200);
    const int64_t count = g->dims[0] * g->dims[1] * g->dims[2];
    for (int64_t n = 0; n < count; n++) blanked[n] = random_below(rarity) == 0;
    if (how == 0) g->blanked_samples = blanked;
    if (how == 1) g->blanked_cells = blanked;
    if (how == 2) g->has_nodata = 1, g->nodata = 60;
    for (int64_t n = 0; n < count && how == 3; n++)
        if (blanked[n]) sample_set(memory, g->type, n, (double)NAN);
}

/* Few kinds of kernels, as each takes PoCL seconds to build: bytes, floats at points with parts missing, and doubles at
 * axes. */
static void grid_choose(tc_grid_options *g) {
    const uint32_t kind = random_below(8);
    tc_grid_options_init(g);
    sizes_choose(g->dims);
    g->samples = memory;
    g->type = kind < 4 ? TC_U8 : kind < 7 ? TC_F32 : TC_F64;
    for (int axis = 0; axis < 3; axis++) g->first_index[axis] = (int64_t)random_below(21) - 10;
    if (random_below(2)) g->matrix[0][0] = -0.75, g->matrix[1][2] = 0.5;
    samples_choose(g, (int)random_below(FIELDS));
    if (g->type == TC_F32) g->points = points;
    for (int axis = 0; axis < 3 && g->type == TC_F64; axis++) g->axes[axis] = axes[axis];
    if (g->type == TC_F32) parts_remove(g);
    missing_count += g->type == TC_F32;
}

/* --------------------------------------------------------------------------------------------------------- volumes */

static tc_status grid_make(tc_context *context, const void *options, tc_grid **grid) {
    return tc_grid_create(context, options, grid);
}

static void run(uint64_t seed, const tc_context_options *copying) {
    tc_grid_options g;
    tc_interval_volume_options how;
    char name[200];
    random_state = seed * 0x2545f4914f6cdd1du;
    grid_choose(&g);
    snprintf(name, sizeof name, "%s", tc_type_name(g.type));
    if (!test_chosen(name)) return;
    grids_open(grid_make, &g, name);
    for (int n = 0; n < RANGES; n++) {
        range_choose(&how);
        snprintf(name, sizeof name, "seed %" PRIu64 ": %lldx%lldx%lld %s, %g to %g", seed, (long long)g.dims[0],
                 (long long)g.dims[1], (long long)g.dims[2], tc_type_name(g.type), how.low, how.high);
        const tc_interval_volume_data *expected = &engines[REFERENCE].data;
        if (!interval_make(&engines[REFERENCE], &how, name)) continue;
        expect_engines(&how, random_below(2), name);
        if (n == 0 && seed % 4 == 0) expect_bounded(copying, grid_make, &g, &how, expected, name);
    }
    grids_close();
}

/* Many layers, so that they go in slabs; nearly no samples missing, or none. */
static void test_slabs(const tc_context_options *copying) {
    tc_grid_options g;
    tc_interval_volume_options how;
    for (int kind = 0; kind < 2; kind++) {
        const char *name = kind ? "layers of f32, some missing" : "layers of u8";
        random_state = 5 + (uint64_t)kind;
        tc_grid_options_init(&g);
        tc_interval_volume_options_init(&how);
        g.dims[0] = 64, g.dims[1] = 40, g.dims[2] = 360;
        g.samples = memory;
        g.type = kind ? TC_F32 : TC_U8;
        how.low = 55, how.high = 75;
        samples_choose(&g, SMOOTH);
        for (int64_t n = 0; n < SAMPLES_MAX && !kind; n++) /* bricks that have nothing, between others */
            if (n / 64 % 40 >= 20 && n / 64 % 40 < 35) ((uint8_t *)memory)[n] = 20;
        if (kind) g.points = points, ((float *)memory)[64 * 40 * 300 + 1000] = NAN;
        grids_open(grid_make, &g, name);
        if (interval_make(&engines[REFERENCE], &how, name))
            expect_bounded(copying, grid_make, &g, &how, &engines[REFERENCE].data, name);
        grids_close();
    }
}

int main(int argc, char **argv) {
    const bool groups = argc > 1 && !strcmp(argv[1], "groups");
    const uint64_t first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const uint64_t count = argc > 3 ? strtoull(argv[3], NULL, 10) : groups ? 16 : tier_count(60);
    tc_context_options options;
    tc_expert_options expert;
    if (!device_exists()) return SKIPPED;
    engines_open(groups, &options, &expert);
    for (uint64_t n = 0; n < count; n++) run(first + n, &options);
    if (argc < 3 && test_chosen("slabs")) test_slabs(&options);
    engines_close();
    printf("%" PRIu64 " volumes, %" PRIu64 " grids with parts missing, %" PRIu64 " bounded, %" PRIu64
           " of them in slabs\n",
           engine_tally.volumes, missing_count, engine_tally.bounded, engine_tally.slabs);
    if (argc < 3 && !getenv("TEST_ONLY"))
        EXPECT(missing_count && engine_tally.slabs, "no grid with parts missing, or none in slabs");
    return EXPECT_DONE();
}
