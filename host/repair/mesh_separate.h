/*
 * mesh_separate.h - sheets that share an edge separated: each gets an edge of its own, at the same position
 *
 * The half-edges of one direction are paired with those of the other; at a border one may stay alone. An end of the
 * edge becomes one vertex for each fan of triangles there. What was closed stays closed; triangles and positions stay
 * what they are.
 */
#ifndef MESH_SEPARATE_H
#define MESH_SEPARATE_H

#include "mesh_collapse.h"

/* edges: some of the edges with several half-edges in one direction, ascending, each as in half_edges.h. An edge stays
 * as it is where another such edge, which is not among them, ends at one of its vertices. mesh->nonmanifold_edges falls
 * by the number of edges that are separated. Returns 0, or STATUS_FAILED with its message (failure.h) where memory or
 * indices of vertices run out; the mesh is then as it was. */
int mesh_separate(collapsed_mesh *mesh, const uint64_t *edges, uint64_t edge_count);

#endif
