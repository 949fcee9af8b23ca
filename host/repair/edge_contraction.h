/* edge_contraction.h - the calls of meshoptimizer, in builds with it, HAVE_MESHOPTIMIZER; for mesh_simplify.c */
#ifndef EDGE_CONTRACTION_H
#define EDGE_CONTRACTION_H

#include <stdint.h>

/* The version of the library's header, as "0.18". */
const char *edge_contraction_version(void);

/*
 * Contracts edges, the least error first, until about `goal` triangles are left, and writes these to `out`, which has
 * room for all. An edge ends at one of its vertices, so that positions stay what they are; vertices on the border of
 * the triangles stay. Whether the surface stays what it is the library does not promise. Returns 0, or STATUS_FAILED
 * with its text (failure.h) where memory runs out. Not for several threads at once.
 */
int edge_contraction(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                     uint64_t goal, uint32_t *out, uint64_t *out_count);

#endif
