/*
 * cell_cases.h - the cases of a cell that is kept whole (method hybrid), derived from its faces
 *
 * Vertices lie on the edges of faces, none on the diagonal of a quadrilateral. A face that is cut is a fan of triangles
 * around its smallest point number, with vertices on their sides: one of five corners or six, and a quadrilateral whose
 * diagonal is an edge of another cell. What a cell emits depends on its shape, the diagonals of its faces, which of
 * these are cut and which corners are inside, and on nothing else: kernels/README.md, "Cells kept whole".
 */
#ifndef CELL_CASES_H
#define CELL_CASES_H

#include "tables/cell_split.h"

enum { CELL_EDGES_MAX = 30, CELL_TRIANGLES_MAX = 28 };

/* Faces and edges of a cell. Edges are in the order of their corners, the lower one first. */
typedef struct cell_frame {
    cell_shape shape;
    int face_count, edge_count;
    cell_face faces[CELL_FACES_MAX];
    bool is_cut[CELL_FACES_MAX]; /* the face is the triangles of its fan */
    uint8_t edges[CELL_EDGES_MAX][2];
} cell_frame;

/* Finds the faces of a shape other than a polyhedron, with these point numbers at its corners; those of more than four
 * corners are cut. mirrored: the cell has a negative volume, so that its faces go round the other way. Then the caller
 * may cut other faces, and then the edges are listed. Corners that have the same point, as in collapsed cells, are one:
 * faces have the first of them. */
void cell_frame_begin(cell_shape shape, const uint32_t points[CELL_CORNERS_MAX], bool mirrored, cell_frame *out);
void cell_frame_end(cell_frame *frame);

typedef struct cell_case {
    int triangle_count;
    uint8_t triangles[CELL_TRIANGLES_MAX][3]; /* edges of the frame; counter-clockwise seen from outside */
} cell_case;

/* pattern: bit n is set where corner n is inside. */
void cell_case_derive(const cell_frame *frame, unsigned pattern, cell_case *out);

#endif
