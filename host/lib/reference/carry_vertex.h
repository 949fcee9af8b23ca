/*
 * carry_vertex.h - another field of the grid on the vertices of a surface
 */
#ifndef CARRY_VERTEX_H
#define CARRY_VERTEX_H

#include "grid/grid.h"

/* Where the reference engine, asked for no mesh, puts the values of the vertices that it meets. */
typedef struct carry {
    const tc_field *field;
    float *out;
    uint64_t room; /* vertices */
} carry;

/* The field at t on the edge from sample a to sample b; nothing for a vertex that there is no room for. */
void carry_vertex(const carry *c, uint64_t vertex, int64_t a, int64_t b, float t);

#endif
