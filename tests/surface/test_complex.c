/*
 * test_complex.c - surfaces of tetrahedral complexes: the kernels against the reference, byte for byte
 *
 * Both are compared with the surface that the signs of the samples call for (signs.h). Where the complex was a
 * structured grid, the surface has to be that of the structured path.
 */
#include "cut.h"
#include "engines.h"
#include "random.h"
#include "samples.h"
#include "signs.h"
#include "topology.h"

#include <math.h>
#include <string.h>

/* Building kernels takes most of the time: work-groups of several sizes for some types only. */
enum { CONTEXTS = 4, CONTEXTS_FEW = 2 };

static tc_context *reference, *devices[CONTEXTS];
static int device_count;

/* ------------------------------------------------------------------------------------------------------- comparison */

static void expect_counts(tc_grid *grid, const tc_extract_options *options, const expected *wanted, const char *what) {
    tc_counts found = {.struct_size = sizeof found};
    EXPECT(tc_count(grid, options, &found) == TC_OK, "%s: %s", what, tc_message());
    const tc_mesh_data sums = {.vertex_count = found.vertex_count,
                               .triangle_count = found.triangle_count,
                               .active_cell_count = found.active_cell_count};
    const char *fault = counts_fault(wanted, &sums);
    EXPECT(!fault, "%s: counted %s", what, fault);
}

/* Several isovalues, one after the other, on one grid of each engine. */
static void engines_compare(const tc_tetrahedra_grid_options *o, const double *isovalues, int isovalue_count,
                            bool complete, const char *what) {
    const bool all = o->type == TC_U8 || o->type >= TC_F32;
    const int count = device_count && !all ? CONTEXTS_FEW : device_count;
    tc_grid *grids[CONTEXTS + 1] = {NULL};
    tc_mesh *meshes[CONTEXTS + 1] = {NULL};
    for (int n = 0; n <= count; n++) {
        char name[120];
        snprintf(name, sizeof name, "%s, context %d", what, n);
        if (n && !test_chosen(name)) continue;
        EXPECT(tc_tetrahedra_grid_create(n ? devices[n - 1] : reference, o, &grids[n]) == TC_OK, "%s: %s", what,
               tc_message());
    }
    for (int i = 0; i < isovalue_count; i++) {
        tc_extract_options options;
        tc_mesh_data first = {.struct_size = sizeof first};
        tc_extract_options_init(&options);
        options.isovalue = isovalues[i];
        expected wanted;
        complex_expect(o, options.isovalue, &wanted);
        for (int n = 0; n <= count; n++) {
            if (!grids[n]) continue;
            tc_mesh_data data = {.struct_size = sizeof data};
            if (random_below(2)) expect_counts(grids[n], &options, &wanted, what);
            tc_status status = tc_extract(grids[n], &options, &meshes[n]);
            EXPECT(status == TC_OK, "%s, engine %d: %s", what, n, tc_message());
            if (status) continue;
            tc_mesh_get(meshes[n], &data);
            if (n == 0) {
                first = data;
                const char *fault = counts_fault(&wanted, &data);
                if (!fault) fault = topology_fault(&wanted, complete, &data);
                EXPECT(!fault, "%s: %s", what, fault);
            } else {
                const char *difference = mesh_difference(&first, &data);
                EXPECT(!difference, "%s, isovalue %g, context %d: %s", what, options.isovalue, n, difference);
            }
        }
        expected_free(&wanted);
    }
    for (int n = 0; n <= count; n++) {
        tc_mesh_destroy(meshes[n]);
        tc_grid_destroy(grids[n]);
    }
}

/* ------------------------------------------------------------------------------------------------- random complexes */

static tc_tetrahedra_grid_options options_of(const tc_tetrahedra *complex, const cell_list *list, tc_type type,
                                             const void *values) {
    tc_tetrahedra_grid_options o;
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = list->point_count, o.points = list->points;
    o.type = type, o.samples = values;
    o.tetrahedron_count = complex->tetrahedron_count, o.tetrahedra = complex->tetrahedra;
    return o;
}

/* Few values, so that many are ties; or all that the type has. */
static double random_value(tc_type type, bool few) {
    if (few) return (double)random_below(5) - (type_least(type) < 0 ? 2 : 0);
    if (random_below(16) == 0) return random_below(2) ? type_most(type) : type_least(type);
    double share = random_between(0, 1), value = share * type_most(type) + (1 - share) * type_least(type);
    return type_is_floating(type) ? value : floor(value);
}

static void mixed_block_compare(tc_type type, uint32_t size, bool few, bool holes) {
    char what[80];
    snprintf(what, sizeof what, "mixed block of %u, %s%s%s", size, tc_type_name(type), few ? ", few values" : "",
             holes ? ", holes" : "");
    cell_list list = mixed_block_make(size, random_u64());
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, what);
    void *values = malloc(8 * list.point_count);
    for (uint64_t n = 0; n < list.point_count; n++) {
        double value = random_value(type, few);
        static const double odd[3] = {NAN, INFINITY, -INFINITY};
        if (holes && random_below(20) == 0) value = odd[random_below(3)];
        sample_set(values, type, (int64_t)n, value);
    }
    double isovalues[5] = {1, 0.5, random_value(type, few), 2, 1};
    if (!few) isovalues[0] = isovalues[4] = random_value(type, few);
    tc_tetrahedra_grid_options o = options_of(&complex, &list, type, values);
    engines_compare(&o, isovalues, 5, !holes, what);
    free(values);
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

/* Cells with faces of many corners: truncated octahedra, or hexagonal columns of prisms, polyhedra, hexahedra. */
static void faceted_block_compare(tc_type type, uint32_t size, bool columns) {
    char what[80];
    snprintf(what, sizeof what, "%s of %u, %s", columns ? "honeycomb" : "truncated octahedra", size,
             tc_type_name(type));
    cell_list list = columns ? honeycomb_make(size, random_u64()) : kelvin_block_make(size, random_u64());
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra complex = cut(&cells, what);
    void *values = malloc(8 * list.point_count);
    for (uint64_t n = 0; n < list.point_count; n++) sample_set(values, type, (int64_t)n, random_value(type, true));
    const double isovalues[2] = {1, 2};
    tc_tetrahedra_grid_options o = options_of(&complex, &list, type, values);
    engines_compare(&o, isovalues, 2, true, what);
    free(values);
    tc_tetrahedra_release(&complex);
    cell_list_free(&list);
}

/* A vertex on the second end of an edge is where that is, to the bit, however far away the first one is. */
static void ends_compare(void) {
    static const float points[12] = {1e8f, -3e7f, 5e8f, -1e8f, 2e8f, 1e7f, 7e7f, 1e8f, -2e8f, 0.1f, 0.2f, 0.3f};
    static const uint8_t values[4] = {0, 0, 0, 1};
    static const uint32_t tetrahedron[4] = {0, 1, 2, 3};
    const double isovalue = 1;
    tc_tetrahedra_grid_options o;
    tc_extract_options how;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_tetrahedra_grid_options_init(&o);
    tc_extract_options_init(&how);
    o.point_count = 4, o.points = points, o.samples = values;
    o.tetrahedron_count = 1, o.tetrahedra = tetrahedron;
    how.isovalue = isovalue;
    EXPECT(!tc_tetrahedra_grid_create(reference, &o, &grid) && !tc_extract(grid, &how, &mesh) &&
               !tc_mesh_get(mesh, &data),
           "ends of edges: %s", tc_message());
    for (uint64_t v = 0; v < data.vertex_count; v++)
        EXPECT(!memcmp(data.positions + 3 * v, points + 9, 12), "a vertex on the end of an edge is elsewhere");
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    engines_compare(&o, &isovalue, 1, true, "ends of edges, u8");
}

/* No tetrahedron shares an edge with another: the table of edges has to grow. */
static void scattered_compare(void) {
    enum { COUNT = 3000 };
    static float points[12 * COUNT];
    static uint8_t values[4 * COUNT];
    static uint32_t tetrahedra[4 * COUNT];
    for (uint32_t n = 0; n < 4 * COUNT; n++) {
        for (int axis = 0; axis < 3; axis++) points[3 * n + (unsigned)axis] = (float)random_between(-1, 1);
        values[n] = (uint8_t)random_below(2);
        tetrahedra[n] = 4 * COUNT - 1 - n;
    }
    tc_tetrahedra_grid_options o;
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = 4 * COUNT, o.points = points, o.samples = values;
    o.tetrahedron_count = COUNT, o.tetrahedra = tetrahedra;
    const double isovalue = 1;
    engines_compare(&o, &isovalue, 1, true, "scattered tetrahedra");
}

/* ------------------------------------------------------------------------------------------------- structured grids */

static int position_compare(const void *a, const void *b) {
    const float *p = a, *q = b;
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] < q[axis] || p[axis] > q[axis]) return p[axis] < q[axis] ? -1 : 1;
    return 0;
}

static float ulp_of(float x) { return nextafterf(fabsf(x), INFINITY) - fabsf(x); }

/* The same vertices but for their order. */
static void expect_same_vertices(const tc_mesh_data *a, const tc_mesh_data *b, const char *what) {
    const size_t count = (size_t)a->vertex_count, bytes = 12 * count;
    float *p = malloc(bytes + 1), *q = malloc(bytes + 1);
    uint64_t far = 0;
    memcpy(p, a->positions, bytes), memcpy(q, b->positions, bytes);
    qsort(p, count, 12, position_compare), qsort(q, count, 12, position_compare);
    for (size_t n = 0; n < 3 * count; n++) far += fabsf(p[n] - q[n]) > 2 * ulp_of(fmaxf(fabsf(p[n]), 1));
    EXPECT(far == 0, "%s: %llu coordinates of vertices differ", what, (unsigned long long)far);
    free(p);
    free(q);
}

static void grid_compare(tc_type type, bool holes, bool mirrored) {
    enum { NX = 19, NY = 12, NZ = 15, COUNT = NX * NY * NZ };
    static double values[COUNT];
    static float points[3 * COUNT];
    tc_grid_options g;
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    char what[80];
    snprintf(what, sizeof what, "grid of %s%s%s", tc_type_name(type), holes ? ", holes" : "",
             mirrored ? ", mirrored" : "");
    tc_grid_options_init(&g);
    g.dims[0] = NX, g.dims[1] = NY, g.dims[2] = NZ, g.type = type, g.samples = values;
    g.first_index[0] = random_below(2);
    if (mirrored) g.matrix[0][0] = -1;
    for (int n = 0; n < COUNT; n++) {
        double x = n % NX, y = n / NX % NY, z = n / NX / NY;
        sample_set(values, type, n, 60 + 30 * sin(0.7 * x + 0.1) + 20 * cos(0.9 * y) + 10 * sin(z + 0.5 * x));
        if (holes && random_below(90) == 0) sample_set(values, type, n, NAN);
        points[3 * n] = (float)(mirrored ? -(x + (double)g.first_index[0]) : x + (double)g.first_index[0]);
        points[3 * n + 1] = (float)y, points[3 * n + 2] = (float)z;
    }
    EXPECT(tc_tetrahedralize_grid(&g, &complex) == TC_OK, "%s: %s", what, tc_message());
    tc_tetrahedra_grid_options o;
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = COUNT, o.points = points, o.type = type, o.samples = values;
    o.tetrahedron_count = complex.tetrahedron_count, o.tetrahedra = complex.tetrahedra;
    const double isovalues[] = {60.3, 80, 45.7};
    engines_compare(&o, isovalues, 3, !holes, what);
    for (int i = 0; i < 3; i++) {
        tc_grid *grid = NULL;
        tc_mesh *meshes[2] = {NULL, NULL};
        tc_mesh_data data[2] = {{.struct_size = sizeof *data}, {.struct_size = sizeof *data}};
        tc_extract_options options;
        topology t[2];
        tc_extract_options_init(&options);
        options.isovalue = isovalues[i];
        EXPECT(extract(reference, &g, &options, &meshes[0], &data[0]), "%s: structured", what);
        EXPECT(!tc_tetrahedra_grid_create(reference, &o, &grid) && !tc_extract(grid, &options, &meshes[1]), "%s: %s",
               what, tc_message());
        tc_mesh_get(meshes[1], &data[1]);
        EXPECT(data[0].vertex_count == data[1].vertex_count && data[0].triangle_count == data[1].triangle_count,
               "%s: %llu vertices and %llu triangles, structured %llu and %llu", what,
               (unsigned long long)data[1].vertex_count, (unsigned long long)data[1].triangle_count,
               (unsigned long long)data[0].vertex_count, (unsigned long long)data[0].triangle_count);
        if (data[0].vertex_count == data[1].vertex_count) expect_same_vertices(&data[0], &data[1], what);
        for (int n = 0; n < 2; n++)
            topology_of(data[n].positions, data[n].vertex_count, data[n].triangles, data[n].triangle_count, &t[n]);
        EXPECT(t[0].euler_characteristic == t[1].euler_characteristic && t[0].boundary_edges == t[1].boundary_edges,
               "%s: topology differs from that of the structured path", what);
        EXPECT(fabs(t[0].volume - t[1].volume) <= 1e-4 * fabs(t[0].volume) + 1e-3, "%s: volumes %g and %g", what,
               t[0].volume, t[1].volume);
        tc_mesh_destroy(meshes[0]);
        tc_mesh_destroy(meshes[1]);
        tc_grid_destroy(grid);
    }
    tc_tetrahedra_release(&complex);
}

/* ---------------------------------------------------------------------------------------------------------- refusal */

static void refusals(tc_context *context) {
    enum { SEVERAL = 40 }; /* tetrahedra: two whole clusters of the kernels, and a part of one */
    static const float points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const double values[4] = {0, 1, 2, 3};
    static const uint32_t good[4] = {0, 1, 2, 3};
    uint32_t bad[4 * SEVERAL];
    tc_tetrahedra_grid_options o;
    tc_extract_options options;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_extract_options_init(&options);
    tc_tetrahedra_grid_options_init(&o);
    EXPECT(tc_tetrahedra_grid_create(context, &o, &grid) == TC_OK, "nothing: %s", tc_message());
    EXPECT(tc_extract(grid, &options, &mesh) == TC_OK && !tc_mesh_get(mesh, &data) && !data.vertex_count,
           "a surface of nothing");
    tc_grid_destroy(grid);
    o.point_count = 4, o.type = TC_F64, o.tetrahedron_count = 1;
    EXPECT_REFUSED(tc_tetrahedra_grid_create(context, &o, &grid), TC_ERROR_ARGUMENT, "no points");
    o.points = points, o.samples = values;
    EXPECT_REFUSED(tc_tetrahedra_grid_create(context, &o, &grid), TC_ERROR_ARGUMENT, "no tetrahedra");
    o.tetrahedra = good;
    o.samples = (const char *)values + 1;
    EXPECT_REFUSED(tc_tetrahedra_grid_create(context, &o, &grid), TC_ERROR_ARGUMENT, "samples not aligned");
    o.samples = values;
    o.points = (const float *)((const char *)points + 2);
    EXPECT_REFUSED(tc_tetrahedra_grid_create(context, &o, &grid), TC_ERROR_ARGUMENT, "points not aligned");
    o.points = points;
    o.point_count = 0;
    EXPECT_REFUSED(tc_tetrahedra_grid_create(context, &o, &grid), TC_ERROR_DATA, "tetrahedra and no points");
    o.point_count = 4;
    o.tetrahedron_count = UINT64_C(1) << 32;
    EXPECT_REFUSED(tc_tetrahedra_grid_create(context, &o, &grid), TC_ERROR_LIMIT, "too many tetrahedra");
    o.tetrahedron_count = 1;
    o.type = (tc_type)77;
    EXPECT_REFUSED(tc_tetrahedra_grid_create(context, &o, &grid), TC_ERROR_ARGUMENT, "no type");
    o.type = TC_F64;
    EXPECT_REFUSED(tc_tetrahedra_grid_create(NULL, &o, &grid), TC_ERROR_ARGUMENT, "no context");
    EXPECT(tc_tetrahedra_grid_create(context, &o, &grid) == TC_OK, "one tetrahedron: %s", tc_message());
    options.isovalue = 1.5;
    options.normals = 1;
    EXPECT_REFUSED(tc_extract(grid, &options, &mesh), TC_ERROR_ARGUMENT, "normals");
    options.normals = 0;
    options.method = TC_METHOD_HYBRID;
    EXPECT_REFUSED(tc_extract(grid, &options, &mesh), TC_ERROR_ARGUMENT, "hybrid");
    options.method = TC_METHOD_TETRA;
    tc_device_mesh target = {.struct_size = sizeof target};
    EXPECT_REFUSED(tc_emit(grid, &options, &target, NULL), TC_ERROR_ARGUMENT, "emit");
    EXPECT(tc_extract(grid, &options, &mesh) == TC_OK && !tc_mesh_get(mesh, &data) && data.triangle_count == 2,
           "one tetrahedron: %s", tc_message());
    tc_grid_destroy(grid);
    for (uint32_t count = 2; count <= SEVERAL; count += SEVERAL - 2) {
        for (uint32_t n = 0; n < 4 * SEVERAL; n++) bad[n] = n % 4 + (n == 7);
        o.tetrahedra = bad, o.tetrahedron_count = count;
        if (tc_tetrahedra_grid_create(context, &o, &grid)) continue;
        EXPECT_REFUSED(tc_extract(grid, &options, &mesh), TC_ERROR_DATA, "a point that is not there");
        EXPECT(strstr(tc_message(), "tetrahedron 1 has point 4"), "not told which: %s", tc_message());
        tc_grid_destroy(grid);
    }
    tc_mesh_destroy(mesh);
}

/* Cancels at the call of that number: one later every time. */
static int cancel_after, cancel_calls;

static int cancel(void *user, const char *stage, double fraction) {
    (void)user, (void)stage, (void)fraction;
    return cancel_calls++ == cancel_after;
}

static void cancelled(tc_engine engine) {
    static const float points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint8_t values[4] = {0, 1, 2, 3};
    static const uint32_t tetrahedron[4] = {0, 1, 2, 3};
    tc_context_options how;
    tc_tetrahedra_grid_options o;
    tc_extract_options options;
    tc_mesh *mesh = NULL;
    tc_grid *grid = NULL;
    tc_context_options_init(&how);
    how.engine = engine, how.progress = cancel;
    tc_context *context = context_open(&how);
    tc_tetrahedra_grid_options_init(&o);
    o.point_count = 4, o.points = points, o.samples = values, o.tetrahedron_count = 1, o.tetrahedra = tetrahedron;
    tc_extract_options_init(&options);
    options.isovalue = 2;
    EXPECT(tc_tetrahedra_grid_create(context, &o, &grid) == TC_OK, "%s", tc_message());
    for (cancel_after = 0;; cancel_after++) {
        cancel_calls = 0;
        tc_status status = tc_extract(grid, &options, &mesh);
        if (cancel_calls <= cancel_after) {
            EXPECT(status == TC_OK, "after cancelling: %s", tc_message());
            break;
        }
        EXPECT(status == TC_ERROR_CANCELLED, "not cancelled");
    }
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    tc_context_destroy(context);
}

static void devices_open(bool always_copy) {
    static const uint32_t work_items[CONTEXTS] = {0, 1, 32, 64}, work_groups[CONTEXTS] = {0, 5, 3, 7};
    static const uint32_t tile_bricks[CONTEXTS] = {0, 1, 0, 3}, spin_limit[CONTEXTS] = {0, 1, 0, 1};
    for (int n = 0; n < CONTEXTS; n++) {
        tc_context_options how;
        tc_expert_options expert;
        options_init(&how, &expert);
        expert.work_items = work_items[n], expert.work_groups = work_groups[n];
        expert.tile_bricks = tile_bricks[n], expert.spin_limit = spin_limit[n];
        expert.always_copy = always_copy;
        devices[device_count++] = context_open(&how);
    }
}

int main(int argc, char **argv) {
    const bool always_copy = argc > 1 && !strcmp(argv[1], "always_copy");
    random_state = 4;
    reference = reference_open();
    const bool has_device = device_exists();
    if (has_device) devices_open(always_copy);
    refusals(reference);
    cancelled(TC_ENGINE_REFERENCE);
    if (has_device && test_chosen("refusals")) {
        refusals(devices[0]);
        cancelled(TC_ENGINE_OPENCL);
    }
    for (tc_type type = TC_U8; type <= TC_F64; type++) {
        mixed_block_compare(type, 1 + random_below(4), true, false);
        mixed_block_compare(type, 9, false, false);
        if (type_is_floating(type)) mixed_block_compare(type, 7, true, true);
    }
    mixed_block_compare(TC_F32, 21, true, false);
    for (int columns = 0; columns < 2; columns++) {
        faceted_block_compare(TC_U8, 4, columns);
        faceted_block_compare(TC_F64, 3, columns);
    }
    ends_compare();
    scattered_compare();
    grid_compare(TC_U8, false, false);
    grid_compare(TC_F32, false, true);
    grid_compare(TC_F32, true, false);
    grid_compare(TC_F64, false, false);
    for (int n = 0; n < device_count; n++) tc_context_destroy(devices[n]);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
