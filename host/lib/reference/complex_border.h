/*
 * complex_border.h - the border of a complex, which closes surfaces: faces that one present tetrahedron has, or one
 * present cell (method hybrid)
 */
#ifndef COMPLEX_BORDER_H
#define COMPLEX_BORDER_H

#include "grid/grid.h"

/* A triangle or a quadrilateral, counter-clockwise seen from outside. A quadrilateral begins with its smallest point,
 * which its diagonal goes through. A half is a quadrilateral's, the other of which is not on the border; it begins with
 * the two points of the diagonal. */
typedef struct border_face {
    uint32_t points[4];
    uint8_t corner_count;
    bool is_half;
} border_face;

typedef struct complex_border {
    border_face *faces; /* by tetrahedron, then by the corner that they do not have; by cell, then as cell_faces has */
    uint64_t face_count, capacity;
} complex_border;

/* Faces of the border that have a point inside. To be released in any case. Tetrahedra, or where keeps_cells is set
 * cells, with a sample that is not finite are not there. */
tc_status complex_border_find(const tc_grid *grid, double isovalue, bool keeps_cells, complex_border *out);
void complex_border_release(complex_border *border);

/* A vertex on the edge of two points, or at one, which is both. */
typedef struct border_vertex {
    uint32_t a, b;
} border_vertex;

/* The inside part of a face; bit n of inside: its point n is inside. has_diagonal: a quadrilateral is cut as its two
 * triangles are, as its diagonal is not crossed or has a vertex; else it is cut as a whole. Returns the number of
 * triangles. They are fanned around inside points, so that no
 * chord can be an edge of the surface. */
enum { BORDER_TRIANGLES_MAX = 4 };

int border_face_cut(const border_face *face, unsigned inside, bool has_diagonal,
                    border_vertex triangles[BORDER_TRIANGLES_MAX][3]);

#endif
