/*
 * mesh_distance.h - how far a surface is from another one: the one-sided Hausdorff distance, by samples
 *
 * Samples of the first surface are its vertices, and of each triangle its centroid and points of a lattice that are not
 * further apart than `spacing`, or a 64th of its longest edge where that is more. Of each the distance to the nearest
 * point of the second surface is exact, but for rounding of doubles. The greatest of them is never more than the true
 * distance, and less than it by no more than the samples are apart.
 */
#ifndef MESH_DISTANCE_H
#define MESH_DISTANCE_H

#include <stdint.h>

typedef struct mesh_view {
    const float *positions; /* as those of mesh_check; indices valid */
    uint64_t vertex_count;
    const uint32_t *triangles;
    uint64_t triangle_count;
} mesh_view;

/* Of a surface: the side of a square as large as its triangles are on average. 0 of an empty one. */
double mesh_spacing(const mesh_view *mesh);

/* *distance: from samples of `from` to `to`; 0 where `from` has no triangles, INFINITY where `to` alone has none.
 * Returns 0, or STATUS_FAILED with its message (failure.h) where memory runs out. */
int mesh_distance(const mesh_view *from, const mesh_view *to, double spacing, double *distance);

#endif
