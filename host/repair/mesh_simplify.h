/*
 * mesh_simplify.h - a surface of fewer triangles that is as much a manifold as it was
 *
 * Edges are contracted by meshoptimizer, which does not look whether the surface stays what it is. So it is given a
 * surface in stages, each of which halves it, and what it makes is compared with what it got (surface_faults.h). Around
 * each fault vertices are locked, and the stage is done again, until there is none. What comes out is homeomorphic to
 * what went in, has the same border, edge by edge, no edge that is folded and was not, and no vertex at a new position.
 *
 * Vertices are locked by leaving out their triangles: the vertices around them are then on the border of what the
 * library gets, and stay.
 *
 * Of builds with meshoptimizer only, HAVE_MESHOPTIMIZER.
 */
#ifndef MESH_SIMPLIFY_H
#define MESH_SIMPLIFY_H

#include <stdint.h>

typedef struct simplified_mesh {
    uint64_t vertex_count, triangle_count;
    uint32_t *triangles; /* 3 vertices each; from malloc */
    uint32_t *sources;   /* per vertex: the original one, ascending; from malloc */
} simplified_mesh;

typedef struct simplify_options {
    double share;       /* of the triangles that is to remain: a goal, which borders and topology may keep it from */
    double fold_cosine; /* of the angle between two triangles' normals, from which on they are folded */
    /* NULL, or called with the result of each stage: *is_good 0 takes that back, and a smaller step is tried. Returns 0
     * or a status that ends it all. */
    int (*judge)(void *user, const simplified_mesh *mesh, int *is_good);
    void *user;
} simplify_options;

/* positions and triangles as those of mesh_check, indices valid. Returns 0 and a mesh to be released; or STATUS_FAILED
 * with its message (failure.h) where memory runs out, or the status of judge. */
int mesh_simplify(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                  const simplify_options *how, simplified_mesh *result);

/* Frees and zeroes. */
void simplified_mesh_release(simplified_mesh *mesh);

#endif
