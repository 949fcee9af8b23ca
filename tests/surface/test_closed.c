/*
 * test_closed.c - closed surfaces of the reference engine: every edge is used as often one way as the other, so none is
 * on a border; the volume enclosed is that of the part of the tetrahedra that is inside, which is computed from them
 *
 * All patterns of a cube, and random grids of all methods: uniform, mirrored and curvilinear, some with missing
 * samples. So are grids of tetrahedra that these are cut into, which begin with the open surface.
 *
 * Usage: test_closed [COUNT]: so many random grids in place of 3,000
 */
#include "engines.h"
#include "random.h"

#include <math.h>

enum { PATTERNS = 2 * 256, SAMPLES_MOST = 512 };

typedef struct edge {
    uint32_t from, to;
} edge;

static int edges_compare(const void *a, const void *b) {
    const edge *p = a, *q = b;
    if (p->from != q->from) return p->from < q->from ? -1 : 1;
    return p->to < q->to ? -1 : p->to > q->to;
}

static void edges_fill(const tc_mesh_data *m, uint64_t count, int turned, edge *out) {
    for (uint64_t n = 0; n < 3 * count; n++) {
        const uint32_t a = m->triangles[n], b = m->triangles[n % 3 == 2 ? n - 2 : n + 1];
        out[n] = turned ? (edge){b, a} : (edge){a, b};
    }
    qsort(out, 3 * count, sizeof *out, edges_compare);
}

/* Whether the first `count` triangles have no border. */
static int is_closed(const tc_mesh_data *m, uint64_t count) {
    edge *forth = malloc((3 * count + 1) * sizeof *forth), *back = malloc((3 * count + 1) * sizeof *back);
    int closed = forth && back;
    if (closed) edges_fill(m, count, 0, forth), edges_fill(m, count, 1, back);
    for (uint64_t n = 0; n < 3 * count && closed; n++) closed = edges_compare(&forth[n], &back[n]) == 0;
    free(forth);
    free(back);
    return closed;
}

static double volume_between(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3], w[3];
    for (int n = 0; n < 3; n++) u[n] = b[n] - a[n], v[n] = c[n] - a[n], w[n] = d[n] - a[n];
    return ((u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
            (u[0] * v[1] - u[1] * v[0]) * w[2]) /
           6;
}

static double enclosed(const tc_mesh_data *m) {
    static const double zero[3];
    double sum = 0, p[3][3];
    for (uint64_t n = 0; n < m->triangle_count; n++) {
        for (int k = 0; k < 9; k++)
            p[k / 3][k % 3] = m->positions[3 * m->triangles[3 * n + (uint64_t)k / 3] + (uint64_t)k % 3];
        sum += volume_between(zero, p[0], p[1], p[2]);
    }
    return sum;
}

static void cross(const double *p, const double *q, double f, double g, double iso, double out[3]) {
    for (int n = 0; n < 3; n++) out[n] = p[n] + (iso - f) / (g - f) * (q[n] - p[n]);
}

/* Of the inside part of a tetrahedron; the corners inside come first. */
static double part_inside(double p[4][3], const double f[4], int inside, double iso) {
    const double whole = fabs(volume_between(p[0], p[1], p[2], p[3]));
    double x[4][3];
    if (inside == 0 || inside == 4) return inside ? whole : 0;
    if (inside == 2) {
        for (int n = 0; n < 4; n++) cross(p[n / 2], p[2 + n % 2], f[n / 2], f[2 + n % 2], iso, x[n]);
        return fabs(volume_between(p[0], x[0], x[1], p[1])) + fabs(volume_between(x[0], x[1], p[1], x[3])) +
               fabs(volume_between(x[0], p[1], x[2], x[3]));
    }
    const int tip = inside == 1 ? 0 : 3;
    for (int n = 0, k = 0; n < 4; n++)
        if (n != tip) cross(p[tip], p[n], f[tip], f[n], iso, x[k++]);
    const double cut = fabs(volume_between(p[tip], x[0], x[1], x[2]));
    return inside == 1 ? cut : whole - cut;
}

/* points: where samples are, x, y, z each. */
static double inside_of_tetrahedra(const tc_grid_options *g, const float *points, double iso) {
    tc_tetrahedra t = {.struct_size = sizeof t};
    const float *samples = g->samples;
    double sum = 0;
    if (tc_tetrahedralize_grid(g, &t)) return NAN;
    for (uint64_t n = 0; n < t.tetrahedron_count; n++) {
        double p[4][3], f[4];
        int at = 0, inside = 0;
        for (int side = 1; side >= 0; side--)
            for (int v = 0; v < 4; v++) {
                const int64_t s = t.tetrahedra[4 * n + (uint64_t)v];
                if ((samples[s] >= iso) != side) continue;
                for (int axis = 0; axis < 3; axis++) p[at][axis] = points[3 * s + axis];
                f[at++] = samples[s], inside += side;
            }
        sum += part_inside(p, f, inside, iso);
    }
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
    const double inside = inside_of_tetrahedra(g, points, iso);
    if (method == TC_METHOD_TETRA)
        EXPECT(fabs(enclosed(&m) - inside) < 1e-3, "grid %d: volume %g, of the tetrahedra %g", number, enclosed(&m),
               inside);
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
}

/* The open surface comes first, with the same numbers. */
static int begins_with(const tc_mesh_data *whole, const tc_mesh_data *open) {
    int same = open->vertex_count <= whole->vertex_count && open->triangle_count <= whole->triangle_count;
    for (uint64_t n = 0; n < 3 * open->vertex_count && same; n++) same = open->positions[n] == whole->positions[n];
    for (uint64_t n = 0; n < 3 * open->triangle_count && same; n++) same = open->triangles[n] == whole->triangles[n];
    return same;
}

/* Points that are carried are where the vertices are, but for rounding. */
static int carried_are_positions(const float *carried, const tc_mesh_data *m) {
    int same = 1;
    for (uint64_t n = 0; n < 3 * m->vertex_count && same; n++)
        same = fabs((double)carried[n] - (double)m->positions[n]) < 1e-5;
    return same;
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
    const double inside = inside_of_tetrahedra(g, points, how.isovalue);
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
