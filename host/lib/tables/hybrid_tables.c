/*
 * The cases of a cube in the hybrid method: marching cubes, whose ambiguous faces are decided as by the tetrahedra.
 *
 * Vertices lie on the twelve edges of a cube. On a face with four of them the diagonal by which the face is cut joins
 * two corners of one sign, so each of the other two is cut off on its own, as the tetrahedra would do it; both cubes of
 * the face agree. Walking around a face counter-clockwise, seen from outside the cube, every side of the patch starts
 * where the walk enters the inside and ends where it leaves: each crossed edge starts one side and ends one, in the
 * other of its two faces, so the sides form loops, and these wind as their triangles shall.
 *
 * Each loop bounds a disk. It is cut by the chords whose squared lengths, between middles of edges, have the least sum;
 * of equal ones the first is taken, which makes the table a function of the numbers of edges alone. A chord in a face
 * of the cube could be one of the neighbour's too, and four triangles would meet in it. Twelve loops of eight vertices
 * have no triangulation without one: they have it in a face at x, y or z = 0, where no neighbour may have one.
 */
#include "tables/loop.h"
#include "tables/tables.h"

#include <string.h>

enum { FACE_CORNERS = 4, CHORD_LOW = 1 << 10, CHORD_HIGH = 1 << 20 };

typedef struct loop {
    unsigned count;
    uint8_t edges[12]; /* indices in cube_edges */
} loop;

/* Corners of a face, counter-clockwise seen from outside. */
static void face_corners(unsigned axis, unsigned high, uint8_t corners[FACE_CORNERS]) {
    unsigned u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, base = high << axis;
    const unsigned around[FACE_CORNERS] = {base, base | u, base | u | v, base | v};
    for (unsigned n = 0; n < FACE_CORNERS; n++) corners[n] = (uint8_t)around[high ? n : FACE_CORNERS - 1 - n];
}

/* Whether the diagonal of a face at this corner is an edge of the tetrahedra. */
static int diagonal_at(unsigned parity, unsigned corner) {
    return memchr(tetrahedron_corners[parity][0], (int)corner, 4) != NULL;
}

/* Enters the sides of the patch in a face into `next`: for an edge, the edge that follows it in its loop. */
static void face_sides(unsigned parity, unsigned pattern, const uint8_t corners[FACE_CORNERS],
                       uint8_t next[CUBE_EDGES]) {
    uint8_t around[FACE_CORNERS];
    int steps[FACE_CORNERS], crossed = 0; /* 1: into the inside, -1: out of it */
    for (unsigned n = 0; n < FACE_CORNERS; n++) {
        unsigned a = corners[n], b = corners[(n + 1) % FACE_CORNERS];
        around[n] = cube_edge_index(a, b);
        steps[n] = (int)(pattern >> b & 1) - (int)(pattern >> a & 1);
        crossed += steps[n] != 0;
    }
    for (unsigned n = 0; n < FACE_CORNERS; n++) {
        if (steps[n] != 1) continue;
        unsigned end = (n + 1) % FACE_CORNERS; /* cuts off the corner inside */
        if (crossed == FACE_CORNERS && diagonal_at(parity, corners[end])) end = (n + FACE_CORNERS - 1) % FACE_CORNERS;
        while (steps[end] != -1) end = (end + 1) % FACE_CORNERS;
        next[around[n]] = around[end];
    }
}

/* Twice the middle of an edge along an axis. */
static int middle(unsigned edge, unsigned axis) {
    const owned_vertex e = cube_edges[edge];
    const unsigned start[3] = {e.dx, e.dy, e.dz};
    return (int)(2 * start[axis] + (e.type == axis));
}

/* The squared length of the chord between the middles of two edges, or more for chords to avoid. */
static int32_t cube_chord_cost(const void *context, uint8_t a, uint8_t b) {
    int32_t cost = 0;
    (void)context;
    for (unsigned axis = 0; axis < 3; axis++) {
        int difference = middle(a, axis) - middle(b, axis);
        cost += difference * difference;
        if (difference == 0 && middle(a, axis) == 0) cost += CHORD_LOW;
        if (difference == 0 && middle(a, axis) == 2) cost += CHORD_HIGH;
    }
    return cost;
}

/* Adds the disk of a loop. */
static void disk_add(const loop *l, int mirrored, cube_case *out) {
    uint8_t(*triangles)[3] = out->vertices + out->triangle_count;
    const unsigned count = loop_triangulate(l->edges, (int)l->count, cube_chord_cost, NULL, triangles);
    for (unsigned n = 0; n < count && mirrored; n++) {
        const uint8_t corner = triangles[n][1];
        triangles[n][1] = triangles[n][2];
        triangles[n][2] = corner;
    }
    out->triangle_count = (uint8_t)(out->triangle_count + count);
}

static void hybrid_case_derive(cube_case *out, unsigned parity, unsigned pattern, int mirrored) {
    uint8_t next[CUBE_EDGES], corners[FACE_CORNERS];
    memset(next, CUBE_EDGES, sizeof next);
    for (unsigned face = 0; face < 6; face++) {
        face_corners(face / 2, face % 2, corners);
        face_sides(parity, pattern, corners, next);
    }
    *out = (cube_case){0};
    for (unsigned start = 0; start < CUBE_EDGES; start++) {
        loop l = {0};
        for (unsigned edge = start; next[edge] < CUBE_EDGES;) {
            const unsigned follower = next[edge];
            l.edges[l.count++] = (uint8_t)edge;
            next[edge] = CUBE_EDGES;
            edge = follower;
        }
        if (l.count) disk_add(&l, mirrored, out);
    }
}

void hybrid_cases_derive(cube_case *cases, int mirrored) {
    for (unsigned n = 0; n < 2 * CASES_TWO_SIGNS; n++)
        hybrid_case_derive(&cases[n], n / CASES_TWO_SIGNS, n % CASES_TWO_SIGNS, mirrored);
}
