/*
 * test_curvilinear.c - rectilinear and curvilinear grids, blanked samples and cells
 *
 * Device against reference, byte for byte, and the reference against the grid (mesh_walk.h), over types, sizes around
 * words, bricks and tiles, slabs and copies; then what coordinates and blanks must and must not change.
 *
 * Usage: test_curvilinear [alone|groups]: only kernels for one work-item, or only those for groups of them
 */
#include "curvilinear_subject.h"
#include "engines.h"
#include "random.h"
#include "samples.h"
#include "topology.h"

#include <math.h>

enum { WHOLE, IN_ROWS, COPIED, CONTEXTS }; /* work-items 1; 32; 1 with buffers of its own */

static tc_context *contexts[CONTEXTS], *reference;

/* ------------------------------------------------------------------------------------------------ device, reference */

static void describe(const subject *s, char *text, size_t bytes) {
    const tc_grid_options *g = &s->grid;
    snprintf(text, bytes, "%s %s %lldx%lldx%lld from %lld%s%s%s", tc_type_name(g->type),
             g->points    ? "points"
             : g->axes[0] ? "axes"
                          : "uniform",
             (long long)g->dims[0], (long long)g->dims[1], (long long)g->dims[2], (long long)g->first_index[0],
             g->blanked_samples ? ", blanked samples" : "", g->blanked_cells ? ", blanked cells" : "",
             s->how.normals ? ", normals" : "");
}

static bool meshes_same(tc_context *context, const subject *s, const tc_mesh_data *expected, const char *how) {
    char text[160], name[200];
    tc_mesh *mesh = NULL;
    tc_mesh_data data;
    const char *difference = "no mesh";
    describe(s, text, sizeof text);
    snprintf(name, sizeof name, "%s, %s", text, how);
    if (!test_chosen(name)) return true;
    if (extract(context, &s->grid, &s->how, &mesh, &data)) difference = mesh_difference(expected, &data);
    EXPECT(!difference, "%s: %s", name, difference);
    tc_mesh_destroy(mesh);
    return !difference;
}

/* The reference's mesh is right, and that of every device context the same. */
static void subject_compare(const subject *s, unsigned which) {
    static const char *const names[CONTEXTS] = {"one work-item", "32 work-items", "copied buffers"};
    char text[160];
    tc_mesh *mesh = NULL;
    tc_mesh_data expected;
    describe(s, text, sizeof text);
    if (!extract(reference, &s->grid, &s->how, &mesh, &expected)) return;
    const char *fault = mesh_fault(&s->grid, s->how.isovalue, &expected);
    EXPECT(!fault, "%s: reference: %s", text, fault);
    EXPECT(expected.triangle_count > 0, "%s: no surface", text);
    for (int n = 0; n < CONTEXTS; n++)
        if (contexts[n] && (which >> n & 1)) meshes_same(contexts[n], s, &expected, names[n]);
    tc_mesh_destroy(mesh);
}

static void coordinates_choose(subject *s, int kind, int turned) {
    if (kind == 0)
        points_fill(s, turned, random_below(2) ? 0.3 : 0);
    else if (kind == 1)
        axes_fill(s, turned);
}

/* kind: 0 points, 1 axes, 2 uniform. */
static void test_engines(subject *s, tc_type type, int kind, unsigned which) {
    static const int64_t sizes[][3] = {{2, 2, 2},   {3, 5, 4},   {63, 9, 5},  {64, 8, 4},
                                       {65, 17, 9}, {130, 7, 6}, {16, 33, 13}};
    for (int n = 0; n < 7; n++)
        for (int blank = kind == 2; blank < 4; blank++) {
            if ((n + blank) % 2 && (type != TC_F32 || n < 2)) continue;
            subject_begin(s, type, sizes[n]);
            s->grid.first_index[0] = random_below(2);
            s->grid.first_index[1] = -3;
            s->how.normals = 1;
            samples_fill(s, n < 2 ? 60 : 5);
            if (s->count == 8) sample_set(s->samples, type, 0, 126), sample_set(s->samples, type, 7, 0);
            coordinates_choose(s, kind, n + blank);
            if (blank && s->count > 100) blanks_fill(s, blank & 1, blank & 2, n % 2 ? 30 : 200);
            subject_compare(s, which);
        }
}

/* Same bytes with every memory budget that suffices; the bound is kept. */
static void test_budgets(subject *s, int kind, int always_copy) {
    tc_context_options options;
    tc_expert_options expert;
    tc_mesh *mesh = NULL;
    tc_mesh_data expected;
    unsigned most = 0, done = 0, refused = 0;
    options_init(&options, &expert);
    expert.always_copy = always_copy;
    subject_begin(s, TC_F32, (int64_t[3]){35, 21, 50});
    samples_fill(s, 1);
    coordinates_choose(s, kind, 0);
    blanks_fill(s, 1, 1, 100);
    s->how.normals = 1;
    if (!extract(reference, &s->grid, &s->how, &mesh, &expected)) return;
    for (options.max_memory_bytes = 16 << 20; options.max_memory_bytes > 20000;
         options.max_memory_bytes = options.max_memory_bytes * 7 / 10) {
        tc_context *context = context_open(&options);
        tc_grid *grid = NULL;
        tc_mesh *slabs = NULL;
        tc_mesh_data data = {.struct_size = sizeof data};
        tc_status status = tc_grid_create(context, &s->grid, &grid);
        if (!status) status = tc_extract(grid, &s->how, &slabs);
        if (!status) status = tc_mesh_get(slabs, &data);
        expect_within(context, options.max_memory_bytes, "budgets");
        const char *difference = status ? NULL : mesh_difference(&expected, &data);
        EXPECT(!difference, "kind %d, copied buffers %d, budget %llu: %s", kind, always_copy,
               (unsigned long long)options.max_memory_bytes, difference);
        EXPECT(!status || status == TC_ERROR_MEMORY, "status %d: %s", (int)status, tc_message());
        status ? refused++ : done++;
        if (!status && data.slab_count > most) most = data.slab_count;
        tc_mesh_destroy(slabs);
        tc_grid_destroy(grid);
        tc_context_destroy(context);
    }
    EXPECT(most >= 4 && done > 3 && refused, "%u budgets suffice, with up to %u slabs; %u do not", done, most, refused);
    tc_mesh_destroy(mesh);
}

/* Normals divide much: every way to divide gives the same bytes. */
static void test_divisions(subject *s) {
    tc_mesh *mesh = NULL;
    tc_mesh_data expected;
    subject_begin(s, TC_F32, (int64_t[3]){33, 17, 14});
    samples_fill(s, 20);
    points_fill(s, 0, 1);
    s->how.normals = 1;
    if (!extract(reference, &s->grid, &s->how, &mesh, &expected)) return;
    for (int division = 1; division <= 3; division++) {
        tc_context_options options;
        tc_expert_options expert;
        tc_context *context = NULL;
        options_init(&options, &expert);
        expert.division = (tc_division)division;
        tc_status status = tc_context_create(&options, &context);
        EXPECT(!status || (division < 3 && status == TC_ERROR_ARGUMENT), "division %d: %s", division, tc_message());
        if (!status) meshes_same(context, s, &expected, division == 3 ? "division in integers" : "division");
        tc_context_destroy(context);
    }
    tc_mesh_destroy(mesh);
}

/* --------------------------------------------------------------------------------------------------------- geometry */

/* A ball in the middle, in a type that has its centre exactly. */
static void ball_fill(subject *s) {
    for (int64_t n = 0; n < s->count; n++) {
        double p[3], distance = 0;
        place_of(s, n, p);
        for (int axis = 0; axis < 3; axis++) {
            double half = 0.5 * (double)(s->grid.dims[axis] - 1), from = (p[axis] - half) / half;
            distance += from * from;
        }
        sample_set(s->samples, s->grid.type, n, 120 - 100 * sqrt(distance));
    }
    s->how.isovalue = 50.25;
}

static bool reference_mesh(const subject *s, tc_mesh **mesh, tc_mesh_data *data) {
    *mesh = NULL;
    return extract(reference, &s->grid, &s->how, mesh, data);
}

static bool triangles_same(const tc_mesh_data *a, const tc_mesh_data *b) {
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           !memcmp(a->triangles, b->triangles, 12 * (size_t)a->triangle_count);
}

/* Coordinates of a uniform grid: the same triangles, positions and normals within rounding. */
static void test_uniform_twin(subject *s, int with_axes) {
    static const double spacing[3] = {0.5, 1.25, 2}, origin[3] = {-7, 3, 100};
    tc_mesh *uniform = NULL, *twin = NULL;
    tc_mesh_data a, b;
    double position_error = 0, normal_error = 0;
    subject_begin(s, TC_F32, (int64_t[3]){33, 20, 27});
    samples_fill(s, 2);
    s->how.normals = 1;
    for (int row = 0; row < 3; row++) s->grid.matrix[row][row] = spacing[row], s->grid.matrix[row][3] = origin[row];
    bool made = reference_mesh(s, &uniform, &a);
    for (int64_t n = 0; n < s->count; n++) {
        double p[3];
        place_of(s, n, p);
        for (int row = 0; row < 3; row++) {
            s->points[3 * n + row] = (float)(origin[row] + spacing[row] * p[row]);
            s->axes[row][(int)p[row]] = s->points[3 * n + row];
        }
    }
    if (with_axes)
        for (int row = 0; row < 3; row++) s->grid.axes[row] = s->axes[row];
    else
        s->grid.points = s->points;
    made = made && reference_mesh(s, &twin, &b);
    EXPECT(made && triangles_same(&a, &b), "coordinates of a uniform grid change its triangles");
    for (uint64_t n = 0; made && n < 3 * a.vertex_count; n++) {
        position_error = fmax(position_error, fabs((double)a.positions[n] - (double)b.positions[n]));
        normal_error = fmax(normal_error, fabs((double)a.normals[n] - (double)b.normals[n]));
    }
    EXPECT(position_error < 4e-5 && normal_error < 2e-5,
           "coordinates of a uniform grid move vertices by %g, normals %g", position_error, normal_error);
    tc_mesh_destroy(uniform);
    tc_mesh_destroy(twin);
}

/* Any orientation, folded cells or collapsed edges: a closed surface that encloses a positive volume. */
static void expect_outward(const subject *s, const char *what) {
    tc_mesh *mesh;
    tc_mesh_data data;
    topology t;
    if (!reference_mesh(s, &mesh, &data)) return;
    topology_of(data.positions, data.vertex_count, data.triangles, data.triangle_count, &t);
    EXPECT(!t.boundary_edges && !t.bad_edges && t.euler_characteristic == 2 && t.volume > 0,
           "%s: %llu boundary edges, Euler characteristic %lld, volume %g", what, (unsigned long long)t.boundary_edges,
           (long long)t.euler_characteristic, t.volume);
    for (uint64_t n = 0; n < 3 * data.vertex_count; n++)
        if (!isfinite(data.positions[n]) || (data.normals && !isfinite(data.normals[n]))) {
            EXPECT(false, "%s: number %llu of the vertices is not finite", what, (unsigned long long)n);
            break;
        }
    tc_mesh_destroy(mesh);
    subject_compare(s, 1u << WHOLE | 1u << IN_ROWS);
}

static void test_winding(subject *s) {
    for (int turned = 0; turned < 8; turned++) {
        subject_begin(s, TC_F32, (int64_t[3]){17, 18, 19});
        ball_fill(s);
        s->how.normals = 1;
        points_fill(s, turned, 0);
        expect_outward(s, "mirrored points");
        sample_set(s->samples, TC_F32, 0, (double)NAN); /* what is missing may be anywhere */
        s->points[0] = s->points[1] = s->points[2] = -9999;
        expect_outward(s, "a missing sample far away");
        sample_set(s->samples, TC_F32, 0, -1000);
        s->grid.has_nodata = 1, s->grid.nodata = -1000;
        expect_outward(s, "a sample of the missing value far away");
        s->grid.has_nodata = 0;
        s->grid.points = NULL;
        axes_fill(s, turned);
        expect_outward(s, "falling axes");
    }
}

/* Points i0 <= i of some rows drawn together, others folded back, beside others that are not. */
static void test_degenerate(subject *s) {
    for (int turned = 0; turned < 2; turned++)
        for (int kind = 0; kind < 4; kind++) {
            subject_begin(s, TC_F32, (int64_t[3]){17, 18, 19});
            ball_fill(s);
            s->how.normals = 1;
            points_fill(s, turned, 0);
            for (int64_t n = 0; n < s->count; n++) {
                double p[3];
                place_of(s, n, p);
                float *at = s->points + 3 * n;
                if (kind == 0 && p[0] < 5) memcpy(at, s->points + 3 * (n - (int64_t)p[0]), 12);
                if (kind == 1 && p[2] < 6) at[0] = at[1] = at[2] = 3;
                if (kind == 2 && (int)p[1] % 3 == 0) at[1] += 2.5f;
                if (kind == 3 && p[0] > 10) at[0] = turned ? -40.0f : 40.0f;
            }
            subject_compare(s, 1u << WHOLE | 1u << IN_ROWS);
            if (kind == 2) expect_outward(s, "folded cells");
        }
    for (int64_t n = 0; n < 3 * s->count; n++) s->points[n] = 1; /* all in one place: turned as the indices are */
    tc_mesh *here = NULL, *uniform = NULL;
    tc_mesh_data a, b;
    bool made = reference_mesh(s, &here, &a);
    s->grid.points = NULL;
    made = made && reference_mesh(s, &uniform, &b);
    EXPECT(made && triangles_same(&a, &b), "a grid that is one point has other triangles than index space");
    tc_mesh_destroy(here);
    tc_mesh_destroy(uniform);
}

/* A pyramid, beside a missing sample: all faces but those of its base lie in planes through the apex, the first point,
 * and only the base tells which way round the grid is. */
static void test_pyramid(subject *s) {
    for (int turned = 0; turned < 2; turned++) {
        subject_begin(s, TC_F32, (int64_t[3]){9, 9, 9});
        ball_fill(s);
        sample_set(s->samples, TC_F32, 8, (double)NAN);
        for (int64_t n = 0; n < s->count; n++) {
            double p[3];
            place_of(s, n, p);
            s->points[3 * n] = (float)((turned ? 8 - p[0] : p[0]) * p[2]);
            s->points[3 * n + 1] = (float)(p[1] * p[2]);
            s->points[3 * n + 2] = (float)p[2];
        }
        s->grid.points = s->points;
        expect_outward(s, turned ? "a mirrored pyramid" : "a pyramid");
    }
}

/* Where cells shrink by 10^8 the normals still are the gradient's. */
static void test_flat_cells(subject *s) {
    tc_mesh *mesh;
    tc_mesh_data data;
    subject_begin(s, TC_F32, (int64_t[3]){9, 9, 9});
    for (int64_t n = 0; n < s->count; n++) {
        double p[3];
        place_of(s, n, p);
        double q[3] = {1e8 * p[0], 1e-8 * p[1], p[2]};
        for (int row = 0; row < 3; row++) s->points[3 * n + row] = (float)q[row];
        sample_set(s->samples, TC_F32, n, p[1] + 0.5 * p[0] + 0.25 * p[2]);
    }
    s->grid.points = s->points;
    s->how.normals = 1;
    s->how.isovalue = 7.1;
    if (!reference_mesh(s, &mesh, &data)) return;
    double error = 0;
    for (uint64_t n = 0; n < data.vertex_count; n++)
        error = fmax(error, fabs((double)data.normals[3 * n + 1] + 1) + fabs((double)data.normals[3 * n]));
    EXPECT(data.vertex_count > 20 && error < 1e-5, "%llu normals in flat cells are off by %g",
           (unsigned long long)data.vertex_count, error);
    tc_mesh_destroy(mesh);
    subject_compare(s, 7);
}

/* --------------------------------------------------------------------------------------------------------- blanking */

/* NaN or a missing value at the same samples. */
static void test_blanks_as_missing(subject *s, tc_type type) {
    tc_mesh *blanked = NULL, *missing = NULL;
    tc_mesh_data a, b;
    subject_begin(s, type, (int64_t[3]){70, 19, 11});
    samples_fill(s, 3);
    points_fill(s, 0, 0.1);
    blanks_fill(s, 1, 0, 60);
    s->how.normals = 1;
    bool made = reference_mesh(s, &blanked, &a);
    for (int64_t n = 0; n < s->count; n++)
        if (s->blanked_samples[n]) sample_set(s->samples, type, n, type == TC_F32 ? (double)NAN : 127);
    s->grid.has_nodata = type != TC_F32;
    s->grid.nodata = 127;
    s->grid.blanked_samples = NULL;
    made = made && reference_mesh(s, &missing, &b);
    const char *difference = made ? mesh_difference(&a, &b) : "no mesh";
    EXPECT(!difference, "blanked samples of %s are not as missing ones: %s", tc_type_name(type), difference);
    tc_mesh_destroy(blanked);
    tc_mesh_destroy(missing);
    subject_compare(s, 7);
}

/* A blanked cell takes its triangles and nothing else. */
static void test_blanked_cell(subject *s) {
    tc_mesh *whole = NULL, *holed = NULL;
    tc_mesh_data a, b;
    subject_begin(s, TC_F32, (int64_t[3]){66, 10, 6});
    ball_fill(s);
    bool made = reference_mesh(s, &whole, &a);
    blanks_fill(s, 0, 1, 4);
    made = made && reference_mesh(s, &holed, &b);
    EXPECT(made && b.triangle_count < a.triangle_count && b.active_cell_count < a.active_cell_count,
           "blanked cells leave %llu triangles of %llu", (unsigned long long)b.triangle_count,
           (unsigned long long)a.triangle_count);
    tc_mesh_destroy(whole);
    tc_mesh_destroy(holed);
    memset(s->blanked_cells, 1, (size_t)s->cell_count);
    made = reference_mesh(s, &holed, &b);
    EXPECT(made && !b.triangle_count && !b.vertex_count, "a grid of blanked cells has a surface");
    tc_mesh_destroy(holed);
}

/* ----------------------------------------------------------------------------------------------------------- errors */

static void expect_refused(const subject *s, tc_status expected, const char *word) {
    tc_context *engines[2] = {reference, contexts[WHOLE]};
    for (int n = 0; n < 2 && engines[n]; n++) {
        tc_grid *grid = NULL;
        tc_status status = tc_grid_create(engines[n], &s->grid, &grid);
        EXPECT(status == expected && !grid && strstr(tc_message(), word), "status %d instead of %d with '%s': %s",
               (int)status, (int)expected, word, tc_message());
        tc_grid_destroy(grid);
    }
}

static void test_errors(subject *s) {
    subject_begin(s, TC_F32, (int64_t[3]){40, 40, 20});
    samples_fill(s, 0);
    points_fill(s, 0, 0);
    axes_fill(s, 0);
    expect_refused(s, TC_ERROR_ARGUMENT, "points");
    s->grid.points = NULL;
    s->grid.axes[1] = NULL;
    expect_refused(s, TC_ERROR_ARGUMENT, "axes");
    s->grid.axes[1] = s->axes[1];
    s->axes[1][7] = NAN;
    expect_refused(s, TC_ERROR_DATA, "position 7 along y");
    s->grid.axes[1] = (const float *)((const char *)s->axes[1] + 2);
    expect_refused(s, TC_ERROR_ARGUMENT, "aligned");
    memset(s->grid.axes, 0, sizeof s->grid.axes);
    s->grid.points = s->points;
    s->points[3 * 31234] = INFINITY;
    s->points[3 * 31999] = NAN;
    expect_refused(s, TC_ERROR_DATA, "point 34, 20, 19");
    s->points[3 * 31234] = 3e38f;
    expect_refused(s, TC_ERROR_DATA, "point 34, 20, 19");
    sample_set(s->samples, TC_F32, 31234, (double)NAN); /* a missing sample may be nowhere */
    expect_refused(s, TC_ERROR_DATA, "point 39, 39, 19");
    s->points[3 * 31999] = 1;
    subject_compare(s, 1u << WHOLE);
}

int main(int argc, char **argv) {
    static subject s;
    const bool groups = argc > 1 && !strcmp(argv[1], "groups"), alone = argc > 1 && !strcmp(argv[1], "alone");
    random_state = 5;
    reference = reference_open();
    if (device_exists())
        for (int n = 0; n < CONTEXTS; n++) {
            if (n == IN_ROWS ? alone : groups) continue;
            tc_context_options options;
            tc_expert_options expert;
            options_init(&options, &expert);
            expert.work_items = n == IN_ROWS ? 32 : 1;
            expert.always_copy = n == COPIED;
            contexts[n] = context_open(&options);
        }
    test_engines(&s, TC_F32, 0, 7);
    test_engines(&s, TC_F32, 1, 7);
    test_engines(&s, TC_U8, 0, 1u << WHOLE | 1u << COPIED);
    test_engines(&s, TC_U32, 0, 1u << WHOLE | 1u << COPIED);
    test_engines(&s, TC_F64, 0, 1u << WHOLE | 1u << COPIED);
    test_engines(&s, TC_F32, 2, 7);
    for (int kind = 0; contexts[WHOLE] && kind < 3 && test_chosen("budgets"); kind++)
        for (int always_copy = 0; always_copy < 2; always_copy++) test_budgets(&s, kind, always_copy);
    if (contexts[WHOLE]) test_divisions(&s);
    test_uniform_twin(&s, 0);
    test_uniform_twin(&s, 1);
    test_winding(&s);
    test_degenerate(&s);
    test_pyramid(&s);
    test_flat_cells(&s);
    test_blanks_as_missing(&s, TC_F32);
    test_blanks_as_missing(&s, TC_U8);
    test_blanked_cell(&s);
    test_errors(&s);
    for (int n = 0; n < CONTEXTS; n++) tc_context_destroy(contexts[n]);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
