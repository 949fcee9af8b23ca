/*
 * test_repair.c - meshes without their triangles of zero area: closed and manifold as before, of the same area and
 * volume
 *
 * A torus whose vertices are moved onto neighbours has all that can happen: single edges, fans, rings that pinch a
 * sheet at a point or along an edge, and components without area. mesh_check says what the result is.
 */
#include "expect.h"
#include "failure.h"
#include "mesh_check.h"
#include "mesh_collapse.h"
#include "random.h"

#include <math.h>
#include <string.h>

enum { RING = 8, RINGS = 20, VERTICES = RING * RINGS, TRIANGLES = 2 * VERTICES, ROUNDS = 400 };

typedef struct torus {
    float positions[VERTICES][3];
    uint32_t triangles[TRIANGLES][3];
} torus;

static uint32_t torus_vertex(int ring, int n) { return (uint32_t)(ring % RINGS * RING + n % RING); }

static void torus_make(torus *t) {
    const double turn = 6.283185307179586;
    int count = 0;
    for (int ring = 0; ring < RINGS; ring++)
        for (int n = 0; n < RING; n++) {
            const double a = turn * ring / RINGS, b = turn * n / RING + 0.1, r = 3 + cos(b);
            float *p = t->positions[torus_vertex(ring, n)];
            p[0] = (float)(r * cos(a));
            p[1] = (float)(r * sin(a));
            p[2] = (float)sin(b);
            const uint32_t v[4] = {torus_vertex(ring, n), torus_vertex(ring + 1, n), torus_vertex(ring + 1, n + 1),
                                   torus_vertex(ring, n + 1)};
            const uint32_t both[2][3] = {{v[0], v[1], v[2]}, {v[0], v[2], v[3]}};
            memcpy(t->triangles[count], both, sizeof both);
            count += 2;
        }
}

static void move_onto(torus *t, uint32_t vertex, uint32_t other) {
    memcpy(t->positions[vertex], t->positions[other], sizeof t->positions[vertex]);
}

static int is_one_position(const float *a, const float *b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2]; }

/* Whether the sources rise, and no edge has length zero. positions become those of the result. */
static void expect_sound(const char *name, const collapsed_mesh *c, const float (*from)[3], float (*positions)[3]) {
    int rises = 1, short_edges = 0;
    for (uint64_t v = 0; v < c->vertex_count; v++) {
        rises &= !v || c->sources[v] >= c->sources[v - 1];
        memcpy(positions[v], from[c->sources[v]], sizeof positions[v]);
    }
    for (uint64_t t = 0; t < c->triangle_count; t++)
        for (int n = 0; n < 3; n++)
            short_edges += is_one_position(positions[c->triangles[3 * t + (uint64_t)n]],
                                           positions[c->triangles[3 * t + (uint64_t)(n + 1) % 3]]);
    EXPECT(rises, "%s: sources fall", name);
    EXPECT(short_edges == 0, "%s: %d edges of length zero are left", name, short_edges);
}

/* Repairs the torus and compares what is left; *is: its topology. Returns how many triangles were dropped. */
static uint64_t expect_repaired(const char *name, const torus *t, mesh_topology *is) {
    static float positions[3 * TRIANGLES][3]; /* a vertex per corner at most */
    collapsed_mesh c;
    mesh_topology was;
    EXPECT(mesh_collapse(t->positions[0], VERTICES, t->triangles[0], TRIANGLES, &c) == 0, "%s: %s", name,
           failure_text());
    const uint64_t dropped = c.dropped_count;
    mesh_check(t->positions[0], VERTICES, t->triangles[0], TRIANGLES, &was);
    *is = was;
    if (dropped) {
        expect_sound(name, &c, t->positions, positions);
        mesh_check(positions[0], c.vertex_count, c.triangles, c.triangle_count, is);
    } else {
        EXPECT(!c.triangles && !c.sources, "%s: a new mesh, though nothing was dropped", name);
    }
    EXPECT(!is->boundary_edges && !is->nonmanifold_edges && !is->nonmanifold_vertices && !is->misoriented_edges &&
               !is->orphan_vertices && !is->invalid_triangles && !c.nonmanifold_edges,
           "%s: boundary %llu, nonmanifold edges %llu (%llu said), vertices %llu, misoriented %llu, orphans %llu", name,
           (unsigned long long)is->boundary_edges, (unsigned long long)is->nonmanifold_edges,
           (unsigned long long)c.nonmanifold_edges, (unsigned long long)is->nonmanifold_vertices,
           (unsigned long long)is->misoriented_edges, (unsigned long long)is->orphan_vertices);
    EXPECT(fabs(is->area - was.area) < 1e-9 && fabs(is->volume - was.volume) < 1e-9,
           "%s: area %.12g, was %.12g; volume %.12g, was %.12g", name, is->area, was.area, is->volume, was.volume);
    collapsed_mesh_release(&c);
    return dropped;
}

/* ---------------------------------------------------------------------------------------------------------- a torus */

static void expect_shape(const char *name, const torus *t, uint64_t dropped_wanted, int64_t euler,
                         uint64_t components) {
    mesh_topology is;
    const uint64_t dropped = expect_repaired(name, t, &is);
    EXPECT(dropped == dropped_wanted && is.euler_characteristic == euler && is.components == components,
           "%s: dropped %llu, Euler characteristic %lld, components %llu", name, (unsigned long long)dropped,
           (long long)is.euler_characteristic, (unsigned long long)is.components);
}

static void test_known(void) {
    torus t;
    torus_make(&t);
    expect_shape("a torus", &t, 0, 0, 1);
    move_onto(&t, torus_vertex(3, 1), torus_vertex(3, 2));
    expect_shape("one edge", &t, 2, 0, 1);

    torus_make(&t);
    for (int n = 1; n < RING; n++) move_onto(&t, torus_vertex(0, n), torus_vertex(0, 0));
    expect_shape("a ring that is a point: a sphere", &t, 2 * RING, 2, 1);
    for (int n = 1; n < RING; n++) move_onto(&t, torus_vertex(4, n), torus_vertex(4, 0));
    expect_shape("two rings that are points: two spheres", &t, 4 * RING, 4, 2);

    torus_make(&t);
    for (int n = 1; n < RING; n++) move_onto(&t, torus_vertex(0, n), torus_vertex(0, n < RING / 2 ? 0 : RING / 2));
    expect_shape("a ring that is an edge: a sphere", &t, 2 * (RING - 2), 2, 1);

    torus_make(&t);
    for (uint32_t v = 1; v < VERTICES; v++) move_onto(&t, v, 0);
    expect_shape("all in one point: nothing", &t, TRIANGLES, 0, 0);
}

static void test_random(void) {
    for (int round = 0; round < ROUNDS; round++) {
        char name[64];
        torus t;
        mesh_topology is;
        torus_make(&t);
        for (int moves = 1 + round / 4; moves > 0; moves--) {
            const uint32_t *triangle = t.triangles[random_below(TRIANGLES)], corner = random_below(3);
            move_onto(&t, triangle[corner], triangle[(corner + 1) % 3]);
        }
        snprintf(name, sizeof name, "round %d", round);
        expect_repaired(name, &t, &is);
    }
}

/* Vertices at few positions, by chance: many sheets meet in the edges between them. */
static void test_few_positions(void) {
    for (int round = 0; round < ROUNDS; round++) {
        char name[64];
        torus t;
        mesh_topology is;
        torus_make(&t);
        const uint32_t count = 2 + (uint32_t)round / 8;
        for (int n = 0; n < VERTICES; n++) {
            const double at = random_below(count);
            for (int axis = 0; axis < 3; axis++) t.positions[n][axis] = (float)cos(at * (axis + 1));
        }
        snprintf(name, sizeof name, "%u positions, round %d", count, round);
        expect_repaired(name, &t, &is);
    }
}

/* A closed umbrella: LEAVES leaves of two triangles around the vertex 0, between which the rim comes to one position.
 * Each leaf is a closed sheet of its own, and all share the edge from 0 to that position. */
static void test_leaves(void) {
    enum { LEAVES = 5, POINTS = 1 + 2 * LEAVES, COUNT = 4 * LEAVES - 2 };
    float positions[POINTS][3] = {{0, 0, 0}}, left[3 * COUNT][3];
    uint32_t triangles[COUNT][3], count = 0;
    collapsed_mesh c;
    mesh_topology is;
    for (uint32_t n = 0; n < 3 * LEAVES; n++) { /* the halves of a leaf are far apart, so that pairs are to be found */
        const uint32_t leaf = n % 3 ? n / 3 : LEAVES - 1 - n / 3, rim = 1 + leaf, next = 1 + (leaf + 1) % LEAVES;
        const uint32_t tip = 1 + LEAVES + leaf, of_leaf[3][3] = {{0, rim, tip}, {0, tip, next}, {next, tip, rim}};
        positions[rim][2] = 1;
        positions[tip][0] = (float)cos(leaf);
        positions[tip][1] = (float)sin(leaf);
        memcpy(triangles[count++], of_leaf[n % 3], sizeof of_leaf[0]);
    }
    for (uint32_t n = 1; n + 1 < LEAVES; n++, count++) {
        const uint32_t inner[3] = {1, 1 + n + 1, 1 + n};
        memcpy(triangles[count], inner, sizeof inner);
    }
    EXPECT(mesh_collapse(positions[0], POINTS, triangles[0], COUNT, &c) == 0, "leaves: %s", failure_text());
    expect_sound("leaves", &c, (const float(*)[3])positions, left);
    mesh_check(left[0], c.vertex_count, c.triangles, c.triangle_count, &is);
    EXPECT(c.triangle_count == 2 * LEAVES && c.vertex_count == 3 * LEAVES && is.components == LEAVES &&
               !is.nonmanifold_edges && !is.boundary_edges && !is.misoriented_edges && !c.nonmanifold_edges,
           "leaves: triangles %llu, vertices %llu, components %llu, nonmanifold edges %llu",
           (unsigned long long)c.triangle_count, (unsigned long long)c.vertex_count, (unsigned long long)is.components,
           (unsigned long long)is.nonmanifold_edges);
    collapsed_mesh_release(&c);
}

/* Three triangles at an edge, and one of zero area beside them: nobody knows which of the three belong together. */
static void test_nonmanifold(void) {
    static const float positions[][3] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, 0, 0}};
    static const uint32_t triangles[][3] = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 2, 5}};
    collapsed_mesh c;
    EXPECT(mesh_collapse(positions[0], 6, triangles[0], 4, &c) == 0, "three at an edge: %s", failure_text());
    EXPECT(c.dropped_count == 1 && c.triangle_count == 3 && c.vertex_count == 5 && c.nonmanifold_edges == 1,
           "three at an edge: dropped %llu, triangles %llu, vertices %llu, nonmanifold edges %llu",
           (unsigned long long)c.dropped_count, (unsigned long long)c.triangle_count,
           (unsigned long long)c.vertex_count, (unsigned long long)c.nonmanifold_edges);
    collapsed_mesh_release(&c);
}

int main(void) {
    random_state = 1;
    test_known();
    test_random();
    test_few_positions();
    test_leaves();
    test_nonmanifold();
    return EXPECT_DONE();
}
