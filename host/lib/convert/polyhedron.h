/*
 * polyhedron.h - a convex polyhedron, given by its faces, cut into tetrahedra by pulling
 *
 * Every face is a fan around its smallest point number, and the cell the cone from its own smallest point over the
 * triangles of the faces that do not contain it: cell_split.h's rule with any number of faces and corners, so that
 * neighbours of all types fit. Faces may be wound either way; for a cone whose tetrahedra agree in sign they are turned
 * so that every edge is passed as often in one direction as in the other. Points that stand twice give triangles and
 * tetrahedra without a volume, which are left out on both sides of a face alike.
 */
#ifndef POLYHEDRON_H
#define POLYHEDRON_H

#include "tetracubes.h"

typedef enum polyhedron_verdict {
    POLYHEDRON_GOOD,
    POLYHEDRON_NO_FACES,
    POLYHEDRON_OFFSETS,   /* offsets of the cell or of a face do not rise, or pass the end */
    POLYHEDRON_TOO_LARGE, /* more corners than POLYHEDRON_CORNERS_MOST */
    POLYHEDRON_POINT,     /* an invalid point number */
    POLYHEDRON_OPEN,      /* the faces bound no volume */
    POLYHEDRON_NO_MEMORY
} polyhedron_verdict;

enum { POLYHEDRON_CORNERS_MOST = 1 << 22 }; /* of all its faces */

/* Whether offsets and points of cell c may be used. */
polyhedron_verdict polyhedron_look(const tc_cells *cells, uint64_t c);

/* Cuts a cell that polyhedron_look accepts: writes its tetrahedra to `out`, or only counts them where that is NULL. May
 * still give the last two verdicts. Allocates memory where the cell has many faces. */
polyhedron_verdict polyhedron_cut(const tc_cells *cells, uint64_t c, uint32_t (*out)[4], int *tetrahedron_count);

#endif
