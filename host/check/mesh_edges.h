/*
 * mesh_edges.h - what its edges tell of a mesh beside mesh_check.h: its border as a signature, and folds
 */
#ifndef MESH_EDGES_H
#define MESH_EDGES_H

#include <stdint.h>

typedef struct mesh_edges {
    uint64_t border; /* a sum of hashes over the edges with one triangle, of the positions of their ends and the
                        direction: the same for the same border, in whatever order and with whatever triangles */
    uint64_t folded; /* edges whose two triangles lie folded onto each other: the cosine of the angle between their
                        normals is below fold_cosine. Triangles without area have no normal */
} mesh_edges;

/* positions and triangles as those of mesh_check, indices valid. Returns 0, or STATUS_FAILED with its message
 * (failure.h) where memory runs out. */
int mesh_edges_find(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                    double fold_cosine, mesh_edges *result);

#endif
