/*
 * interval_facts.h - what can be said of tetrahedra, and of what a grid's tetrahedra have between two isovalues, by
 * geometry alone: shares nothing with how interval volumes are made
 */
#ifndef INTERVAL_FACTS_H
#define INTERVAL_FACTS_H

#include "tetracubes.h"

#include <stdbool.h>

/* A face of a tetrahedron, counter-clockwise seen from outside it. */
typedef struct outer_face {
    uint32_t v[3];
} outer_face;

typedef struct interval_facts {
    uint64_t bad_vertices; /* out of range, or twice in a tetrahedron */
    uint64_t unused_vertices;
    uint64_t bad_faces;   /* of three tetrahedra or more, or passed by two in the same direction */
    double volume, least; /* sum, and that of the most negative or smallest tetrahedron */
    outer_face *outer;    /* faces that one tetrahedron has; from malloc */
    uint64_t outer_count;
} interval_facts;

/* outer NULL where memory ran out. */
interval_facts interval_facts_of(const float *points, uint64_t point_count, const uint32_t *tetrahedra,
                                 uint64_t tetrahedron_count);

double face_area(const float *points, const uint32_t v[3]);

/* Of a tetrahedron or triangle (count 4 or 3) with these values at its corners, the part where they are >= level. */
double part_above(const double *values, int count, double level);

/* Whether two sets of triangles, those of b turned over where `turned`, have the same border and the same vertices, so
 * that they can differ in how polygons are cut only. */
bool same_sheet(const outer_face *a, const outer_face *b, uint64_t count, bool turned);

#endif
