/*
 * method.h - what the host knows of the methods of structured grids (methods.h in kernels is their list)
 */
#ifndef METHOD_H
#define METHOD_H

#include "tables/tables.h"
#include "kernels/base/methods.h"
#include "tetracubes.h"

#include <stdbool.h>

typedef struct method_row {
    const char *name;
    int vertex_types; /* the first so many of enum vertex_type */
    cases_derive *derive;
    caps_derive *derive_caps; /* of closed surfaces */
} method_row;

extern const method_row methods[METHOD_COUNT]; /* by tc_method */

/* Whether samples can be vertices, and so have a third sign, 0. */
static inline bool method_has_zeros(tc_method method) { return methods[method].vertex_types > VERTEX_SAMPLE; }

/* Whether diagonals of faces have vertices. Without, a cube's triangles come from the method's table alone; else the
 * reference makes them tetrahedron by tetrahedron. */
static inline bool method_has_diagonals(tc_method method) { return methods[method].vertex_types > EDGE_XY; }

#endif
