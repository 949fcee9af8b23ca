/*
 * expected.h - the surface that a grid must have, from the signs of its samples alone
 *
 * Method. A cell is a body with flat faces, each a ring of corners. In every face the crossed edges are joined in pairs
 * by arcs: a triangle has one arc or none; a square with four crossed edges has two, which cut off the corners that the
 * diagonal of the split, between samples whose i + j + k is even, does not join. The arcs of a body close to loops, and
 * each loop bounds one disk of the surface. With arcs and loops the Euler characteristic is known, the arcs that one
 * body alone has are the boundary, and the corners of loops around a crossed edge, joined across arcs, are its fans.
 *
 * Arcs are directed as the disk to their left passes them when it is seen from outside. That follows from where the
 * corners lie and which of them are inside; no case table, and nothing of the library, is used.
 */
#ifndef EXPECTED_H
#define EXPECTED_H

#include <stdbool.h>
#include <stdint.h>

/* A tetrahedron (4) or a cube (8, numbered x + 2 y + 4 z). */
typedef struct body {
    int corner_count;
    uint32_t samples[8]; /* their numbers */
    double at[8][3];
    bool inside[8], even[8]; /* even: of cubes alone */
} body;

typedef struct arc {
    uint32_t from, to; /* vertices */
    uint32_t next;     /* the arc that follows in its loop */
    uint32_t loop;
} arc;

typedef struct expected {
    uint32_t vertex_count, arc_count, loop_count;
    uint64_t triangle_count, active_cells, boundary_edges, fans;
    int64_t euler_characteristic;
    bool conforming;     /* no arc belongs to three bodies, or to two in the same direction */
    uint32_t (*ends)[2]; /* the samples that each vertex lies between, lower number first */
    arc *arcs;

    /* which vertex lies between two samples: open addressing, 0 is an empty place */
    uint64_t *keys;
    uint32_t *vertices, place_mask;
} expected;

/* Room for so many bodies; exits where memory runs out. */
void expected_begin(expected *e, uint64_t most_bodies, int corner_count);

/* Adds a body's arcs, turned round where `mirrored`. Vertices are numbered as they come, edges of a body in the order
 * 01 02 03 12 13 23. active_cells is the caller's to count. */
void expected_add(expected *e, const body *b, bool mirrored);

/* The vertex between two samples, UINT32_MAX where there is none. */
uint32_t expected_vertex(const expected *e, uint32_t a, uint32_t b);

/* Numbers the vertices anew, by rising keys, one per vertex. */
void expected_renumber(expected *e, const uint64_t *keys);

/* Counts what follows from the arcs. */
void expected_finish(expected *e);
void expected_free(expected *e);

#endif
