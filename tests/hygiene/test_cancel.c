/*
 * test_cancel.c - cancelled at any call of the progress callback, everything can be used again
 *
 * For every kind of grid, on each engine, whole, in slabs and on a device with memory of its own: tc_count, tc_extract
 * into a new mesh and into a kept one, at a first and at a repeated isovalue, and tc_interpolate_field are cancelled at
 * each call of the callback in turn. Each time the status is TC_ERROR_CANCELLED, what was to be made is empty, and then
 * the same grid gives the right bytes. What was counted before a cancelled call is not emitted; what is counted after
 * it is.
 */
#include "kinds.h"

typedef struct watch {
    int calls, cancel_at;
} watch;

static int watch_progress(void *user, const char *stage, double fraction) {
    watch *w = user;
    return stage && fraction >= 0 && ++w->calls == w->cancel_at;
}

typedef struct subject {
    const char *name;
    enum kind kind;
    watch *watch;
    tc_grid *grid;
    tc_mesh *kept;
    const tc_mesh_data *expected; /* of each isovalue */
    float *carried;
    bool opencl;
} subject;

typedef tc_status action(const subject *s, const tc_extract_options *how);

static void expect_cancelled(const subject *s, tc_status status, bool empty, const char *what) {
    EXPECT(status == TC_ERROR_CANCELLED, "%s, %s, cancelled at call %d: status %d (%s)", s->name, what,
           s->watch->cancel_at, (int)status, tc_message());
    EXPECT(empty, "%s, %s, cancelled at call %d: not empty", s->name, what, s->watch->cancel_at);
    EXPECT(s->watch->calls == s->watch->cancel_at, "%s, %s: called %d times, cancelled at %d", s->name, what,
           s->watch->calls, s->watch->cancel_at);
}

static tc_status count(const subject *s, const tc_extract_options *how) {
    tc_counts counts = {.struct_size = sizeof counts, .vertex_count = 9, .triangle_count = 9, .mesh_bytes = 9};
    tc_status status = tc_count(s->grid, how, &counts);
    if (s->watch->cancel_at)
        expect_cancelled(s, status, !counts.vertex_count && !counts.triangle_count && !counts.mesh_bytes, "count");
    return status;
}

static tc_status extract_new(const subject *s, const tc_extract_options *how) {
    tc_mesh *mesh = NULL;
    tc_status status = tc_extract(s->grid, how, &mesh);
    if (s->watch->cancel_at) expect_cancelled(s, status, !mesh, "a new mesh");
    tc_mesh_destroy(mesh);
    return status;
}

static tc_status extract_kept(const subject *s, const tc_extract_options *how) {
    tc_mesh *mesh = s->kept;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_status status = tc_extract(s->grid, how, &mesh);
    const bool there = mesh == s->kept && tc_mesh_get(mesh, &data) == TC_OK;
    if (s->watch->cancel_at)
        expect_cancelled(s, status, there && !data.vertex_count && !data.triangle_count, "a kept mesh");
    return status;
}

static tc_status carry(const subject *s, const tc_extract_options *how) {
    const tc_field field = {sizeof field, TC_F64, 1, kind_f64};
    const tc_mesh_data *mesh = &s->expected[how->isovalue < 100];
    tc_status status = tc_interpolate_field(s->grid, how, &field, s->carried, mesh->vertex_count);
    if (s->watch->cancel_at) expect_cancelled(s, status, true, "carry");
    return status;
}

/* The repeated isovalue, of which the grid remembers something, then the first. */
static void expect_usable(const subject *s) {
    *s->watch = (watch){0};
    for (int isovalue = 1; isovalue >= 0; isovalue--) {
        tc_extract_options how;
        tc_mesh *mesh = s->kept;
        tc_mesh_data data = {.struct_size = sizeof data};
        kind_how(s->kind, isovalue, &how);
        const bool done = tc_extract(s->grid, &how, &mesh) == TC_OK && tc_mesh_get(mesh, &data) == TC_OK;
        const char *difference = done ? mesh_difference(&s->expected[isovalue], &data) : tc_message();
        EXPECT(!difference, "%s, after cancelling: %s", s->name, difference);
    }
}

/* After a cancelled count, or a call that was cancelled since the count, tc_emit asks for a count; where the count
 * stands, it asks for buffers. */
static void expect_count_stands(const subject *s, bool stands) {
    const tc_device_mesh no_buffers = {.struct_size = sizeof no_buffers};
    tc_extract_options how;
    if (!s->opencl || s->kind == KIND_COMPLEX) return;
    kind_how(s->kind, 0, &how);
    EXPECT(tc_emit(s->grid, &how, &no_buffers, NULL) == TC_ERROR_ARGUMENT, "emitted into no buffers");
    EXPECT(stands == !strstr(tc_message(), "tc_count"), "%s: a count that %s: %s", s->name,
           stands ? "stands" : "is none", tc_message());
}

/* Cancels at every call, or at the first, the last and every step-th. */
static void test_action(const subject *s, action *act, int isovalue, int step) {
    tc_extract_options how;
    kind_how(s->kind, isovalue, &how);
    *s->watch = (watch){0};
    if (act == carry) act(s, &how);   /* from the first one on, grids in slabs keep what it needs */
    expect_usable(s), count(s, &how); /* as below: what they leave makes the next call a shorter one */
    *s->watch = (watch){0};
    EXPECT(act(s, &how) == TC_OK, "%s: %s", s->name, tc_message());
    const int calls = s->watch->calls;
    EXPECT(calls > 0, "%s: progress is never told", s->name);
    for (int n = 1; n <= calls; n += n + step > calls && n < calls ? calls - n : step) {
        *s->watch = (watch){0};
        count(s, &how);
        *s->watch = (watch){.cancel_at = n};
        act(s, &how);
        if (act != carry) expect_count_stands(s, false);
        expect_usable(s);
    }
    kind_how(s->kind, 0, &how);
    EXPECT(count(s, &how) == TC_OK, "%s: %s", s->name, tc_message());
    if (!strstr(s->name, "slabs")) expect_count_stands(s, true); /* which may be too large for tc_emit */
}

static void test_kind(tc_context *context, watch *w, enum kind kind, const tc_mesh_data expected[2], const char *mode,
                      int step) {
    static float carried[1 << 17];
    static action *const actions[] = {count, extract_new, extract_kept, carry};
    tc_extract_options how;
    char name[64];
    snprintf(name, sizeof name, "%s, %s", mode, kind_names[kind]);
    subject s = {name, kind, w, NULL, NULL, expected, carried, strstr(mode, "reference") == NULL};
    kind_how(kind, 0, &how);
    if (expected[0].vertex_count > sizeof carried / sizeof *carried) exit(EXIT_FAILURE);
    for (size_t n = 0; n < sizeof actions / sizeof *actions; n++)
        for (int isovalue = 0; isovalue < 2; isovalue++) {
            *w = (watch){0};
            EXPECT(kind_open(context, kind, &s.grid) == TC_OK, "%s: %s", name, tc_message());
            if (isovalue) EXPECT(tc_extract(s.grid, &how, &s.kept) == TC_OK, "%s: %s", name, tc_message());
            if (!s.kept) EXPECT(tc_extract(s.grid, &how, &s.kept) == TC_OK, "%s: %s", name, tc_message());
            test_action(&s, actions[n], isovalue, step);
            tc_grid_destroy(s.grid);
            s.grid = NULL;
        }
    tc_mesh_destroy(s.kept);
}

static const struct {
    const char *name;
    tc_engine engine;
    uint64_t memory;
    int always_copy;
} modes[] = {{"reference", TC_ENGINE_REFERENCE, 0, 0},
             {"whole", TC_ENGINE_OPENCL, 0, 0},
             {"slabs", TC_ENGINE_OPENCL, 1, 0},
             {"copied buffers", TC_ENGINE_OPENCL, 0, 1},
             {"copied buffers, slabs", TC_ENGINE_OPENCL, 1, 1}};

/* Whether both surfaces of the kind are made within so much memory; in_slabs: in several slabs each. */
static bool made_within(enum kind kind, int always_copy, uint64_t bytes, bool *in_slabs) {
    tc_context_options options;
    tc_expert_options expert;
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    options_init(&options, &expert);
    options.max_memory_bytes = bytes;
    expert.always_copy = always_copy;
    tc_context *context = context_open(&options);
    tc_mesh_data data = {.struct_size = sizeof data};
    bool done = kind_open(context, kind, &grid) == TC_OK;
    *in_slabs = true;
    for (int isovalue = 0; isovalue < 2 && done; isovalue++) {
        kind_how(kind, isovalue, &how);
        done = tc_extract(grid, &how, &mesh) == TC_OK && tc_mesh_get(mesh, &data) == TC_OK;
        *in_slabs = *in_slabs && data.slab_count > 1;
    }
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return done;
}

/* About the most memory in which the kind is extracted in several slabs, by bisection: what suffices for one slab, and
 * what does not. 0: of the small ones, whose samples are little beside what every slab needs. */
static uint64_t slabs_memory(enum kind kind, int always_copy) {
    uint64_t one = kind == KIND_COMPLEX ? 8 << 20 : 512 << 10, less = 1 << 10;
    bool in_slabs;
    while (one - less > one / 256) {
        const uint64_t bytes = less + (one - less) / 2;
        *(made_within(kind, always_copy, bytes, &in_slabs) && !in_slabs ? &one : &less) = bytes;
    }
    if (made_within(kind, always_copy, less, &in_slabs) && in_slabs) return less;
    EXPECT(kind == KIND_U8 || kind == KIND_RECTILINEAR, "%s: is never extracted in slabs: %s", kind_names[kind],
           tc_message());
    return 0;
}

static void test_mode(size_t mode, enum kind kind, const tc_mesh_data expected[2], int step) {
    watch w = {0};
    tc_context_options options;
    tc_expert_options expert;
    options_init(&options, &expert);
    options.engine = modes[mode].engine;
    expert.always_copy = modes[mode].always_copy;
    options.max_memory_bytes = modes[mode].memory ? slabs_memory(kind, modes[mode].always_copy) : 0;
    options.progress = watch_progress;
    options.progress_user = &w;
    if (modes[mode].memory && !options.max_memory_bytes) return;
    tc_context *context = context_open(&options);
    test_kind(context, &w, kind, expected, modes[mode].name, step);
    tc_context_destroy(context);
}

int main(int argc, char **argv) {
    const int step = argc > 1 && !strcmp(argv[1], "all") ? 1 : 7;
    kinds_fill();
    tc_context *reference = reference_open();
    const bool device = device_exists();
    for (enum kind kind = 0; kind < KINDS; kind++) {
        tc_mesh_data expected[2];
        tc_mesh *meshes[2];
        for (int n = 0; n < 2; n++) meshes[n] = kind_expected(reference, kind, n, &expected[n]);
        for (size_t mode = 0; mode < sizeof modes / sizeof *modes; mode++)
            if (device || modes[mode].engine == TC_ENGINE_REFERENCE) test_mode(mode, kind, expected, step);
        for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
    }
    tc_context_destroy(reference);
    kinds_release();
    const int failed = EXPECT_DONE();
    return failed || device ? failed : SKIPPED;
}
