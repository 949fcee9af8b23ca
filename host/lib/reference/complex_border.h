/*
 * complex_border.h - the border of a complex, which closes surfaces: faces that one present tetrahedron has
 */
#ifndef COMPLEX_BORDER_H
#define COMPLEX_BORDER_H

#include "grid/grid.h"

/* Its points, counter-clockwise seen from outside the tetrahedron. */
typedef struct border_face {
    uint32_t points[3];
} border_face;

typedef struct complex_border {
    border_face *faces; /* by tetrahedron, then by the corner that they do not have */
    uint64_t face_count, room;
} complex_border;

/* Faces of the border that have a point inside. To be released in any case. Tetrahedra with a sample that is not finite
 * are not there. */
tc_status complex_border_find(const tc_grid *grid, double isovalue, complex_border *out);
void complex_border_release(complex_border *border);

/* A vertex on the edge of two points, or in the place of one, which is both. */
typedef struct border_vertex {
    uint32_t a, b;
} border_vertex;

/* The inside part of a face; bit n of inside: its point n is. Returns the number of triangles. They are fanned around
 * an inside point, so that no chord can be an edge of the surface. */
int border_face_cut(const border_face *face, unsigned inside, border_vertex triangles[2][3]);

#endif
