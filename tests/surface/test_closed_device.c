/*
 * test_closed_device.c - closed surfaces by the kernels are those of the reference, byte for byte
 *
 * Random grids of all methods, of sizes around words, bricks and tiles: noise, smooth fields, ties, samples all inside
 * and all outside but for some; samples and cells missing here and there, in boxes, or all but some; uniform and
 * curvilinear, mirrored, from odd indices on. Of each grid several surfaces, so that later ones go by the ranges of
 * bricks, one of them with all samples inside; counted, extracted, by the fallback of the scan too, with a field
 * carried to its vertices. test_closed looks at what the reference makes, test_device at slabs, divisions and shapes of
 * work.
 *
 * Usage: test_closed_device [alone|groups [SEED [COUNT]]]: a failure names the seed of its grid, `test_closed_device
 * groups SEED 1` repeats it.
 */
#include "engines.h"
#include "random.h"
#include "random_field.h"
#include "samples.h"

#include <inttypes.h>
#include <math.h>

enum { SAMPLES_MAX = 80000, SURFACES = 4, ALL_INSIDE = RANDOM_FIELDS, FEW_INSIDE, ALL_OUTSIDE_BUT, FIELDS };

static double memory[SAMPLES_MAX]; /* aligned for every type */
static float points[3 * SAMPLES_MAX];
static uint8_t blanked[SAMPLES_MAX];

/* What was met, so that no kind is left out by chance. */
static struct tally { uint64_t surfaces, missing, border_alone; } tally;

/* The contexts that surfaces are made in: the reference's, the device's, and one with everything copied and every sum
 * of the scan made again. */
enum { REFERENCE, DEVICE, COPYING, CONTEXTS };

typedef struct engine {
    tc_context *context;
    tc_grid *grid;
    tc_mesh *mesh;
    tc_mesh_data data;
} engine;

static engine engines[CONTEXTS];

/* --------------------------------------------------------------------------------------------------------- grids */

static void sizes_choose(int64_t dims[3]) {
    static const int64_t xs[] = {2, 3, 63, 64, 65, 66, 67, 127, 128, 129, 130, 131};
    static const int64_t ys[] = {2, 3, 7, 8, 9, 10, 16, 17, 18}, zs[] = {2, 3, 4, 5, 6, 8, 9, 13, 24};
    dims[0] = xs[random_below(12)], dims[1] = ys[random_below(9)], dims[2] = zs[random_below(9)];
    if (random_below(3) == 0)
        for (int axis = 0; axis < 3; axis++) dims[axis] = 2 + random_below(7);
}

static double value_choose(int field, const double wave[4], double x, double y, double z) {
    if (field == ALL_INSIDE) return 90 + random_below(20);
    if (field == FEW_INSIDE) return random_below(50) ? 20 : 90;
    if (field == ALL_OUTSIDE_BUT) return random_below(50) ? 90 : 20;
    return field_value(field, wave, x, y, z);
}

static void samples_choose(const tc_grid_options *grid, int field) {
    double wave[4];
    int64_t n = 0;
    wave_choose(wave);
    for (int64_t z = 0; z < grid->dims[2]; z++)
        for (int64_t y = 0; y < grid->dims[1]; y++)
            for (int64_t x = 0; x < grid->dims[0]; x++, n++) {
                sample_set(memory, grid->type, n, value_choose(field, wave, 0.2 * (double)x, (double)y, (double)z));
                points[3 * n] = (float)x + (float)random_between(-0.2, 0.2);
                points[3 * n + 1] = -(float)y + (float)random_between(-0.2, 0.2);
                points[3 * n + 2] = (float)z + (float)random_between(-0.2, 0.2);
            }
}

/* Here and there; in a box; everywhere but in a box. */
static bool is_gone(const int64_t p[3], const int64_t low[3], const int64_t high[3], uint32_t kind, uint32_t rarity) {
    bool within = true;
    for (int axis = 0; axis < 3; axis++) within = within && p[axis] >= low[axis] && p[axis] <= high[axis];
    return kind == 0 ? random_below(rarity) == 0 : kind == 1 ? within : !within;
}

/* Blanks samples or cells, or takes samples out by a value. */
static void parts_remove(tc_grid_options *grid) {
    const uint32_t kind = random_below(3), rarity = 2 + random_below(200), how = random_below(4);
    int64_t low[3], high[3], n = 0, p[3];
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = random_below((uint32_t)grid->dims[axis]);
        high[axis] = low[axis] + random_below((uint32_t)(grid->dims[axis] - low[axis]));
    }
    const bool cells = how == 1;
    for (p[2] = 0; p[2] < grid->dims[2] - cells; p[2]++)
        for (p[1] = 0; p[1] < grid->dims[1] - cells; p[1]++)
            for (p[0] = 0; p[0] < grid->dims[0] - cells; p[0]++, n++) {
                blanked[n] = is_gone(p, low, high, kind, rarity);
                if (how == 2 && blanked[n]) sample_set(memory, grid->type, n, 99);
                if (how == 3 && blanked[n]) sample_set(memory, grid->type, n, (double)NAN);
            }
    if (how == 0) grid->blanked_samples = blanked;
    if (how == 1) grid->blanked_cells = blanked;
    grid->has_nodata = how == 2, grid->nodata = 99;
}

/* Few kinds of kernels, as each takes PoCL seconds to build: bytes, and floats with all that there is. Wide samples
 * where kernels are built fast. */
static void grid_choose(tc_grid_options *grid, tc_extract_options *how, bool wide) {
    tc_grid_options_init(grid);
    tc_extract_options_init(how);
    sizes_choose(grid->dims);
    const bool plain = random_below(2), turned = random_below(2);
    grid->type = plain ? TC_U8 : TC_F32;
    grid->samples = memory;
    how->method = wide ? TC_METHOD_TETRA : (tc_method)random_below(3);
    how->closed = 1;
    how->normals = !plain;
    if (wide) grid->type = TC_F64, how->normals = 0;
    for (int axis = 0; axis < 3; axis++) grid->first_index[axis] = (int64_t)random_below(21) - 10;
    if (turned) grid->matrix[0][0] = -0.75, grid->matrix[1][2] = 0.5;
    samples_choose(grid, (int)random_below(FIELDS));
    if (plain && !wide) return;
    if (!wide) grid->points = points;
    parts_remove(grid);
}

/* -------------------------------------------------------------------------------------------------------- surfaces */

static void mesh_make(engine *e, const tc_extract_options *how, const char *name) {
    e->data = (tc_mesh_data){.struct_size = sizeof e->data};
    tc_status status = tc_extract(e->grid, how, &e->mesh);
    if (!status) status = tc_mesh_get(e->mesh, &e->data);
    EXPECT(!status, "%s: %s", name, tc_message());
}

static void expect_count(engine *e, const tc_extract_options *how, const tc_mesh_data *mesh, const char *name) {
    tc_counts counts = {.struct_size = sizeof counts};
    EXPECT(!tc_count(e->grid, how, &counts), "%s: %s", name, tc_message());
    EXPECT(counts.vertex_count == mesh->vertex_count && counts.triangle_count == mesh->triangle_count &&
               counts.active_cell_count == mesh->active_cell_count,
           "%s: counted %" PRIu64 " vertices and %" PRIu64 " triangles, not %" PRIu64 " and %" PRIu64, name,
           counts.vertex_count, counts.triangle_count, mesh->vertex_count, mesh->triangle_count);
}

/* A field of two components: the bytes where samples are or could be. */
static void expect_carried(const tc_extract_options *how, uint64_t vertex_count, const char *name) {
    tc_field field = {.struct_size = sizeof field, .type = TC_I16, .components = 2, .values = memory};
    float *values[2];
    for (int n = 0; n < 2; n++) {
        values[n] = calloc(2 * vertex_count + 1, sizeof *values[n]);
        EXPECT(!tc_interpolate_field(engines[n].grid, how, &field, values[n], 2 * vertex_count), "%s, carried: %s",
               name, tc_message());
    }
    EXPECT(!memcmp(values[0], values[1], 2 * vertex_count * sizeof(float)), "%s: carried values differ", name);
    for (int n = 0; n < 2; n++) free(values[n]);
}

static void expect_surface(const tc_extract_options *how, uint32_t choice, const char *name) {
    const engine *reference = &engines[REFERENCE];
    mesh_make(&engines[REFERENCE], how, name);
    if (choice & 1) expect_count(&engines[DEVICE], how, &reference->data, name);
    for (int n = DEVICE; n < CONTEXTS; n++) {
        mesh_make(&engines[n], how, name);
        const char *difference = mesh_difference(&reference->data, &engines[n].data);
        EXPECT(!difference, "%s, %s: %s", name, n == COPYING ? "copied" : "in place", difference);
    }
    if (choice & 2) expect_carried(how, reference->data.vertex_count, name);
    if ((choice & 3) == 0) expect_count(&engines[DEVICE], how, &reference->data, name);
    tally.surfaces++;
    tally.border_alone += reference->data.active_cell_count == 0 && reference->data.vertex_count > 0;
}

static void grids_open(const tc_grid_options *grid, const char *name) {
    for (int n = 0; n < CONTEXTS; n++)
        EXPECT(!tc_grid_create(engines[n].context, grid, &engines[n].grid), "%s: %s", name, tc_message());
}

static void grids_close(void) {
    for (int n = 0; n < CONTEXTS; n++) {
        tc_grid_destroy(engines[n].grid);
        engines[n].grid = NULL;
    }
}

static void run(uint64_t seed, bool wide) {
    static const double all_inside[] = {-5, -1e30, -1e300};
    tc_grid_options grid;
    tc_extract_options how;
    char name[200];
    random_state = seed * 0x2545f4914f6cdd1du;
    grid_choose(&grid, &how, wide);
    snprintf(name, sizeof name, "%s, %s", tc_type_name(grid.type), tc_method_name(how.method));
    if (!test_chosen(name)) return;
    grids_open(&grid, name);
    for (int n = 0; n < SURFACES; n++) {
        const bool all = n == 2;
        how.isovalue = all ? all_inside[random_below(3)] : 60 + 0.5 * (double)random_below(9) - 2;
        snprintf(name, sizeof name, "seed %" PRIu64 ": %lldx%lldx%lld %s, %s, isovalue %g", seed,
                 (long long)grid.dims[0], (long long)grid.dims[1], (long long)grid.dims[2], tc_type_name(grid.type),
                 tc_method_name(how.method), how.isovalue);
        expect_surface(&how, random_below(4), name);
    }
    tally.missing += grid.blanked_samples || grid.blanked_cells || grid.has_nodata;
    grids_close();
}

/* ---------------------------------------------------------------------------------------------------- bricks inside */

/* Bricks that are all inside have nothing to emit but at the border; a run of them is passed over as a whole. */
static void test_inside_bricks(void) {
    const int64_t dims[3] = {600, 24, 5};
    tc_grid_options grid;
    tc_extract_options how;
    uint8_t *samples = (uint8_t *)memory;
    tc_grid_options_init(&grid);
    tc_extract_options_init(&how);
    memcpy(grid.dims, dims, sizeof dims);
    grid.samples = samples;
    how.closed = 1;
    for (int hole = 0; hole < 2; hole++) {
        for (int64_t n = 0; n < dims[0] * dims[1] * dims[2]; n++) samples[n] = (uint8_t)(100 + n % 7);
        if (hole) samples[(2 * dims[1] + 12) * dims[0] + 300] = 3;
        grids_open(&grid, "bricks inside");
        for (int visit = 0; visit < 3; visit++) {
            how.isovalue = visit == 2 ? 10 : 50;
            expect_surface(&how, (uint32_t)visit, hole ? "bricks inside, with a hole" : "bricks inside");
        }
        grids_close();
    }
}

/* A sample is missing beside a brick that is all inside, or in it: 64 x 8 x 4 samples from (64, 8, 4) on. */
static void test_inside_gaps(void) {
    static const int64_t gaps[][3] = {{62, 12, 6},  {63, 12, 6}, {64, 12, 6}, {127, 12, 6}, {128, 12, 6},
                                      {129, 12, 6}, {90, 6, 6},  {90, 7, 6},  {90, 16, 6},  {90, 17, 6},
                                      {90, 12, 2},  {90, 12, 3}, {90, 12, 8}, {90, 12, 9}};
    const int64_t dims[3] = {140, 26, 13};
    tc_grid_options grid;
    tc_extract_options how;
    tc_grid_options_init(&grid);
    tc_extract_options_init(&how);
    memcpy(grid.dims, dims, sizeof dims);
    grid.type = TC_F32, grid.samples = memory, grid.points = points;
    how.closed = how.normals = 1;
    for (size_t n = 0; n < sizeof gaps / sizeof *gaps; n++) {
        char name[60];
        samples_choose(&grid, ALL_INSIDE);
        sample_set(memory, TC_F32, (gaps[n][2] * dims[1] + gaps[n][1]) * dims[0] + gaps[n][0], (double)NAN);
        snprintf(name, sizeof name, "bricks inside, gap %d", (int)n);
        grids_open(&grid, name);
        for (uint32_t visit = 0; visit < 2; visit++) {
            how.isovalue = visit ? 10 : 60;
            expect_surface(&how, visit, name);
        }
        grids_close();
    }
}

static void contexts_open(uint32_t work_items) {
    tc_context_options options;
    tc_expert_options expert;
    engines[REFERENCE].context = reference_open();
    options_init(&options, &expert);
    expert.work_items = work_items;
    expert.tile_bricks = 3;
    engines[DEVICE].context = context_open(&options);
    expert.spin_limit = 1;
    expert.always_copy = 1;
    engines[COPYING].context = context_open(&options);
}

static void contexts_close(void) {
    for (int n = 0; n < CONTEXTS; n++) {
        tc_mesh_destroy(engines[n].mesh);
        tc_context_destroy(engines[n].context);
    }
}

int main(int argc, char **argv) {
    const bool groups = argc > 1 && !strcmp(argv[1], "groups");
    const uint64_t first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const uint64_t count = argc > 3 ? strtoull(argv[3], NULL, 10) : groups ? 40 : tier_count(300);
    if (!device_exists()) return SKIPPED;
    contexts_open(groups ? 64 : 1);
    const bool narrow = groups && tier_is_quick(); /* PoCL takes long to build kernels for groups */
    for (uint64_t n = 0; n < count; n++) run(first + n, n % 16 == 15 && !narrow);
    if (argc < 3 && test_chosen("bricks inside")) test_inside_bricks();
    if (argc < 3 && test_chosen("gaps inside")) test_inside_gaps();
    contexts_close();
    printf("%" PRIu64 " closed surfaces, %" PRIu64 " of them border alone, %" PRIu64 " grids with parts missing\n",
           tally.surfaces, tally.border_alone, tally.missing);
    if (argc < 3 && !getenv("TEST_ONLY"))
        EXPECT(tally.missing > 10 && tally.border_alone > 10,
               "%" PRIu64 " grids with parts missing, %" PRIu64 " surfaces of nothing but the border", tally.missing,
               tally.border_alone);
    return EXPECT_DONE();
}
