/*
 * test_geometry.c - surfaces of known fields: how fast their errors fall as grids get finer, and fields whose surfaces
 * are exact
 *
 * Sphere, torus and gyroid are sampled in double, at the places of the grid's points, on uniform grids, on curvilinear
 * ones and on complexes of hexahedra, and extracted by both methods from f32 and f64 samples. Linear interpolation
 * makes the largest distance of a vertex from the true surface, the area and the enclosed volume converge with the
 * square of the spacing: from every grid to one of half the spacing the observed order must lie between 1.8 and 2.2.
 *
 * Of a linear field every vertex lies on the plane to a few units in the last place, on any grid and in any type. Of a
 * quadratic one the value at a vertex is off by no more than L^2 |f''| / 8, L the longest edge, and that is reached.
 *
 * Usage: test_geometry [long SHAPE]: of one shape, both types everywhere and one resolution more
 */
#include "analytic.h"

#include "engines.h"
#include "samples.h"

#include <float.h>
#include <math.h>

enum { LEVELS_MOST = 4 };

static tc_context *reference;
static tc_mesh *mesh;

static void *memory_get(size_t bytes) {
    void *memory = malloc(bytes);
    if (memory) return memory;
    printf("no memory\n");
    exit(EXIT_FAILURE);
}

/* The mesh, which stays until the next one; false where there is none. */
static bool surface_get(const field_grid *g, layout l, tc_method method, double isovalue, tc_mesh_data *data) {
    const tc_status status = field_grid_extract(g, reference, l, method, isovalue, &mesh, data);
    EXPECT(!status, "no mesh of %d^3 samples: %s", (int)g->n, tc_message());
    return !status;
}

/* ------------------------------------------------------------------------------------------------------ convergence */

enum { VERTEX, AREA, VOLUME, ERRORS };

static const char *const error_names[ERRORS] = {"vertex", "area", "volume"};

typedef struct errors {
    double of[ERRORS];
} errors;

static void triangle_get(const tc_mesh_data *m, uint64_t t, double p[3][3]) {
    for (int n = 0; n < 3; n++)
        for (int axis = 0; axis < 3; axis++)
            p[n][axis] = (double)m->positions[3 * (size_t)m->triangles[3 * t + (uint64_t)n] + (size_t)axis];
}

/* The volume is the flux of a third of (x, y, z): through the surface, and through the planes in which the domain
 * ends. */
static errors errors_of(const shape *s, place origin, const tc_mesh_data *m) {
    errors e = {{0}};
    double area = 0, volume = 0;
    for (int axis = 0; axis < 3; axis++) volume += s->high * s->cap(s->high + origin.of[axis]) / 3;
    for (uint64_t n = 0; n < m->vertex_count; n++) {
        double p[3];
        for (size_t axis = 0; axis < 3; axis++) p[axis] = (double)m->positions[3 * n + axis] + origin.of[axis];
        e.of[VERTEX] = fmax(e.of[VERTEX], s->distance(p));
    }
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], u[3], v[3], normal[3];
        triangle_get(m, t, p);
        for (int axis = 0; axis < 3; axis++) u[axis] = p[1][axis] - p[0][axis], v[axis] = p[2][axis] - p[0][axis];
        for (int n = 0; n < 3; n++)
            normal[n] = 0.5 * (u[(n + 1) % 3] * v[(n + 2) % 3] - u[(n + 2) % 3] * v[(n + 1) % 3]);
        area += hypot(hypot(normal[0], normal[1]), normal[2]);
        for (int axis = 0; axis < 3; axis++) volume += normal[axis] * (p[0][axis] + p[1][axis] + p[2][axis]) / 9;
    }
    e.of[AREA] = area - s->area;
    e.of[VOLUME] = volume - s->volume;
    return e;
}

/* The largest error of vertices, the mean of the others: of a single grid these depend on how it happens to lie. */
static void errors_add(errors *sum, const errors *one, int count) {
    sum->of[VERTEX] = fmax(sum->of[VERTEX], one->of[VERTEX]);
    for (int n = AREA; n < ERRORS; n++) sum->of[n] += one->of[n] / count;
}

/* Between grids of which each has half the spacing of the one before. */
static double order_between(double coarse, double fine) { return log2(fabs(coarse / fine)); }

static bool order_is_right(double order) { return order >= 1.8 && order <= 2.2; }

/* The error, of those in the mask, that does not fall as it should; NULL where all do. */
static const char *order_fault(const errors *levels, int count, unsigned mask) {
    for (int n = 0; n < ERRORS; n++)
        for (int level = 1; level < count && (mask >> n & 1); level++)
            if (!order_is_right(order_between(levels[level - 1].of[n], levels[level].of[n]))) return error_names[n];
    return NULL;
}

static void levels_print(const char *name, const errors *levels, int count) {
    printf("order %s:", name);
    for (int n = 0; n < ERRORS; n++) {
        printf(" %s", error_names[n]);
        for (int level = 1; level < count; level++)
            printf(" %.3f", order_between(levels[level - 1].of[n], levels[level].of[n]));
        printf(" (last error %.3g)%s", levels[count - 1].of[n], n + 1 < ERRORS ? "," : "\n");
    }
}

typedef enum plant { NONE, ROUNDED, TURNED, HOLES, SHIFTED, ONE_MOVED, PLANTS } plant;

static const struct {
    const char *name;
    unsigned found_by; /* bits of errors that must not fall as they should */
} plants[PLANTS] = {{"nothing", 0},
                    {"vertices rounded to quarters of the spacing", 1 << VERTEX},
                    {"all triangles turned round", 1 << VOLUME},
                    {"one triangle in 200 left out", 1 << AREA | 1 << VOLUME},
                    {"half a spacing beside", 1 << VERTEX},
                    {"one vertex moved by a quarter of the spacing", 1 << VERTEX}};

/* A fault put into a copy of the mesh of a grid of that spacing; its arrays are the caller's to free. */
static tc_mesh_data plant_fault(plant what, const tc_mesh_data *m, double step) {
    float *positions = memory_get(12 * (size_t)m->vertex_count);
    uint32_t *triangles = memory_get(12 * (size_t)m->triangle_count);
    tc_mesh_data damaged = *m;
    damaged.positions = positions, damaged.triangles = triangles;
    memcpy(positions, m->positions, 12 * (size_t)m->vertex_count);
    memcpy(triangles, m->triangles, 12 * (size_t)m->triangle_count);
    for (uint64_t n = 0; n < 3 * m->vertex_count; n++) {
        if (what == ROUNDED) positions[n] = (float)(step / 4 * round((double)positions[n] / (step / 4)));
        if (what == SHIFTED && n % 3 == 1) positions[n] += (float)(step / 2);
    }
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        uint32_t *v = triangles + 3 * t;
        const uint32_t first = v[0];
        if (what == TURNED) v[0] = v[1], v[1] = first;
        if (what == HOLES && t % 200 == 0) v[0] = v[1];
    }
    if (what == ONE_MOVED) positions[3 * (m->vertex_count / 2)] += (float)(step / 4);
    return damaged;
}

typedef struct series {
    const shape *shape;
    layout layout;
    tc_method method;
    tc_type type;
    int64_t coarsest; /* samples along an axis */
    int levels;
    int places; /* of the finest grid; twice as many of each coarser one, whose errors scatter more */
} series;

/* ONE_MOVED is put into one mesh, of the finest grid. */
static void series_measure(const series *r, plant what, errors levels[LEVELS_MOST]) {
    const shape *s = r->shape;
    for (int level = 0; level < r->levels; level++) {
        const int places = r->places << (r->levels - 1 - level);
        levels[level] = (errors){{0}};
        for (int n = 0; n < places; n++) {
            tc_mesh_data data;
            const place origin = place_choose(n, s->room);
            const int64_t size = ((r->coarsest - 1) << level) + 1;
            field_grid g = field_grid_make(s->value, s->low, s->high, origin, size, r->layout != UNIFORM, r->type);
            if (surface_get(&g, r->layout, r->method, s->isovalue, &data)) {
                const bool spared = what == ONE_MOVED && (level + 1 < r->levels || n > 0);
                tc_mesh_data damaged = plant_fault(spared ? NONE : what, &data, g.step);
                const errors one = errors_of(s, origin, &damaged);
                errors_add(&levels[level], &one, places);
                free((void *)(uintptr_t)damaged.positions);
                free((void *)(uintptr_t)damaged.triangles);
            }
            field_grid_free(&g);
        }
    }
}

static void series_converges(const series *r) {
    errors levels[LEVELS_MOST];
    char name[80];
    snprintf(name, sizeof name, "%s, %s, %s, %s", r->shape->name, layout_name(r->layout),
             r->method == TC_METHOD_HYBRID ? "hybrid" : "tetra", tc_type_name(r->type));
    series_measure(r, NONE, levels);
    const char *fault = order_fault(levels, r->levels, 7);
    EXPECT(!fault, "%s: the %s error does not fall as the square of the spacing", name, fault);
    levels_print(name, levels, r->levels);
}

static void test_planted_faults(const shape *s) {
    const series r = {s, UNIFORM, TC_METHOD_TETRA, TC_F64, 17, 3, 2};
    for (plant p = NONE + 1; p < PLANTS; p++) {
        errors levels[LEVELS_MOST];
        series_measure(&r, p, levels);
        for (unsigned n = 0; n < ERRORS; n++)
            if (plants[p].found_by >> n & 1)
                EXPECT(order_fault(levels, r.levels, 1u << n), "%s, %s: not found by the %s error", s->name,
                       plants[p].name, error_names[n]);
    }
    printf("planted faults, %s: %d found\n", s->name, PLANTS - 1);
}

/* ---------------------------------------------------------------------------------------------------- exact fields */

static const double plane[3] = {1, 2, -3};

static double plane_value(const double p[3]) { return 60 + plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2]; }

/* The largest error of a plane's vertices, in units of what one rounding of coordinates and samples is. */
static double plane_error(const tc_mesh_data *m, double isovalue, double extent) {
    const double unit = FLT_EPSILON / 2 * (6 * extent + 128);
    double most = 0;
    for (uint64_t n = 0; n < m->vertex_count; n++) {
        const float *v = m->positions + 3 * n;
        const double p[3] = {(double)v[0], (double)v[1], (double)v[2]};
        most = fmax(most, fabs(plane_value(p) - isovalue) / unit);
    }
    return most;
}

enum { PLANE_ROUNDINGS = 3 }; /* of the crossing, the way along the edge, and the coordinate */

static void test_planes(void) {
    double worst = 0;
    for (layout l = UNIFORM; l < LAYOUTS; l++)
        for (tc_type type = TC_U8; type <= TC_F64; type++) {
            tc_mesh_data data;
            const bool whole = !type_is_floating(type); /* samples of whole values at whole places */
            if (whole && l == CURVILINEAR) continue;
            const double isovalue = 71.7;
            field_grid g = field_grid_make(plane_value, 0, 16, (place){{0}}, 17, l != UNIFORM && !whole, type);
            if (!surface_get(&g, l, TC_METHOD_TETRA, isovalue, &data)) return;
            const double error = plane_error(&data, isovalue, 16);
            EXPECT(data.triangle_count > 500 && error <= PLANE_ROUNDINGS,
                   "plane, %s, %s: %llu triangles, off by %g roundings", layout_name(l), tc_type_name(type),
                   (unsigned long long)data.triangle_count, error);
            worst = fmax(worst, error);
            float *positions = memory_get(12 * (size_t)data.vertex_count);
            memcpy(positions, data.positions, 12 * (size_t)data.vertex_count);
            positions[7] += 0x1p-14f;
            data.positions = positions;
            EXPECT(plane_error(&data, isovalue, 16) > PLANE_ROUNDINGS, "a vertex moved by %g is not found", 0x1p-14);
            free(positions);
            field_grid_free(&g);
        }
    printf("planes: off by %.2f roundings at most\n", worst);
}

/* |p|^2 changes along an edge of length L by L^2 / 4 from its chord; edges are diagonals or, of the hybrid, sides. */
static void test_error_bound(void) {
    const shape *sphere = &shapes[0];
    for (int method = 0; method < 2; method++) {
        tc_mesh_data data;
        field_grid g = field_grid_make(sphere->value, -1, 1, (place){{0}}, 41, false, TC_F64);
        const double bound = (method ? 0.25 : 0.5) * g.step * g.step;
        double most = 0;
        if (!surface_get(&g, UNIFORM, (tc_method)method, sphere->isovalue, &data)) return;
        for (uint64_t n = 0; n < data.vertex_count; n++) {
            const float *v = data.positions + 3 * n;
            const double p[3] = {(double)v[0], (double)v[1], (double)v[2]};
            most = fmax(most, fabs(sphere->value(p) - sphere->isovalue));
        }
        EXPECT(most <= bound * (1 + 1e-3) && most >= 0.98 * bound, "method %d: values off by %g, not %g", method, most,
               bound);
        printf("values at vertices: off by %.4f of the bound\n", most / bound);
        field_grid_free(&g);
    }
}

static void test_shape(const shape *s, bool finer) {
    for (layout l = UNIFORM; l < LAYOUTS; l++)
        for (int method = 0; method < (l == HEXAHEDRA ? 1 : 2); method++)
            for (tc_type type = TC_F32; type <= TC_F64; type++) {
                const bool plain = l == UNIFORM && method == TC_METHOD_TETRA;
                const int levels = finer && l != HEXAHEDRA ? 4 : 3;
                if (!finer && type == TC_F64 && !plain) continue;
                series_converges(&(series){s, l, (tc_method)method, type, 17, levels, levels == 4 ? 4 : 8});
            }
    test_planted_faults(s);
}

int main(int argc, char **argv) {
    const bool finer = argc > 2 && !strcmp(argv[1], "long");
    reference = reference_open();
    for (size_t n = 0; n < SHAPES; n++)
        if (!finer || !strcmp(argv[2], shapes[n].name)) test_shape(&shapes[n], finer);
    test_planes();
    test_error_bound();
    tc_mesh_destroy(mesh);
    tc_context_destroy(reference);
    return EXPECT_DONE();
}
