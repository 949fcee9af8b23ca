/*
 * neighbours.h - which vertices of a mesh each vertex is joined to, as far as they may pull at it
 *
 * Vertices are divided into ranges, which threads take one by one. What is found depends on the mesh alone.
 */
#ifndef NEIGHBOURS_H
#define NEIGHBOURS_H

#include "grid/mesh.h"

enum { NEIGHBOUR_RANGES = 32 };

/* Vertices that follow each other, and arrays with an element for each. */
typedef struct neighbour_range {
    uint32_t first, end; /* vertices */
    uint64_t capacity;   /* of the lists */
    uint32_t *starts;    /* where the neighbours of each begin */
    uint32_t *vertices;  /* the neighbours, in an order that follows from the mesh */
    uint8_t *counts;     /* how many */
    uint8_t *on_border;  /* it has an edge with one triangle */
} neighbour_range;

typedef struct neighbour_lists {
    neighbour_range ranges[NEIGHBOUR_RANGES];
    uint32_t range_count;
} neighbour_lists;

/* Vertices on a border have the neighbours along it; else those where more than two triangles meet in an edge have the
 * neighbours along such edges; all others have all. They lie in `arrays` and `lists`, which are made as large as is
 * needed; states: NEIGHBOUR_STATE_BYTES per vertex, whose content is lost. NEIGHBOURS_AHEAD entries behind the
 * lists, and some more, may be read and mean nothing. */
enum { NEIGHBOUR_STATE_BYTES = 16, NEIGHBOURS_AHEAD = 512 };
tc_status neighbours_find(const tc_mesh *mesh, void *states, host_block *arrays, host_block *lists,
                          neighbour_lists *out);

#endif
