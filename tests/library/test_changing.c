/*
 * test_changing.c - samples, blanks and tetrahedra that change while a surface, an interval volume or the surfaces of a
 * label map are made of them, which callers may not do: a call then fails, or what it makes is of what there was at
 * some time, but no index leads beyond its vertices
 *
 * The callback for progress changes them, between the two stages among others.
 */
#include "engines.h"
#include "random.h"

#include <math.h>

enum { NX = 70, NY = 21, NZ = 17, SAMPLES = NX * NY * NZ, CUBES = (NX - 1) * (NY - 1) * (NZ - 1) };

static float values[SAMPLES];
static uint8_t bytes[SAMPLES], blanked_samples[SAMPLES], blanked_cells[CUBES];
static tc_tetrahedra complex_cut;
static bool is_reference; /* the engine */
static tc_method method;

static void noise_fill(void) {
    for (int n = 0; n < SAMPLES; n++) {
        values[n] = (float)random_between(-1, 1);
        bytes[n] = (uint8_t)random_below(256);
        blanked_samples[n] = 0;
    }
    memset(blanked_cells, 0, sizeof blanked_cells);
}

/* ---------------------------------------------------------------------------------------------------------- changes */

static void change_samples(void) { noise_fill(); }

static void change_to_gaps(void) {
    for (int n = 0; n < SAMPLES; n++)
        if (random_below(3) == 0) values[n] = (float)NAN, blanked_samples[n] = 1;
}

static void change_from_gaps(void) {
    for (int n = 0; n < SAMPLES; n++)
        if (values[n] != values[n]) values[n] = (float)random_between(-1, 1);
    memset(blanked_samples, 0, sizeof blanked_samples);
    memset(blanked_cells, 0, sizeof blanked_cells);
}

static void change_cells(void) {
    for (int n = 0; n < CUBES; n++) blanked_cells[n] = random_below(4) == 0;
}

/* From a few cells to all of them: far more than was counted. */
static void cells_few(void) {
    for (int n = 0; n < CUBES; n++) blanked_cells[n] = n % 1000 != 0;
}

static void change_from_few_cells(void) { memset(blanked_cells, 0, sizeof blanked_cells); }

static void change_tetrahedra(void) {
    uint32_t *points = (uint32_t *)(uintptr_t)complex_cut.tetrahedra;
    for (uint64_t n = 0; n < 4 * complex_cut.tetrahedron_count; n++)
        if (random_below(50) == 0) points[n] = random_below(SAMPLES);
}

static void change_tetrahedra_beyond(void) {
    uint32_t *points = (uint32_t *)(uintptr_t)complex_cut.tetrahedra;
    for (uint64_t n = 0; n < 4 * complex_cut.tetrahedron_count; n += 1000) points[n] = SAMPLES + 1000 * SAMPLES;
}

static const struct {
    const char *name;
    void (*make)(void);
    bool complex;
} changes[] = {{"samples", change_samples, false},
               {"samples go missing", change_to_gaps, false},
               {"samples come back", change_from_gaps, false},
               {"cells are blanked", change_cells, false},
               {"cells come back", change_from_few_cells, false},
               {"samples of a complex", change_samples, true},
               {"samples of a complex go missing", change_to_gaps, true},
               {"tetrahedra", change_tetrahedra, true},
               {"tetrahedra, out of range", change_tetrahedra_beyond, true}};

typedef struct moment {
    int calls, at; /* of progress; the change comes at this one */
    void (*make)(void);
} moment;

static int progress_change(void *user, const char *stage, double fraction) {
    moment *m = user;
    (void)stage;
    (void)fraction;
    if (m->calls++ == m->at) m->make();
    return 0;
}

/* ------------------------------------------------------------------------------------------------------------ tests */

static tc_grid *grid_open(tc_context *context, bool is_complex, int kind) {
    tc_grid *grid = NULL;
    tc_status status;
    if (is_complex) {
        tc_tetrahedra_grid_options options;
        static float points[3 * SAMPLES];
        for (int n = 0; n < SAMPLES; n++)
            points[3 * n] = (float)(n % NX), points[3 * n + 1] = (float)(n / NX % NY),
                       points[3 * n + 2] = (float)(n / NX / NY);
        tc_tetrahedra_grid_options_init(&options);
        options.point_count = SAMPLES;
        options.points = points;
        options.type = TC_F32;
        options.samples = values;
        options.tetrahedron_count = complex_cut.tetrahedron_count;
        options.tetrahedra = complex_cut.tetrahedra;
        status = tc_tetrahedra_grid_create(context, &options, &grid);
    } else {
        tc_grid_options options;
        tc_grid_options_init(&options);
        options.dims[0] = NX, options.dims[1] = NY, options.dims[2] = NZ;
        options.type = kind == 0 ? TC_U8 : TC_F32;
        options.samples = kind == 0 ? (const void *)bytes : values;
        options.blanked_samples = kind == 2 ? blanked_samples : NULL;
        options.blanked_cells = kind == 2 ? blanked_cells : NULL;
        status = tc_grid_create(context, &options, &grid);
    }
    EXPECT(!status, "no grid: %s", tc_message());
    return grid;
}

/* Where a call of the reference engine succeeds, it has made all triangles that it counted: none is left as it was. */
static void expect_made(const tc_mesh_data *data, const char *name, int kind, int at) {
    uint64_t unmade = 0;
    for (uint64_t n = 0; n < data->triangle_count; n++) {
        const uint32_t *t = data->triangles + 3 * n;
        unmade += t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    }
    EXPECT(unmade == 0, "%s, kind %d, at call %d: %llu triangles with a vertex twice", name, kind, at,
           (unsigned long long)unmade);
}

static void expect_within_vertices(const uint32_t *indices, uint64_t count, uint64_t vertices, const char *of,
                                   size_t change, int kind, int at) {
    uint64_t beyond = 0;
    for (uint64_t n = 0; n < count; n++) beyond += indices[n] >= vertices;
    EXPECT(beyond == 0, "%s, %s, kind %d, at call %d: %llu indices beyond the vertices", changes[change].name, of, kind,
           at, (unsigned long long)beyond);
}

static void extract_while_changing(tc_context *context, size_t change, int kind, moment *m, int at) {
    tc_extract_options how;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_extract_options_init(&how);
    noise_fill();
    if (kind == 2 && changes[change].make == change_from_gaps) change_to_gaps(), change_cells();
    if (changes[change].make == change_from_few_cells) cells_few();
    how.isovalue = kind == 0 ? 128 : 0;
    how.normals = kind != 1;
    how.method = method;
    tc_grid *grid = grid_open(context, changes[change].complex, kind);
    *m = (moment){0, at, changes[change].make};
    tc_status status = tc_extract(grid, &how, &mesh);
    EXPECT(status == TC_OK || (status == TC_ERROR_DATA && *tc_message()), "%s: status %d: %s", changes[change].name,
           (int)status, tc_message());
    if (!status) tc_mesh_get(mesh, &data);
    expect_within_vertices(data.triangles, 3 * data.triangle_count, data.vertex_count, "surface", change, kind, at);
    if (is_reference && !changes[change].complex) expect_made(&data, changes[change].name, kind, at);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
}

static void interval_while_changing(tc_context *context, size_t change, int kind, moment *m, int at) {
    tc_interval_volume_options how;
    tc_interval_volume *interval = NULL;
    tc_interval_volume_data data = {.struct_size = sizeof data};
    tc_interval_volume_options_init(&how);
    how.low = -0.3, how.high = 0.4;
    noise_fill();
    tc_grid *grid = grid_open(context, changes[change].complex, kind);
    *m = (moment){0, at, changes[change].make};
    tc_status status = tc_extract_interval_volume(grid, &how, &interval);
    EXPECT(status == TC_OK || (status == TC_ERROR_DATA && *tc_message()), "%s, interval: status %d: %s",
           changes[change].name, (int)status, tc_message());
    if (!status) tc_interval_volume_get(interval, &data);
    expect_within_vertices(data.tetrahedra, 4 * data.tetrahedron_count, data.vertex_count, "interval", change, kind,
                           at);
    tc_interval_volume_destroy(interval);
    tc_grid_destroy(grid);
}

/* From two labels to 256, which have several times as many triangles in a cube. */
static void labels_while_changing(tc_context *context, size_t change, moment *m, int at) {
    tc_labels_options how;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_labels_options_init(&how);
    how.smoothing = 0;
    noise_fill();
    for (int n = 0; n < SAMPLES; n++) bytes[n] &= 1;
    tc_grid *grid = grid_open(context, false, 0);
    *m = (moment){0, at, changes[change].make};
    tc_status status = tc_extract_labels(grid, &how, &mesh);
    EXPECT(status == TC_OK || (status == TC_ERROR_DATA && *tc_message()), "%s, labels: status %d: %s",
           changes[change].name, (int)status, tc_message());
    if (!status) tc_mesh_get(mesh, &data);
    expect_within_vertices(data.triangles, 3 * data.triangle_count, data.vertex_count, "labels", change, 0, at);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
}

static void complex_make(void) {
    tc_grid_options options;
    tc_grid_options_init(&options);
    options.dims[0] = NX, options.dims[1] = NY, options.dims[2] = NZ;
    options.samples = bytes;
    tc_tetrahedra_release(&complex_cut);
    complex_cut = (tc_tetrahedra){.struct_size = sizeof complex_cut};
    EXPECT(!tc_tetrahedralize_grid(&options, &complex_cut), "%s", tc_message());
}

static void changes_try(tc_context *context, moment *m) {
    for (size_t change = 0; change < sizeof changes / sizeof *changes; change++)
        for (int kind = 0; kind < 3; kind++)
            for (int at = 0; at < 12; at++) {
                /* what lies beyond on a device is for its caller to see to */
                if (changes[change].make == change_tetrahedra_beyond && !is_reference) continue;
                if (changes[change].complex && (kind != 1 || method != TC_METHOD_TETRA)) continue;
                if (changes[change].complex) complex_make();
                extract_while_changing(context, change, kind, m, at);
                if (changes[change].complex) complex_make();
                if (method != TC_METHOD_TETRA || at % 3) continue;
                if (kind == 1) interval_while_changing(context, change, kind, m, at);
                if (changes[change].make == change_samples && kind == 0) labels_while_changing(context, change, m, at);
            }
}

static void engine_test(tc_engine engine, uint64_t budget) {
    const tc_method methods[] = {TC_METHOD_TETRA, TC_METHOD_SNAP};
    moment m;
    tc_context_options options;
    tc_context_options_init(&options);
    options.engine = engine;
    is_reference = engine == TC_ENGINE_REFERENCE;
    options.max_memory_bytes = budget;
    options.progress = progress_change;
    options.progress_user = &m;
    m = (moment){0, -1, noise_fill};
    tc_context *context = context_open(&options);
    for (size_t n = 0; n < sizeof methods / sizeof *methods; n++) {
        method = methods[n];
        changes_try(context, &m);
    }
    tc_context_destroy(context);
}

int main(int argc, char **argv) {
    random_state = 5;
    const bool on_device = argc > 1 && !strcmp(argv[1], "device");
    if (!on_device) engine_test(TC_ENGINE_REFERENCE, 0);
    if (on_device && !device_exists()) return SKIPPED;
    if (on_device) engine_test(TC_ENGINE_OPENCL, 0);
    tc_tetrahedra_release(&complex_cut);
    return EXPECT_DONE();
}
