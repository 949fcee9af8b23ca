/*
 * neighbours.h - which vertices of a mesh each vertex is joined to, as far as they may pull at it
 *
 * Vertices are divided into ranges, which threads take one by one. What a range finds depends on the mesh alone.
 */
#ifndef NEIGHBOURS_H
#define NEIGHBOURS_H

#include "grid/mesh.h"

typedef struct neighbour_range {
    uint32_t first, end; /* vertices */
    uint32_t *starts;    /* end - first + 1: where the neighbours of each begin, with room for more */
    uint8_t *counts;     /* one per vertex: how many it has */
    uint32_t *vertices;  /* in an order that follows from the mesh */
    uint8_t *on_border;  /* one per vertex: it has an edge with one triangle */
} neighbour_range;

typedef struct neighbour_lists {
    neighbour_range *ranges;
    uint32_t range_count;
} neighbour_lists;

/* Vertices on a border have the neighbours along it; else those where more than two triangles meet in an edge have the
 * neighbours along such edges; all others have all. To be released in any case. */
tc_status neighbours_find(const tc_mesh *mesh, neighbour_lists *out);
void neighbours_release(neighbour_lists *lists);

#endif
