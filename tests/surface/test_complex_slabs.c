/*
 * test_complex_slabs.c - complexes under bounds on memory, slab by slab: the same bytes as the reference, never more
 * device memory than allowed, and a refusal that says what would do
 *
 * Usage: test_complex_slabs [always_copy|large]: as on a device with memory of its own; complexes of millions of
 * tetrahedra.
 */
#include "cut.h"
#include "engines.h"
#include "random.h"
#include "samples.h"

#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>

static tc_context *reference;
static bool always_copy;

/* ------------------------------------------------------------------------------------------------------- complexes */

/* A complex with what it points to; options is the view of it. */
typedef struct subject {
    char name[80];
    tc_tetrahedra_grid_options options;
    float *points;
    uint32_t *tetrahedra;
    void *values;
    double isovalues[3];
} subject;

static subject subject_make(const char *name, tc_type type, uint64_t points, uint64_t tetrahedra) {
    subject s = {.points = malloc(12 * points), .tetrahedra = malloc(16 * tetrahedra), .values = malloc(8 * points)};
    if (!s.points || !s.tetrahedra || !s.values) exit(EXIT_FAILURE);
    snprintf(s.name, sizeof s.name, "%s", name);
    tc_tetrahedra_grid_options_init(&s.options);
    s.options.type = type, s.options.samples = s.values;
    s.options.point_count = points, s.options.points = s.points;
    s.options.tetrahedron_count = tetrahedra, s.options.tetrahedra = s.tetrahedra;
    return s;
}

static void subject_free(subject *s) {
    free(s->points);
    free(s->tetrahedra);
    free(s->values);
}

static void tetrahedra_shuffle(subject *s) {
    for (uint32_t n = (uint32_t)s->options.tetrahedron_count - 1; n > 0; n--) {
        uint32_t other = random_below(n + 1), t[4];
        memcpy(t, s->tetrahedra + 4 * n, 16);
        memcpy(s->tetrahedra + 4 * n, s->tetrahedra + 4 * other, 16);
        memcpy(s->tetrahedra + 4 * other, t, 16);
    }
}

/* Few values, so that a surface is everywhere, with ties; holes: and samples that are missing. Shuffled, tetrahedra
 * that share edges are far from each other. */
static subject block_make(tc_type type, uint32_t size, bool holes, bool shuffled) {
    char name[80];
    snprintf(name, sizeof name, "block of %u, %s%s%s", size, tc_type_name(type), holes ? ", holes" : "",
             shuffled ? ", shuffled" : "");
    cell_list list = mixed_block_make(size, random_u64());
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, name);
    subject s = subject_make(name, type, list.point_count, complex.tetrahedron_count);
    memcpy(s.points, list.points, 12 * list.point_count);
    memcpy(s.tetrahedra, complex.tetrahedra, 16 * complex.tetrahedron_count);
    for (uint64_t n = 0; n < list.point_count; n++) {
        static const double odd[3] = {NAN, INFINITY, -INFINITY};
        bool missing = holes && random_below(20) == 0;
        sample_set(s.values, type, (int64_t)n, missing ? odd[random_below(3)] : (double)random_below(5));
    }
    s.isovalues[0] = s.isovalues[2] = 2, s.isovalues[1] = 0.5;
    if (shuffled) tetrahedra_shuffle(&s);
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
    return s;
}

/* No tetrahedron shares a point with another, and most have four crossed edges: what slabs have to have room for. */
static subject scattered_make(uint32_t count) {
    subject s = subject_make("scattered tetrahedra", TC_U8, 4 * count, count);
    for (uint32_t n = 0; n < 4 * count; n++) {
        for (uint32_t axis = 0; axis < 3; axis++) s.points[3 * n + axis] = (float)random_between(-1, 1);
        sample_set(s.values, TC_U8, n, n / 2 % 2);
        s.tetrahedra[n] = 4 * count - 1 - n;
    }
    s.isovalues[0] = s.isovalues[1] = s.isovalues[2] = 1;
    return s;
}

/* All tetrahedra have one edge, which is crossed: a vertex for all slabs. */
static subject hub_make(uint32_t count) {
    subject s = subject_make("tetrahedra around an edge", TC_F32, count + 3, count);
    for (uint32_t n = 0; n < count + 3; n++) {
        for (uint32_t axis = 0; axis < 3; axis++) s.points[3 * n + axis] = (float)random_between(-1, 1);
        sample_set(s.values, TC_F32, n, n % 2);
        if (n < count) memcpy(s.tetrahedra + 4 * n, (uint32_t[]){n + 3, 1, n + 2, 0}, 16);
    }
    s.isovalues[0] = s.isovalues[2] = 0.25, s.isovalues[1] = 0.75;
    return s;
}

/* ------------------------------------------------------------------------------------------------------ comparison */

static tc_context *bounded_open(uint64_t budget, unsigned variant) {
    tc_context_options how;
    tc_expert_options expert;
    options_init(&how, &expert);
    how.max_memory_bytes = budget;
    expert.always_copy = always_copy;
    if (variant) expert.work_items = 32, expert.work_groups = 3, expert.tile_bricks = 1, expert.spin_limit = 1;
    return context_open(&how);
}

/* The surface of isovalue n is that in wanted, by tc_extract and by tc_count; returns its number of slabs. */
static uint32_t surface_compare(const subject *s, tc_grid *grid, tc_mesh **mesh, int n, tc_mesh *wanted,
                                uint64_t budget) {
    tc_extract_options options;
    tc_counts counts = {.struct_size = sizeof counts};
    tc_mesh_data data = {.struct_size = sizeof data}, first = {.struct_size = sizeof first};
    tc_extract_options_init(&options);
    options.isovalue = s->isovalues[n];
    tc_mesh_get(wanted, &first);
    if (random_below(2)) {
        EXPECT(!tc_count(grid, &options, &counts), "%s, %llu bytes: %s", s->name, (unsigned long long)budget,
               tc_message());
        EXPECT(counts.vertex_count == first.vertex_count && counts.triangle_count == first.triangle_count &&
                   counts.active_cell_count == first.active_cell_count,
               "%s, %llu bytes: counts differ", s->name, (unsigned long long)budget);
    }
    tc_status status = tc_extract(grid, &options, mesh);
    EXPECT(!status, "%s, %llu bytes: %s", s->name, (unsigned long long)budget, tc_message());
    if (status) return 0;
    tc_mesh_get(*mesh, &data);
    const char *difference = mesh_difference(&first, &data);
    EXPECT(!difference, "%s, %llu bytes, isovalue %g, %u slabs: %s", s->name, (unsigned long long)budget,
           options.isovalue, data.slab_count, difference);
    return data.slab_count;
}

static void surfaces_of_reference(const subject *s, tc_mesh *meshes[3]) {
    tc_grid *grid = NULL;
    EXPECT(!tc_tetrahedra_grid_create(reference, &s->options, &grid), "%s: %s", s->name, tc_message());
    for (int n = 0; n < 3; n++) {
        tc_extract_options options;
        tc_extract_options_init(&options);
        options.isovalue = s->isovalues[n];
        meshes[n] = NULL;
        EXPECT(!tc_extract(grid, &options, &meshes[n]), "%s: %s", s->name, tc_message());
    }
    tc_grid_destroy(grid);
}

/* Whether the budget does; *slabs: the most of any isovalue. */
static bool budget_compare(const subject *s, uint64_t budget, unsigned variant, tc_mesh *wanted[3], uint32_t *slabs) {
    tc_context *context = bounded_open(budget, variant);
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_status status = tc_tetrahedra_grid_create(context, &s->options, &grid);
    EXPECT(status == TC_OK || status == TC_ERROR_MEMORY, "%s: %s", s->name, tc_message());
    for (int n = 0; n < 3 && !status; n++) {
        uint32_t count = surface_compare(s, grid, &mesh, n, wanted[n], budget);
        if (count > *slabs) *slabs = count;
    }
    expect_within(context, budget, s->name);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return !status;
}

/* From more than enough down to the least that does. */
static void budgets_compare(subject s) {
    tc_mesh *wanted[3];
    uint64_t budget = 450 * s.options.tetrahedron_count;
    uint32_t slabs = 0;
    surfaces_of_reference(&s, wanted);
    for (unsigned variant = 0; budget_compare(&s, budget, variant, wanted, &slabs); variant = !variant)
        budget = budget / 20 * (slabs > 1 ? 11 : 17);
    const uint64_t least = bytes_advised(s.name);
    EXPECT(least > budget && slabs > s.options.tetrahedron_count / 200, "%s: refused at %llu bytes after %u slabs",
           s.name, (unsigned long long)budget, slabs);
    slabs = 0;
    EXPECT(budget_compare(&s, least, 0, wanted, &slabs), "%s: %s", s.name, tc_message());
    EXPECT(slabs >= s.options.tetrahedron_count / 16, "%s: %u slabs at the least", s.name, slabs);
    EXPECT(!budget_compare(&s, least - 1, 0, wanted, &slabs), "%s: less than the least does", s.name);
    for (int n = 0; n < 3; n++) tc_mesh_destroy(wanted[n]);
    subject_free(&s);
}

/* ----------------------------------------------------------------------------------------------------- other cases */

/* Whole while the surface is small; cut for the first that is not; two complexes take turns in one context. */
static void cut_later(void) {
    subject s = block_make(TC_U8, 12, false, false);
    tc_mesh *wanted[3], *mesh = NULL;
    uint32_t slabs[2][4];
    const int order[4] = {0, 1, 0, 1};
    uint64_t peak;
    memset(s.values, 0, s.options.point_count);
    for (uint64_t n = 0; n < s.options.point_count; n++)
        ((uint8_t *)s.values)[n] = n % 97 == 5 ? 200 : (uint8_t)(n % 2);
    s.isovalues[0] = s.isovalues[2] = 100, s.isovalues[1] = 1;
    surfaces_of_reference(&s, wanted);
    tc_context *context = bounded_open(0, 0);
    tc_grid *grids[2] = {NULL, NULL};
    EXPECT(!tc_tetrahedra_grid_create(context, &s.options, &grids[0]), "%s", tc_message());
    surface_compare(&s, grids[0], &mesh, 0, wanted[0], 0);
    tc_context_device_bytes(context, &peak);
    tc_grid_destroy(grids[0]);
    tc_context_destroy(context);
    context = bounded_open(2 * peak, 0); /* the second complex is created while the first one is there */
    for (int g = 0; g < 2; g++) EXPECT(!tc_tetrahedra_grid_create(context, &s.options, &grids[g]), "%s", tc_message());
    for (int n = 0; n < 4; n++)
        for (int g = 0; g < 2; g++)
            slabs[g][n] = surface_compare(&s, grids[g], &mesh, order[n], wanted[order[n]], 2 * peak);
    EXPECT(slabs[0][0] == 1 && slabs[0][1] > 1 && slabs[0][2] > 1, "slabs: %u, then %u and %u", slabs[0][0],
           slabs[0][1], slabs[0][2]);
    for (int g = 0; g < 2; g++) tc_grid_destroy(grids[g]);
    tc_context_destroy(context);
    for (int n = 0; n < 3; n++) tc_mesh_destroy(wanted[n]);
    tc_mesh_destroy(mesh);
    subject_free(&s);
}

/* A point that is not there, in the last slab. */
static void point_refused(uint64_t budget) {
    subject s = block_make(TC_U8, 9, false, false);
    tc_context *context = bounded_open(budget, 0);
    tc_extract_options options;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    char wanted[80];
    tc_extract_options_init(&options);
    options.isovalue = 2;
    s.tetrahedra[4 * s.options.tetrahedron_count - 2] = (uint32_t)s.options.point_count;
    snprintf(wanted, sizeof wanted, "tetrahedron %llu has point %llu",
             (unsigned long long)s.options.tetrahedron_count - 1, (unsigned long long)s.options.point_count);
    EXPECT(!tc_tetrahedra_grid_create(context, &s.options, &grid), "%s", tc_message());
    EXPECT_REFUSED(tc_extract(grid, &options, &mesh), TC_ERROR_DATA, "a point that is not there");
    EXPECT(strstr(tc_message(), wanted), "not told which: %s", tc_message());
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    subject_free(&s);
}

static int cancel_after, cancel_calls;
static double cancel_fraction;

static int cancel(void *user, const char *stage, double fraction) {
    (void)user, (void)stage;
    EXPECT(fraction >= cancel_fraction && fraction <= 1, "progress from %g to %g", cancel_fraction, fraction);
    cancel_fraction = fraction;
    return cancel_calls++ == cancel_after;
}

/* At every call of the callback in turn; what follows is right all the same. */
static void cancelled(uint64_t budget) {
    subject s = block_make(TC_U8, 5, false, false);
    tc_mesh *wanted[3], *mesh = NULL;
    tc_context_options how;
    tc_expert_options expert;
    tc_extract_options options;
    tc_grid *grid = NULL;
    surfaces_of_reference(&s, wanted);
    tc_extract_options_init(&options);
    options.isovalue = s.isovalues[0];
    options_init(&how, &expert);
    how.max_memory_bytes = budget, expert.always_copy = always_copy, how.progress = cancel;
    tc_context *context = context_open(&how);
    EXPECT(!tc_tetrahedra_grid_create(context, &s.options, &grid), "%s", tc_message());
    for (cancel_after = 0;; cancel_after++) {
        cancel_calls = 0, cancel_fraction = 0;
        tc_status status = tc_extract(grid, &options, &mesh);
        if (cancel_calls <= cancel_after) break;
        EXPECT(status == TC_ERROR_CANCELLED, "not cancelled: %s", tc_message());
    }
    EXPECT(cancel_after > 6, "%d calls of the callback", cancel_after);
    cancel_fraction = 0;
    tc_mesh_data data = {.struct_size = sizeof data}, first = {.struct_size = sizeof first};
    tc_mesh_get(mesh, &data), tc_mesh_get(wanted[0], &first);
    EXPECT(!mesh_difference(&first, &data), "after cancelling");
    for (int n = 0; n < 3; n++) tc_mesh_destroy(wanted[n]);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    subject_free(&s);
}

/* ----------------------------------------------------------------------------------------------------------- large */

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Ten million tetrahedra: a sphere in a grid of 127^3 samples sent through the converter. */
static void sphere_compare(void) {
    enum { N = 127, COUNT = N * N * N };
    tc_grid_options g;
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    tc_mesh *wanted[3];
    subject s = subject_make("sphere", TC_F32, COUNT, 1);
    tc_grid_options_init(&g);
    g.dims[0] = g.dims[1] = g.dims[2] = N, g.type = TC_F32, g.samples = s.values;
    for (int n = 0; n < COUNT; n++) {
        const int k = n / (N * N), j = n / N % N, i = n % N;
        const double x = i - 62.7, y = j - 63.1, z = k - 62.9;
        sample_set(s.values, TC_F32, n, sqrt(x * x + y * y + z * z));
        s.points[3 * n] = (float)x, s.points[3 * n + 1] = (float)y, s.points[3 * n + 2] = (float)z;
    }
    s.isovalues[0] = 40, s.isovalues[1] = 20.5, s.isovalues[2] = 61;
    EXPECT(!tc_tetrahedralize_grid(&g, &complex), "%s", tc_message());
    s.options.tetrahedron_count = complex.tetrahedron_count, s.options.tetrahedra = complex.tetrahedra;
    surfaces_of_reference(&s, wanted);
    static const uint64_t budgets[] = {UINT64_C(1) << 40, 192 << 20, 64 << 20, 16 << 20};
    for (int n = 0; n < 4; n++) {
        uint32_t slabs = 0;
        double start = seconds();
        EXPECT(budget_compare(&s, budgets[n], 0, wanted, &slabs), "%s", tc_message());
        printf("%llu tetrahedra, three isovalues in %llu MB: %u slabs, %.2f s\n",
               (unsigned long long)complex.tetrahedron_count, (unsigned long long)(budgets[n] >> 20), slabs,
               seconds() - start);
        EXPECT((slabs > 1) == (n > 0), "%u slabs", slabs);
    }
    for (int n = 0; n < 3; n++) tc_mesh_destroy(wanted[n]);
    tc_tetrahedra_release(&complex);
    subject_free(&s);
}

/* Memory that is zero, and takes none of the machine's until it is written; NULL where there is no address space. */
static void *zeros_map(uint64_t bytes) {
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    EXPECT(memory != MAP_FAILED, "no address space for %llu bytes", (unsigned long long)bytes);
    return memory == MAP_FAILED ? NULL : memory;
}

static uint64_t buffer_most(const tc_context *context) {
    tc_device_info info = {.struct_size = sizeof info};
    EXPECT(!tc_context_device(context, &info), "%s", tc_message());
    return info.max_buffer_bytes;
}

/* All isovalues in the context; false where some was made in one piece. */
static bool surfaces_compare(const subject *s, tc_context *context, tc_mesh *wanted[3]) {
    tc_mesh *mesh = NULL;
    tc_grid *grid = NULL;
    bool cut = true;
    EXPECT(!tc_tetrahedra_grid_create(context, &s->options, &grid), "%s: %s", s->name, tc_message());
    for (int n = 0; n < 3; n++) {
        double start = seconds();
        uint32_t slabs = surface_compare(s, grid, &mesh, n, wanted[n], 0);
        printf("%s: %u slabs, %.2f s\n", s->name, slabs, seconds() - start);
        cut = cut && slabs > 1;
    }
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return cut;
}

/* More tetrahedra than one piece may have, or one buffer: a block's at both ends of an array of others that are all of
 * one point. */
static void array_compare(tc_context *context) {
    const uint64_t most = buffer_most(context) / 16, piece = UINT64_C(1) << 28;
    const uint64_t count = (most < piece ? most : piece) + 12345;
    subject s = block_make(TC_F32, 9, false, true);
    const uint64_t half = s.options.tetrahedron_count / 2, rest = s.options.tetrahedron_count - half;
    tc_mesh *wanted[3];
    surfaces_of_reference(&s, wanted);
    uint32_t *tetrahedra = zeros_map(16 * count);
    if (!tetrahedra) return;
    memcpy(tetrahedra, s.tetrahedra, 16 * half);
    memcpy(tetrahedra + 4 * (count - rest), s.tetrahedra + 4 * half, 16 * rest);
    s.options.tetrahedron_count = count, s.options.tetrahedra = tetrahedra;
    snprintf(s.name, sizeof s.name, "%llu tetrahedra", (unsigned long long)count);
    EXPECT(surfaces_compare(&s, context, wanted), "not cut");
    for (int n = 0; n < 3; n++) tc_mesh_destroy(wanted[n]);
    munmap(tetrahedra, 16 * count);
    subject_free(&s);
}

/* More points than one buffer may have, of which a few are used. */
static void points_compare(tc_context *context) {
    const uint64_t count = buffer_most(context) / 12 + 12345;
    subject s = block_make(TC_U8, 9, false, false);
    const uint64_t step = (count - 1) / s.options.point_count;
    tc_mesh *wanted[3];
    float *points = zeros_map(12 * count);
    uint8_t *values = zeros_map(count);
    if (!points || !values || count > UINT32_MAX) return;
    for (uint64_t n = 0; n < s.options.point_count; n++) {
        memcpy(points + 3 * n * step, s.points + 3 * n, 12);
        values[n * step] = ((const uint8_t *)s.values)[n];
    }
    for (uint64_t n = 0; n < 4 * s.options.tetrahedron_count; n++) s.tetrahedra[n] *= (uint32_t)step;
    s.options.point_count = count, s.options.points = points, s.options.samples = values;
    snprintf(s.name, sizeof s.name, "%llu points", (unsigned long long)count);
    surfaces_of_reference(&s, wanted);
    surfaces_compare(&s, context, wanted);
    for (int n = 0; n < 3; n++) tc_mesh_destroy(wanted[n]);
    munmap(points, 12 * count);
    munmap(values, count);
    subject_free(&s);
}

int main(int argc, char **argv) {
    always_copy = argc > 1 && !strcmp(argv[1], "always_copy");
    random_state = 7;
    if (!device_exists()) return SKIPPED;
    reference = reference_open();
    if (argc > 1 && !strcmp(argv[1], "large")) {
        tc_context *unbounded = bounded_open(0, 0);
        sphere_compare();
        array_compare(unbounded);
        points_compare(unbounded);
        tc_context_destroy(unbounded);
    } else {
        budgets_compare(block_make(TC_U8, 7, false, false));
        budgets_compare(block_make(TC_F32, 6, true, true));
        budgets_compare(block_make(TC_F64, 5, true, false));
        budgets_compare(scattered_make(1501));
        budgets_compare(hub_make(800));
        cut_later();
        point_refused(100000);
        point_refused(always_copy ? 10000 : 30000);
        cancelled(always_copy ? 10000 : 24000);
        cancelled(always_copy ? 40000 : 60000);
    }
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
