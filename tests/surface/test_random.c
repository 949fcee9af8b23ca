/*
 * test_random.c - random grids: both engines against the grid, and against each other byte for byte
 *
 * Every sample type; sizes around words of 64 samples and the edges of bricks (64 x 8 x 4), and tiny ones; noise,
 * smooth fields, small integers with many ties, extremes of the type; NaN, infinities and missing values sprinkled;
 * sheared and mirrored matrices; odd and negative first indices.
 *
 * Usage: test_random [SEED [COUNT]]. A failure names the seed of its grid: `test_random SEED 1` repeats it.
 */
#include "engines.h"
#include "random.h"
#include "samples.h"

#include <inttypes.h>
#include <math.h>

enum { SAMPLES_MAX = 40000 };

static tc_context *contexts[2]; /* reference; device, NULL where there is none */
static tc_mesh *meshes[2];
static double memory[SAMPLES_MAX]; /* aligned for every type */

static int64_t pick_size(const int64_t *sizes) {
    unsigned count = 0;
    while (sizes[count]) count++;
    return sizes[random_below(count)];
}

static void sizes_choose(int64_t dims[3]) {
    static const int64_t xs[] = {2, 3, 4, 9, 15, 16, 17, 33, 63, 64, 65, 66, 100, 127, 128, 129, 130, 191, 192, 193, 0};
    static const int64_t ys[] = {2, 3, 5, 7, 8, 9, 10, 15, 16, 17, 18, 25, 0};
    static const int64_t zs[] = {2, 3, 4, 5, 6, 7, 8, 9, 12, 13, 17, 0};
    do {
        dims[0] = pick_size(xs);
        dims[1] = pick_size(ys);
        dims[2] = pick_size(zs);
    } while (dims[0] * dims[1] * dims[2] > SAMPLES_MAX);
}

static void matrix_choose(double matrix[3][4]) {
    unsigned kind = random_below(4);
    if (kind == 0) return;
    for (int r = 0; r < 3; r++) {
        matrix[r][r] = random_between(0.3, 3);
        if (kind > 1 && random_below(2)) matrix[r][r] = -matrix[r][r];
        for (int c = 0; c < 3; c++)
            if (c != r && kind == 3) matrix[r][c] = random_between(-0.1, 0.1);
        matrix[r][3] = random_between(-100, 100);
    }
}

/* ------------------------------------------------------------------------------------------------------- the field */

typedef enum field_kind { NOISE, SMOOTH, TIES, EXTREMES, FIELD_KINDS } field_kind;

static double clamp(tc_type type, double value) { return fmin(fmax(value, type_least(type)), type_most(type)); }

static double extreme_value(tc_type type) {
    if (!type_is_floating(type)) {
        double values[] = {type_least(type), type_most(type), type_least(type) + 1, type_most(type) - 1, 1};
        return values[random_below(5)];
    }
    double least = type == TC_F32 ? 0x1p-149 : 0x1p-1074;
    double values[] = {type_most(type), -type_most(type), least, -least, 0.0, -0.0, 3 * least, type_most(type) / 2, 1};
    return values[random_below(9)];
}

static double field_value(field_kind kind, tc_type type, const double wave[4], const int64_t p[3]) {
    double centre = type_is_floating(type) ? 0 : (type_least(type) + type_most(type)) / 2;
    switch (kind) {
    case NOISE:
        return clamp(type, centre + random_between(-100, 100));
    case SMOOTH:
        return clamp(type, centre + 60 * (sin(wave[0] * (double)p[0] + wave[3]) +
                                          sin(wave[1] * (double)p[1]) * cos(wave[2] * (double)p[2])));
    case TIES:
        return clamp(type, floor(centre) + random_below(4));
    default:
        return extreme_value(type);
    }
}

/* An isovalue among the samples, just as often equal to one. */
static double isovalue_choose(field_kind kind, tc_type type, int64_t count) {
    double a = sample_get(memory, type, random_below((uint32_t)count));
    double b = sample_get(memory, type, random_below((uint32_t)count));
    switch (kind == EXTREMES ? random_below(2) : random_below(4)) {
    case 0:
        return a;
    case 1:
        return 0.5 * a + 0.5 * b;
    case 2:
        return a + random_between(-1.5, 1.5);
    default:
        return floor(b) + 0.5;
    }
}

/* Takes samples away: not finite, where the type can be, or equal to a value that is named missing. */
static void samples_remove(tc_grid_options *grid, int64_t count) {
    static const double not_finite[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    uint32_t kind = random_below(4), rarity = 1u << random_below(9);
    if (kind == 1) {
        grid->has_nodata = 1;
        grid->nodata = random_below(8) ? sample_get(memory, grid->type, random_below((uint32_t)count)) : 0.5;
    }
    if (!type_is_floating(grid->type) || kind == 2) return;
    for (int64_t n = 0; n < count && kind == 3; n++)
        if (random_below(rarity + 2) == 0) sample_set(memory, grid->type, n, not_finite[random_below(3)]);
}

static void grid_choose(tc_grid_options *grid, tc_extract_options *how) {
    double wave[4];
    tc_grid_options_init(grid);
    tc_extract_options_init(how);
    sizes_choose(grid->dims);
    matrix_choose(grid->matrix);
    grid->type = (tc_type)random_below(8);
    grid->samples = memory;
    for (int axis = 0; axis < 3; axis++)
        if (random_below(3) == 0) grid->first_index[axis] = (int64_t)random_below(2001) - 1000;
    field_kind kind = (field_kind)random_below(FIELD_KINDS);
    for (int n = 0; n < 4; n++) wave[n] = random_between(0.02, 0.9);
    int64_t count = 0;
    for (int64_t z = 0; z < grid->dims[2]; z++)
        for (int64_t y = 0; y < grid->dims[1]; y++)
            for (int64_t x = 0; x < grid->dims[0]; x++)
                sample_set(memory, grid->type, count++, field_value(kind, grid->type, wave, (int64_t[3]){x, y, z}));
    how->isovalue = isovalue_choose(kind, grid->type, count);
    samples_remove(grid, count);
    /* combinations of type, missing samples and normals that are built anyway */
    bool missing = grid->has_nodata || type_is_floating(grid->type);
    how->normals =
        missing ? random_below(2) || !type_is_floating(grid->type) : random_below(3) == 0 && grid->type == TC_U8;
}

/* ------------------------------------------------------------------------------------------------------------ runs */

static void run(uint64_t seed) {
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh_data data[2];
    random_state = seed * 0x2545f4914f6cdd1du;
    grid_choose(&grid, &how);
    char name[200];
    snprintf(name, sizeof name, "seed %" PRIu64 ": %lldx%lldx%lld %s, isovalue %.17g, nodata %d %g, normals %d", seed,
             (long long)grid.dims[0], (long long)grid.dims[1], (long long)grid.dims[2], tc_type_name(grid.type),
             how.isovalue, grid.has_nodata, grid.nodata, how.normals);
    if (!test_chosen(name)) return;
    for (int n = 0; n < 2 && contexts[n]; n++)
        if (!extract(contexts[n], &grid, &how, &meshes[n], &data[n])) {
            printf("%s\n", name);
            return;
        }
    const char *fault = mesh_fault(&grid, how.isovalue, &data[0]);
    EXPECT(!fault, "%s: reference: %s", name, fault);
    if (!contexts[1]) return;
    const char *difference = mesh_difference(&data[0], &data[1]);
    EXPECT(!difference, "%s: device and reference: %s", name, difference);
    fault = difference ? mesh_fault(&grid, how.isovalue, &data[1]) : NULL;
    EXPECT(!fault, "%s: device: %s", name, fault);
}

int main(int argc, char **argv) {
    uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 0) : 1996;
    uint64_t count = argc > 2 ? strtoull(argv[2], NULL, 0) : 250;
    tc_context_options options;
    tc_context_options_init(&options);
    contexts[0] = reference_open();
    if (device_exists()) contexts[1] = context_open(&options);
    bool skipped = !contexts[1];
    for (uint64_t n = 0; n < count; n++) run(seed + n);
    for (int n = 0; n < 2; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_context_destroy(contexts[n]);
    }
    int failed = EXPECT_DONE();
    return failed || !skipped ? failed : SKIPPED;
}
