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
#include "engines.h"
#include "random.h"
#include "random_field.h"
#include "samples.h"

#include <inttypes.h>
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
static struct tally { uint64_t volumes, missing, slabs, bounded; } tally;

enum { REFERENCE, DEVICE, COPYING, CONTEXTS };

typedef struct engine {
    tc_context *context;
    tc_grid *grid;
    tc_interval *interval;
    tc_interval_data data;
} engine;

static engine engines[CONTEXTS];

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
    tally.missing += g->type == TC_F32;
}

static void range_choose(tc_interval_options *o) {
    static const double far[] = {-5, -1e30, -1e300, 300, 1e30, 1e300};
    tc_interval_options_init(o);
    const uint32_t kind = random_below(8);
    if (kind) o->low = kind == 1 ? far[random_below(3)] : 58 + 0.5 * (double)random_below(8);
    if (kind != 2) o->high = kind == 3 ? far[3 + random_below(3)] : 60 + 0.5 * (double)(1 + random_below(8));
    if (!(o->low < o->high)) o->high = o->low + 0.5;
}

/* --------------------------------------------------------------------------------------------------------- volumes */

static bool interval_make(engine *e, const tc_interval_options *how, const char *name) {
    e->data = (tc_interval_data){.struct_size = sizeof e->data};
    tc_status status = tc_extract_interval(e->grid, how, &e->interval);
    if (!status) status = tc_interval_get(e->interval, &e->data);
    EXPECT(!status, "%s: %s", name, tc_message());
    return !status;
}

static void expect_count(engine *e, const tc_interval_options *how, const tc_interval_data *d, const char *name) {
    tc_interval_counts c = {.struct_size = sizeof c};
    EXPECT(!tc_count_interval(e->grid, how, &c), "%s: %s", name, tc_message());
    EXPECT(c.sample_count == d->sample_count && c.low_count == d->low_count && c.high_count == d->high_count &&
               c.tetrahedron_count == d->tetrahedron_count,
           "%s: counted %" PRIu64 " + %" PRIu64 " + %" PRIu64 " vertices, %" PRIu64 " tetrahedra", name, c.sample_count,
           c.low_count, c.high_count, c.tetrahedron_count);
}

static void expect_same(const tc_interval_data *a, const tc_interval_data *b, const char *name, const char *how) {
    EXPECT(a->sample_count == b->sample_count && a->low_count == b->low_count && a->high_count == b->high_count &&
               a->tetrahedron_count == b->tetrahedron_count,
           "%s, %s: sizes differ", name, how);
    if (a->vertex_count != b->vertex_count || a->tetrahedron_count != b->tetrahedron_count) return;
    for (uint64_t n = 0; n < 3 * a->vertex_count; n++)
        if (memcmp(&a->positions[n], &b->positions[n], sizeof(float))) {
            EXPECT(false, "%s, %s: vertex %" PRIu64 " of %" PRIu64 " differs", name, how, n / 3, a->vertex_count);
            break;
        }
    for (uint64_t n = 0; n < 4 * a->tetrahedron_count; n++)
        if (a->tetrahedra[n] != b->tetrahedra[n]) {
            EXPECT(false, "%s, %s: tetrahedron %" PRIu64 " of %" PRIu64 " differs", name, how, n / 4,
                   a->tetrahedron_count);
            break;
        }
}

static void grids_open(const tc_grid_options *g, const char *name) {
    for (int n = 0; n < CONTEXTS; n++)
        EXPECT(!tc_grid_create(engines[n].context, g, &engines[n].grid), "%s: %s", name, tc_message());
}

static void grids_close(void) {
    for (int n = 0; n < CONTEXTS; n++) {
        tc_grid_destroy(engines[n].grid);
        engines[n].grid = NULL;
    }
}

/* With hardly enough memory: the same bytes, by buffers that fit. What a refusal advises is enough, at the latest. */
static void expect_bounded(const tc_context_options *usual, const tc_grid_options *g, const tc_interval_options *how,
                           const tc_interval_data *expected, const char *name) {
    tc_context_options options = *usual;
    uint64_t budget = 40000;
    for (int attempt = 0; attempt < 20; attempt++) {
        engine e = {0};
        options.max_memory_bytes = budget;
        e.context = context_open(&options);
        tc_status status = tc_grid_create(e.context, g, &e.grid);
        if (!status) status = tc_extract_interval(e.grid, how, &e.interval);
        if (!status) {
            e.data.struct_size = sizeof e.data;
            tc_interval_get(e.interval, &e.data);
            expect_same(expected, &e.data, name, "bounded");
            expect_within(e.context, budget, name);
            tally.slabs += e.data.slab_count > 1, tally.bounded++;
        } else {
            EXPECT(status == TC_ERROR_MEMORY, "%s, %" PRIu64 " bytes: %s", name, budget, tc_message());
            const uint64_t advised = bytes_advised(name);
            EXPECT(advised > budget, "%s: %" PRIu64 " bytes are too few, and %" PRIu64 " are advised", name, budget,
                   advised);
            budget += budget / 3 < advised - budget ? budget / 3 : advised - budget;
        }
        tc_interval_destroy(e.interval);
        tc_grid_destroy(e.grid);
        tc_context_destroy(e.context);
        if (!status) return;
    }
    EXPECT(false, "%s: no budget is enough", name);
}

static void run(uint64_t seed, const tc_context_options *copying) {
    tc_grid_options g;
    tc_interval_options how;
    char name[200];
    random_state = seed * 0x2545f4914f6cdd1du;
    grid_choose(&g);
    snprintf(name, sizeof name, "%s", tc_type_name(g.type));
    if (!test_chosen(name)) return;
    grids_open(&g, name);
    for (int n = 0; n < RANGES; n++) {
        range_choose(&how);
        snprintf(name, sizeof name, "seed %" PRIu64 ": %lldx%lldx%lld %s, %g to %g", seed, (long long)g.dims[0],
                 (long long)g.dims[1], (long long)g.dims[2], tc_type_name(g.type), how.low, how.high);
        const tc_interval_data *expected = &engines[REFERENCE].data;
        if (!interval_make(&engines[REFERENCE], &how, name)) continue;
        if (random_below(2)) expect_count(&engines[DEVICE], &how, expected, name);
        for (int m = DEVICE; m < CONTEXTS; m++)
            if (interval_make(&engines[m], &how, name))
                expect_same(expected, &engines[m].data, name, m == COPYING ? "copied" : "in place");
        tally.volumes++;
        if (n == 0 && seed % 4 == 0) expect_bounded(copying, &g, &how, expected, name);
    }
    grids_close();
}

/* Many layers, so that they go in slabs; nearly no samples missing, or none. */
static void test_slabs(const tc_context_options *copying) {
    tc_grid_options g;
    tc_interval_options how;
    for (int kind = 0; kind < 2; kind++) {
        const char *name = kind ? "layers of f32, some missing" : "layers of u8";
        random_state = 5 + (uint64_t)kind;
        tc_grid_options_init(&g);
        tc_interval_options_init(&how);
        g.dims[0] = 64, g.dims[1] = 40, g.dims[2] = 360;
        g.samples = memory;
        g.type = kind ? TC_F32 : TC_U8;
        how.low = 55, how.high = 75;
        samples_choose(&g, SMOOTH);
        for (int64_t n = 0; n < SAMPLES_MAX && !kind; n++) /* bricks that have nothing, between others */
            if (n / 64 % 40 >= 20 && n / 64 % 40 < 35) ((uint8_t *)memory)[n] = 20;
        if (kind) g.points = points, ((float *)memory)[64 * 40 * 300 + 1000] = NAN;
        grids_open(&g, name);
        if (interval_make(&engines[REFERENCE], &how, name))
            expect_bounded(copying, &g, &how, &engines[REFERENCE].data, name);
        grids_close();
    }
}

int main(int argc, char **argv) {
    const bool groups = argc > 1 && !strcmp(argv[1], "groups");
    const uint64_t first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const uint64_t count = argc > 3 ? strtoull(argv[3], NULL, 10) : groups ? 16 : 60;
    tc_context_options options;
    tc_expert_options expert;
    if (!device_exists()) return SKIPPED;
    options_init(&options, &expert);
    engines[REFERENCE].context = reference_open();
    expert.work_items = groups ? 64 : 1;
    expert.tile_bricks = 3;
    engines[DEVICE].context = context_open(&options);
    expert.spin_limit = 1;
    expert.always_copy = 1;
    engines[COPYING].context = context_open(&options);
    for (uint64_t n = 0; n < count; n++) run(first + n, &options);
    if (argc < 3 && test_chosen("slabs")) test_slabs(&options);
    for (int n = 0; n < CONTEXTS; n++) {
        tc_interval_destroy(engines[n].interval);
        tc_context_destroy(engines[n].context);
    }
    printf("%" PRIu64 " volumes, %" PRIu64 " grids with parts missing, %" PRIu64 " bounded, %" PRIu64
           " of them in slabs\n",
           tally.volumes, tally.missing, tally.bounded, tally.slabs);
    if (argc < 3 && !getenv("TEST_ONLY"))
        EXPECT(tally.missing && tally.slabs, "no grid with parts missing, or none in slabs");
    return EXPECT_DONE();
}
