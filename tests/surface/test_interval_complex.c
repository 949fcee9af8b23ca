/*
 * test_interval_complex.c - interval volumes of grids of tetrahedra by the kernels are those of the reference, byte for
 * byte, and so are fields at their vertices
 *
 * Random blocks of mixed cells, in any order, with the cells given or not; tetrahedra that share nothing, or one edge;
 * all sample types: noise, ties, samples all within and few; some not finite. Of each grid several ranges, so that
 * later ones go by the ranges of clusters: counted and extracted; in place; copied, with every sum of the scan made
 * again; in slabs, as little memory as goes; with surfaces in between. Cancelled at every call of the callback, and
 * refused where a point is not there. test_interval looks at what the reference makes.
 *
 * Usage: test_interval_complex [alone|groups [SEED [COUNT]]]: a failure names the seed of its grid,
 * `test_interval_complex groups SEED 1` repeats it. From 1000 grids on of all types, as each takes PoCL seconds to
 * build its kernels.
 */
#include "cut.h"
#include "interval_engines.h"
#include "random_field.h"
#include "samples.h"

#include <math.h>

enum { RANGES = 3, ALL_WITHIN = RANDOM_FIELDS, FEW_WITHIN, TWO_SIDES, FIELDS };

static uint64_t gap_count;
static bool all_types;

/* ----------------------------------------------------------------------------------------------------------- grids */

/* A complex with what it points to; options is the view of it. */
typedef struct subject {
    tc_tetrahedra_grid_options options;
    cell_list list; /* of blocks */
    tc_cells cells;
    tc_tetrahedra cut;
    float *points;
    uint32_t *tetrahedra;
    void *samples;
} subject;

static tc_status grid_make(tc_context *context, const void *options, tc_grid **grid) {
    return tc_tetrahedra_grid_create(context, options, grid);
}

static void tetrahedra_shuffle(subject *s) {
    for (uint32_t n = (uint32_t)s->options.tetrahedron_count; n > 1; n--) {
        uint32_t *a = s->tetrahedra + 4 * (n - 1), *b = s->tetrahedra + 4 * (size_t)random_below(n), t[4];
        memcpy(t, a, sizeof t);
        memcpy(a, b, sizeof t);
        memcpy(b, t, sizeof t);
    }
}

static void block_make(subject *s) {
    const uint32_t size = 1 + random_below(random_below(6) ? 4 : 12);
    s->list = mixed_block_make(size, random_u64());
    s->cells = cell_list_view(&s->list);
    s->cut = cut(&s->cells, "block");
    s->options.point_count = s->list.point_count, s->options.tetrahedron_count = s->cut.tetrahedron_count;
    s->points = malloc(12 * s->list.point_count);
    s->tetrahedra = malloc(16 * s->cut.tetrahedron_count);
    if (!s->points || !s->tetrahedra) exit(EXIT_FAILURE);
    memcpy(s->points, s->list.points, 12 * s->list.point_count);
    memcpy(s->tetrahedra, s->cut.tetrahedra, 16 * s->cut.tetrahedron_count);
    if (random_below(3) == 0)
        tetrahedra_shuffle(s);
    else if (random_below(2))
        s->options.source = &s->cells, s->options.cells = s->cut.cells;
}

/* No tetrahedron shares a point with another; or all have one edge. */
static void loose_make(subject *s, bool hub) {
    const uint32_t count = 1 + random_below(200), points = hub ? count + 3 : 4 * count;
    s->options.point_count = points, s->options.tetrahedron_count = count;
    s->points = malloc(12 * (size_t)points);
    s->tetrahedra = malloc(16 * (size_t)count);
    if (!s->points || !s->tetrahedra) exit(EXIT_FAILURE);
    for (uint32_t n = 0; n < 3 * points; n++) s->points[n] = (float)random_between(-1, 1);
    for (uint32_t n = 0; n < 4 * count; n++) s->tetrahedra[n] = 4 * count - 1 - n;
    for (uint32_t n = 0; n < count && hub; n++) memcpy(s->tetrahedra + 4 * n, (uint32_t[]){n + 3, 1, n + 2, 0}, 16);
}

static double value_choose(int field, const double wave[4], const float *point) {
    if (field == ALL_WITHIN) return 60 + random_below(2);
    if (field == FEW_WITHIN) return random_below(50) ? 20 : 60;
    if (field == TWO_SIDES) return point[0] < point[1] ? 20 : random_below(20) ? 90 : 60;
    return field_value(field, wave, point[0], point[1], point[2]);
}

static void samples_choose(subject *s) {
    static const double gaps[3] = {NAN, INFINITY, -INFINITY};
    const int field = (int)random_below(FIELDS);
    const uint32_t rarity = random_below(2) ? 0 : 2 + random_below(60);
    double wave[4];
    wave_choose(wave);
    s->samples = malloc(8 * s->options.point_count);
    if (!s->samples) exit(EXIT_FAILURE);
    s->options.samples = s->samples;
    for (uint64_t n = 0; n < s->options.point_count; n++) {
        const bool gap = s->options.type >= TC_F32 && rarity && random_below(rarity) == 0;
        const double value = value_choose(field, wave, s->points + 3 * n);
        sample_set(s->samples, s->options.type, (int64_t)n, gap ? gaps[random_below(3)] : value);
        gap_count += gap;
    }
}

static void subject_choose(subject *s) {
    static const tc_type few[] = {TC_U8, TC_F32, TC_I32};
    const uint32_t kind = random_below(10);
    *s = (subject){.cut = {.struct_size = sizeof s->cut}};
    tc_tetrahedra_grid_options_init(&s->options);
    if (kind < 2)
        loose_make(s, kind);
    else
        block_make(s);
    s->options.points = s->points, s->options.tetrahedra = s->tetrahedra;
    s->options.type = all_types ? (tc_type)random_below(8) : few[random_below(3)];
    samples_choose(s);
}

static void subject_free(subject *s) {
    tc_tetrahedra_release(&s->cut);
    if (s->list.points) cell_list_free(&s->list);
    free(s->points);
    free(s->tetrahedra);
    free(s->samples);
}

/* --------------------------------------------------------------------------------------------------------- volumes */

/* Points and numbers as a field, by both engines. */
static void expect_carried(const subject *s, const tc_interval_volume_options *how, const char *name) {
    const uint64_t count = 3 * engines[REFERENCE].data.vertex_count;
    const tc_field field = {.struct_size = sizeof field, .type = TC_F32, .components = 3, .values = s->points};
    float *values[2] = {calloc((size_t)count + 1, sizeof(float)), calloc((size_t)count + 1, sizeof(float))};
    if (!values[0] || !values[1]) exit(EXIT_FAILURE);
    for (int n = 0; n < 2; n++)
        EXPECT(!tc_interpolate_interval_volume(engines[n].grid, how, &field, values[n], count), "%s: %s", name,
               tc_message());
    EXPECT(!memcmp(values[0], values[1], sizeof(float) * count), "%s: fields differ", name);
    free(values[0]);
    free(values[1]);
}

/* A surface between two volumes is not theirs. */
static void expect_surface(const tc_interval_volume_options *how, const char *name) {
    tc_extract_options surface;
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data data[2] = {{.struct_size = sizeof *data}, {.struct_size = sizeof *data}};
    tc_extract_options_init(&surface);
    surface.isovalue = isinf(how->low) ? how->high : how->low;
    for (int n = 0; n < 2; n++)
        EXPECT(!tc_extract(engines[n].grid, &surface, &meshes[n]) && !tc_mesh_get(meshes[n], &data[n]), "%s: %s", name,
               tc_message());
    const char *difference = mesh_difference(&data[0], &data[1]);
    EXPECT(!difference, "%s, a surface in between: %s", name, difference);
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
}

static void run(uint64_t seed, const tc_context_options *copying) {
    subject s;
    tc_interval_volume_options how;
    char name[200];
    random_state = seed * 0x2545f4914f6cdd1du;
    subject_choose(&s);
    snprintf(name, sizeof name, "%s", tc_type_name(s.options.type));
    if (!test_chosen(name)) {
        subject_free(&s);
        return;
    }
    grids_open(grid_make, &s.options, name);
    for (int n = 0; n < RANGES; n++) {
        range_choose(&how);
        snprintf(name, sizeof name, "seed %" PRIu64 ": %" PRIu64 " tetrahedra, %s%s, %g to %g", seed,
                 s.options.tetrahedron_count, tc_type_name(s.options.type), s.options.source ? ", cells" : "", how.low,
                 how.high);
        if (!interval_make(&engines[REFERENCE], &how, name)) continue;
        expect_engines(&how, random_below(2), name);
        if (random_below(2)) expect_carried(&s, &how, name);
        if (random_below(4) == 0) expect_surface(&how, name);
        if (n == 0 && seed % 4 == 0)
            expect_bounded(copying, grid_make, &s.options, &how, &engines[REFERENCE].data, name);
    }
    grids_close();
    subject_free(&s);
}

/* ----------------------------------------------------------------------------------------------------- other cases */

/* A block of u8 or f32 from 0 to 100, of so many tetrahedra that there are slabs. */
static void large_make(subject *s, tc_type type) {
    *s = (subject){.cut = {.struct_size = sizeof s->cut}};
    tc_tetrahedra_grid_options_init(&s->options);
    do {
        if (s->points) subject_free(s);
        *s = (subject){.cut = {.struct_size = sizeof s->cut}};
        tc_tetrahedra_grid_options_init(&s->options);
        block_make(s);
    } while (s->options.tetrahedron_count < 4000);
    s->options.points = s->points, s->options.tetrahedra = s->tetrahedra, s->options.type = type;
    s->samples = malloc(8 * s->options.point_count);
    if (!s->samples) exit(EXIT_FAILURE);
    s->options.samples = s->samples;
    for (uint64_t n = 0; n < s->options.point_count; n++) {
        const float *p = s->points + 3 * n;
        sample_set(s->samples, type, (int64_t)n, floor(50 + 25 * sin(p[0]) * cos(p[1]) + 20 * sin(p[2])));
    }
}

/* Many budgets, from little to plenty: whole, in few slabs and in many, with points whole and gathered. */
static void test_slabs(const tc_context_options *copying) {
    tc_interval_volume_options how;
    tc_interval_volume_options_init(&how);
    how.low = 45, how.high = 60;
    for (int kind = 0; kind < 2; kind++) {
        const char *name = kind ? "slabs of f32" : "slabs of u8";
        subject s;
        random_state = 7 + (uint64_t)kind;
        large_make(&s, kind ? TC_F32 : TC_U8);
        if (kind) ((float *)s.samples)[s.options.point_count / 2] = NAN;
        grids_open(grid_make, &s.options, name);
        uint32_t slabs = 0, whole = 0;
        for (uint64_t budget = 90000; interval_make(&engines[REFERENCE], &how, name) && budget < 20000000;
             budget = budget / 2 * 3) {
            tc_context_options options = *copying;
            engine e = {.data = {.struct_size = sizeof e.data}};
            options.max_memory_bytes = budget;
            e.context = context_open(&options);
            tc_status status = grid_make(e.context, &s.options, &e.grid);
            for (int n = 0; n < 2 && !status; n++) status = tc_extract_interval_volume(e.grid, &how, &e.interval);
            EXPECT(!status || status == TC_ERROR_MEMORY, "%s: %s", name, tc_message());
            if (!status) {
                tc_interval_volume_get(e.interval, &e.data);
                expect_same(&engines[REFERENCE].data, &e.data, name, "budgets");
                expect_within(e.context, budget, name);
                if (e.data.slab_count > slabs) slabs = e.data.slab_count;
                whole += e.data.slab_count == 1;
            }
            tc_interval_volume_destroy(e.interval);
            tc_grid_destroy(e.grid);
            tc_context_destroy(e.context);
        }
        EXPECT(slabs > 20 && whole, "%s: at most %u slabs, %u times whole", name, slabs, whole);
        engine_tally.slabs += slabs;
        grids_close();
        subject_free(&s);
    }
}

static int cancel_at, cancel_calls;
static double cancel_fraction;

static int cancel(void *user, const char *stage, double fraction) {
    (void)user;
    EXPECT(fraction >= cancel_fraction && fraction <= 1, "%s: progress from %g to %g", stage, cancel_fraction,
           fraction);
    cancel_fraction = fraction;
    return cancel_calls++ == cancel_at;
}

/* At every call of the callback in turn; what follows is right all the same. */
static void test_cancelled(const tc_context_options *usual, uint64_t budget, const char *name) {
    tc_context_options options = *usual;
    tc_interval_volume_options how;
    subject s;
    random_state = 11;
    large_make(&s, TC_U8);
    tc_interval_volume_options_init(&how);
    how.low = 45, how.high = 60;
    options.max_memory_bytes = budget, options.progress = cancel;
    engine e = {.context = context_open(&options)};
    EXPECT(!grid_make(engines[REFERENCE].context, &s.options, &engines[REFERENCE].grid), "%s", tc_message());
    EXPECT(!grid_make(e.context, &s.options, &e.grid), "%s: %s", name, tc_message());
    for (cancel_at = 0;; cancel_at++) {
        cancel_calls = 0, cancel_fraction = 0;
        tc_status status = tc_extract_interval_volume(e.grid, &how, &e.interval);
        if (cancel_calls <= cancel_at) break;
        EXPECT(status == TC_ERROR_CANCELLED, "%s: not cancelled: %s", name, tc_message());
    }
    EXPECT(cancel_at > 2, "%s: %d calls of the callback", name, cancel_at);
    cancel_fraction = 0;
    e.data.struct_size = sizeof e.data;
    tc_interval_volume_get(e.interval, &e.data);
    if (interval_make(&engines[REFERENCE], &how, name))
        expect_same(&engines[REFERENCE].data, &e.data, name, "after cancelling");
    tc_interval_volume_destroy(e.interval);
    tc_grid_destroy(e.grid);
    tc_context_destroy(e.context);
    grids_close();
    subject_free(&s);
}

/* A point that is not there. */
static void test_refused(void) {
    tc_interval_volume_options how;
    subject s;
    random_state = 13;
    large_make(&s, TC_U8);
    tc_interval_volume_options_init(&how);
    how.low = 45;
    s.tetrahedra[4 * s.options.tetrahedron_count - 2] = (uint32_t)s.options.point_count;
    grids_open(grid_make, &s.options, "refused");
    for (int n = 0; n < CONTEXTS; n++) {
        tc_interval_volume_counts counts = {.struct_size = sizeof counts};
        EXPECT_REFUSED(tc_extract_interval_volume(engines[n].grid, &how, &engines[n].interval), TC_ERROR_DATA,
                       "a point that is not there");
        EXPECT_REFUSED(tc_count_interval_volume(engines[n].grid, &how, &counts), TC_ERROR_DATA,
                       "a point that is not there");
        EXPECT(strstr(tc_message(), "has point"), "not told which: %s", tc_message());
    }
    grids_close();
    subject_free(&s);
}

int main(int argc, char **argv) {
    const bool groups = argc > 1 && !strcmp(argv[1], "groups");
    const uint64_t first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    const uint64_t count = argc > 3 ? strtoull(argv[3], NULL, 10) : groups ? 40 : tier_count(150);
    tc_context_options options;
    tc_expert_options expert;
    if (!device_exists()) return SKIPPED;
    if (groups) groups_begin();
    all_types = count >= 1000;
    engines_open(groups, &options, &expert);
    for (uint64_t n = 0; n < count; n++) run(first + n, &options);
    if (argc < 3 && test_chosen("slabs")) test_slabs(&options);
    if (argc < 3 && test_chosen("refused")) {
        test_cancelled(&options, 0, "cancelled");
        test_cancelled(&options, 400000, "cancelled in slabs");
        test_refused();
    }
    engines_close();
    printf("%" PRIu64 " volumes, %" PRIu64 " samples missing, %" PRIu64 " bounded, %" PRIu64 " slabs\n",
           engine_tally.volumes, gap_count, engine_tally.bounded, engine_tally.slabs);
    if (argc < 3 && !getenv("TEST_ONLY")) EXPECT(gap_count && engine_tally.slabs, "no samples missing, or no slabs");
    return EXPECT_DONE();
}
