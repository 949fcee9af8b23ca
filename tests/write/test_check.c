/*
 * test_check.c - the mesh checks: known meshes, planted faults, and a brute-force checker on random small meshes
 *
 * Compiled a second time with mesh_check.c's blocks and windows made tiny, so that the small meshes need many of them.
 * Usage: test_check [SEED]
 */
#include "exit_status.h"
#include "expect.h"
#include "failure.h"
#include "mesh_check.h"
#include "torus.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static void expect_topology(const char *name, const mesh_topology *is, const mesh_topology *should) {
    EXPECT(is->boundary_edges == should->boundary_edges && is->nonmanifold_edges == should->nonmanifold_edges &&
               is->nonmanifold_vertices == should->nonmanifold_vertices &&
               is->misoriented_edges == should->misoriented_edges && is->orphan_vertices == should->orphan_vertices &&
               is->invalid_triangles == should->invalid_triangles &&
               is->euler_characteristic == should->euler_characteristic && is->components == should->components,
           "%s: boundary %llu/%llu, nonmanifold edges %llu/%llu, vertices %llu/%llu, misoriented %llu/%llu, orphans "
           "%llu/%llu, invalid %llu/%llu, euler %lld/%lld, components %llu/%llu (is/should)",
           name, (unsigned long long)is->boundary_edges, (unsigned long long)should->boundary_edges,
           (unsigned long long)is->nonmanifold_edges, (unsigned long long)should->nonmanifold_edges,
           (unsigned long long)is->nonmanifold_vertices, (unsigned long long)should->nonmanifold_vertices,
           (unsigned long long)is->misoriented_edges, (unsigned long long)should->misoriented_edges,
           (unsigned long long)is->orphan_vertices, (unsigned long long)should->orphan_vertices,
           (unsigned long long)is->invalid_triangles, (unsigned long long)should->invalid_triangles,
           (long long)is->euler_characteristic, (long long)should->euler_characteristic,
           (unsigned long long)is->components, (unsigned long long)should->components);
}

/* ---------------------------------------------------------------------------------------------------- known meshes */

/* Unit tetrahedra: one at the origin, one shifted; then single points for meshes that care for topology alone. */
static const float points[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1},
                                  {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}};

enum { NO = -1 }; /* an index that is out of range, as the largest one is */

static const struct {
    const char *name;
    int vertex_count, triangle_count;
    int triangles[8][3];
    mesh_topology should;
} known[] = {
    {"empty", 0, 0, {{0}}, {0}},
    {"points alone", 3, 0, {{0}}, {.orphan_vertices = 3, .euler_characteristic = 3}},
    {"one triangle", 3, 1, {{0, 1, 2}}, {.boundary_edges = 3, .euler_characteristic = 1, .components = 1}},
    {"tetrahedron", 4, 4, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {.euler_characteristic = 2, .components = 1}},
    {"two tetrahedra",
     8,
     8,
     {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {4, 6, 5}, {4, 5, 7}, {4, 7, 6}, {5, 6, 7}},
     {.euler_characteristic = 4, .components = 2}},
    {"tetrahedron and orphans",
     6,
     4,
     {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
     {.orphan_vertices = 2, .euler_characteristic = 4, .components = 1}},
    {"tetrahedron with a flipped face",
     4,
     4,
     {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 3, 2}},
     {.misoriented_edges = 3, .euler_characteristic = 2, .components = 1}},
    {"tetrahedra that share a vertex",
     7,
     8,
     {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 5, 4}, {0, 4, 6}, {0, 6, 5}, {4, 5, 6}},
     {.nonmanifold_vertices = 1, .euler_characteristic = 3, .components = 1}},
    {"tetrahedra that share an edge",
     6,
     8,
     {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 1}, {0, 1, 5}, {0, 5, 4}, {1, 4, 5}},
     {.nonmanifold_edges = 1, .euler_characteristic = 3, .components = 1}},
    {"disk",
     7,
     6,
     {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6}, {0, 6, 1}},
     {.boundary_edges = 6, .euler_characteristic = 1, .components = 1}},
    {"Moebius strip",
     5,
     5,
     {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 0}, {4, 0, 1}},
     {.boundary_edges = 5, .misoriented_edges = 1, .components = 1}},
    {"bow tie",
     5,
     2,
     {{0, 1, 2}, {0, 3, 4}},
     {.boundary_edges = 6, .nonmanifold_vertices = 1, .euler_characteristic = 1, .components = 1}},
    {"three triangles on an edge",
     5,
     3,
     {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}},
     {.boundary_edges = 6, .nonmanifold_edges = 1, .euler_characteristic = 1, .components = 1}},
    {"a triangle twice",
     3,
     2,
     {{0, 1, 2}, {1, 2, 0}},
     {.misoriented_edges = 3, .euler_characteristic = 2, .components = 1}},
    {"a triangle and its reverse", 3, 2, {{0, 1, 2}, {0, 2, 1}}, {.euler_characteristic = 2, .components = 1}},
    {"a triangle three times",
     3,
     3,
     {{0, 1, 2}, {1, 2, 0}, {0, 2, 1}},
     {.nonmanifold_edges = 3, .euler_characteristic = 3, .components = 1}},
    {"bad indices",
     4,
     7,
     {{0, 1, 4}, {NO, 1, 2}, {0, NO, 2}, {1, 1, 2}, {1, 2, 1}, {2, 1, 1}, {0, 1, 2}},
     {.boundary_edges = 3, .orphan_vertices = 1, .invalid_triangles = 6, .euler_characteristic = 2, .components = 1}},
    {"bad indices alone",
     1,
     3,
     {{0, 0, 0}, {NO, NO, NO}, {1, 2, 3}},
     {.orphan_vertices = 1, .invalid_triangles = 3, .euler_characteristic = 1}},
};

/* Exactly as large as the mesh, so that a sanitizer sees the first step beyond. */
static void *copy_exactly(const void *from, size_t bytes) {
    void *to = bytes > 0 ? malloc(bytes) : NULL;
    if (to) memcpy(to, from, bytes);
    return to;
}

static void test_known_meshes(void) {
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        uint64_t vertex_count = (uint64_t)known[i].vertex_count, triangle_count = (uint64_t)known[i].triangle_count;
        float *positions = copy_exactly(points, vertex_count * sizeof *points);
        uint32_t *triangles = copy_exactly(known[i].triangles, triangle_count * sizeof *known[i].triangles);
        mesh_topology is;
        mesh_summary summary;
        int status = mesh_check(positions, vertex_count, triangles, triangle_count, &is);
        mesh_summarize(positions, vertex_count, triangles, triangle_count, &summary);
        EXPECT(status == 0, "%s: status %d: %s", known[i].name, status, failure_text());
        expect_topology(known[i].name, &is, &known[i].should);
        free(positions);
        free(triangles);
    }
}

static void test_area_and_volume(void) {
    float moved[sizeof points / sizeof *points][3];
    uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    for (size_t v = 0; v < sizeof points / sizeof *points; v++)
        for (int axis = 0; axis < 3; axis++) moved[v][axis] = 2 * points[v][axis] + 10 * (float)axis - 7;
    mesh_topology is;
    mesh_check(moved[0], 4, triangles[0], 4, &is);
    EXPECT(fabs(is.area - 4 * (1.5 + sqrt(0.75))) < 1e-12, "area %.17g", is.area);
    EXPECT(fabs(is.volume - 8.0 / 6) < 1e-12, "volume %.17g", is.volume);

    for (int t = 0; t < 4; t++) {
        uint32_t second = triangles[t][1];
        triangles[t][1] = triangles[t][2];
        triangles[t][2] = second;
    }
    mesh_check(moved[0], 4, triangles[0], 4, &is);
    EXPECT(fabs(is.volume + 8.0 / 6) < 1e-12, "volume turned inside out %.17g", is.volume);

    moved[3][0] = NAN;
    mesh_check(moved[0], 4, triangles[0], 4, &is);
    EXPECT(fabs(is.area - 4 * 0.5) < 1e-12, "area of the finite triangle %.17g", is.area);
    EXPECT(isfinite(is.volume), "volume %.17g", is.volume);
}

/* --------------------------------------------------------------------------------------------------------- summary */

static void test_summary(void) {
    enum { COUNT = 10 };
    const float above_one = nextafterf(1, 2);
    const float positions[COUNT][3] = {{1, 2, 3},        {2, 4, 6},        {4, 8, 12},     {1, 2, 3},
                                       {-5, 0, 0.5f},    {NAN, 99, 0},     {0, -99, 1e9f}, {above_one, 2, -3},
                                       {0, INFINITY, 0}, {0, 0, -INFINITY}};
    const uint32_t triangles[][3] = {
        {0, 1, 2}, /* on a line */
        {0, 3, 4}, /* two corners at one position */
        {0, 0, 4}, /* one vertex twice */
        {0, 1, 4}, {0, 7, 4}, {0, 1, COUNT}, {UINT32_MAX, 0, 1}, {0, 5, 4},
    };
    mesh_summary is;
    mesh_summarize(positions[0], COUNT, triangles[0], sizeof triangles / sizeof *triangles, &is);
    EXPECT(is.degenerate_triangles == 3, "%llu degenerate", (unsigned long long)is.degenerate_triangles);
    EXPECT(is.nonfinite_vertices == 3, "%llu not finite", (unsigned long long)is.nonfinite_vertices);
    const double bounds[2][3] = {{-5, -99, -3}, {4, 8, 1e9}};
    for (int axis = 0; axis < 3; axis++)
        EXPECT(is.bounds[0][axis] == bounds[0][axis] && is.bounds[1][axis] == bounds[1][axis],
               "axis %d from %g to %g, should be %g to %g", axis, is.bounds[0][axis], is.bounds[1][axis],
               bounds[0][axis], bounds[1][axis]);

    mesh_summarize(positions[5], 1, NULL, 0, &is);
    EXPECT(is.nonfinite_vertices == 1 && is.bounds[0][1] == 0 && is.bounds[1][1] == 0, "bounds of no finite vertex");
    mesh_summarize(NULL, 0, NULL, 0, &is);
    EXPECT(is.bounds[0][0] == 0 && is.bounds[1][2] == 0 && is.degenerate_triangles == 0, "summary of the empty mesh");
}

/* A hair beside the line is not on it: one unit in the last place of one coordinate. */
static void test_degenerate_is_exact(void) {
    float positions[3][3] = {{0.1f, 0.2f, 0.3f}, {0.1f, 0.2f, 0.3f}, {0, 0, 0}};
    const uint32_t triangle[3] = {0, 1, 2};
    mesh_summary is;
    mesh_summarize(positions[0], 3, triangle, 1, &is);
    EXPECT(is.degenerate_triangles == 1, "two equal corners");
    positions[1][2] = nextafterf(0.3f, 1);
    mesh_summarize(positions[0], 3, triangle, 1, &is);
    EXPECT(is.degenerate_triangles == 0, "corners that differ in the last place");

    for (int axis = 0; axis < 3; axis++) { /* in each coordinate plane: one component of the product alone is not 0 */
        float right_angled[3][3] = {{0}};
        right_angled[1][axis] = 1;
        right_angled[2][(axis + 1) % 3] = 1;
        mesh_summarize(right_angled[0], 3, triangle, 1, &is);
        EXPECT(is.degenerate_triangles == 0, "triangle in the plane of axis %d and the next", axis);
    }
}

/* ---------------------------------------------------------------------------------------------------------- shapes */

static void expect_shapes(const mesh_shapes *is, uint64_t triangles, uint64_t below_10, uint64_t below_20,
                          double median, const char *name) {
    EXPECT(is->triangles == triangles && is->below_10 == below_10 && is->below_20 == below_20 &&
               mesh_shapes_median(is) == median,
           "%s: %llu of %llu triangles below 10 degrees, %llu below 20, median %.17g", name,
           (unsigned long long)is->below_10, (unsigned long long)is->triangles, (unsigned long long)is->below_20,
           mesh_shapes_median(is));
}

/* Triangles that are known, alone and together; from either end, turned round and away from the axes. */
static void test_shapes(void) {
    static const struct {
        float corners[3][3];
        double angle; /* to a tenth */
        int below_10, below_20;
    } shapes[] = {
        {{{0, 0, 0}, {1, 0, 0}, {0.5f, 0.8660254f, 0}}, 60, 0, 0},
        {{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 45, 0, 0},
        {{{0, 0, 0}, {0, 0, 3}, {4, 0, 0}}, 36.9, 0, 0},
        {{{1, 1, 1}, {2, 2, 1}, {1, 1, 1.5f}}, 19.5, 0, 1},
        {{{0, 0, 0}, {1, 0, 0}, {1, 0.1f, 0}}, 5.7, 1, 1},
        {{{0, 0, 0}, {1, 0, 0}, {0.5f, 0.01f, 0}}, 1.1, 1, 1},
        {{{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}, 0, 1, 1},
        {{{1, 2, 3}, {1, 2, 3}, {5, 5, 5}}, 0, 1, 1},
        {{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, 0, 1, 1},
        {{{-3e38f, 0, 0}, {3e38f, 0, 0}, {0, 3e38f, 0}}, 45, 0, 0},
        {{{0, 0, 0}, {1e-45f, 0, 0}, {0, 1e-45f, 0}}, 45, 0, 0},
    };
    enum { COUNT = sizeof shapes / sizeof *shapes };
    static const uint32_t orders[][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}, {1, 0, 2}, {0, 2, 1}};
    mesh_shapes sum = {0};
    for (uint32_t n = 0; n < COUNT; n++) {
        mesh_shapes is = {0};
        mesh_shapes_add(shapes[n].corners[0], 3, orders[0], 6, &is);
        expect_shapes(&is, 6, 6 * (uint64_t)shapes[n].below_10, 6 * (uint64_t)shapes[n].below_20, shapes[n].angle,
                      "a triangle");
        mesh_shapes_add(shapes[n].corners[0], 3, orders[n % 6], 1, &sum);
    }
    expect_shapes(&sum, COUNT, 5, 6, 19.5, "known triangles");

    const float odd[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 0}};
    const uint32_t left_out[][3] = {{0, 1, 1}, {0, 1, 3}, {0, 1, 4}, {UINT32_MAX, 1, 2}, {0, 1, 2}, {2, 1, 2}};
    mesh_shapes is = {0};
    mesh_shapes_add(odd[0], 4, left_out[0], 6, &is);
    expect_shapes(&is, 1, 0, 0, 45, "invalid triangles and one that is valid");
    is = (mesh_shapes){0};
    mesh_shapes_add(NULL, 0, NULL, 0, &is);
    expect_shapes(&is, 0, 0, 0, 0, "no triangle");
}

static int compare_doubles(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Against the law of cosines, and a median of sorted angles. */
static void test_random_shapes(void) {
    enum { COUNT = 2001 };
    static float corners[3 * COUNT][3];
    static uint32_t triangles[3 * COUNT];
    static double angles[COUNT];
    uint64_t below_10 = 0, below_20 = 0;
    mesh_shapes is = {0};
    for (uint32_t n = 0; n < COUNT; n++) {
        double squares[3] = {0};
        for (uint32_t m = 0; m < 3; m++) {
            triangles[3 * n + m] = 3 * n + m;
            for (int axis = 0; axis < 3; axis++) corners[3 * n + m][axis] = (float)random_between(-1, 1);
        }
        for (uint32_t m = 0; m < 3; m++)
            for (int axis = 0; axis < 3; axis++) {
                const double step = (double)corners[3 * n + m][axis] - (double)corners[3 * n + (m + 1) % 3][axis];
                squares[m] += step * step;
            }
        angles[n] = 180;
        for (int m = 0; m < 3; m++) {
            const double a = squares[m], b = squares[(m + 1) % 3], c = squares[(m + 2) % 3];
            angles[n] = fmin(angles[n], 180 / 3.14159265358979323846 * acos((b + c - a) / (2 * sqrt(b * c))));
        }
        below_10 += angles[n] < 10;
        below_20 += angles[n] < 20;
    }
    mesh_shapes_add(corners[0], 3 * COUNT, triangles, COUNT, &is);
    qsort(angles, COUNT, sizeof *angles, compare_doubles);
    expect_shapes(&is, COUNT, below_10, below_20, floor(10 * angles[COUNT / 2] + 0.5) / 10, "random triangles");
    EXPECT(below_10 > 0 && below_10 < below_20 && below_20 < COUNT, "random triangles have no slivers");
}

/* Constants from an implementation of the XXH64 specification apart from libxxhash. */
static void test_hash(void) {
    uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const float one[3] = {1, 2, 3};
    EXPECT(mesh_hash(NULL, 0, NULL, 0) == 0xef46db3751d8e999u, "hash of nothing");
    EXPECT(mesh_hash(one, 1, NULL, 0) == 0x6d50bdacee372b0eu, "hash of a point: %llx",
           (unsigned long long)mesh_hash(one, 1, NULL, 0));
    uint64_t hash = mesh_hash(points[0], 4, triangles[0], 4);
    EXPECT(hash == 0x028ebfd77ea29efau, "hash of a tetrahedron: %llx", (unsigned long long)hash);
    triangles[3][2] = 0;
    EXPECT(mesh_hash(points[0], 4, triangles[0], 4) != hash, "hash does not see the last index");
}

/* --------------------------------------------------------------------------------------------- against brute force */

enum { SMALL_VERTICES = 12, SMALL_TRIANGLES = 24 };

static int uses(const uint32_t v[3], uint32_t vertex) { return v[0] == vertex || v[1] == vertex || v[2] == vertex; }

/* 1 where two triangles at the vertex have an edge there in common. */
static int are_joined(const uint32_t a[3], const uint32_t b[3], uint32_t vertex) {
    for (int k = 0; k < 3; k++)
        if (a[k] != vertex && uses(b, a[k])) return 1;
    return 0;
}

static int are_touching(const uint32_t a[3], const uint32_t b[3], uint32_t unused) {
    (void)unused;
    return uses(b, a[0]) || uses(b, a[1]) || uses(b, a[2]);
}

/* The classes of triangles (those that use the vertex, or all where it is UINT32_MAX) under the relation, by flooding
 * until nothing changes. */
static uint64_t count_classes(uint32_t (*triangles)[3], int count, uint32_t vertex,
                              int (*related)(const uint32_t *, const uint32_t *, uint32_t)) {
    int label[SMALL_TRIANGLES], changed = 1;
    for (int i = 0; i < count; i++) label[i] = i;
    while (changed) {
        changed = 0;
        for (int i = 0; i < count; i++)
            for (int j = 0; j < count; j++)
                if ((vertex == UINT32_MAX || (uses(triangles[i], vertex) && uses(triangles[j], vertex))) &&
                    related(triangles[i], triangles[j], vertex) && label[j] > label[i]) {
                    label[j] = label[i];
                    changed = 1;
                }
    }
    uint64_t classes = 0;
    for (int i = 0; i < count; i++) classes += label[i] == i && (vertex == UINT32_MAX || uses(triangles[i], vertex));
    return classes;
}

static mesh_topology check_by_force(uint32_t (*triangles)[3], int count, uint32_t vertex_count) {
    mesh_topology should = {0};
    int passes[SMALL_VERTICES][SMALL_VERTICES] = {{0}};
    uint32_t valid[SMALL_TRIANGLES][3];
    int valid_count = 0;
    for (int t = 0; t < count; t++) {
        const uint32_t *v = triangles[t];
        if (v[0] >= vertex_count || v[1] >= vertex_count || v[2] >= vertex_count || v[0] == v[1] || v[1] == v[2] ||
            v[0] == v[2]) {
            should.invalid_triangles++;
            continue;
        }
        memcpy(valid[valid_count++], v, sizeof *valid);
        for (int k = 0; k < 3; k++) passes[v[k]][v[(k + 1) % 3]]++;
    }
    int64_t edges = 0;
    for (uint32_t a = 0; a < vertex_count; a++) {
        uint64_t fans = count_classes(valid, valid_count, a, are_joined);
        should.nonmanifold_vertices += fans > 1;
        should.orphan_vertices += fans == 0;
        for (uint32_t b = a + 1; b < vertex_count; b++) {
            int both = passes[a][b] + passes[b][a];
            edges += both > 0;
            should.boundary_edges += both == 1;
            should.nonmanifold_edges += both > 2;
            should.misoriented_edges += both == 2 && passes[a][b] != 1;
        }
    }
    should.components = count_classes(valid, valid_count, UINT32_MAX, are_touching);
    should.euler_characteristic = (int64_t)vertex_count - edges + valid_count;
    return should;
}

static void test_against_force(void) {
    static const float positions[SMALL_VERTICES][3];
    for (int round = 0; round < 20000; round++) {
        uint64_t seed = random_state;
        uint32_t vertex_count = 3 + random_below(SMALL_VERTICES - 2), triangles[SMALL_TRIANGLES][3];
        int count = (int)random_below(SMALL_TRIANGLES + 1);
        uint32_t most = vertex_count + (round % 4 == 0); /* now and then an index too far */
        for (int t = 0; t < count; t++)
            for (int k = 0; k < 3; k++) triangles[t][k] = random_below(most);
        mesh_topology should = check_by_force(triangles, count, vertex_count), is;
        char name[64];
        snprintf(name, sizeof name, "random mesh, seed %llu", (unsigned long long)seed);
        EXPECT(mesh_check(positions[0], vertex_count, triangles[0], (uint64_t)count, &is) == 0, "%s", name);
        expect_topology(name, &is, &should);
    }
}

/* -------------------------------------------------------------------------------------------------- planted faults */

static mesh_topology check_torus(const torus *m, uint64_t triangle_count) {
    mesh_topology is;
    int status = mesh_check(m->positions[0], TORUS_VERTICES, m->triangles[0], triangle_count, &is);
    EXPECT(status == 0, "torus: status %d: %s", status, failure_text());
    return is;
}

/* A vertex far from all of triangle t: it shares no triangle with them. */
static uint32_t far_vertex(const torus *m, uint32_t t) {
    return m->triangles[(t + TORUS_TRIANGLES / 2) % TORUS_TRIANGLES][0];
}

static void test_whole_torus(const torus *m) {
    const double volume = 2 * 9.8696044010893586 * 3, area = 4 * 9.8696044010893586 * 3; /* 2 pi^2 R r^2, 4 pi^2 R r */
    mesh_topology is = check_torus(m, TORUS_TRIANGLES);
    expect_topology("torus", &is, &(mesh_topology){.components = 1});
    EXPECT(fabs(is.volume / volume - 1) < 20.0 / TORUS_VERTICES, "volume %g, should be about %g", is.volume, volume);
    EXPECT(fabs(is.area / area - 1) < 20.0 / TORUS_VERTICES, "area %g, should be about %g", is.area, area);
}

static void test_deleted_triangle(const torus *m, uint32_t t) {
    uint32_t kept[3], *last = m->triangles[TORUS_TRIANGLES - 1];
    memcpy(kept, m->triangles[t], sizeof kept);
    memcpy(m->triangles[t], last, sizeof kept);
    mesh_topology is = check_torus(m, TORUS_TRIANGLES - 1);
    expect_topology("deleted triangle", &is,
                    &(mesh_topology){.boundary_edges = 3, .euler_characteristic = -1, .components = 1});
    memcpy(m->triangles[t], kept, sizeof kept);
}

static void test_doubled_triangle(const torus *m, uint32_t t) {
    memcpy(m->triangles[TORUS_TRIANGLES], m->triangles[t], sizeof *m->triangles);
    mesh_topology is = check_torus(m, TORUS_TRIANGLES + 1);
    expect_topology("doubled triangle", &is,
                    &(mesh_topology){.nonmanifold_edges = 3, .euler_characteristic = 1, .components = 1});
}

static void test_flipped_triangle(const torus *m, uint32_t t) {
    uint32_t *v = m->triangles[t], second = v[1];
    v[1] = v[2];
    v[2] = second;
    mesh_topology is = check_torus(m, TORUS_TRIANGLES);
    expect_topology("flipped triangle", &is, &(mesh_topology){.misoriented_edges = 3, .components = 1});
    v[2] = v[1];
    v[1] = second;
}

static void test_changed_index(const torus *m, uint32_t t) {
    uint32_t *index = &m->triangles[t][random_below(3)], kept = *index;
    *index = far_vertex(m, t);
    mesh_topology is = check_torus(m, TORUS_TRIANGLES);
    expect_topology(
        "changed index", &is,
        &(mesh_topology){.boundary_edges = 4, .nonmanifold_vertices = 1, .euler_characteristic = -2, .components = 1});
    *index = TORUS_VERTICES;
    is = check_torus(m, TORUS_TRIANGLES);
    expect_topology(
        "index out of range", &is,
        &(mesh_topology){.boundary_edges = 3, .invalid_triangles = 1, .euler_characteristic = -1, .components = 1});
    *index = kept;
}

/* Leaves the torus welded. */
static void test_welded_vertices(torus *m, uint32_t t) {
    uint32_t kept = m->triangles[t][0], gone = far_vertex(m, t);
    for (uint32_t *v = m->triangles[0]; v < m->triangles[TORUS_TRIANGLES]; v++)
        if (*v == gone) *v = kept;
    mesh_topology is = check_torus(m, TORUS_TRIANGLES);
    expect_topology("welded vertices", &is,
                    &(mesh_topology){.nonmanifold_vertices = 1, .orphan_vertices = 1, .components = 1});
}

static void test_planted_faults(void) {
    torus m;
    make_torus(&m);
    test_whole_torus(&m);
    for (int round = 0; round < 3; round++) {
        uint32_t t = random_below(TORUS_TRIANGLES - 1);
        printf("faults at triangle %u\n", t);
        test_deleted_triangle(&m, t);
        test_doubled_triangle(&m, t);
        test_flipped_triangle(&m, t);
        test_changed_index(&m, t);
    }
    test_whole_torus(&m);
    test_welded_vertices(&m, random_below(TORUS_TRIANGLES));
    free(m.positions);
    free(m.triangles);
}

/* -------------------------------------------------------------------------------------------------------- extremes */

/* One vertex in very many triangles: more edge ends than an insertion sort should see. */
static void test_great_fan(void) {
    enum { COUNT = 300000 };
    float(*positions)[3] = calloc(COUNT + 1, sizeof *positions);
    uint32_t(*triangles)[3] = malloc(COUNT * sizeof *triangles);
    mesh_topology is;
    if (!positions || !triangles) exit(EXIT_FAILURE);
    for (uint32_t t = 0; t < COUNT; t++)
        memcpy(triangles[t], (uint32_t[3]){0, 1 + t, 1 + (t + 1) % COUNT}, sizeof *triangles);
    EXPECT(mesh_check(positions[0], COUNT + 1, triangles[0], COUNT, &is) == 0, "%s", failure_text());
    expect_topology("great fan", &is,
                    &(mesh_topology){.boundary_edges = COUNT, .euler_characteristic = 1, .components = 1});
    free(positions);
    free(triangles);
}

static void test_memory_runs_out(void) {
#ifdef __SANITIZE_ADDRESS__
    printf("skipped: memory running out (the address sanitizer needs address space itself)\n");
#else
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        struct rlimit limit = {1u << 30, 1u << 30};
        mesh_topology is = {.area = 1};
        setrlimit(RLIMIT_AS, &limit);
        int status = mesh_check(NULL, UINT64_C(1) << 32, NULL, 0, &is);
        _exit(status == STATUS_FAILED && is.area == 0 && strstr(failure_text(), "memory") ? 0 : 1);
    }
    int status = 1;
    waitpid(child, &status, 0);
    EXPECT(status == 0, "no clear failure where memory runs out: %d", status);
#endif
}

int main(int argc, char **argv) {
    random_state = argc > 1 ? strtoull(argv[1], NULL, 0) : 1996;
    printf("seed %llu\n", (unsigned long long)random_state);
    test_known_meshes();
    test_area_and_volume();
    test_summary();
    test_degenerate_is_exact();
    test_shapes();
    test_random_shapes();
    test_hash();
    test_against_force();
    test_great_fan();
    test_memory_runs_out();
    test_planted_faults();
    return EXPECT_DONE();
}
