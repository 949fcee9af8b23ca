/*
 * tables.h - the split of a cube into five tetrahedra, the 16 cases of a tetrahedron, and what follows from them
 *
 * Cube corners are numbered c = x + 2 y + 4 z:          6-------7
 *                                                      /|      /|      z  y
 *                                                     4-------5 |      | /
 *                                                     | 2-----|-3      |/
 *                                                     |/      |/       0---x
 *                                                     0-------1
 *
 * An even cube (i + j + k even) has the central tetrahedron {0, 3, 5, 6} and one at each of the corners 1, 2, 4, 7; an
 * odd cube is its mirror in x. Every tetrahedron (v0, v1, v2, v3) is listed so that (v1 - v0) x (v2 - v0) . (v3 - v0)
 * is positive.
 *
 *             v3            Edges: 0 = v0 v1, 1 = v0 v2, 2 = v0 v3, 3 = v1 v2, 4 = v1 v3, 5 = v2 v3.
 *            /|\            A case has bit n set when vn is inside. Its triangles are listed by edges and wind
 *           / | \           counter-clockwise seen from outside.
 *         v0--|--v2
 *           \ | /           Source: Carneiro, Silva, Kaufman, "Tetra-Cubes" (SIBGRAPI 1996), section 5.1, which counts
 *             v1            seven edges; there are six.
 */
#ifndef TABLES_H
#define TABLES_H

#include <stdint.h>

enum { TETRAHEDRA_PER_CUBE = 5, EDGES_PER_SAMPLE = 6, CUBE_EDGES = 18, CUBE_TRIANGLES_MAX = 10 };

/* Vertices that a sample owns, in their order in a mesh: on its six edges, and the one at itself, where the
 * surface goes through the sample (method snap), or ends at the border inside it (closed surfaces). */
enum vertex_type { EDGE_X, EDGE_Y, EDGE_Z, EDGE_XY, EDGE_XZ, EDGE_YZ, VERTEX_SAMPLE, VERTEX_TYPES_MOST };

extern const uint8_t tetrahedron_corners[2][TETRAHEDRA_PER_CUBE][4]; /* [parity][tetrahedron][vertex] */
extern const uint8_t tetrahedron_edges[6][2];                        /* [edge][end] */

typedef struct tetrahedron_case {
    uint8_t triangle_count;
    uint8_t triangles[2][3]; /* edges */
} tetrahedron_case;

extern const tetrahedron_case tetrahedron_cases[16];

/* A vertex of a cube, on an edge between two of its corners or at one: the sample that owns it, by its offset, and its
 * type. */
typedef struct owned_vertex {
    uint8_t dx, dy, dz;
    uint8_t type;
} owned_vertex;

owned_vertex edge_between(unsigned corner_a, unsigned corner_b);

/* The 18 edges of a cube: those owned by samples at x (rows (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1)), then those
 * owned by samples at x + 1. */
extern const owned_vertex cube_edges[CUBE_EDGES];

/* The index in cube_edges of the edge between two corners. */
uint8_t cube_edge_index(unsigned corner_a, unsigned corner_b);

/* Where a vertex of a cube lies: an index in cube_edges, or CUBE_EDGES + c for corner c itself. */
owned_vertex cube_vertex(unsigned index);

/* What all tetrahedra of a cube emit, derived from the tables above; vertices are indices as cube_vertex has them. */
typedef struct cube_case {
    uint8_t triangle_count;
    uint8_t vertices[CUBE_TRIANGLES_MAX][3];
    uint8_t padding;
} cube_case; /* 32 bytes, as the emit kernel reads it */

/* Cases of a cube of either parity. Two signs: bit c of a case is corner c, 1 inside. Three: digit c to the base 3 is
 * corner c, 0 outside, 1 a vertex, 2 inside. */
enum { CASES_TWO_SIGNS = 256, CASES_THREE_SIGNS = 6561 };

/* The bits of a number below 256 as digits to the base 3. */
uint16_t bits_as_digits(unsigned bits);

/* Fills cases[parity * cases of a cube + case]. mirrored: the grid's Jacobian is negative, so triangles are turned
 * over. */
typedef void cases_derive(cube_case *cases, int mirrored);

cases_derive tetra_cases_derive, hybrid_cases_derive, snap_cases_derive;

/* The inside part of a cube's face on the border, as triangles that wind counter-clockwise seen from outside the cube;
 * vertices are indices as cube_vertex has them. */
typedef struct cap_case {
    uint8_t triangle_count;
    uint8_t vertices[4][3];
} cap_case;

/* Faces are those at low x, high x, low y, high y, low z, high z. Digit n to the base 3 of a case is corner n of the
 * face, in the order of the cube's corners: 0 outside, 1 a vertex of the surface, 2 inside. */
enum { CUBE_FACES = 6, CAP_CASES = 81 };

/* Corner n of a face, 0 <= n < 4. */
unsigned face_corner(unsigned face, unsigned n);

/* Fills cases[(parity * CUBE_FACES + face) * CAP_CASES + case]. */
typedef void caps_derive(cap_case *cases, int mirrored);

caps_derive tetra_caps_derive, hybrid_caps_derive, snap_caps_derive;

#endif
