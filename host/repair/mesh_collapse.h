/*
 * mesh_collapse.h - triangles of zero area out of a mesh, so that what is left stays closed
 *
 * Knows the mesh alone, as mesh_check does. Where two corners of a triangle are at one position, the edge between them
 * is contracted: vertices that such edges join become one, and triangles with two corners there are dropped. What their
 * other two edges joined is joined to each other, so an edge keeps its two triangles, and the border stays what it was.
 * Vertices at one position that no such edge joins (two sheets that touch) stay apart. A sheet that is pinched off at a
 * point gets a vertex on each side, one that is pinched off along an edge an edge on each side (mesh_separate.h); a
 * component without any area goes.
 *
 * Not dropped: triangles whose three corners are apart on a line. Nothing is moved.
 */
#ifndef MESH_COLLAPSE_H
#define MESH_COLLAPSE_H

#include <stdint.h>

typedef struct collapsed_mesh {
    uint64_t vertex_count, triangle_count;
    uint32_t *triangles; /* 3 vertices each, in the mesh's order; from malloc */
    uint32_t *sources;   /* the vertex of the mesh that each vertex is: its place, normal and values. Not falling; one
                            may stand several times, where a sheet was pinched off; from malloc */
    uint64_t dropped_count; /* triangles */
    uint64_t crowded_edges; /* passed twice or more in one direction: the mesh had such edges there before */
} collapsed_mesh;

/* positions and triangles as those of mesh_check, indices valid. Returns 0 and a mesh to be released, or STATUS_FAILED
 * with its text (failure.h) where memory runs out. Where there is nothing to drop dropped_count is 0 and the arrays are
 * NULL: the mesh stays as it is. */
int mesh_collapse(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                  collapsed_mesh *result);

/* Frees and zeroes. */
void collapsed_mesh_release(collapsed_mesh *mesh);

#endif
