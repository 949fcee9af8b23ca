/*
 * test_interval.c - interval volumes: tetrahedra that fill what lies between two surfaces
 *
 * Of two tetrahedra side by side all cases and all orders of their points; of random structured grids of all kinds and
 * types, with parts missing, and the grids of tetrahedra that they are cut into:
 *
 * - crossings are the vertices of both surfaces, to the bit; samples within that a present tetrahedron has come first;
 * - every face has one or two tetrahedra, in opposite directions. Those with one are both surfaces, but for how
 *   quadrilaterals are cut, and the part within of the grid's own border, by its area;
 * - volumes sum up to what the grid's tetrahedra have within, computed from their values; none is inverted.
 *
 * Of the reference engine; or of kernels, grids of tetrahedra alone, of two types and some of the orders. That kernels
 * make the reference's bytes is looked at by test_interval_device and test_interval_complex.
 *
 * Usage: test_interval [SEED [COUNT]]: a failure names the seed of its grid, `test_interval SEED 1` repeats it.
 * test_interval alone|groups: by kernels.
 */
#include "engines.h"
#include "interval_facts.h"
#include "random.h"
#include "random_field.h"
#include "samples.h"

#include <inttypes.h>
#include <math.h>

enum { SAMPLES_MAX = 20000 };

static tc_context *context;
static bool by_kernels;
static double memory[SAMPLES_MAX]; /* aligned for every type */
static float points[3 * SAMPLES_MAX], axes[3][600];
static uint8_t blanked[SAMPLES_MAX];
static struct tally { uint64_t tetrahedra, missing, one_sided, empty; } tally;

/* What is looked at: a grid by its tetrahedra. */
typedef struct subject {
    const char *name;
    tc_grid *grid;
    const float *points;
    const void *samples;
    tc_type type;
    uint64_t point_count;
    const uint32_t *tetrahedra;
    uint64_t tetrahedron_count;
} subject;

/* -------------------------------------------------------------------------------------------------------- expected */

/* What the grid's tetrahedra have within: volume, the area in their border, samples. */
typedef struct expected {
    double volume, border_area;
    uint64_t samples;
} expected;

static double within(const double *values, int count, const tc_interval_volume_options *o) {
    return part_above(values, count, o->low) - part_above(values, count, o->high);
}

static expected expected_of(const subject *s, const tc_interval_volume_options *o) {
    expected e = {0, 0, 0};
    interval_facts whole = interval_facts_of(s->points, s->point_count, s->tetrahedra, s->tetrahedron_count);
    uint8_t *used = calloc(s->point_count + 1, 1);
    double values[4];
    if (!used) exit(EXIT_FAILURE);
    for (uint64_t n = 0; n < s->tetrahedron_count; n++) {
        const uint32_t *v = s->tetrahedra + 4 * n;
        const interval_facts one = interval_facts_of(s->points, s->point_count, v, 1);
        for (int m = 0; m < 4; m++) values[m] = sample_get(s->samples, s->type, v[m]), used[v[m]] = 1;
        e.volume += one.volume * within(values, 4, o);
        free(one.outer);
    }
    for (uint64_t n = 0; n < s->point_count; n++) {
        const double value = sample_get(s->samples, s->type, (int64_t)n);
        e.samples += used[n] && value >= o->low && value < o->high;
    }
    for (uint64_t n = 0; n < whole.outer_count; n++) {
        const uint32_t *v = whole.outer[n].v;
        for (int m = 0; m < 3; m++) values[m] = sample_get(s->samples, s->type, v[m]);
        e.border_area += face_area(s->points, v) * within(values, 3, o);
    }
    free(whole.outer);
    free(used);
    return e;
}

/* --------------------------------------------------------------------------------------------------------- surfaces */

/* Faces of the interval volume whose vertices are all in one block, numbered from its first. */
static uint64_t faces_take(const interval_facts *f, uint64_t first, uint64_t count, outer_face *out) {
    uint64_t taken = 0;
    for (uint64_t n = 0; n < f->outer_count; n++) {
        bool all = true;
        for (int m = 0; m < 3; m++) {
            const uint64_t v = f->outer[n].v[m];
            all = all && v >= first && v - first < count;
            out[taken].v[m] = (uint32_t)(v - first);
        }
        taken += all;
    }
    return taken;
}

/* The surface of a bound: its vertices are those of the block from `first` on, and its triangles the faces there.
 * Returns how many. Triangles of the high one face the other way. */
static uint64_t expect_surface(const subject *s, double isovalue, const tc_interval_volume_data *d,
                               const interval_facts *f, uint64_t first, uint64_t count, bool is_high) {
    tc_mesh *mesh = NULL;
    tc_mesh_data m = {.struct_size = sizeof m};
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = isovalue;
    if (isinf(isovalue)) {
        EXPECT(count == 0, "%s: vertices of a bound that there is not", s->name);
        return 0;
    }
    const bool made = !tc_extract(s->grid, &how, &mesh) && !tc_mesh_get(mesh, &m);
    EXPECT(made, "%s: %s", s->name, tc_message());
    EXPECT(m.vertex_count == count && (!count || !memcmp(m.positions, d->positions + 3 * first, 12 * count)),
           "%s: %s crossings are not the surface's vertices", s->name, is_high ? "high" : "low");
    outer_face *faces = malloc((f->outer_count + 1) * sizeof *faces);
    if (!faces) exit(EXIT_FAILURE);
    const uint64_t taken = faces_take(f, first, count, faces);
    EXPECT(taken == m.triangle_count, "%s: %" PRIu64 " faces on the %s surface of %" PRIu64 " triangles", s->name,
           taken, is_high ? "high" : "low", m.triangle_count);
    EXPECT(taken != m.triangle_count || same_sheet(faces, (const outer_face *)m.triangles, taken, is_high),
           "%s: faces on the %s surface are not its triangles", s->name, is_high ? "high" : "low");
    free(faces);
    tc_mesh_destroy(mesh);
    return taken;
}

/* Vertices at samples are where the points are, in their order but for bricks. */
static void expect_fields(const subject *s, const tc_interval_volume_options *o, const tc_interval_volume_data *d,
                          double step) {
    const tc_field field = {.struct_size = sizeof field, .type = TC_F32, .components = 3, .values = s->points};
    float *carried = malloc(12 * d->vertex_count + 4);
    if (!carried) exit(EXIT_FAILURE);
    EXPECT(!tc_interpolate_interval_volume(s->grid, o, &field, carried, 3 * d->vertex_count), "%s: %s", s->name,
           tc_message());
    double most = 0;
    for (uint64_t n = 0; n < 3 * d->vertex_count; n++)
        most = fmax(most, fabs((double)carried[n] - (double)d->positions[n]));
    EXPECT(most <= step, "%s: points that are carried are not the vertices, by %g", s->name, most);
    EXPECT(tc_interpolate_interval_volume(s->grid, o, &field, carried, 3 * d->vertex_count + 3) == TC_ERROR_ARGUMENT,
           "%s: too much room for a field is taken", s->name);
    free(carried);
}

/* step: by how much float32 may move a vertex. */
static void expect_interval(const subject *s, const tc_interval_volume_options *o, double step) {
    tc_interval_volume *interval = NULL;
    tc_interval_volume_data d = {.struct_size = sizeof d};
    tc_interval_volume_counts counts = {.struct_size = sizeof counts};
    const bool made = !tc_extract_interval_volume(s->grid, o, &interval) && !tc_interval_volume_get(interval, &d) &&
                      !tc_count_interval_volume(s->grid, o, &counts);
    EXPECT(made, "%s: %s", s->name, tc_message());
    EXPECT(counts.sample_count == d.sample_count && counts.low_count == d.low_count &&
               counts.high_count == d.high_count && counts.tetrahedron_count == d.tetrahedron_count,
           "%s: counted and made differ", s->name);
    interval_facts f = interval_facts_of(d.positions, d.vertex_count, d.tetrahedra, d.tetrahedron_count);
    const expected e = expected_of(s, o);
    EXPECT(!f.bad_vertices && !f.unused_vertices && !f.bad_faces,
           "%s: %" PRIu64 " bad vertices, %" PRIu64 " unused, %" PRIu64 " bad faces", s->name, f.bad_vertices,
           f.unused_vertices, f.bad_faces);
    EXPECT(d.sample_count == e.samples, "%s: %" PRIu64 " samples, not %" PRIu64, s->name, d.sample_count, e.samples);
    const uint64_t low = expect_surface(s, o->low, &d, &f, d.sample_count, d.low_count, false);
    const uint64_t high = expect_surface(s, o->high, &d, &f, d.sample_count + d.low_count, d.high_count, true);
    double area = 0, surfaces = 0;
    for (uint64_t n = 0; n < f.outer_count; n++) area += face_area(d.positions, f.outer[n].v);
    outer_face *faces = malloc((f.outer_count + 1) * sizeof *faces);
    if (!faces) exit(EXIT_FAILURE);
    for (int bound = 0; bound < 2; bound++) {
        const uint64_t first = d.sample_count + (bound ? d.low_count : 0);
        const uint64_t count = faces_take(&f, first, bound ? d.high_count : d.low_count, faces);
        for (uint64_t n = 0; n < count; n++) surfaces += face_area(d.positions + 3 * first, faces[n].v);
    }
    free(faces);
    const double tolerance = step * (double)(f.outer_count + 1);
    EXPECT(fabs(area - surfaces - e.border_area) <= 4 * tolerance, "%s: area in the border %g, not %g", s->name,
           area - surfaces, e.border_area);
    EXPECT(fabs(f.volume - e.volume) <= tolerance, "%s: volume %.9g, not %.9g", s->name, f.volume, e.volume);
    EXPECT(!d.tetrahedron_count || f.least >= -step, "%s: a tetrahedron has volume %g", s->name, f.least);
    EXPECT(low + high <= f.outer_count, "%s: more faces on surfaces than there are", s->name);
    expect_fields(s, o, &d, step);
    tally.tetrahedra += d.tetrahedron_count, tally.empty += !d.tetrahedron_count;
    free(f.outer);
    tc_interval_volume_destroy(interval);
}

/* ------------------------------------------------------------------------------------------------------------ cases */

static const double case_values[3] = {-1.25, 0.5, 2.75};

/* Two tetrahedra with a common face; corner n of the pair has number order[n]. */
static void pair_try(const uint32_t order[5], int digits) {
    static const float places[5][3] = {
        {0, 0, 0}, {1, 0.125f, 0}, {0.25f, 1, 0}, {0.375f, 0.25f, 1}, {0.25f, 0.375f, -1}};
    const uint32_t tetrahedra[8] = {order[0], order[1], order[2], order[3], order[0], order[2], order[1], order[4]};
    float at[15], samples[5];
    tc_tetrahedra_grid_options o;
    tc_interval_volume_options how;
    char name[64];
    tc_interval_volume_options_init(&how);
    how.low = 0, how.high = 1;
    snprintf(name, sizeof name, "pair, order %u%u%u%u%u, case %d", order[0], order[1], order[2], order[3], order[4],
             digits);
    subject s = {name, NULL, at, samples, TC_F32, 5, tetrahedra, 2};
    for (int n = 0; n < 5; n++, digits /= 3) {
        memcpy(at + 3 * order[n], places[n], sizeof places[n]);
        samples[order[n]] = (float)case_values[digits % 3];
    }
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = 5, o.points = at, o.type = TC_F32, o.samples = samples;
    o.tetrahedron_count = 2, o.tetrahedra = tetrahedra;
    EXPECT(!tc_tetrahedra_grid_create(context, &o, &s.grid), "%s: %s", name, tc_message());
    expect_interval(&s, &how, 2e-6);
    tc_grid_destroy(s.grid);
}

static void orders_try(uint32_t order[5], int n) {
    static int order_count;
    if (n == 5 && (!by_kernels || order_count++ % 13 == 0))
        for (int digits = 0; digits < 243; digits++) pair_try(order, digits);
    for (int m = n; m < 5; m++) {
        const uint32_t a = order[n], b = order[m];
        order[n] = b, order[m] = a;
        orders_try(order, n + 1);
        order[n] = a, order[m] = b;
    }
}

/* ----------------------------------------------------------------------------------------------------- random grids */

static void samples_choose(tc_grid_options *g) {
    const int field = (int)random_below(RANDOM_FIELDS), kind = (int)random_below(3);
    double wave[4];
    int64_t n = 0, p[3];
    wave_choose(wave);
    for (int axis = 0; axis < 3; axis++)
        for (int64_t m = 0; m < g->dims[axis]; m++)
            axes[axis][m] = (axis == 1 ? -1 : 1) * ((float)m + (float)random_between(-0.3, 0.3));
    for (p[2] = 0; p[2] < g->dims[2]; p[2]++)
        for (p[1] = 0; p[1] < g->dims[1]; p[1]++)
            for (p[0] = 0; p[0] < g->dims[0]; p[0]++, n++) {
                const double value = field_value(field, wave, (double)p[0], (double)p[1], (double)p[2]);
                sample_set(memory, g->type, n, value);
                for (int r = 0; r < 3; r++) {
                    const double *m = g->matrix[r];
                    points[3 * n + r] = kind == 0 ? (float)(m[0] * (double)(p[0] + g->first_index[0]) +
                                                            m[1] * (double)(p[1] + g->first_index[1]) +
                                                            m[2] * (double)(p[2] + g->first_index[2]) + m[3])
                                        : kind == 1
                                            ? axes[r][p[r]]
                                            : (float)((r == 0 ? -1 : 1) * ((double)p[r] + random_between(-0.1, 0.1)));
                }
            }
    if (kind == 1)
        for (int axis = 0; axis < 3; axis++) g->axes[axis] = axes[axis];
    if (kind == 2) g->points = points;
}

/* Blanks samples or cells, or takes samples out by their value. */
static void parts_remove(tc_grid_options *g) {
    const uint32_t how = random_below(6), rarity = 2 + random_below(60);
    const int64_t count = g->dims[0] * g->dims[1] * g->dims[2];
    for (int64_t n = 0; n < count; n++) blanked[n] = random_below(rarity) == 0;
    if (how == 0) g->blanked_samples = blanked;
    if (how == 1) g->blanked_cells = blanked;
    if (how == 2) g->has_nodata = 1, g->nodata = sample_get(memory, g->type, random_below((uint32_t)count));
    for (int64_t n = 0; n < count && how == 3 && g->type >= TC_F32; n++)
        if (blanked[n]) sample_set(memory, g->type, n, n % 2 ? (double)NAN : (double)INFINITY);
    tally.missing += how < 3 || (how == 3 && g->type >= TC_F32);
}

static void grid_choose(tc_grid_options *g) {
    static const double sheared[3][4] = {{-0.75, 0.125, 0, 1}, {0, 1.5, 0.25, -3}, {0.125, 0, 0.75, 0.5}};
    static const int64_t xs[] = {2, 3, 5, 9, 63, 64, 65, 66, 130}, ys[] = {2, 3, 8, 9, 10, 17},
                         zs[] = {2, 3, 4, 5, 6, 9};
    tc_grid_options_init(g);
    g->dims[0] = xs[random_below(random_below(4) ? 4 : 9)], g->dims[1] = ys[random_below(random_below(4) ? 3 : 6)];
    g->dims[2] = zs[random_below(6)];
    g->type = by_kernels ? (random_below(2) ? TC_U8 : TC_F32) : (tc_type)random_below(8);
    g->samples = memory;
    for (int axis = 0; axis < 3; axis++) g->first_index[axis] = random_below(2) ? 0 : (int64_t)random_below(7) - 3;
    if (random_below(2)) memcpy(g->matrix, sheared, sizeof sheared);
    samples_choose(g);
    parts_remove(g);
}

static void interval_choose(tc_interval_volume_options *o) {
    tc_interval_volume_options_init(o);
    const double low = 40 + 0.5 * (double)random_below(60), width = 0.5 * (double)(1 + random_below(40));
    const uint32_t sides = random_below(6);
    if (sides) o->low = random_below(3) ? 59 + 0.5 * (double)random_below(4) : low;
    if (sides != 1) o->high = sides ? o->low + (random_below(3) ? width : 0.5) : low;
    tally.one_sided += sides < 2;
}

/* The tetrahedra that do not have the point, in memory of their own. */
static uint32_t *without_point(subject *s, uint32_t point) {
    uint32_t *kept = malloc(16 * s->tetrahedron_count + 1);
    uint64_t count = 0;
    if (!kept) exit(EXIT_FAILURE);
    for (uint64_t n = 0; n < s->tetrahedron_count; n++) {
        bool has = false;
        for (int m = 0; m < 4; m++) has = has || s->tetrahedra[4 * n + (uint64_t)m] == point;
        if (!has) memcpy(kept + 4 * count++, s->tetrahedra + 4 * n, 16);
    }
    s->tetrahedra = kept, s->tetrahedron_count = count;
    return kept;
}

/* Of real types with a sample that is missing. */
static void complex_try(const subject *structured, const tc_interval_volume_options *how, double step) {
    tc_tetrahedra_grid_options o;
    subject s = *structured;
    uint32_t *kept = NULL;
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = s.point_count, o.points = s.points, o.type = s.type, o.samples = s.samples;
    o.tetrahedron_count = s.tetrahedron_count, o.tetrahedra = s.tetrahedra;
    if (s.type >= TC_F32) {
        const uint32_t point = random_below((uint32_t)s.point_count);
        sample_set(memory, s.type, point, (double)NAN);
        kept = without_point(&s, point);
    }
    EXPECT(!tc_tetrahedra_grid_create(context, &o, &s.grid), "%s: %s", s.name, tc_message());
    expect_interval(&s, how, step);
    tc_grid_destroy(s.grid);
    free(kept);
}

static void run(uint64_t seed) {
    tc_grid_options g;
    tc_interval_volume_options how;
    tc_tetrahedra t = {.struct_size = sizeof t};
    char name[160];
    random_state = seed * 0x2545f4914f6cdd1du;
    grid_choose(&g);
    interval_choose(&how);
    snprintf(name, sizeof name, "seed %" PRIu64 ": %lldx%lldx%lld %s, %g to %g", seed, (long long)g.dims[0],
             (long long)g.dims[1], (long long)g.dims[2], tc_type_name(g.type), how.low, how.high);
    EXPECT(!tc_tetrahedralize_grid(&g, &t), "%s: %s", name, tc_message());
    subject s = {name,         NULL,
                 points,       memory,
                 g.type,       (uint64_t)(g.dims[0] * g.dims[1] * g.dims[2]),
                 t.tetrahedra, t.tetrahedron_count};
    const double step = 2e-7 * (double)(g.dims[0] + g.dims[1] + g.dims[2] + 10);
    if (!by_kernels) {
        EXPECT(!tc_grid_create(context, &g, &s.grid), "%s: %s", name, tc_message());
        expect_interval(&s, &how, step);
        tc_grid_destroy(s.grid);
    }
    if (by_kernels || seed % 3 == 0) complex_try(&s, &how, step);
    tc_tetrahedra_release(&t);
}

/* Mistakes of the caller. */
static void test_refused(void) {
    static const double bounds[][2] = {{1, 1}, {2, 1}, {(double)NAN, 1}, {-INFINITY, INFINITY}, {INFINITY, INFINITY}};
    tc_grid_options g;
    tc_grid *grid = NULL;
    tc_interval_volume *interval = NULL;
    tc_interval_volume_options o;
    tc_grid_options_init(&g);
    tc_interval_volume_options_init(&o);
    g.dims[0] = g.dims[1] = g.dims[2] = 2, g.samples = memory;
    EXPECT(!tc_grid_create(context, &g, &grid), "%s", tc_message());
    for (size_t n = 0; n < sizeof bounds / sizeof *bounds; n++) {
        o.low = bounds[n][0], o.high = bounds[n][1];
        EXPECT(tc_extract_interval_volume(grid, &o, &interval) == TC_ERROR_ARGUMENT && !interval, "%g to %g is taken",
               o.low, o.high);
    }
    tc_grid_destroy(grid);
}

/* Each kind of damage is seen. */
static void test_faults(void) {
    static const float at[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    const uint32_t good[8] = {0, 1, 2, 3, 4, 1, 3, 2};
    uint32_t bad[8];
    for (int fault = 0; fault < 4; fault++) {
        memcpy(bad, good, sizeof bad);
        if (fault == 1) bad[5] = 3, bad[6] = 1;
        if (fault == 2) bad[7] = 5;
        if (fault == 3) bad[4] = 0;
        interval_facts f = interval_facts_of(at, 5, bad, 2);
        const bool sound = !f.bad_faces && !f.bad_vertices && !f.unused_vertices && f.least > 0;
        EXPECT(sound == (fault == 0), "fault %d of tetrahedra is not seen", fault);
        free(f.outer);
    }
    const outer_face a[2] = {{{0, 1, 2}}, {{0, 2, 3}}}, b[2] = {{{1, 2, 3}}, {{1, 3, 0}}},
                     c[2] = {{{0, 1, 2}}, {{0, 3, 2}}};
    EXPECT(same_sheet(a, b, 2, false) && !same_sheet(a, b, 2, true) && !same_sheet(a, c, 2, false),
           "sheets that differ are not told apart");
}

static tc_context *kernels_open(bool groups) {
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    expert.work_items = groups ? 64 : 1;
    return context_open(&options);
}

int main(int argc, char **argv) {
    const bool groups = argc > 1 && !strcmp(argv[1], "groups");
    by_kernels = groups || (argc > 1 && !strcmp(argv[1], "alone"));
    const uint64_t first = argc > 1 && !by_kernels ? strtoull(argv[1], NULL, 10) : 1;
    const uint64_t count = argc > 2 ? strtoull(argv[2], NULL, 10) : 60;
    uint32_t order[5] = {0, 1, 2, 3, 4};
    if (by_kernels && !device_exists()) return SKIPPED;
    if (groups) groups_begin();
    context = by_kernels ? kernels_open(groups) : reference_open();
    if (argc < 2) test_faults();
    if (argc < 2) test_refused();
    if (argc < 2 || by_kernels) orders_try(order, 0);
    for (uint64_t n = 0; n < count; n++) run(first + n);
    printf("%" PRIu64 " tetrahedra, %" PRIu64 " grids with parts missing, %" PRIu64 " one-sided, %" PRIu64 " empty\n",
           tally.tetrahedra, tally.missing, tally.one_sided, tally.empty);
    tc_context_destroy(context);
    return EXPECT_DONE();
}
