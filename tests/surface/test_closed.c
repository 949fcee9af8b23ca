/*
 * test_closed.c - closed surfaces of the reference engine: every edge is used as often one way as the other, so none is
 * on a border; the volume enclosed is that of the part of the tetrahedra that is inside, which is computed from them
 *
 * All patterns of a cube, and random grids of all methods: uniform, mirrored and curvilinear, some with missing
 * samples. So are grids of tetrahedra that these are cut into, which begin with the open surface.
 *
 * Usage: test_closed [COUNT]: so many random grids in place of 3,000
 */
#include "closed.h"
#include "engines.h"
#include "random.h"

#include <math.h>

enum { PATTERNS = 2 * 256, SAMPLES_MOST = 512 };

/* points: where samples are, x, y, z each. */
static double inside_of_grid(const tc_grid_options *g, const float *points, double iso) {
    tc_tetrahedra t = {.struct_size = sizeof t};
    if (tc_tetrahedralize_grid(g, &t)) return NAN;
    const double sum = inside_of_tetrahedra(&t, points, g->samples, iso);
    tc_tetrahedra_release(&t);
    return sum;
}

/* Extracts with a method; the mesh is closed, with the right volume. */
static void grid_try(tc_context *context, const tc_grid_options *g, const float *points, tc_method method, int number) {
    const double iso = 0.5;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data m = {.struct_size = sizeof m};
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = iso, how.method = method, how.closed = 1;
    const bool made = !tc_grid_create(context, g, &grid) && !tc_extract(grid, &how, &mesh) && !tc_mesh_get(mesh, &m);
    EXPECT(made, "grid %d, %s: %s", number, tc_method_name(method), tc_message());
    EXPECT(is_closed(&m, m.triangle_count), "grid %d, %s: not closed", number, tc_method_name(method));
    if (m.triangle_count)
        EXPECT(!is_closed(&m, m.triangle_count - 1), "grid %d, %s: a missing triangle is not seen", number,
               tc_method_name(method));
    const double inside = inside_of_grid(g, points, iso);
    if (method == TC_METHOD_TETRA)
        EXPECT(fabs(enclosed(&m) - inside) < 1e-3, "grid %d: volume %g, of the tetrahedra %g", number, enclosed(&m),
               inside);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
}

/* The same cut into tetrahedra: closed, counted, with points carried to where they are. */
static void complex_try(tc_context *context, const tc_grid_options *g, const float *points, int number) {
    tc_tetrahedra_grid_options o;
    tc_tetrahedra t = {.struct_size = sizeof t};
    tc_grid *grid = NULL;
    tc_mesh *meshes[2] = {NULL, NULL};
    tc_mesh_data m[2] = {{.struct_size = sizeof m[0]}, {.struct_size = sizeof m[0]}};
    tc_counts counts = {.struct_size = sizeof counts};
    tc_extract_options how;
    float *carried = NULL;
    tc_field field = {.struct_size = sizeof field, .type = TC_F32, .components = 3, .values = points};
    tc_extract_options_init(&how);
    how.isovalue = 0.5;
    tc_tetrahedra_grid_options_init(&o);
    bool made = !tc_tetrahedralize_grid(g, &t);
    o.point_count = (uint64_t)(g->dims[0] * g->dims[1] * g->dims[2]);
    o.points = points, o.type = TC_F32, o.samples = g->samples;
    o.tetrahedron_count = t.tetrahedron_count, o.tetrahedra = t.tetrahedra;
    made = made && !tc_tetrahedra_grid_create(context, &o, &grid);
    for (how.closed = 0; how.closed < 2 && made; how.closed++)
        made = !tc_extract(grid, &how, &meshes[how.closed]) && !tc_mesh_get(meshes[how.closed], &m[how.closed]);
    how.closed = 1;
    made = made && !tc_count(grid, &how, &counts) && (carried = malloc(12 * m[1].vertex_count + 1));
    made = made && !tc_interpolate_field(grid, &how, &field, carried, 3 * m[1].vertex_count);
    EXPECT(made, "tetrahedra %d: %s", number, tc_message());
    EXPECT(!made || (counts.vertex_count == m[1].vertex_count && counts.triangle_count == m[1].triangle_count),
           "tetrahedra %d: counts differ", number);
    EXPECT(!made || carried_are_positions(carried, &m[1]),
           "tetrahedra %d: points that are carried are not the vertices", number);
    EXPECT(!made || begins_with(&m[1], &m[0]), "tetrahedra %d: the open surface is another", number);
    EXPECT(is_closed(&m[1], m[1].triangle_count), "tetrahedra %d: not closed", number);
    const double inside = inside_of_grid(g, points, how.isovalue);
    EXPECT(fabs(enclosed(&m[1]) - inside) < 1e-3, "tetrahedra %d: volume %g, of the tetrahedra %g", number,
           enclosed(&m[1]), inside);
    free(carried);
    for (int n = 0; n < 2; n++) tc_mesh_destroy(meshes[n]);
    tc_grid_destroy(grid);
    tc_tetrahedra_release(&t);
}

/* Patterns of a cube in both parities, then random grids. */
static void number_try(tc_context *context, int number) {
    static float samples[SAMPLES_MOST], points[3 * SAMPLES_MOST];
    const bool is_pattern = number < PATTERNS;
    const uint32_t kind = is_pattern ? 0 : random_below(4);
    const bool mirrored = kind & 1, moved = kind & 2;
    tc_grid_options g;
    tc_grid_options_init(&g);
    for (int axis = 0; axis < 3; axis++) g.dims[axis] = is_pattern ? 2 : 2 + random_below(6);
    g.first_index[0] = is_pattern ? number / 256 : (int)random_below(2);
    g.matrix[0][3] = -(double)g.first_index[0];
    g.type = TC_F32, g.samples = samples;
    for (int n = 0; n < SAMPLES_MOST; n++)
        samples[n] = is_pattern ? (number >> (n & 7) & 1 ? 0.75f : 0.125f) : (float)random_below(9) / 8;
    for (int64_t n = 0; n < g.dims[0] * g.dims[1] * g.dims[2]; n++) {
        const int64_t at[3] = {n % g.dims[0], n / g.dims[0] % g.dims[1], n / g.dims[0] / g.dims[1]};
        for (int axis = 0; axis < 3; axis++)
            points[3 * n + axis] = (float)((double)at[axis] + (moved ? random_between(-0.2, 0.2) : 0));
        if (mirrored) points[3 * n] = -points[3 * n];
    }
    if (moved) g.points = points;
    if (mirrored && !moved) g.matrix[0][0] = -1, g.matrix[0][3] = -g.matrix[0][3];
    if (!is_pattern && number % 3 == 0) g.has_nodata = 1, g.nodata = 0.25;
    for (int m = 0; tc_method_name((tc_method)m); m++) grid_try(context, &g, points, (tc_method)m, number);
    complex_try(context, &g, points, number);
}

int main(int argc, char **argv) {
    const int count = argc > 1 ? atoi(argv[1]) : 3000;
    tc_context *context = reference_open();
    random_state = 1996;
    for (int n = 0; n < PATTERNS + count; n++) number_try(context, n);
    tc_context_destroy(context);
    return EXPECT_DONE();
}
