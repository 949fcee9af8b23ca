/*
 * mesh_separate.h - edges that sheets meet in into several edges at the same place, of two triangles or, at a border,
 * one
 *
 * The triangles that pass an edge in one direction are joined to those that pass it in the other, two by two, and an
 * end of the edge becomes a vertex for each fan of triangles there. What was closed stays closed; triangles and
 * positions stay what they are.
 */
#ifndef MESH_SEPARATE_H
#define MESH_SEPARATE_H

#include "mesh_collapse.h"

/* edges: some that are passed several times in one direction, rising, edge_count of them, each (lower vertex << 32 |
 * higher vertex). Those stay of which an end has such an edge that is not among them. mesh->crowded_edges falls by the
 * number of those that are separated. Returns 0, or STATUS_FAILED with its text (failure.h) where memory or numbers of
 * vertices run out, the mesh as it was. */
int mesh_separate(collapsed_mesh *mesh, const uint64_t *edges, uint64_t edge_count);

#endif
