/*
 * cell_split.h - one cell of an unstructured grid cut into tetrahedra
 *
 * Every quadrilateral face is cut by the diagonal through its smallest point number, so that the two cells of a face
 * agree on it whatever their types and the order of their corners. The cell itself is the cone from its smallest corner
 * over the triangles of the faces that do not contain it: of a wedge 3 tetrahedra, of a pyramid 2, of a hexahedron 6,
 * or 5 where none of the diagonals meets the corner opposite the smallest. Faces of more corners, of prisms, are fans
 * around their smallest; a pentagonal prism gives 9, a hexagonal one 12. polyhedron.h does the same with any faces.
 *
 * Corners as VTK numbers them, but for the wedge's bottom, which is turned over here:
 *
 *       7-------6                 5           4
 *      /|      /|                /|\         /|\
 *     4-------5 |               3---4       / | \
 *     | 3-----|-2               | 2 |      3--|--2
 *     |/      |/                |/ \|     /   | /
 *     0-------1                 0---1    0-------1
 *
 * Faces are listed counter-clockwise seen from outside, so that a tetrahedron made of a corner and a face of a cell of
 * positive volume has a positive one.
 *
 * Dompierre, Labbe, Vallet, Camarero, "How to subdivide pyramids, prisms, and hexahedra into tetrahedra" (1999).
 */
#ifndef CELL_SPLIT_H
#define CELL_SPLIT_H

#include <stdbool.h>
#include <stdint.h>

enum { CELL_CORNERS_MAX = 12, CELL_TETRAHEDRA_MAX = 12 };

typedef enum cell_shape {
    CELL_TETRAHEDRON,
    CELL_HEXAHEDRON,
    CELL_WEDGE,
    CELL_PYRAMID,
    CELL_PENTAGONAL_PRISM,
    CELL_HEXAGONAL_PRISM,
    CELL_POLYHEDRON,
    CELL_FLAT,
    CELL_OTHER
} cell_shape;

/* One of VTK's types of cells. */
typedef struct cell_type {
    const char *name;
    cell_shape shape;
    uint8_t corner_count;
    uint8_t point_count; /* that such a cell has, the first ones; 0: any number from corner_count on */
    bool curved;
    uint8_t corners[CELL_CORNERS_MAX]; /* where in the cell's points the corners of the shape are */
} cell_type;

/* CELL_OTHER for types that VTK does not have. */
const cell_type *cell_type_get(unsigned vtk_type);

enum { CELL_FACES_MAX = 8, CELL_FACE_CORNERS_MAX = 6 };

/* A face, counter-clockwise seen from outside, from its smallest point number on: it is cut as a fan around that. */
typedef struct cell_face {
    uint8_t corner_count;
    uint8_t corners[CELL_FACE_CORNERS_MAX];
} cell_face;

/* The faces of a shape other than a polyhedron, with these point numbers at its corners; returns their number. */
int cell_faces(cell_shape shape, const uint32_t points[CELL_CORNERS_MAX], cell_face faces[CELL_FACES_MAX]);

/* Cuts a shape other than a polyhedron, with these point numbers at its corners; returns the number of tetrahedra.
 * Tetrahedra with a point twice, as in collapsed cells, are left out. */
int cell_split(cell_shape shape, const uint32_t points[CELL_CORNERS_MAX], uint32_t out[CELL_TETRAHEDRA_MAX][4]);

#endif
