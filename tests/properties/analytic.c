#include "analytic.h"

#include "complex.h"
#include "samples.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void *memory_get(size_t bytes) {
    void *memory = malloc(bytes);
    if (memory) return memory;
    printf("no memory\n");
    exit(EXIT_FAILURE);
}

/* ----------------------------------------------------------------------------------------------------------- fields */

#define PI     3.14159265358979323846
#define RADIUS 0.71 /* of the sphere */
#define RING   0.55 /* of the torus */
#define TUBE   0.27
#define LEVEL  0.8 /* of the gyroid */

static double square_of(const double p[3]) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2]; }

static double sphere_value(const double p[3]) { return -square_of(p); }
static double sphere_distance(const double p[3]) { return fabs(sqrt(square_of(p)) - RADIUS); }

static double tube_square(const double p[3]) {
    const double from_ring = hypot(p[0], p[1]) - RING;
    return from_ring * from_ring + p[2] * p[2];
}

static double torus_value(const double p[3]) { return -tube_square(p); }
static double torus_distance(const double p[3]) { return fabs(sqrt(tube_square(p)) - TUBE); }

static double gyroid_value(const double p[3]) {
    return sin(p[0]) * cos(p[1]) + sin(p[1]) * cos(p[2]) + sin(p[2]) * cos(p[0]);
}

static double gyroid_distance(const double p[3]) {
    double gradient[3];
    for (int n = 0; n < 3; n++) {
        const double x = p[n], y = p[(n + 1) % 3], z = p[(n + 2) % 3];
        gradient[n] = cos(x) * cos(y) - sin(z) * sin(x);
    }
    return fabs(gyroid_value(p) - LEVEL) / sqrt(square_of(gradient));
}

static double no_cap(double x) { return 0 * x; }

/* For given y, sin x cos y + sin y cos z + sin z cos x is a wave in z around its first term. */
static double gyroid_cap(double x) {
    enum { STEPS = 20000 };
    double sum = 0;
    for (int n = 0; n < STEPS; n++) {
        const double y = 2 * PI * n / STEPS, height = (LEVEL - sin(x) * cos(y)) / hypot(sin(y), cos(x));
        sum += 2 * acos(fmax(-1, fmin(1, height)));
    }
    return sum * 2 * PI / STEPS;
}

/* Roberts' sequence in three dimensions. */
place place_choose(int n, double room) {
    static const double steps[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    place p;
    for (int axis = 0; axis < 3; axis++) p.of[axis] = room * fmod(0.5 + n * steps[axis], 1);
    return p;
}

/* The radii are no multiples of a spacing. */
const shape shapes[SHAPES] = {
    {"sphere", sphere_value, sphere_distance, -RADIUS *RADIUS, -1, 1, 4 * PI *RADIUS *RADIUS,
     4 * PI / 3 * RADIUS *RADIUS *RADIUS, no_cap, 0.12},
    {"torus", torus_value, torus_distance, -TUBE *TUBE, -1, 1, 4 * PI *PI *RING *TUBE, 2 * PI *PI *RING *TUBE *TUBE,
     no_cap, 0.12},
    {"gyroid", gyroid_value, gyroid_distance, LEVEL, 0, 2 * PI, 106.00102046, 59.217285386, gyroid_cap, 2 * PI},
};

/* ------------------------------------------------------------------------------------------------------------ grids */

const char *layout_name(layout l) {
    static const char *const names[LAYOUTS] = {"uniform", "curvilinear", "hexahedra"};
    return names[l];
}

/* Points of the uniform grid as the library makes them, or moved by a smooth map that keeps the domain's faces. */
static void points_make(field_grid *g, bool mapped, double high) {
    const double turn = 2 * PI / (high - g->low), size = 0.12 * (high - g->low) / (2 * PI);
    size_t at = 0;
    for (int64_t z = 0; z < g->n; z++)
        for (int64_t y = 0; y < g->n; y++)
            for (int64_t x = 0; x < g->n; x++) {
                const int64_t index[3] = {x, y, z};
                double p[3];
                for (int axis = 0; axis < 3; axis++) p[axis] = g->low + g->step * (double)index[axis];
                for (int axis = 0; axis < 3; axis++) {
                    const double u = turn * (p[axis] - g->low), v = turn * (p[(axis + 1) % 3] - g->low);
                    g->points[at++] = (float)(p[axis] + (mapped ? size * sin(u) * (1 + cos(v)) : 0));
                }
            }
}

field_grid field_grid_make(field_value *value, double low, double high, place origin, int64_t n, bool mapped,
                           tc_type type) {
    field_grid g = {.n = n, .type = type, .low = low, .step = (double)(float)((high - low) / (double)(n - 1))};
    const size_t count = (size_t)(n * n * n);
    g.points = memory_get(12 * count);
    g.samples = memory_get(8 * count);
    points_make(&g, mapped, high);
    for (size_t m = 0; m < count; m++) {
        double p[3];
        for (size_t axis = 0; axis < 3; axis++) p[axis] = (double)g.points[3 * m + axis] + origin.of[axis];
        sample_set(g.samples, type, (int64_t)m, value(p));
    }
    return g;
}

void field_grid_free(field_grid *g) {
    free(g->points);
    free(g->samples);
}

static tc_status hexahedra_create(const field_grid *g, tc_context *context, tc_tetrahedra *complex, tc_grid **grid) {
    static const uint8_t order[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    const uint32_t n = (uint32_t)g->n, m = n - 1;
    cell_list list = cell_list_make(0, (uint64_t)m * m * m);
    free(list.points);
    list.points = g->points;
    list.point_count = (uint64_t)n * n * n;
    for (uint32_t cell = 0; cell < m * m * m; cell++) {
        uint32_t corners[8];
        for (uint32_t c = 0; c < 8; c++)
            corners[c] = ((cell / m / m + (order[c] >> 2)) * n + cell / m % m + (order[c] >> 1 & 1)) * n + cell % m +
                         (order[c] & 1);
        cell_list_add(&list, 12, 8, corners, false);
    }
    tc_cells cells = cell_list_view(&list);
    tc_tetrahedra_grid_options options;
    tc_tetrahedra_grid_options_init(&options);
    tc_status status = tc_tetrahedralize(&cells, complex);
    options.point_count = list.point_count, options.points = g->points;
    options.type = g->type, options.samples = g->samples;
    options.tetrahedron_count = complex->tetrahedron_count, options.tetrahedra = complex->tetrahedra;
    if (!status) status = tc_tetrahedra_grid_create(context, &options, grid);
    list.points = NULL;
    cell_list_free(&list);
    return status;
}

static tc_status structured_create(const field_grid *g, tc_context *context, layout l, tc_grid **grid) {
    tc_grid_options options;
    tc_grid_options_init(&options);
    for (int axis = 0; axis < 3; axis++) {
        options.dims[axis] = g->n;
        options.matrix[axis][axis] = g->step;
        options.matrix[axis][3] = g->low;
    }
    options.type = g->type;
    options.samples = g->samples;
    if (l == CURVILINEAR) options.points = g->points;
    return tc_grid_create(context, &options, grid);
}

tc_status field_grid_extract(const field_grid *g, tc_context *context, layout l, tc_method method, double isovalue,
                             tc_mesh **mesh, tc_mesh_data *data) {
    tc_grid *grid = NULL;
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    tc_extract_options how;
    tc_extract_options_init(&how);
    how.isovalue = isovalue;
    how.method = method;
    *data = (tc_mesh_data){.struct_size = sizeof *data};
    tc_status status =
        l == HEXAHEDRA ? hexahedra_create(g, context, &complex, &grid) : structured_create(g, context, l, &grid);
    if (!status) status = tc_extract(grid, &how, mesh);
    if (!status) status = tc_mesh_get(*mesh, data);
    tc_grid_destroy(grid);
    tc_tetrahedra_release(&complex);
    return status;
}
