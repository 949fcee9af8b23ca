/*
 * test_budget.c - a memory budget that is too small is refused with one that does: that one, and every larger one
 *
 * Budgets fall from more than enough until a call is refused; what the refusal advises is followed, exactly and by
 * more. With "always_copy" as on a device with memory of its own.
 */
#include "engines.h"
#include "random.h"

#include <math.h>

enum { NX = 130, NY = 50, NZ = 22, SAMPLES = NX * NY * NZ, CUBES = (NX - 1) * (NY - 1) * (NZ - 1) };

static uint8_t bytes[SAMPLES], blanked_samples[SAMPLES], blanked_cells[CUBES];
static float values[SAMPLES], points[3 * SAMPLES], axes[NX];
static bool always_copy;

typedef struct subject {
    const char *name;
    tc_type type;
    bool gaps, blanked, curvilinear, rectilinear, smooth;
    tc_method method;
} subject;

static const subject subjects[] = {
    {"u8 noise", .type = TC_U8},
    {"f32 noise with gaps", .type = TC_F32, .gaps = true},
    {"f32 noise, hybrid", .type = TC_F32, .method = TC_METHOD_HYBRID},
    {"u8 noise, snap", .type = TC_U8, .method = TC_METHOD_SNAP},
    {"u8, smooth", .type = TC_U8, .smooth = true},
    {"curvilinear, blanked", .type = TC_F32, .curvilinear = true, .blanked = true},
    {"rectilinear", .type = TC_U8, .rectilinear = true, .smooth = true},
};

static void arrays_fill(const subject *s) {
    random_state = 7;
    for (int n = 0; n < SAMPLES; n++) {
        const int x = n % NX, y = n / NX % NY, z = n / NX / NY;
        double value = s->smooth ? 128 + 100 * sin(0.2 * x) * cos(0.15 * y + 0.1 * z) : random_between(0, 256);
        bytes[n] = (uint8_t)value;
        values[n] = s->gaps && n % 301 == 0 ? (float)NAN : (float)value;
        blanked_samples[n] = n % 211 == 0;
        points[3 * n] = (float)x, points[3 * n + 1] = (float)y, points[3 * n + 2] = (float)z + 0.1f * (float)sin(x);
    }
    for (int n = 0; n < CUBES; n++) blanked_cells[n] = n % 97 == 0;
    for (int n = 0; n < NX; n++) axes[n] = (float)n * 1.5f;
}

static void grid_describe(const subject *s, tc_grid_options *grid) {
    tc_grid_options_init(grid);
    grid->dims[0] = NX, grid->dims[1] = NY, grid->dims[2] = NZ;
    grid->type = s->type;
    grid->samples = s->type == TC_U8 ? (const void *)bytes : values;
    if (s->blanked) grid->blanked_samples = blanked_samples, grid->blanked_cells = blanked_cells;
    if (s->curvilinear) grid->points = points;
    grid->first_index[2] = s->method == TC_METHOD_SNAP; /* then slabs depend on most of what follows them */
    for (int axis = 0; axis < 3 && s->rectilinear; axis++) grid->axes[axis] = axes;
}

static tc_extract_options surface_of(const subject *s, bool normals) {
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = 128;
    how.method = s->method;
    how.normals = normals;
    return how;
}

/* Another method has plans and buffers of its own, which do not come on top. */
static void other_method(tc_grid *grid, const tc_extract_options *how) {
    tc_extract_options by_tetra = *how;
    tc_mesh *mesh = NULL;
    by_tetra.method = TC_METHOD_TETRA;
    EXPECT(tc_extract(grid, &by_tetra, &mesh) == TC_OK, "tetra of the same grid: %s", tc_message());
    tc_mesh_destroy(mesh);
}

/* False where it is refused for want of memory. */
static bool budget_does(const subject *s, uint64_t budget, bool normals, const tc_mesh_data *expected) {
    tc_context_options options;
    tc_expert_options expert;
    tc_grid_options volume;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    const tc_extract_options how = surface_of(s, normals);
    options_init(&options, &expert);
    options.max_memory_bytes = budget;
    expert.always_copy = always_copy;
    tc_context *context = context_open(&options);
    grid_describe(s, &volume);
    tc_status status = tc_grid_create(context, &volume, &grid);
    if (!status && s->method == TC_METHOD_SNAP) other_method(grid, &how);
    if (!status) status = tc_extract(grid, &how, &mesh);
    EXPECT(status == TC_OK || status == TC_ERROR_MEMORY, "%s: %s", s->name, tc_message());
    if (!status) {
        tc_mesh_get(mesh, &data);
        const char *difference = mesh_difference(expected, &data);
        EXPECT(!difference, "%s, %llu bytes: %s", s->name, (unsigned long long)budget, difference);
        if (s->method == TC_METHOD_SNAP) other_method(grid, &how);
    }
    expect_within(context, budget, s->name);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
    return !status;
}

static void subject_test(const subject *s, tc_context *reference) {
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data expected[2];
    tc_grid_options volume;
    uint64_t advised = 0, refused = 0, enough = 64 << 20;
    int refusals = 0;
    arrays_fill(s);
    grid_describe(s, &volume);
    for (int normals = 0; normals < 2; normals++) {
        const tc_extract_options how = surface_of(s, normals);
        if (!extract(reference, &volume, &how, &meshes[normals], &expected[normals])) return;
    }
    while (enough - refused > enough / 50) { /* bisection: every refusal has its advice */
        const uint64_t budget = refused + (enough - refused) / 2;
        const bool normals = refusals % 2;
        if (budget_does(s, budget, normals, &expected[normals])) {
            enough = budget;
            continue;
        }
        advised = bytes_advised(s->name);
        refused = budget;
        if (refusals++ > 3) continue;
        EXPECT(advised > budget, "%s: %llu refused, %llu advised", s->name, (unsigned long long)budget,
               (unsigned long long)advised);
    }
    EXPECT(refusals > 1 && advised >= enough / 50 * 49, "%s: %d refusals", s->name, refusals);
    for (int step = 0; step < 12; step += tier_is_quick() ? 3 : 1) { /* up to budgets that need no slabs */
        const uint64_t budget = advised + advised * (uint64_t)(step * step) / 12;
        EXPECT(budget_does(s, budget, step % 2, &expected[step % 2]), "%s: advised %llu, given %llu: %s", s->name,
               (unsigned long long)advised, (unsigned long long)budget, tc_message());
    }
    for (int normals = 0; normals < 2; normals++) tc_mesh_destroy(meshes[normals]);
}

int main(int argc, char **argv) {
    always_copy = argc > 1 && !strcmp(argv[1], "always_copy");
    if (!device_exists()) return SKIPPED;
    tc_context *reference = reference_open();
    for (size_t n = 0; n < sizeof subjects / sizeof *subjects; n++) subject_test(&subjects[n], reference);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
