/*
 * test_device.c - the device's mesh is the reference's, byte for byte, however the work is cut
 *
 * Variations: work-group sizes and counts, tiles, waiting of the scan, ways to divide, memory budgets (slabs), matrices
 * and first indices, meshes and grids used again. The reference's meshes are checked whole against their grids.
 *
 * Usage: test_device [always_copy|hybrid|snap|closed]...: with always_copy, samples and meshes are copied even where
 * the device shares the memory; with hybrid or snap, surfaces are those of the method, which test_hybrid or test_snap
 * checks against their grids; with closed they are closed, as test_closed checks.
 */
#include "engines.h"
#include "random.h"
#include "samples.h"
#include "topology.h"

#include <math.h>

/* A grid, how to extract it, and what has to come out. */
typedef struct subject {
    const char *name;
    tc_grid_options grid;
    tc_extract_options how;
    tc_mesh *mesh;
    tc_mesh_data expected;
    uint64_t hash;
} subject;

enum { WAVES, MISSING, EXTREMES, HALVES, GENTLE, GENTLE_MISSING, SUBJECTS };

static subject subjects[SUBJECTS];
static int always_copy; /* whether contexts on the device copy samples and meshes */
static tc_method method;
static int closed;

/* What is wrong with a mesh of the tetrahedra. */
static const char *walk_fault(const tc_grid_options *grid, double isovalue, const tc_mesh_data *mesh) {
    return method == TC_METHOD_TETRA && !closed ? mesh_fault(grid, isovalue, mesh) : NULL;
}

/* -------------------------------------------------------------------------------------------------------- subjects */

static double wave_at(const int64_t p[3]) {
    double x = 0.31 * (double)p[0], y = 0.27 * (double)p[1], z = 0.35 * (double)p[2];
    return sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x);
}

/* Any finite number, all exponents alike. */
static double random_f32(void) {
    float value;
    do {
        uint32_t bits = (uint32_t)random_u64();
        memcpy(&value, &bits, sizeof value);
    } while (!isfinite(value));
    return (double)value;
}

/* Between 0, at x = 0, and these a crossing of 147 * 2^-149 lies half way between two subnormal floats; 98 and 2 also
 * tell apart products with a rounded reciprocal. */
static double half_way_value(const int64_t p[3]) {
    static const double values[] = {98, 294, 42, 14, 6, 2};
    return p[0] ? values[(p[1] + 2 * p[2]) % 6] : 0;
}

static double subject_value(int kind, const int64_t p[3]) {
    if (kind == WAVES) return 127.5 + 60 * wave_at(p);
    if (kind == EXTREMES) return random_f32();
    if (kind == HALVES) return half_way_value(p);
    if (kind == GENTLE) { /* layers in the middle emit nothing */
        double inside = fmax(0, 60 - 3 * fabs((double)p[2] - 48));
        return fmin(255, fmax(0, 127.5 + 4 * ((double)p[0] + 5 * wave_at(p) - 30 + inside)));
    }
    /* many, so that edges lose all of their cubes, by samples on both sides of where slabs meet */
    if (random_below(kind == GENTLE_MISSING ? 20 : 300) == 0) return (double)NAN;
    if (kind == GENTLE_MISSING && method == TC_METHOD_SNAP && (p[0] < 16 || !tier_is_quick()))
        return random_between(-1, 1); /* kernels that take long, too */
    return kind == GENTLE_MISSING ? (double)p[0] - 2.2 * (double)p[1] + 2 * wave_at(p) : wave_at(p);
}

/* Few kinds of kernels serve all, as PoCL takes long to build one: bytes without normals, floats with them. */
static void subject_open(int kind, const char *name, tc_type type, const int64_t dims[3], double isovalue) {
    subject *s = &subjects[kind];
    int64_t n = 0;
    s->name = name;
    tc_grid_options_init(&s->grid);
    tc_extract_options_init(&s->how);
    memcpy(s->grid.dims, dims, sizeof s->grid.dims);
    s->grid.type = type;
    s->how.isovalue = isovalue;
    s->how.normals = type == TC_F32;
    s->how.method = method;
    s->how.closed = closed;
    void *samples = malloc((size_t)(dims[0] * dims[1] * dims[2]) * tc_type_bytes(type));
    if (!samples) exit(EXIT_FAILURE);
    for (int64_t z = 0; z < dims[2]; z++)
        for (int64_t y = 0; y < dims[1]; y++)
            for (int64_t x = 0; x < dims[0]; x++)
                sample_set(samples, type, n++, subject_value(kind, (int64_t[3]){x, y, z}));
    s->grid.samples = samples;
    tc_context *reference = reference_open();
    if (!extract(reference, &s->grid, &s->how, &s->mesh, &s->expected)) exit(EXIT_FAILURE);
    const char *fault = walk_fault(&s->grid, isovalue, &s->expected);
    EXPECT(!fault, "%s: reference: %s", name, fault);
    s->hash = mesh_bytes_hash(&s->expected);
    tc_context_destroy(reference);
}

static void subject_close(subject *s) {
    tc_mesh_destroy(s->mesh);
    free((void *)(uintptr_t)s->grid.samples);
}

/* The mesh is the subject's; how names the variation. */
static void expect_mesh(const subject *s, const tc_mesh_data *data, const char *how) {
    const char *difference = mesh_difference(&s->expected, data);
    EXPECT(!difference, "%s, %s: %s", s->name, how, difference);
    if (difference) return;
    uint64_t hash = mesh_bytes_hash(data);
    EXPECT(hash == s->hash, "%s, %s: hash %llx, not %llx", s->name, how, (unsigned long long)hash,
           (unsigned long long)s->hash);
}

static void expect_variation(const tc_context_options *options, const subject *s) {
    char how[160];
    tc_mesh_data data;
    tc_mesh *mesh = NULL;
    const tc_expert_options *e = options->expert;
    snprintf(how, sizeof how, "%u work-items, %u groups, tiles of %u, %u polls, division %d", e->work_items,
             e->work_groups, e->tile_bricks, e->spin_limit, (int)e->division);
    if (!test_chosen(how)) return;
    tc_context *context = context_open(options);
    for (uint32_t repeat = 0; repeat < (e->spin_limit ? 3 : 1); repeat++)
        if (extract(context, &s->grid, &s->how, &mesh, &data)) expect_mesh(s, &data, how);
    tc_mesh_destroy(mesh);
    tc_context_destroy(context);
}

/* ------------------------------------------------------------------------------------------------------------ work */

static void test_work_shapes(int first, int end) {
    static const uint32_t items[] = {1, 32, 64, 256}, groups[] = {1, 2, 3, 16}, tiles[] = {1, 27, 7, 1000};
    tc_context_options options;
    tc_expert_options expert;
    for (int i = first; i < end; i++) {
        const subject *s = &subjects[i & 1 ? MISSING : WAVES];
        for (int n = 0; n < 4; n++) {
            options_init(&options, &expert);
            expert.always_copy = always_copy;
            expert.work_items = items[i];
            expert.work_groups = groups[n];
            expert.tile_bricks = tiles[(n + i) % 4];
            expect_variation(&options, s);
            expert.work_groups = 16;
            expert.tile_bricks = tiles[n];
            expert.spin_limit = 1;
            expect_variation(&options, s);
        }
    }
}

static void test_divisions(void) {
    for (int division = 1; division <= 3; division++) {
        tc_context_options options;
        tc_expert_options expert;
        tc_context *context = NULL;
        options_init(&options, &expert);
        expert.always_copy = always_copy;
        expert.division = (tc_division)division;
        tc_status status = tc_context_create(&options, &context);
        tc_context_destroy(context);
        EXPECT(status == TC_OK || (division < 3 && status == TC_ERROR_ARGUMENT), "division %d: status %d, %s", division,
               (int)status, tc_message());
        for (int n = EXTREMES; n <= HALVES && !status; n++) expect_variation(&options, &subjects[n]);
    }
}

/* ---------------------------------------------------------------------------------------------------------- memory */

/* By how much the next budget is less. Above what holds the whole, where there is one slab, the quick tier tries few.
 */
static uint64_t budget_step(uint64_t budget, uint64_t whole) {
    const unsigned more = method == TC_METHOD_SNAP; /* it has more kinds of plans */
    const uint64_t steps = tier_is_quick() ? 5 + 2 * more : UINT64_C(10) << more;
    return budget / (tier_is_quick() && budget > 2 * whole ? 3 : steps);
}

/* Same bytes at every budget that suffices, in one slab, in few, in many; the bound is kept. The quick tier tries
 * fewer: PoCL takes most of the time to open a context for each. */
static void test_memory_budgets(const subject *s) {
    uint32_t most = 0;
    bool one = false, few = false;
    unsigned done = 0, refused = 0;
    tc_context_options options;
    tc_expert_options expert;
    if (!test_chosen("memory budgets") && !test_chosen(s->name)) return;
    options_init(&options, &expert);
    expert.always_copy = always_copy;
    uint64_t whole = (uint64_t)(s->grid.dims[0] * s->grid.dims[1] * s->grid.dims[2]) * tc_type_bytes(s->grid.type) +
                     24 * s->expected.vertex_count + 12 * s->expected.triangle_count;
    for (options.max_memory_bytes = 16 * whole; options.max_memory_bytes > whole / 200;
         options.max_memory_bytes -= budget_step(options.max_memory_bytes, whole)) {
        tc_context *context = context_open(&options);
        tc_grid *grid = NULL;
        tc_mesh *mesh = NULL;
        tc_mesh_data data = {.struct_size = sizeof data};
        tc_status status = tc_grid_create(context, &s->grid, &grid);
        if (!status) status = tc_extract(grid, &s->how, &mesh);
        if (!status) status = tc_mesh_get(mesh, &data);
        expect_within(context, options.max_memory_bytes, s->name);
        if (status) {
            refused++;
            EXPECT(status == TC_ERROR_MEMORY && !mesh && strstr(tc_message(), "byte"), "%s, budget %llu: status %d, %s",
                   s->name, (unsigned long long)options.max_memory_bytes, (int)status, tc_message());
        } else {
            done++;
            EXPECT(!refused, "%s: a budget of %llu suffices, a larger one did not", s->name,
                   (unsigned long long)options.max_memory_bytes);
            most = data.slab_count > most ? data.slab_count : most;
            one = one || data.slab_count == 1;
            few = few || (data.slab_count > 1 && data.slab_count < 6);
            expect_mesh(s, &data, "with a memory budget");
        }
        tc_mesh_destroy(mesh);
        tc_grid_destroy(grid);
        tc_context_destroy(context);
    }
    EXPECT(one && few && most >= 4 && done > 5 && refused, "%s: %u budgets suffice, with up to %u slabs; %u do not",
           s->name, done, most, refused);
}

/* ----------------------------------------------------------------------------------------------------- world space */

static void ball_make(uint8_t *samples, int64_t size) {
    double centre = 0.5 * (double)(size - 1);
    for (int64_t n = 0; n < size * size * size; n++) {
        double x = (double)(n % size) - centre, y = (double)(n / size % size) - centre;
        double z = (double)(n / size / size) - centre;
        samples[n] = (uint8_t)fmax(0, 200 - 180 * sqrt(x * x + y * y + z * z) / centre);
    }
}

/* Any matrix and first index: the closed surface has positive volume in world space. */
static void test_world_space(tc_context *reference, tc_context *device) {
    enum { SIZE = 21 };
    static uint8_t samples[SIZE * SIZE * SIZE];
    static const double matrices[][3][4] = {
        {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},          {{0.5, 0, 0, 7}, {0, 1.25, 0, -3}, {0, 0, 4, 100}},
        {{-1, 0, 0, 20}, {0, 1, 0, 0}, {0, 0, 1, 0}},        {{-2, 0, 0, 0}, {0, -0.3, 0, 0}, {0, 0, -1, 0}},
        {{1, 0.4, 0, 0}, {0, 1, -0.7, 0}, {0.2, 0, 1, -50}}, {{0, 1, 0, 5}, {1, 0, 0, 0}, {0, 0, 1, 0}},
        {{0, 0, 3, 0}, {2, 0, 0, 1}, {0, 1, 0, 2}},          {{0.6, -0.8, 0, 0}, {0.8, 0.6, 0, 0}, {0, 0, -1e-3, 0}},
    };
    static const int64_t firsts[][3] = {{0, 0, 0}, {1, 0, 0}, {-7, 12, -20}, {1001, -5000, 3}};
    ball_make(samples, SIZE);
    for (int m = 0; m < 8; m++)
        for (int f = 0; f < 4; f++) {
            subject s = {.name = "a ball in world space"};
            tc_mesh *mesh = NULL;
            tc_mesh_data data;
            topology t;
            tc_grid_options_init(&s.grid);
            tc_extract_options_init(&s.how);
            for (int axis = 0; axis < 3; axis++) s.grid.dims[axis] = SIZE;
            memcpy(s.grid.matrix, matrices[m], sizeof s.grid.matrix);
            memcpy(s.grid.first_index, firsts[f], sizeof s.grid.first_index);
            s.grid.samples = samples;
            s.how.isovalue = 100.5;
            s.how.normals = 1;
            s.how.method = method;
            s.how.closed = closed;
            if (!extract(reference, &s.grid, &s.how, &s.mesh, &s.expected)) return;
            if (!extract(device, &s.grid, &s.how, &mesh, &data)) return;
            s.hash = mesh_bytes_hash(&s.expected);
            expect_mesh(&s, &data, "matrices and first indices");
            const char *fault = walk_fault(&s.grid, s.how.isovalue, &data);
            EXPECT(!fault, "matrix %d, first %d: %s", m, f, fault);
            topology_of(data.positions, data.vertex_count, data.triangles, data.triangle_count, &t);
            EXPECT(t.boundary_edges == 0 && t.euler_characteristic == 2 && t.volume > 0,
                   "matrix %d, first %d: %llu boundary edges, Euler characteristic %lld, volume %g", m, f,
                   (unsigned long long)t.boundary_edges, (long long)t.euler_characteristic, t.volume);
            tc_mesh_destroy(s.mesh);
            tc_mesh_destroy(mesh);
        }
}

/* ------------------------------------------------------------------------------------------------------ used again */

/* One grid, one mesh, many isovalues; counts alone agree. Another mesh, made for each, is the measure. */
static void test_reuse(tc_context *device) {
    static const double isovalues[] = {127.5, 20, 240, 127.5, -5, 100, 300, 187.25, 64};
    tc_grid *grid = NULL;
    tc_mesh *kept = NULL;
    EXPECT(tc_grid_create(device, &subjects[WAVES].grid, &grid) == TC_OK, "no grid: %s", tc_message());
    for (size_t n = 0; n < sizeof isovalues / sizeof *isovalues && grid; n++) {
        tc_extract_options how = subjects[WAVES].how;
        tc_mesh *fresh = NULL;
        tc_mesh_data a = {.struct_size = sizeof a}, b = {.struct_size = sizeof b};
        tc_counts counts = {.struct_size = sizeof counts};
        how.isovalue = isovalues[n];
        tc_status status = tc_count(grid, &how, &counts);
        if (!status) status = tc_extract(grid, &how, &fresh);
        if (!status) status = tc_mesh_get(fresh, &a);
        if (!status) status = tc_extract(grid, &how, &kept);
        if (!status) status = tc_mesh_get(kept, &b);
        EXPECT(status == TC_OK, "isovalue %g: %s", how.isovalue, tc_message());
        const char *difference = mesh_difference(&a, &b);
        EXPECT(!difference, "isovalue %g, mesh used again: %s", how.isovalue, difference);
        EXPECT(counts.vertex_count == a.vertex_count && counts.triangle_count == a.triangle_count &&
                   counts.active_cell_count == a.active_cell_count &&
                   counts.mesh_bytes == (how.normals ? 24 : 12) * a.vertex_count + 12 * a.triangle_count,
               "isovalue %g: counting alone gives %llu vertices, %llu triangles", how.isovalue,
               (unsigned long long)counts.vertex_count, (unsigned long long)counts.triangle_count);
        const char *fault = walk_fault(&subjects[WAVES].grid, how.isovalue, &b);
        EXPECT(!fault, "isovalue %g: %s", how.isovalue, fault);
        tc_mesh_destroy(fresh);
    }
    tc_grid_destroy(grid);
    tc_mesh_data last;
    for (int n = 0; n < SUBJECTS; n++)
        if (extract(device, &subjects[n].grid, &subjects[n].how, &kept, &last))
            expect_mesh(&subjects[n], &last, "into a mesh of another grid");
    tc_mesh_destroy(kept);
}

/* ----------------------------------------------------------------------------------------------------- convergence */

/* A sphere of radius 0.7 in [-1, 1]^3: halving the spacing quarters the errors of radius and volume. */
static void test_sphere_converges(tc_context *device) {
    const double radius = 0.7, volume = 4.0 / 3 * 3.14159265358979323846 * radius * radius * radius;
    double radius_errors[3] = {0}, volume_errors[3] = {0};
    for (int level = 0; level < 3; level++) {
        int64_t size = (8 << level) + 1;
        double spacing = 2.0 / (double)(size - 1);
        tc_grid_options grid;
        tc_extract_options how;
        tc_mesh *mesh = NULL;
        tc_mesh_data data;
        topology t;
        tc_grid_options_init(&grid);
        tc_extract_options_init(&how);
        float *samples = malloc((size_t)(size * size * size) * sizeof *samples);
        if (!samples) exit(EXIT_FAILURE);
        for (int axis = 0; axis < 3; axis++) {
            grid.dims[axis] = size;
            grid.matrix[axis][axis] = spacing;
            grid.matrix[axis][3] = -1;
        }
        for (int64_t n = 0; n < size * size * size; n++) {
            double x = spacing * (double)(n % size) - 1, y = spacing * (double)(n / size % size) - 1;
            double z = spacing * (double)(n / size / size) - 1;
            samples[n] = (float)-sqrt(x * x + y * y + z * z);
        }
        grid.type = TC_F32;
        grid.samples = samples;
        how.isovalue = -radius;
        how.normals = 1;
        how.method = method;
        if (extract(device, &grid, &how, &mesh, &data)) {
            topology_of(data.positions, data.vertex_count, data.triangles, data.triangle_count, &t);
            volume_errors[level] = fabs(t.volume - volume);
            for (uint64_t v = 0; v < data.vertex_count; v++) {
                const float *p = data.positions + 3 * v;
                double r =
                    sqrt((double)p[0] * (double)p[0] + (double)p[1] * (double)p[1] + (double)p[2] * (double)p[2]);
                radius_errors[level] = fmax(radius_errors[level], fabs(r - radius));
            }
        }
        tc_mesh_destroy(mesh);
        free(samples);
    }
    for (int level = 1; level < 3; level++)
        EXPECT(radius_errors[level] > 0 && radius_errors[level] < radius_errors[level - 1] / 2.5 &&
                   volume_errors[level] < volume_errors[level - 1] / 3,
               "level %d: radius is off by %g after %g, volume by %g after %g", level, radius_errors[level],
               radius_errors[level - 1], volume_errors[level], volume_errors[level - 1]);
    EXPECT(volume_errors[2] < 0.005 * volume, "volume is off by %g", volume_errors[2]);
}

/* The device is described as it is, also where its sharing of memory is not made use of. */
static void test_description(const tc_context *device) {
    tc_device_info told = {.struct_size = sizeof told}, real = {.struct_size = sizeof real};
    int count = 0;
    EXPECT(!tc_context_device(device, &told) && !tc_device_count(&count), "no description: %s", tc_message());
    for (int n = 0; n < count; n++)
        if (!tc_device_get(n, &real) && real.platform_index == told.platform_index &&
            real.device_index == told.device_index)
            EXPECT(!memcmp(&real, &told, sizeof real), "%s is described in two ways", told.name);
}

/* What host/include/README.md promises of a device's memory beyond samples and mesh, with what small buffers come to
 * beside it. Snap has words of zeros besides, and more cases. */
static void test_memory_per_sample(void) {
    const int64_t dims[3] = {256, 160, 160};
    const bool zeros = method == TC_METHOD_SNAP;
    const double promised[2] = {zeros ? 0.41 : 0.285, zeros ? 0.535 : 0.41}, fixed = zeros ? 620e3 : 200e3;
    const size_t count = (size_t)(dims[0] * dims[1] * dims[2]);
    void *samples = malloc(count * sizeof(float));
    for (int missing = 0; missing < 2; missing++) {
        tc_context_options options;
        tc_expert_options expert;
        tc_grid_options grid;
        tc_extract_options how;
        tc_mesh *mesh = NULL;
        tc_mesh_data data;
        uint64_t peak = 0;
        options_init(&options, &expert);
        expert.always_copy = always_copy;
        tc_grid_options_init(&grid);
        tc_extract_options_init(&how);
        memcpy(grid.dims, dims, sizeof dims);
        grid.type = missing ? TC_F32 : TC_U8;
        grid.samples = samples;
        for (size_t n = 0; n < count; n++) sample_set(samples, grid.type, (int64_t)n, (double)(n % 251 * 255 / 250));
        grid.has_nodata = missing;
        grid.nodata = 3;
        how.isovalue = 250;
        how.normals = missing;
        how.method = method;
        how.closed = closed;
        tc_context *context = context_open(&options);
        if (extract(context, &grid, &how, &mesh, &data)) {
            tc_context_device_bytes(context, &peak);
            double mesh_bytes = (how.normals ? 24 : 12) * (double)data.vertex_count + 12 * (double)data.triangle_count;
            double beyond = (double)peak - (double)(count * tc_type_bytes(grid.type)) - mesh_bytes;
            EXPECT(beyond <= promised[missing] * (double)count + fixed, "%g bytes per sample beyond samples and mesh%s",
                   beyond / (double)count, missing ? ", with missing samples" : "");
        }
        tc_mesh_destroy(mesh);
        tc_context_destroy(context);
    }
    free(samples);
}

int main(int argc, char **argv) {
    for (int n = 1; n < argc; n++) {
        always_copy = always_copy || !strcmp(argv[n], "always_copy");
        closed = closed || !strcmp(argv[n], "closed");
        for (int m = 0; tc_method_name((tc_method)m); m++)
            if (!strcmp(argv[n], tc_method_name((tc_method)m))) method = (tc_method)m;
    }
    if (!device_exists()) return SKIPPED;
    tc_context_options options;
    tc_expert_options expert;
    random_state = 1996;
    subject_open(WAVES, "waves", TC_U8, (int64_t[3]){130, 21, 30}, 127.5);
    subject_open(MISSING, "waves with missing samples", TC_F32, (int64_t[3]){70, 18, 22}, 0.1);
    subject_open(EXTREMES, "all floats", TC_F32, (int64_t[3]){20, 19, 18}, 1e-3);
    subject_open(HALVES, "crossings half way between floats", TC_F32, (int64_t[3]){2, 9, 9}, 0x93p-149);
    const bool large = method == TC_METHOD_SNAP; /* its windows of slabs are five layers and more */
    subject_open(GENTLE, "gentle waves", TC_U8, (int64_t[3]){67, large ? 160 : 46, large ? 297 : 97}, 127.5);
    subject_open(GENTLE_MISSING, "gentle waves with missing samples", TC_F32,
                 (int64_t[3]){65, large ? 92 : 31, large ? 137 : 58}, 0.1);
    options_init(&options, &expert);
    expert.always_copy = always_copy;
    tc_context *reference = reference_open(), *device = context_open(&options);
    test_work_shapes(0, 1);
    test_divisions();
    test_memory_budgets(&subjects[GENTLE]);
    /* closed ones by snap: PoCL takes ten seconds to optimise these kernels */
    if (!tier_is_quick() || !closed || method != TC_METHOD_SNAP) test_memory_budgets(&subjects[GENTLE_MISSING]);
    if (test_chosen("world space")) test_world_space(reference, device);
    if (test_chosen("used again")) test_reuse(device);
    if (test_chosen("description")) test_description(device);
    if (test_chosen("convergence") && method != TC_METHOD_SNAP) test_sphere_converges(device);
    if (test_chosen("memory per sample")) test_memory_per_sample();
    groups_begin();
    /* building for many work-items takes PoCL long */
    test_work_shapes(1, method == TC_METHOD_TETRA && (!closed || !tier_is_quick()) ? 4 : 2);
    tc_context_destroy(reference);
    tc_context_destroy(device);
    for (int n = 0; n < SUBJECTS; n++) subject_close(&subjects[n]);
    return EXPECT_DONE();
}
