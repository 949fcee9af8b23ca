/*
 * Closed surfaces of the reference engine: every edge is used as often one way as the other, so none is on a border;
 * the volume enclosed is that of the part of the tetrahedra that is inside, which is computed from them. All patterns
 * of a cube, and random grids of all methods, some with missing samples.
 */
#include "tetracubes.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { RANDOM_GRIDS = 3000, SAMPLES_MOST = 512 };

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

static double inside_of_tetrahedra(const tc_grid_options *g, double iso) {
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
                p[at][0] = (double)(s % g->dims[0]), p[at][1] = (double)(s / g->dims[0] % g->dims[1]);
                p[at][2] = (double)(s / g->dims[0] / g->dims[1]);
                f[at++] = samples[s], inside += side;
            }
        sum += part_inside(p, f, inside, iso);
    }
    tc_tetrahedra_release(&t);
    return sum;
}

/* Extracts with a method; returns whether the mesh is closed, with the right volume. */
static int grid_try(tc_context *context, const tc_grid_options *g, tc_method method, double iso) {
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data m = {.struct_size = sizeof m};
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = iso, how.method = method, how.closed = 1;
    int good = !tc_grid_create(context, g, &grid) && !tc_extract(grid, &how, &mesh) && !tc_mesh_get(mesh, &m);
    good = good && is_closed(&m, m.triangle_count);
    if (good && m.triangle_count) good = !is_closed(&m, m.triangle_count - 1); /* a missing triangle is seen */
    if (good && method == TC_METHOD_TETRA) good = fabs(enclosed(&m) - inside_of_tetrahedra(g, iso)) < 1e-3;
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    return good;
}

static uint64_t state = 1;
static uint32_t next(uint32_t below) {
    state = state * UINT64_C(6364136223846793005) + 1442695040888963407u;
    return (uint32_t)(state >> 33) % below;
}

int main(void) {
    tc_context *context = NULL;
    tc_context_options device;
    float samples[SAMPLES_MOST];
    int failed = 0;
    tc_context_options_init(&device);
    device.engine = TC_ENGINE_REFERENCE;
    if (tc_context_create(&device, &context)) return 1;
    for (int n = 0; n < 2 * 256 + RANDOM_GRIDS; n++) {
        tc_grid_options g;
        tc_grid_options_init(&g);
        for (int axis = 0; axis < 3; axis++) g.dims[axis] = n < 512 ? 2 : 2 + (int64_t)next(6);
        g.first_index[0] = n < 512 ? n / 256 : (int64_t)next(2);
        g.type = TC_F32, g.samples = samples;
        for (int s = 0; s < SAMPLES_MOST; s++)
            samples[s] = n < 512 ? (n >> (s & 7) & 1 ? 0.75f : 0.125f) : (float)next(9) / 8;
        if (n % 3 == 0) g.has_nodata = n >= 512, g.nodata = 0.25;
        for (int method = TC_METHOD_TETRA; method <= TC_METHOD_SNAP; method++)
            if (!grid_try(context, &g, (tc_method)method, 0.5)) {
                if (failed++ < 10) printf("grid %d, %s: not closed, or another volume\n", n, tc_method_name(method));
            }
    }
    tc_context_destroy(context);
    printf("%d failed\n", failed);
    return failed != 0;
}
