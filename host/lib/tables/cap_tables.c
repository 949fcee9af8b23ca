/*
 * The inside part of a cube's face on the border, which closes a surface (option closed).
 *
 * Every tetrahedron's side in the face is cut off where it is outside:
 *
 *       +             +             +               +         three inside: the side itself
 *      / \           / \           / \             / \        two: a quadrilateral
 *     /   \         *   \         *---*           /   \       one: a triangle
 *    +-----+       - *---+       -     -         *-----0      0: a sample that the surface goes through, its vertex
 *
 * Polygons are fanned around an inside sample, so that all chords end there: the surface has no such vertex, and so no
 * such edge. In the hybrid method a face is cut as a whole, and its crossed edges are joined as the diagonal says.
 */
#include "tables/tables.h"

#include <stdbool.h>
#include <string.h>

/* A polygon of a face: vertices as cube_vertex has them. */
typedef struct polygon {
    uint8_t vertices[8];
    unsigned count;
} polygon;

enum sign { OUTSIDE, ZERO, INSIDE };

unsigned face_corner(unsigned face, unsigned n) {
    const unsigned axis = face / 2, low = n & 1, high = n >> 1, side = face & 1;
    if (axis == 0) return side | low << 1 | high << 2;
    if (axis == 1) return low | side << 1 | high << 2;
    return low | high << 1 | side << 2;
}

static bool in_face(unsigned corner, unsigned face) { return (corner >> (face / 2) & 1) == (face & 1); }

static void vertex_add(polygon *p, unsigned vertex) { p->vertices[p->count++] = (uint8_t)vertex; }

/* Fans the polygon around its vertex `apex`. */
static void polygon_fan(cap_case *c, const polygon *p, unsigned apex, int mirrored) {
    for (unsigned n = 1; n + 1 < p->count; n++, c->triangle_count++) {
        const unsigned next = (apex + n) % p->count, after = (apex + n + 1) % p->count;
        uint8_t *triangle = c->vertices[c->triangle_count];
        triangle[0] = p->vertices[apex];
        triangle[1] = p->vertices[mirrored ? after : next];
        triangle[2] = p->vertices[mirrored ? next : after];
    }
}

/* The part of a polygon of corners that is inside; returns where in it corner `apex` is. */
static unsigned polygon_cut(const uint8_t *corners, unsigned count, const uint8_t signs[8], unsigned apex,
                            polygon *out) {
    unsigned found = 0;
    out->count = 0;
    for (unsigned n = 0; n < count; n++) {
        const unsigned a = corners[n], b = corners[(n + 1) % count];
        if (a == apex) found = out->count;
        if (signs[a] != OUTSIDE) vertex_add(out, CUBE_EDGES + a);
        if (signs[a] + signs[b] == INSIDE && signs[a] != signs[b]) vertex_add(out, cube_edge_index(a, b));
    }
    return found;
}

/* ------------------------------------------------------------------------------------------------------- tetrahedra */

/* The side of a tetrahedron opposite to each of its corners, counter-clockwise seen from outside it. */
static const uint8_t sides[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

/* Around the inside corner that another one follows, else the only one. */
static void side_cut(cap_case *c, const uint8_t corners[3], const uint8_t signs[8], int mirrored) {
    int apex = -1;
    for (unsigned n = 0; n < 3; n++)
        if (signs[corners[n]] == INSIDE && (apex < 0 || signs[corners[(n + 1) % 3]] == INSIDE)) apex = corners[n];
    if (apex < 0) return;
    polygon p;
    const unsigned at = polygon_cut(corners, 3, signs, (unsigned)apex, &p);
    polygon_fan(c, &p, at, mirrored);
}

static void face_of_tetrahedra(cap_case *c, unsigned parity, unsigned face, const uint8_t signs[8], int mirrored) {
    for (unsigned t = 0; t < TETRAHEDRA_PER_CUBE; t++)
        for (unsigned side = 0; side < 4; side++) {
            const uint8_t *tetrahedron = tetrahedron_corners[parity][t], *of = sides[side];
            const uint8_t corners[3] = {tetrahedron[of[0]], tetrahedron[of[1]], tetrahedron[of[2]]};
            if (in_face(corners[0], face) && in_face(corners[1], face) && in_face(corners[2], face))
                side_cut(c, corners, signs, mirrored);
        }
}

/* ------------------------------------------------------------------------------------------------------------ cubes */

/* The face's corners counter-clockwise seen from outside the cube, from one on the split's diagonal on. */
static void face_ring(unsigned parity, unsigned face, uint8_t ring[4]) {
    static const uint8_t around[4] = {0, 1, 3, 2};
    const bool turned = (face & 1) == (face / 2 == 1); /* seen from outside, the order of axes is turned over */
    for (unsigned n = 0; n < 4; n++) ring[n] = (uint8_t)face_corner(face, around[turned ? (4 - n) % 4 : n]);
    const unsigned odd = ring[0] ^ ring[0] >> 1 ^ ring[0] >> 2; /* diagonals end in samples that are even */
    const unsigned start = (odd ^ parity) & 1;
    uint8_t from[4];
    memcpy(from, ring, sizeof from);
    for (unsigned n = 0; n < 4; n++) ring[n] = from[(n + start) % 4];
}

static void face_of_cube(cap_case *c, unsigned parity, unsigned face, const uint8_t signs[8], int mirrored) {
    uint8_t ring[4];
    unsigned inside = 0;
    polygon p;
    face_ring(parity, face, ring);
    for (unsigned n = 0; n < 4; n++) inside |= (unsigned)(signs[ring[n]] == INSIDE) << n;
    if (inside == 0) return;
    if (inside == 10) { /* the diagonal is outside, and parts the two that are inside */
        for (unsigned n = 1; n < 4; n += 2) {
            const uint8_t corners[3] = {ring[n], ring[(n + 1) % 4], ring[n - 1]};
            p.count = 0;
            vertex_add(&p, CUBE_EDGES + corners[0]);
            vertex_add(&p, cube_edge_index(corners[0], corners[1]));
            vertex_add(&p, cube_edge_index(corners[2], corners[0]));
            polygon_fan(c, &p, 0, mirrored);
        }
        return;
    }
    const unsigned apex = inside & 1 ? 0 : inside & 4 ? 2 : inside & 2 ? 1 : 3;
    const unsigned at = polygon_cut(ring, 4, signs, ring[apex], &p);
    polygon_fan(c, &p, at, mirrored);
}

/* ----------------------------------------------------------------------------------------------------------- tables */

typedef void face_cut(cap_case *c, unsigned parity, unsigned face, const uint8_t signs[8], int mirrored);

static void faces_cut(cap_case *cases, face_cut *cut, bool zeros, int mirrored) {
    memset(cases, 0, 2 * CUBE_FACES * CAP_CASES * sizeof *cases);
    for (unsigned n = 0; n < 2 * CUBE_FACES * CAP_CASES; n++) {
        const unsigned face = n / CAP_CASES % CUBE_FACES;
        uint8_t signs[8] = {0};
        bool has_zeros = false;
        for (unsigned corner = 0, digits = n % CAP_CASES; corner < 4; corner++, digits /= 3) {
            signs[face_corner(face, corner)] = (uint8_t)(digits % 3);
            has_zeros = has_zeros || digits % 3 == ZERO;
        }
        if (zeros || !has_zeros) cut(&cases[n], n / CAP_CASES / CUBE_FACES, face, signs, mirrored);
    }
}

void tetra_caps_derive(cap_case *cases, int mirrored) { faces_cut(cases, face_of_tetrahedra, false, mirrored); }
void snap_caps_derive(cap_case *cases, int mirrored) { faces_cut(cases, face_of_tetrahedra, true, mirrored); }
void hybrid_caps_derive(cap_case *cases, int mirrored) { faces_cut(cases, face_of_cube, false, mirrored); }
