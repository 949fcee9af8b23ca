/*
 * carry_vertex.h - a field on one vertex, as the reference makes it
 */
#ifndef CARRY_VERTEX_H
#define CARRY_VERTEX_H

#include "grid/carry.h"

/* The field at t on the edge from sample a to sample b; nothing for a vertex that there is no room for. */
void carry_vertex(const carry *c, uint64_t vertex, int64_t a, int64_t b, float t);

#endif
