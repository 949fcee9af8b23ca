/*
 * test_order.c - calls in any order, on objects of several contexts: each gives what it would alone
 *
 * A seeded walk makes, uses and destroys contexts, grids of every kind, meshes and fields, in any order that does not
 * use what is gone, wrong calls among them; a mesh goes from grid to grid and from context to context. After each
 * extraction the bytes are the right ones, and tc_emit knows whether its count still stands.
 *
 *     test_order [SEED [STEPS]]
 */
#include "kinds.h"
#include "random.h"

enum { CONTEXTS = 2, GRIDS = 4, MESHES = 3 };

typedef struct walk {
    tc_context *contexts[CONTEXTS];
    tc_grid *grids[GRIDS];
    enum kind kinds[GRIDS];
    int homes[GRIDS];         /* their contexts */
    tc_mesh *meshes[MESHES];  /* of any context */
    int counted[CONTEXTS];    /* the grid whose count stands, or -1 */
    int counted_at[CONTEXTS]; /* its isovalue */
    bool cancel;
    bool opencl[CONTEXTS];
    tc_mesh_data expected[KINDS][2];
} walk;

static int progress(void *user, const char *stage, double fraction) {
    return ((walk *)user)->cancel && stage && fraction > 0.3;
}

static void context_make(walk *w, int n, bool device) {
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    w->opencl[n] = device && random_below(2);
    options.engine = w->opencl[n] ? TC_ENGINE_OPENCL : TC_ENGINE_REFERENCE;
    expert.always_copy = random_below(4) == 0;
    options.progress = progress;
    options.progress_user = w;
    w->contexts[n] = context_open(&options);
    w->counted[n] = -1;
}

static void grid_drop(walk *w, int g) {
    if (w->grids[g] && w->counted[w->homes[g]] == g) w->counted[w->homes[g]] = -1;
    tc_grid_destroy(w->grids[g]);
    w->grids[g] = NULL;
}

static void grid_make(walk *w, int g) {
    grid_drop(w, g);
    w->homes[g] = (int)random_below(CONTEXTS);
    w->kinds[g] = (enum kind)random_below(KINDS);
    EXPECT(kind_open(w->contexts[w->homes[g]], w->kinds[g], &w->grids[g]) == TC_OK, "%s", tc_message());
}

static void context_remake(walk *w, int n, bool device) {
    for (int g = 0; g < GRIDS; g++)
        if (w->homes[g] == n) grid_drop(w, g);
    tc_context_destroy(w->contexts[n]);
    context_make(w, n, device);
}

static void extract_step(walk *w, int g, int isovalue, int m) {
    tc_extract_options how;
    tc_mesh_data data = {.struct_size = sizeof data};
    kind_how(w->kinds[g], isovalue, &how);
    if (random_below(4) == 0) tc_mesh_destroy(w->meshes[m]), w->meshes[m] = NULL;
    w->counted[w->homes[g]] = -1;
    const bool done = tc_extract(w->grids[g], &how, &w->meshes[m]) == TC_OK && !tc_mesh_get(w->meshes[m], &data);
    const char *difference = done ? mesh_difference(&w->expected[w->kinds[g]][isovalue], &data) : tc_message();
    EXPECT(!difference, "%s: %s", kind_names[w->kinds[g]], difference);
}

static void count_step(walk *w, int g, int isovalue) {
    const tc_mesh_data *expected = &w->expected[w->kinds[g]][isovalue];
    tc_counts counts = {.struct_size = sizeof counts};
    tc_extract_options how;
    kind_how(w->kinds[g], isovalue, &how);
    EXPECT(tc_count(w->grids[g], &how, &counts) == TC_OK && counts.vertex_count == expected->vertex_count &&
               counts.triangle_count == expected->triangle_count,
           "%s: %s", kind_names[w->kinds[g]], tc_message());
    w->counted[w->homes[g]] = w->kinds[g] == KIND_COMPLEX ? -1 : g;
    w->counted_at[w->homes[g]] = isovalue;
}

/* Into no buffers: only the words of the refusal tell whether the count stands. */
static void emit_step(walk *w, int g, int isovalue) {
    const tc_device_mesh mesh = {.struct_size = sizeof mesh};
    const int home = w->homes[g];
    const bool stands = w->counted[home] == g && w->counted_at[home] == isovalue;
    tc_extract_options how;
    kind_how(w->kinds[g], isovalue, &how);
    EXPECT(tc_emit(w->grids[g], &how, &mesh, NULL) == TC_ERROR_ARGUMENT, "emitted into no buffers");
    if (!w->opencl[home] || w->kinds[g] == KIND_COMPLEX) return;
    EXPECT(stands == !!strstr(tc_message(), "buffer"), "%s, counted %d: %s", kind_names[w->kinds[g]], stands,
           tc_message());
}

static void cancel_step(walk *w, int g, int isovalue, int m) {
    tc_extract_options how;
    tc_mesh_data data = {.struct_size = sizeof data};
    kind_how(w->kinds[g], isovalue, &how);
    const bool kept = w->meshes[m] != NULL;
    w->cancel = true;
    EXPECT_REFUSED(tc_extract(w->grids[g], &how, &w->meshes[m]), TC_ERROR_CANCELLED, kind_names[w->kinds[g]]);
    w->cancel = false;
    w->counted[w->homes[g]] = -1;
    EXPECT(kept == (w->meshes[m] != NULL), "a mesh came or went with a cancelled extraction");
    EXPECT(!kept || (!tc_mesh_get(w->meshes[m], &data) && !data.vertex_count), "a mesh of a cancelled extraction");
}

/* Refused before anything is touched: a count stands. */
static void wrong_step(walk *w, int g) {
    tc_counts counts = {.struct_size = sizeof counts};
    tc_extract_options how;
    tc_grid *none = NULL;
    tc_mesh *mesh = NULL;
    kind_how(w->kinds[g], 0, &how);
    how.isovalue = NAN;
    EXPECT_REFUSED(tc_count(w->grids[g], &how, &counts), TC_ERROR_ARGUMENT, "no isovalue");
    EXPECT_REFUSED(tc_extract(w->grids[g], &how, &mesh), TC_ERROR_ARGUMENT, "no isovalue");
    EXPECT_REFUSED(tc_extract(w->grids[g], NULL, &mesh), TC_ERROR_ARGUMENT, "no options");
    EXPECT_REFUSED(tc_grid_create(w->contexts[w->homes[g]], NULL, &none), TC_ERROR_ARGUMENT, "no options");
    EXPECT(!mesh && !none, "something was made by wrong calls");
}

static void carry_step(walk *w, int g, int isovalue) {
    static float out[1 << 17];
    const uint64_t count = w->expected[w->kinds[g]][isovalue].vertex_count;
    const tc_field field = {sizeof field, TC_F64, 1, kind_f64};
    tc_extract_options how;
    kind_how(w->kinds[g], isovalue, &how);
    if (count > sizeof out / sizeof *out) exit(EXIT_FAILURE);
    EXPECT(tc_interpolate_field(w->grids[g], &how, &field, out, count) == TC_OK, "%s", tc_message());
    const int home = w->homes[g]; /* another surface than the counted one is counted, and not for tc_emit */
    if (w->counted[home] != g || w->counted_at[home] != isovalue) w->counted[home] = -1;
    uint64_t far = 0; /* the samples are the field, but for their rounding */
    for (uint64_t n = 0; n < count; n++) far += !(fabs((double)out[n] - how.isovalue) < 1);
    EXPECT(w->kinds[g] == KIND_U8 || w->kinds[g] == KIND_CURVILINEAR || far == 0,
           "%s: %llu values of %llu are not the isovalue", kind_names[w->kinds[g]], (unsigned long long)far,
           (unsigned long long)count);
}

static void step(walk *w, bool device) {
    const int g = (int)random_below(GRIDS), m = (int)random_below(MESHES), isovalue = (int)random_below(2);
    const uint32_t choice = random_below(100);
    if (choice < 1) {
        context_remake(w, (int)random_below(CONTEXTS), device);
    } else if (choice < 12 || !w->grids[g]) {
        grid_make(w, g);
    } else if (choice < 15) {
        grid_drop(w, g);
    } else if (choice < 40) {
        extract_step(w, g, isovalue, m);
    } else if (choice < 60) {
        count_step(w, g, isovalue);
    } else if (choice < 75) {
        emit_step(w, g, isovalue);
    } else if (choice < 85) {
        cancel_step(w, g, isovalue, m);
    } else if (choice < 90) {
        carry_step(w, g, isovalue);
    } else {
        wrong_step(w, g);
    }
}

int main(int argc, char **argv) {
    const uint64_t seed = argc > 1 ? strtoull(argv[1], NULL, 0) : 1;
    const long steps = argc > 2 ? strtol(argv[2], NULL, 0) : 1000;
    static walk w;
    tc_mesh *expected[KINDS][2];
    random_state = seed;
    kinds_fill();
    tc_context *reference = reference_open();
    for (int n = 0; n < 2 * KINDS; n++)
        expected[n / 2][n % 2] = kind_expected(reference, (enum kind)(n / 2), n % 2, &w.expected[n / 2][n % 2]);
    const bool device = device_exists();
    for (int n = 0; n < CONTEXTS; n++) context_make(&w, n, device);
    for (long n = 0; n < steps; n++) {
        const long failures = expect_failures;
        step(&w, device);
        if (failures < expect_failures) printf("at step %ld of seed %llu\n", n, (unsigned long long)seed);
    }
    for (int g = 0; g < GRIDS; g++) grid_drop(&w, g);
    for (int m = 0; m < MESHES; m++) tc_mesh_destroy(w.meshes[m]);
    for (int n = 0; n < CONTEXTS; n++) tc_context_destroy(w.contexts[n]);
    for (int n = 0; n < 2 * KINDS; n++) tc_mesh_destroy(expected[n / 2][n % 2]);
    tc_context_destroy(reference);
    kinds_release();
    const int failed = EXPECT_DONE();
    return failed || device ? failed : SKIPPED;
}
