/*
 * test_misuse.c - every public function with every argument and every field of a struct that is not allowed
 *
 * All that calls take stands in one struct of arguments, good ones. The table (misuse_places.h) names a call, one
 * place in that struct, and the values to be written there, each with the statuses that it may end in; test_abi.py sees
 * to it that no function of the header and no field of a struct that the caller fills is left out. The sizes of structs
 * are tried one and all, and so are contents of the arrays of cells. After each call the outputs are zero or usable,
 * and a good extraction has the right bytes. Under a sanitizer this also shows that nothing beyond the arrays is read.
 */
#include "misuse_places.h"

/* -------------------------------------------------------------------------------------------------------- machinery */

static void expect_good(const world *w, const char *what) {
    tc_extract_options how;
    tc_mesh *mesh = w->kept;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_extract_options_init(&how);
    how.isovalue = 127.5;
    bool done = tc_extract(w->grid, &how, &mesh) == TC_OK && mesh == w->kept && tc_mesh_get(mesh, &data) == TC_OK;
    EXPECT(done, "after %s: %s", what, tc_message());
    const char *difference = done ? mesh_difference(&w->expected, &data) : NULL;
    EXPECT(!difference, "after %s: %s", what, difference);
}

/* Runs the call with what it is to be given; it ends in one of the statuses. */
static tc_status expect_status(const world *w, call_function *run, arguments *a, unsigned may, const char *what) {
    bool zero = false;
    tc_status status = run(a, &zero);
    EXPECT(may >> status & 1, "%s: status %d (%s)", what, (int)status, tc_message());
    EXPECT(!status || (zero && *tc_message()), "%s: status %d without a message, or output not zero", what,
           (int)status);
    expect_good(w, what);
    return status;
}

/* The reference has no device: what is asked of it is refused, whatever else is wrong. */
static unsigned may_end_in(const world *w, const place *p, const bad *value) {
    bool opencl = w->engine == TC_ENGINE_OPENCL;
    int devices;
    if (!strcmp(p->call, "tc_device_get") && tc_device_count(&devices)) return value->may | DEVICE;
    if (!strcmp(p->call, "tc_emit")) return ARGUMENT;
    if (value->may & OK && !strcmp(p->call, "tc_context_create") && opencl) return value->may | ARGUMENT | MEMORY;
    return value->may;
}

static void test_place(const world *w, const place *p) {
    static const bad misaligned[] = {{0, ARGUMENT}, {0, ENDS}};
    for (const bad *value = p->values ? p->values : misaligned; value->may; value++) {
        arguments a;
        char what[160];
        arguments_fill(w, &a);
        char *at = (char *)&a + p->at;
        if (p->values)
            memcpy(at, &value->bits, p->bytes);
        else
            *(uintptr_t *)at += 1;
        snprintf(what, sizeof what, "%s with %s %s0x%llx", p->call, p->name, p->values ? "= " : "misaligned, + ",
                 p->values ? (unsigned long long)value->bits : 1ull);
        expect_status(w, p->run, &a, may_end_in(w, p, value), what);
    }
}

/* ------------------------------------------------------------------------------------------------- sizes of structs */

typedef struct sized {
    const char *name;
    call_function *run;
    size_t at, bytes;
    bool is_result;
} sized;

#define SIZED(call, where, is_result)                                                                                  \
    { #call ": " #where, call_##call, offsetof(arguments, where), sizeof(((arguments *)0)->where), is_result }

static const sized sizes[] = {
    SIZED(tc_device_get, info, true),
    SIZED(tc_context_device, info, true),
    SIZED(tc_context_tuning, tuning, true),
    SIZED(tc_context_create, context_options, false),
    SIZED(tc_context_create, expert_options, false),
    SIZED(tc_grid_create, grid_options, false),
    SIZED(tc_tetrahedra_grid_create, tetrahedra_grid_options, false),
    SIZED(tc_count, extract_options, false),
    SIZED(tc_count, counts, true),
    SIZED(tc_extract, extract_options, false),
    SIZED(tc_extract_labels, labels_options, false),
    SIZED(tc_emit, device_mesh, false),
    SIZED(tc_stream, stream_options, false),
    SIZED(tc_mesh_get, mesh_data, true),
    SIZED(tc_interpolate_field, field, false),
    SIZED(tc_count_interval_volume, interval_volume_options, false),
    SIZED(tc_count_interval_volume, interval_volume_counts, true),
    SIZED(tc_interval_volume_get, interval_volume_data, true),
    SIZED(tc_interpolate_interval_volume, field, false),
    SIZED(tc_tetrahedralize, cells, false),
    SIZED(tc_tetrahedralize, tetrahedra, true),
    SIZED(tc_tetrahedralize_grid, tetrahedra, true),
};

/* Bytes beyond struct_size are not read, so that their fields have defaults, and not written: they stay 0xee. With a
 * size that is not allowed nothing is written. */
static void test_size(const world *w, const sized *s, size_t size) {
    arguments a, good, defaults;
    bool zero, legitimate = size >= sizeof size && size <= s->bytes && size % sizeof size == 0;
    char what[128];
    arguments_fill(w, &a);
    arguments_fill(w, &good);
    arguments_fill(w, &defaults);
    defaults_fill(&defaults);
    char *at = (char *)&a + s->at, *at_good = (char *)&good + s->at;
    memcpy(at, &size, sizeof size);
    if (legitimate) memset(at + size, 0xee, s->bytes - size);
    if (legitimate && !s->is_result) memcpy(at_good + size, (char *)&defaults + s->at + size, s->bytes - size);
    tc_status status = s->run(&a, &zero), good_status = s->run(&good, &zero);
    snprintf(what, sizeof what, "%s of %zu bytes", s->name, size);
    EXPECT(legitimate || status == TC_ERROR_ARGUMENT, "%s: status %d", what, (int)status);
    for (size_t n = s->is_result && legitimate ? size : sizeof size; n < s->bytes && s->is_result; n++)
        if ((unsigned char)at[n] != 0xee) {
            EXPECT(false, "%s: byte %zu is written", what, n);
            break;
        }
    if (legitimate && !s->is_result)
        EXPECT(status == good_status && !memcmp(&a.counts, &good.counts, sizeof a.counts),
               "%s: status %d, and %d with defaults", what, (int)status, (int)good_status);
    if (s->is_result && !status && s->run != call_tc_tetrahedralize && s->run != call_tc_tetrahedralize_grid)
        EXPECT(good_status == TC_OK && !memcmp(at + sizeof size, at_good + sizeof size, size - sizeof size),
               "%s: not what a caller of today gets", what);
    expect_good(w, what);
}

static void test_sizes(const world *w) {
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        for (size_t size = 0; size <= sizes[n].bytes + 16; size++) test_size(w, &sizes[n], size);
        test_size(w, &sizes[n], SIZE_MAX);
        test_size(w, &sizes[n], SIZE_MAX / 2 + 1);
    }
}

/* ----------------------------------------------------------------------------------------------- contents of arrays */

static const int64_t numbers[] = {
    -1, INT64_MIN, INT64_MAX, INT64_C(1) << 31, INT64_C(1) << 32, POINTS, POINTS + 1, 0, 1, 7, 8, 9};
enum { NUMBERS = sizeof numbers / sizeof *numbers };

/* Offsets but for the last, which says how long the connectivity is. */
static void test_cell_arrays(const world *w) {
    int64_t o[CELLS + 1], c[CORNERS];
    uint8_t t[CELLS];
    int64_t f[CELLS + FACES + FACE_CORNERS];
    float p[3 * POINTS];
    arguments a;
    for (int at = 0; at < CELLS + FACES + FACE_CORNERS; at++)
        for (int n = 0; n < NUMBERS; n++) {
            int64_t starts[CELLS + 1], ends[FACES + 1];
            memcpy(f, cell_faces, CELLS * sizeof *f);
            memcpy(f + CELLS, face_offsets, FACES * sizeof *f);
            memcpy(f + CELLS + FACES, face_connectivity, FACE_CORNERS * sizeof *f);
            f[at] = numbers[n];
            memcpy(starts, cell_faces, sizeof starts), memcpy(starts, f, CELLS * sizeof *f);
            memcpy(ends, face_offsets, sizeof ends), memcpy(ends, f + CELLS, FACES * sizeof *f);
            arguments_fill(w, &a);
            a.cells.cell_faces = starts, a.cells.face_offsets = ends, a.cells.face_connectivity = f + CELLS + FACES;
            bool outside = at >= CELLS + FACES && (numbers[n] < 0 || numbers[n] >= POINTS);
            expect_status(w, call_tc_tetrahedralize, &a, outside ? DATA : OK | DATA | ARGUMENT, "an array of faces");
        }
    for (int at = 0; at < CELLS + CORNERS; at++)
        for (int n = 0; n < NUMBERS; n++) {
            memcpy(o, offsets, sizeof o);
            memcpy(c, connectivity, sizeof c);
            *(at < CELLS ? &o[at] : &c[at - CELLS]) = numbers[n];
            for (int type = 0; type < 256; type += at < CELLS ? 1 : 256) {
                memcpy(t, types, sizeof t);
                if (at < CELLS) t[0] = (uint8_t)type;
                arguments_fill(w, &a);
                a.cells.offsets = o, a.cells.connectivity = c, a.cells.types = t;
                bool outside = at >= CELLS && (numbers[n] < 0 || numbers[n] >= POINTS);
                expect_status(w, call_tc_tetrahedralize, &a, outside ? DATA : OK | DATA | ARGUMENT,
                              "an array of cells");
            }
        }
    static const int64_t beyond[] = {0, INT64_C(1) << 40, (INT64_C(1) << 40) + 4, 4};
    static const uint8_t between_flat_ones[] = {1, 10, 1};
    arguments_fill(w, &a);
    a.cells.cell_count = 3, a.cells.offsets = beyond, a.cells.types = between_flat_ones;
    expect_status(w, call_tc_tetrahedralize, &a, DATA, "a cell beyond the last offset");
    static const float coordinates[] = {NAN, INFINITY, -INFINITY, 0x1p127f, -0x1p127f};
    for (int at = 0; at < 3 * POINTS; at++)
        for (int n = 0; n < 5; n++) {
            memcpy(p, points, sizeof p);
            p[at] = coordinates[n];
            arguments_fill(w, &a);
            a.cells.points = p;
            expect_status(w, call_tc_tetrahedralize, &a, DATA, "a coordinate");
        }
}

static void test_tetrahedra(const world *w) {
    static const uint32_t bad_points[] = {POINTS, 1u << 31, UINT32_MAX};
    uint32_t t[4 * TETRAHEDRA];
    for (int at = 0; at < 4 * TETRAHEDRA; at++)
        for (int n = 0; n < 3; n++) {
            arguments a;
            memcpy(t, tetrahedra, sizeof t);
            t[at] = bad_points[n];
            arguments_fill(w, &a);
            a.tetrahedra_grid_options.tetrahedra = t;
            a.extract_options.isovalue = 0.5;
            tc_grid *grid = NULL;
            tc_mesh *mesh = NULL;
            EXPECT(tc_tetrahedra_grid_create(w->context, &a.tetrahedra_grid_options, &grid) == TC_OK, "%s",
                   tc_message());
            EXPECT_REFUSED(tc_count(grid, &a.extract_options, &a.counts), TC_ERROR_DATA, "a point that is not there");
            EXPECT_REFUSED(tc_extract(grid, &a.extract_options, &mesh), TC_ERROR_DATA, "a point that is not there");
            EXPECT(!mesh, "a mesh of a complex that has no such point");
            tc_grid_destroy(grid);
        }
    expect_good(w, "tetrahedra without their points");
}

/* Coordinates of structured grids: which arrays, and what is in them. */
static void test_coordinates(const world *w) {
    static call_function *const calls[] = {call_tc_grid_create, call_tc_tetrahedralize_grid};
    static const float wrong[] = {NAN, INFINITY, -INFINITY, 0x1p127f};
    for (int n = 0; n < 2; n++) {
        arguments a;
        for (int axes = 1; axes < 7; axes++) {
            arguments_fill(w, &a);
            for (int d = 0; d < 3; d++) a.grid_options.axes[d] = axes >> d & 1 ? axis : NULL;
            expect_status(w, calls[n], &a, ARGUMENT, "one or two axes");
        }
        arguments_fill(w, &a);
        for (int d = 0; d < 3; d++) a.grid_options.axes[d] = axis;
        a.grid_options.points = lattice;
        expect_status(w, calls[n], &a, ARGUMENT, "axes and points");
        a.grid_options.points = NULL;
        expect_status(w, calls[n], &a, OK, "axes");
        a.grid_options.axes[1] = (const float *)((const char *)axis + 1);
        expect_status(w, calls[n], &a, ARGUMENT, "axes that are not aligned");
        arguments_fill(w, &a);
        a.grid_options.points = (const float *)((const char *)lattice + 2);
        expect_status(w, calls[n], &a, ARGUMENT, "points that are not aligned");
        a.grid_options.points = lattice;
        expect_status(w, calls[n], &a, OK, "points");
        for (int m = 0; m < 4; m++) {
            const float right = lattice[SAMPLES];
            lattice[SAMPLES] = wrong[m];
            expect_status(w, calls[n], &a, DATA, "a point that is not finite");
            lattice[SAMPLES] = right;
        }
    }
}

/* -------------------------------------------------------------------------------------------------------- all of it */

/* What returns no status. */
static void test_others(const world *w) {
    uint64_t peak = 1;
    tc_context_options_init(NULL);
    tc_expert_options_init(NULL);
    tc_grid_options_init(NULL);
    tc_extract_options_init(NULL);
    tc_tetrahedra_grid_options_init(NULL);
    tc_stream_options_init(NULL);
    tc_interval_volume_options_init(NULL);
    tc_interval_volume_destroy(NULL);
    tc_context_destroy(NULL);
    tc_grid_destroy(NULL);
    tc_mesh_destroy(NULL);
    tc_tetrahedra_release(NULL);
    tc_tetrahedra zeroed = {0}, made = {.struct_size = sizeof made};
    tc_cells cells = {.struct_size = sizeof cells,
                      .point_count = POINTS,
                      .points = points,
                      .cell_count = CELLS,
                      .types = types,
                      .offsets = offsets,
                      .connectivity = connectivity,
                      .cell_faces = cell_faces,
                      .face_offsets = face_offsets,
                      .face_connectivity = face_connectivity};
    tc_tetrahedra_release(&zeroed);
    EXPECT(tc_tetrahedralize(&cells, &made) == TC_OK && made.tetrahedron_count > 1, "%s", tc_message());
    tc_tetrahedra_release(&made);
    tc_tetrahedra_release(&made);
    EXPECT(made.tetrahedron_count == 0 && !made.tetrahedra && !made.cells, "a complex after its release");
    EXPECT(tc_seam_size(NULL) == 0, "a seam of no grid");
    EXPECT(!tc_context_cl_context(NULL) && !tc_context_cl_queue(NULL), "OpenCL objects of no context");
    EXPECT(tc_context_build_ms(NULL) == 0, "kernels of no context");
    EXPECT(tc_context_device_bytes(NULL, NULL) == 0 && tc_context_device_bytes(NULL, &peak) == 0 && peak == 0,
           "device bytes of no context");
    for (unsigned n = 8; n; n <<= 1)
        EXPECT(tc_type_bytes((tc_type)n) == 0 && !tc_type_name((tc_type)n) && !tc_method_name((tc_method)n),
               "%u is a type or method", n);
    EXPECT(tc_version() && tc_message(), "no text");
    expect_good(w, "calls for nothing");
}

static void world_open(world *w, tc_engine engine) {
    arguments a;
    *w = (world){.engine = engine, .expected.struct_size = sizeof w->expected};
    arguments_fill(w, &a);
    w->context = context_open(&a.context_options);
    EXPECT(tc_grid_create(w->context, &a.grid_options, &w->grid) == TC_OK &&
               tc_extract(w->grid, &a.extract_options, &w->mesh) == TC_OK &&
               tc_extract(w->grid, &a.extract_options, &w->kept) == TC_OK &&
               tc_mesh_get(w->mesh, &w->expected) == TC_OK,
           "%s", tc_message());
    tc_interval_volume_data d = {.struct_size = sizeof d};
    EXPECT(tc_extract_interval_volume(w->grid, &a.interval_volume_options, &w->interval) == TC_OK &&
               tc_interval_volume_get(w->interval, &d) == TC_OK && d.vertex_count < CARRIED_MOST,
           "%s", tc_message());
    w->interval_vertices = d.vertex_count;
    if (!w->expected.vertex_count || w->expected.vertex_count > CARRIED_MOST - 1) exit(EXIT_FAILURE);
}

static void world_close(world *w) {
    tc_mesh_destroy(w->kept);
    tc_interval_volume_destroy(w->interval);
    tc_mesh_destroy(w->mesh);
    tc_grid_destroy(w->grid);
    tc_context_destroy(w->context);
}

static void test_engine(tc_engine engine) {
    world w;
    world_open(&w, engine);
    for (size_t n = 0; n < sizeof places / sizeof *places; n++) test_place(&w, &places[n]);
    test_sizes(&w);
    test_tetrahedra(&w);
    test_coordinates(&w);
    if (engine == TC_ENGINE_REFERENCE) test_cell_arrays(&w);
    test_others(&w);
    world_close(&w);
}

int main(void) {
    arrays_fill();
    test_engine(TC_ENGINE_REFERENCE);
    bool device = device_exists();
    if (device) test_engine(TC_ENGINE_OPENCL);
    int failed = EXPECT_DONE();
    return failed || device ? failed : SKIPPED;
}
