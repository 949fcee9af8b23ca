/*
 * label_tables.h - label maps in a tetrahedron: where vertices are, and the triangles of the 15 partitions of its
 * corners
 *
 * Corners of one label are a part. Two parts of a tetrahedron are separated by an interface, a triangle or a
 * quadrilateral:
 *
 *     3 + 1, 2 + 2     one, as at an isovalue: vertices on the edges between the parts
 *     2 + 1 + 1        three: vertices on five edges, and on the two faces with three labels. There the three meet in a
 *                      junction, from one face to the other
 *     1 + 1 + 1 + 1    six: vertices on all edges, on all four faces, and one in the cell, where four junctions meet
 *
 *           b              On a face with three labels the three edges' vertices are joined to the face's. So the
 *          / \             interfaces of neighbours fit, and the surface of each label, taken alone, has in every
 *         /   \            tetrahedron the disks that its corners against all others give, with some vertices more
 *        *--.--*           on their borders.
 *       /   |   \
 *      a----*----c
 *
 * A partition is known by the edges whose ends differ: bit n of a pattern is edge n (tables.h). All tables are derived
 * from the split and the 16 cases.
 */
#ifndef LABEL_TABLES_H
#define LABEL_TABLES_H

#include "tables/tables.h"

#include <stdbool.h>

/* Vertices of a tetrahedron: on edge n; on the face that does not have corner n; in the cell. */
enum { LABEL_EDGE, LABEL_FACE = 6, LABEL_CELL = 10, LABEL_VERTICES };

/* Types of vertices that a sample owns, in the order of a row: on its six edges; on the two triangles of each of its
 * xy, xz and yz faces; and within the cube that begins at it, on the faces and in the cells of its tetrahedra. */
enum { LABEL_TYPE_FACES = 6, LABEL_TYPE_INNER = 12, LABEL_TYPE_CELLS = 16, LABEL_TYPES = 21 };

enum { LABEL_PATTERNS = 64, INTERFACES_MOST = 6 };

/* Between the parts of two corners: fanned around its first vertex. Counter-clockwise seen from the side of `outer`. */
typedef struct label_interface {
    uint8_t inner, outer; /* corners */
    uint8_t vertex_count; /* 3 or 4 */
    uint8_t vertices[4];
} label_interface;

typedef struct label_case {
    uint8_t interface_count, triangle_count;
    label_interface interfaces[INTERFACES_MOST];
} label_case;

/* What a vertex lies between: corners of the cube at its owner, two, three or four. */
typedef struct label_corners {
    uint8_t count;
    uint8_t corners[4];
} label_corners;

typedef struct label_tables {
    label_case cases[LABEL_PATTERNS];                            /* patterns that no labels make have no interfaces */
    owned_vertex owners[2][TETRAHEDRA_PER_CUBE][LABEL_VERTICES]; /* [parity][tetrahedron][vertex] */
    label_corners corners[2][LABEL_TYPES];                       /* [parity of the cube at the owner][type] */
    float offsets[2][LABEL_TYPES][3]; /* from the owner to the middle of those, in index space */
} label_tables;

void label_tables_derive(label_tables *tables);

/* Which of two labels that meet comes first in a triangle: the lower one, and the background last. */
static inline bool label_precedes(uint32_t a, uint32_t b) { return a - 1 < b - 1; }

#endif
