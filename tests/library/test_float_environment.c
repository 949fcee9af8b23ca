/*
 * test_float_environment.c - results do not depend on the caller's floating-point environment, which stays as it is
 *
 * Every mode has a process of its own, where OpenCL is first used in that mode: threads that a driver starts then would
 * inherit it. Meshes are compared with those that the reference engine has made in the default environment before.
 */
#include "complex.h"
#include "engines.h"
#include "random.h"

#include <fenv.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

/* More points than a thread checks at once, so that the library's own threads are at work, too. */
enum { NX = 48, NY = 40, NZ = 36, SAMPLES = NX * NY * NZ };

/* ----------------------------------------------------------------------------------------------------------- modes */

static void mode_default(void) {}
static void mode_upward(void) { fesetround(FE_UPWARD); }
static void mode_downward(void) { fesetround(FE_DOWNWARD); }
static void mode_toward_zero(void) { fesetround(FE_TOWARDZERO); }
#ifdef __SSE__
static void mode_flush(void) { _mm_setcsr(_mm_getcsr() | 0x8040); } /* as programs linked with -ffast-math start */
#endif
#ifdef __GLIBC__
static void mode_trap(void) { feenableexcept(FE_ALL_EXCEPT); }
static void mode_trap_upward(void) { fesetround(FE_UPWARD), feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW); }
#endif

static const struct {
    const char *name;
    void (*set)(void);
} modes[] = {
    {"the default", mode_default},
    {"rounding upward", mode_upward},
    {"rounding downward", mode_downward},
    {"rounding toward zero", mode_toward_zero},
#ifdef __SSE__
    {"subnormal numbers flushed", mode_flush},
#endif
#ifdef __GLIBC__
    {"traps", mode_trap},
    {"traps and rounding upward", mode_trap_upward},
#endif
};

/* What can be told of an environment. */
typedef struct environment {
    int rounding, flags, traps;
    unsigned control;
} environment;

static environment environment_now(void) {
    environment e = {.rounding = fegetround(), .flags = fetestexcept(FE_ALL_EXCEPT)};
#ifdef __GLIBC__
    e.traps = fegetexcept();
#endif
#ifdef __SSE__
    e.control = _mm_getcsr();
#endif
    return e;
}

static environment callers;
static const char *mode_name;

static void expect_callers(const char *where) {
    const environment now = environment_now();
    EXPECT(now.rounding == callers.rounding && now.flags == callers.flags && now.traps == callers.traps &&
               now.control == callers.control,
           "%s, %s: another environment: rounding %x, was %x; flags %x, were %x; traps %x, were %x; control %x, was %x",
           mode_name, where, (unsigned)now.rounding, (unsigned)callers.rounding, (unsigned)now.flags,
           (unsigned)callers.flags, (unsigned)now.traps, (unsigned)callers.traps, now.control, callers.control);
}

/* ---------------------------------------------------------------------------------------------------------- volumes */

typedef struct subject {
    tc_grid_options options;
    tc_extract_options how;
    tc_mesh *expected;
    tc_mesh_data data;
    float *carried;
} subject;

enum { SUBJECTS = 6 };

static subject subjects[SUBJECTS];
static float points[3 * SAMPLES];
static double field_values[SAMPLES];

/* Rows change from moderate to subnormal samples. */
static void *samples_make(tc_type type) {
    char *samples = malloc(SAMPLES * tc_type_bytes(type));
    for (size_t n = 0; n < SAMPLES; n++) {
        const bool small = n / NX % 2;
        const double x = random_between(-1, 1);
        if (type == TC_F32) ((float *)(void *)samples)[n] = (float)(small ? 0x1p-130 * x : x);
        if (type == TC_F64) ((double *)(void *)samples)[n] = small ? 0x1p-1030 * x : x;
        if (type == TC_U8) ((uint8_t *)samples)[n] = (uint8_t)(128 + 100 * x);
        if (type == TC_I32) ((int32_t *)(void *)samples)[n] = (int32_t)(2e9 * x);
    }
    return samples;
}

static void subject_make(subject *s, tc_type type, bool curvilinear, bool hybrid) {
    tc_grid_options_init(&s->options);
    tc_extract_options_init(&s->how);
    s->options.dims[0] = NX, s->options.dims[1] = NY, s->options.dims[2] = NZ;
    s->options.type = type;
    s->options.samples = samples_make(type);
    if (curvilinear) s->options.points = points;
    for (int n = 0; n < 3; n++) s->options.matrix[n][n] = 0.1 * (n + 1), s->options.matrix[n][3] = 5.1;
    s->how.isovalue = type == TC_F32 ? 0x1p-140 : type == TC_F64 ? 0x1p-1040 : 128.3;
    s->how.method = hybrid ? TC_METHOD_HYBRID : TC_METHOD_TETRA;
    s->how.normals = 1;
}

static void subjects_make(void) {
    random_state = 20;
    for (int n = 0; n < SAMPLES; n++) {
        const float at[3] = {0.1f * (float)(n % NX), 0.2f * (float)(n / NX % NY), 0.3f * (float)(n / NX / NY)};
        for (int axis = 0; axis < 3; axis++) points[3 * n + axis] = at[axis] + (float)random_between(-0.01, 0.01);
        field_values[n] = random_between(-1, 1) * (n % 2 ? 1 : 0x1p-1030);
    }
    subject_make(&subjects[0], TC_F32, false, false);
    subject_make(&subjects[1], TC_F64, false, false);
    subject_make(&subjects[2], TC_F32, true, false);
    subject_make(&subjects[3], TC_F64, true, false);
    subject_make(&subjects[4], TC_U8, false, true);
    subject_make(&subjects[5], TC_I32, false, false);
}

/* ------------------------------------------------------------------------------------------------------------ calls */

static const tc_field field = {sizeof field, TC_F64, 1, field_values};

static float *carry(tc_grid *grid, const subject *s, uint64_t count) {
    float *out = calloc((size_t)count + 1, sizeof *out);
    EXPECT(!tc_interpolate_field(grid, &s->how, &field, out, count), "%s: %s", mode_name, tc_message());
    return out;
}

static void expected_make(subject *s, tc_context *reference) {
    tc_grid *grid = NULL;
    s->data.struct_size = sizeof s->data;
    EXPECT(!tc_grid_create(reference, &s->options, &grid) && !tc_extract(grid, &s->how, &s->expected) &&
               !tc_mesh_get(s->expected, &s->data),
           "%s", tc_message());
    EXPECT(s->data.triangle_count > 10000, "a mesh too small to tell");
    s->carried = carry(grid, s, s->data.vertex_count);
    tc_grid_destroy(grid);
}

static long progress_calls;

static int progress_look(void *user, const char *stage, double fraction) {
    (void)user;
    (void)fraction;
    progress_calls++;
    expect_callers(stage);
    return 0;
}

static void subject_compare(tc_context *context, const subject *s, int number) {
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_counts counts = {.struct_size = sizeof counts};
    EXPECT(!tc_grid_create(context, &s->options, &grid), "%s: %s", mode_name, tc_message());
    expect_callers("tc_grid_create");
    EXPECT(!tc_count(grid, &s->how, &counts), "%s: %s", mode_name, tc_message());
    expect_callers("tc_count");
    EXPECT(counts.vertex_count == s->data.vertex_count, "%s: counts differ", mode_name);
    EXPECT(!tc_extract(grid, &s->how, &mesh) && !tc_mesh_get(mesh, &data), "%s: %s", mode_name, tc_message());
    expect_callers("tc_extract");
    const char *difference = mesh ? mesh_difference(&s->data, &data) : "no mesh";
    EXPECT(!difference, "%s, subject %d: %s", mode_name, number, difference);
    float *carried = carry(grid, s, s->data.vertex_count);
    expect_callers("tc_interpolate_field");
    EXPECT(!memcmp(carried, s->carried, s->data.vertex_count * sizeof *carried), "%s: carried values differ",
           mode_name);
    free(carried);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    expect_callers("tc_grid_destroy");
}

static void engine_compare(tc_engine engine) {
    tc_context_options options;
    tc_context *context = NULL;
    tc_context_options_init(&options);
    options.engine = engine;
    options.check_device = 1;
    options.progress = progress_look;
    EXPECT(!tc_context_create(&options, &context), "%s: %s", mode_name, tc_message());
    expect_callers("tc_context_create");
    progress_calls = 0;
    for (int n = 0; n < SUBJECTS && context; n++) subject_compare(context, &subjects[n], n);
    EXPECT(progress_calls > SUBJECTS, "%s: progress is told %ld times", mode_name, progress_calls);
    tc_context_destroy(context);
    expect_callers("tc_context_destroy");
}

/* Small enough that coordinates are subnormal: cells of negative volume are found by its sign. */
static void cells_shrink(cell_list *list) {
    for (uint64_t n = 0; n < 3 * list->point_count; n++) list->points[n] *= 0x1p-140f;
}

static void complexes_compare(const tc_tetrahedra *a, const tc_tetrahedra *b) {
    EXPECT(a->tetrahedron_count == b->tetrahedron_count && a->inverted_cell_count == b->inverted_cell_count &&
               a->folded_cell_count == b->folded_cell_count,
           "%s: complexes differ: %llu cells inverted, and %llu", mode_name, (unsigned long long)a->inverted_cell_count,
           (unsigned long long)b->inverted_cell_count);
    EXPECT(!memcmp(a->tetrahedra, b->tetrahedra, 16 * (size_t)a->tetrahedron_count), "%s: tetrahedra differ",
           mode_name);
}

/* ------------------------------------------------------------------------------------------------------------ tests */

static void mode_test(int mode) {
    mode_name = modes[mode].name;
    tc_context *reference = reference_open();
    tc_tetrahedra before = {.struct_size = sizeof before}, after = {.struct_size = sizeof after};
    cell_list list = mixed_block_make(34, 20);
    cells_shrink(&list);
    const tc_cells cells = cell_list_view(&list);
    EXPECT(!tc_tetrahedralize(&cells, &before), "%s", tc_message());
    EXPECT(list.cell_count > 1 << 15 && before.inverted_cell_count > 1000, "too few cells to tell");
    for (int n = 0; n < SUBJECTS; n++) expected_make(&subjects[n], reference);

    feclearexcept(FE_ALL_EXCEPT);
    modes[mode].set();
    callers = environment_now();
    EXPECT(!tc_tetrahedralize(&cells, &after), "%s", tc_message());
    expect_callers("tc_tetrahedralize");
    complexes_compare(&before, &after);
    engine_compare(TC_ENGINE_REFERENCE);
    const bool has_device = device_exists();
    expect_callers("tc_device_count");
    if (has_device) engine_compare(TC_ENGINE_OPENCL);

    for (int n = 0; n < SUBJECTS; n++) {
        tc_mesh_destroy(subjects[n].expected);
        free(subjects[n].carried);
    }
    tc_tetrahedra_release(&before);
    tc_tetrahedra_release(&after);
    cell_list_free(&list);
    tc_context_destroy(reference);
}

static int round_upward(void *user, const char *stage, double fraction) {
    (void)stage;
    (void)fraction;
    tc_mesh *mesh = NULL;
    fesetround(FE_UPWARD);
    EXPECT(!tc_extract(user, &subjects[1].how, &mesh), "within a callback: %s", tc_message());
    EXPECT(fegetround() == FE_UPWARD, "a call within a callback leaves another environment");
    tc_mesh_destroy(mesh);
    return 0;
}

/* What a callback does to its environment is the caller's wish; it may call the library itself, for other contexts. */
static void test_callback(void) {
    tc_context *other = reference_open();
    tc_context_options options;
    tc_grid *grid = NULL, *inner = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    EXPECT(!tc_grid_create(other, &subjects[1].options, &inner), "%s", tc_message());
    mode_name = "a callback";
    expected_make(&subjects[0], other);
    tc_context_options_init(&options);
    options.engine = TC_ENGINE_REFERENCE;
    options.progress = round_upward;
    options.progress_user = inner;
    tc_context *context = context_open(&options);
    EXPECT(!tc_grid_create(context, &subjects[0].options, &grid) && !tc_extract(grid, &subjects[0].how, &mesh), "%s",
           tc_message());
    EXPECT(fegetround() == FE_UPWARD, "what a callback has set is lost");
    fesetround(FE_TONEAREST);
    tc_mesh_get(mesh, &data);
    const char *difference = mesh_difference(&subjects[0].data, &data);
    EXPECT(!difference, "a callback that rounds upward: %s", difference);
    tc_mesh_destroy(mesh);
    tc_mesh_destroy(subjects[0].expected);
    free(subjects[0].carried);
    tc_grid_destroy(grid);
    tc_grid_destroy(inner);
    tc_context_destroy(context);
    tc_context_destroy(other);
}

int main(void) {
    subjects_make();
    for (int mode = 0; mode < (int)(sizeof modes / sizeof *modes); mode++) {
        int status = -1;
        fflush(stdout);
        pid_t child = fork();
        if (child == 0) {
            mode_test(mode);
            fesetenv(FE_DFL_ENV);
            _exit((fflush(stdout), expect_failures != 0));
        }
        waitpid(child, &status, 0);
        EXPECT(WIFEXITED(status) && WEXITSTATUS(status) == 0, "%s: the process ends with status %x", modes[mode].name,
               (unsigned)status);
    }
    subjects[0].expected = NULL;
    test_callback();
    for (int n = 0; n < SUBJECTS; n++) free((void *)(uintptr_t)subjects[n].options.samples);
    return EXPECT_DONE();
}
