/*
 * test_simplify.c - what simplified surfaces are judged by: folds and borders, distances, and where a surface is no
 * longer what it was
 *
 * On a torus, of which a part may be left out, and into which faults are planted one by one.
 */
#include "expect.h"
#include "failure.h"
#include "mesh_distance.h"
#include "mesh_edges.h"
#include "surface_faults.h"
#define TORUS_SIDE 12
#include "torus.h"

enum { SURFACES = 300, POINTS = 12, FACES = 30 };

static const double fold_cosine = -0.8660254037844386;

/* ------------------------------------------------------------------------------------------------------------ edges */

static mesh_edges edges_of(const torus *m, uint64_t triangle_count) {
    mesh_edges found;
    EXPECT(mesh_edges_find(m->positions[0], TORUS_VERTICES, m->triangles[0], triangle_count, fold_cosine, &found) == 0,
           "%s", failure_text());
    return found;
}

static void swap_triangles(torus *m, uint32_t a, uint32_t b) {
    uint32_t kept[3];
    memcpy(kept, m->triangles[a], sizeof kept);
    memcpy(m->triangles[a], m->triangles[b], sizeof kept);
    memcpy(m->triangles[b], kept, sizeof kept);
}

/* The third corner of the first triangle goes to the other side of the opposite edge. */
static void fold_first(torus *m) {
    const uint32_t *first = m->triangles[0];
    float *p = m->positions[first[2]];
    for (int k = 0; k < 3; k++)
        p[k] = m->positions[first[0]][k] + m->positions[first[1]][k] - p[k] + 0.01f * m->positions[first[0]][k];
}

static void test_edges(void) {
    torus m;
    make_torus(&m);
    mesh_edges found = edges_of(&m, TORUS_TRIANGLES);
    EXPECT(!found.border && !found.folded, "the torus has a border or folds: %llu", (unsigned long long)found.folded);

    const mesh_edges open = edges_of(&m, TORUS_TRIANGLES - 2);
    EXPECT(open.border && !open.folded, "no border where triangles are missing");
    for (uint32_t n = 0; n < TORUS_TRIANGLES - 2; n++) swap_triangles(&m, n, random_below(TORUS_TRIANGLES - 2));
    EXPECT(edges_of(&m, TORUS_TRIANGLES - 2).border == open.border, "the border depends on the order of triangles");
    EXPECT(edges_of(&m, TORUS_TRIANGLES - 3).border != open.border, "another border, and the same sum");

    fold_first(&m);
    EXPECT(edges_of(&m, TORUS_TRIANGLES - 2).folded > 0, "a fold is not seen");
    free(m.positions);
    free(m.triangles);
}

/* -------------------------------------------------------------------------------------------------------- distances */

/* The square of the distance between p and the triangle, by the nearest of many points in it: an upper bound, and with
 * `steps` of them per edge not far from it. */
static double nearest_by_points(const float p[3], const float a[3], const float b[3], const float c[3], int steps) {
    double nearest = INFINITY;
    for (int i = 0; i <= steps; i++)
        for (int j = 0; i + j <= steps; j++) {
            double square = 0;
            for (int k = 0; k < 3; k++) {
                const double at = a[k] + ((double)i * (b[k] - a[k]) + (double)j * (c[k] - a[k])) / steps;
                square += (at - p[k]) * (at - p[k]);
            }
            nearest = fmin(nearest, square);
        }
    return nearest;
}

static void random_surface(float positions[POINTS][3], uint32_t triangles[FACES][3]) {
    for (int v = 0; v < POINTS; v++)
        for (int k = 0; k < 3; k++) positions[v][k] = (float)random_between(-1, 1);
    for (int t = 0; t < FACES; t++)
        for (int k = 0; k < 3; k++) triangles[t][k] = random_below(POINTS);
}

/* Of single points, as triangles whose corners are one vertex: their distance is known to any accuracy. */
static void test_distance_of_points(void) {
    enum { STEPS = 60 };
    for (int n = 0; n < SURFACES; n++) {
        float point[3], positions[POINTS][3];
        uint32_t corners[3] = {0, 0, 0}, triangles[FACES][3];
        random_surface(positions, triangles);
        for (int k = 0; k < 3; k++) point[k] = (float)random_between(-2, 2);
        const uint64_t count = 1 + random_below(FACES);
        const mesh_view from = {point, 1, corners, 1}, to = {positions[0], POINTS, triangles[0], count};
        double distance, expected = INFINITY;
        EXPECT(mesh_distance(&from, &to, 0.1, &distance) == 0, "%s", failure_text());
        for (uint64_t t = 0; t < count; t++)
            expected = fmin(expected, nearest_by_points(point, positions[triangles[t][0]], positions[triangles[t][1]],
                                                        positions[triangles[t][2]], STEPS));
        expected = sqrt(expected);
        EXPECT(distance <= expected + 1e-6 && distance >= expected - 3.5 / STEPS, "surface %d: %g, not %g", n, distance,
               expected);
    }
}

static void test_distance_of_squares(void) {
    static const float low[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                       high[4][3] = {{0, 0, 0.25f}, {1, 0, 0.25f}, {1, 1, 0.25f}, {0, 1, 0.25f}},
                       roof[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 0.5f, 0.75f}};
    static const uint32_t two[6] = {0, 1, 2, 0, 2, 3}, four[12] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
    const mesh_view a = {low[0], 4, two, 2}, b = {high[0], 4, two, 2}, c = {roof[0], 5, four, 4}, none = {0};
    double distance;
    mesh_distance(&a, &b, 0.5, &distance);
    EXPECT(distance == 0.25, "squares: %g", distance);
    mesh_distance(&c, &a, 0.5, &distance);
    EXPECT(distance == 0.75, "from the roof: %g", distance);
    mesh_distance(&a, &c, 0.01, &distance); /* of the centre: by the roof's slope */
    EXPECT(fabs(distance - 0.75 * 0.5 / sqrt(0.75 * 0.75 + 0.25)) < 1e-3, "to the roof: %g", distance);
    mesh_distance(&a, &a, 0.1, &distance);
    EXPECT(distance < 1e-12, "to itself: %g", distance);
    mesh_distance(&none, &a, 0.1, &distance);
    EXPECT(distance == 0, "from nothing: %g", distance);
    mesh_distance(&a, &none, 0.1, &distance);
    EXPECT(isinf(distance), "to nothing: %g", distance);
    EXPECT(fabs(mesh_spacing(&a) - sqrt(0.5)) < 1e-12 && mesh_spacing(&none) == 0, "spacing %g", mesh_spacing(&a));
}

/* ----------------------------------------------------------------------------------------------------------- faults */

typedef struct comparison {
    torus mesh;
    uint8_t locked[TORUS_VERTICES], marks[TORUS_VERTICES];
    surface_shape shape;
} comparison;

static void comparison_make(comparison *c) {
    make_torus(&c->mesh);
    memset(c->locked, 0, sizeof c->locked);
    EXPECT(surface_shape_take(c->mesh.positions[0], TORUS_VERTICES, c->mesh.triangles[0], TORUS_TRIANGLES, fold_cosine,
                              c->locked, &c->shape) == 0,
           "%s", failure_text());
    for (int v = 0; v < TORUS_VERTICES; v++) EXPECT(!c->locked[v], "vertex %d of the torus is locked", v);
}

static void comparison_release(comparison *c) {
    surface_shape_release(&c->shape);
    free(c->mesh.positions);
    free(c->mesh.triangles);
}

static surface_faults faults_of(comparison *c, uint64_t triangle_count) {
    surface_faults faults;
    memset(c->marks, 0, sizeof c->marks);
    EXPECT(surface_faults_find(&c->shape, c->mesh.triangles[0], triangle_count, fold_cosine, c->locked, c->marks,
                               &faults) == 0,
           "%s", failure_text());
    return faults;
}

/* Contracts the edge between the first two corners of a triangle: the second one becomes the first. Returns how many
 * triangles are left. */
static uint64_t contract(torus *m, uint64_t count, uint32_t kept, uint32_t gone) {
    uint64_t left = 0;
    for (uint64_t t = 0; t < count; t++) {
        uint32_t v[3];
        for (int k = 0; k < 3; k++) v[k] = m->triangles[t][k] == gone ? kept : m->triangles[t][k];
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        memcpy(m->triangles[left++], v, sizeof v);
    }
    return left;
}

static void test_no_fault(void) {
    comparison c;
    comparison_make(&c);
    surface_faults faults = faults_of(&c, TORUS_TRIANGLES);
    EXPECT(!faults.vertices && !faults.components, "the torus itself has faults");
    const uint32_t kept = c.mesh.triangles[4][2], gone = c.mesh.triangles[4][0]; /* side by side around the tube */
    const uint64_t left = contract(&c.mesh, TORUS_TRIANGLES, kept, gone);
    faults = faults_of(&c, left);
    EXPECT(left == TORUS_TRIANGLES - 2 && !faults.vertices && !faults.components, "an edge was contracted: %llu faults",
           (unsigned long long)faults.vertices);
    comparison_release(&c);
}

/* A fault at some vertices, as the marks tell; where these are locked it counts as one that was there. */
static void expect_fault(const char *name, comparison *c, uint64_t triangle_count, uint32_t vertex) {
    const surface_faults faults = faults_of(c, triangle_count);
    EXPECT(faults.vertices > 0 && c->marks[vertex] == 1, "%s is not found", name);
    for (int v = 0; v < TORUS_VERTICES; v++) c->locked[v] |= c->marks[v];
    EXPECT(!faults_of(c, triangle_count).vertices, "%s: a locked vertex is marked", name);
    comparison_release(c);
}

static void test_faults(void) {
    comparison c;
    uint32_t last[3];

    comparison_make(&c);
    expect_fault("a hole", &c, TORUS_TRIANGLES - 1, c.mesh.triangles[TORUS_TRIANGLES - 1][0]);

    comparison_make(&c);
    memcpy(last, c.mesh.triangles[7], sizeof last);
    memcpy(c.mesh.triangles[TORUS_TRIANGLES], last, sizeof last);
    expect_fault("a triangle twice", &c, TORUS_TRIANGLES + 1, last[1]);

    comparison_make(&c);
    memcpy(last, c.mesh.triangles[7], sizeof last);
    memcpy(c.mesh.triangles[7], (uint32_t[3]){last[1], last[0], last[2]}, sizeof last);
    expect_fault("a triangle turned over", &c, TORUS_TRIANGLES, last[2]);

    comparison_make(&c); /* far from each other: two fans at one vertex */
    const uint32_t here = c.mesh.triangles[0][0], there = c.mesh.triangles[SIDE * SIDE + SIDE][0];
    const uint64_t left = contract(&c.mesh, TORUS_TRIANGLES, here, there);
    expect_fault("two vertices made one", &c, left, here);

    comparison_make(&c);
    fold_first(&c.mesh);
    expect_fault("a fold", &c, TORUS_TRIANGLES, c.mesh.triangles[0][0]);
}

/* Cuts the torus along two rings and closes each cut by a fan: a sphere, with no fault at a vertex that is not at the
 * cut, which here count as locked. The Euler characteristic alone tells. */
static void test_lost_handle(void) {
    comparison c;
    comparison_make(&c);
    uint32_t rings[2][SIDE];
    uint64_t left = 0;
    for (int i = 0; i < SIDE; i++) { /* torus.h: the first triangle of quadrilateral (i, j) is v, far, right */
        rings[0][i] = c.mesh.triangles[2 * i][0];
        rings[1][i] = c.mesh.triangles[2 * (SIDE + i)][0];
        c.locked[rings[0][i]] = c.locked[rings[1][i]] = 1;
    }
    for (uint64_t t = 2 * SIDE; t < TORUS_TRIANGLES; t++) memcpy(c.mesh.triangles[left++], c.mesh.triangles[t], 12);
    for (int i = 1; i + 1 < SIDE; i++) {
        memcpy(c.mesh.triangles[left++], (uint32_t[3]){rings[1][0], rings[1][i], rings[1][i + 1]}, 12);
        memcpy(c.mesh.triangles[left++], (uint32_t[3]){rings[0][0], rings[0][i + 1], rings[0][i]}, 12);
    }
    const surface_faults faults = faults_of(&c, left);
    EXPECT(!faults.vertices, "a closed cut has %llu faults", (unsigned long long)faults.vertices);
    EXPECT(faults.components == 1 && faults.smallest == TORUS_TRIANGLES, "a lost handle is not found");
    EXPECT(c.marks[c.mesh.triangles[left / 2][0]] == MARK_COMPONENT, "its component is not marked");
    comparison_release(&c);
}

static void test_vanished(void) {
    comparison c;
    comparison_make(&c);
    const surface_faults faults = faults_of(&c, 0);
    EXPECT(faults.components == 1 && !faults.vertices, "a component that vanished is not found");
    comparison_release(&c);
}

int main(void) {
    random_state = 3;
    if (test_chosen("edges")) test_edges();
    if (test_chosen("distance_of_points")) test_distance_of_points();
    if (test_chosen("distance_of_squares")) test_distance_of_squares();
    if (test_chosen("no_fault")) test_no_fault();
    if (test_chosen("faults")) test_faults();
    if (test_chosen("lost_handle")) test_lost_handle();
    if (test_chosen("vanished")) test_vanished();
    return EXPECT_DONE();
}
