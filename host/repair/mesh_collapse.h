/*
 * mesh_collapse.h - triangles of zero area dropped from a mesh, so that the rest stays closed
 *
 * It needs the mesh alone. Where two corners of a triangle have the same position, the edge between them is contracted:
 * its two vertices become one, and the triangles at this edge are dropped. The two other edges of a dropped triangle
 * become one edge, so that the triangles on both sides stay neighbours. So every edge keeps its two triangles, and the
 * border stays the border.
 *
 * Vertices at the same position are merged only where an edge joins them: two sheets that merely touch stay apart.
 * Where a contraction pinches a sheet at a point, each side gets a vertex of its own; where it pinches along an edge,
 * each side gets an edge of its own (mesh_separate.h). A component without area vanishes.
 *
 * Triangles whose corners lie at three positions on one line stay. No vertex is moved.
 */
#ifndef MESH_COLLAPSE_H
#define MESH_COLLAPSE_H

#include <stdint.h>

typedef struct collapsed_mesh {
    uint64_t vertex_count, triangle_count;
    uint32_t *triangles; /* 3 vertices each, in the order of the original ones; from malloc */
    uint32_t *sources; /* per vertex: the original vertex that has its position, normal and values. Ascending; a pinched
                          vertex stands here once for each side; from malloc */
    uint64_t dropped_count;     /* triangles */
    uint64_t nonmanifold_edges; /* with several half-edges in one direction, as the original mesh had them there */
} collapsed_mesh;

/* positions and triangles as those of mesh_check, indices valid. Returns 0 and a mesh to be released, or STATUS_FAILED
 * with its message (failure.h) where memory runs out. Where nothing is dropped, dropped_count is 0 and the arrays are
 * NULL: the original mesh is the result. */
int mesh_collapse(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                  collapsed_mesh *result);

/* Frees and zeroes. */
void collapsed_mesh_release(collapsed_mesh *mesh);

#endif
