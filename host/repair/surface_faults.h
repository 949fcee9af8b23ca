/*
 * surface_faults.h - where a surface of fewer triangles is no longer the surface that it was
 *
 * Both have the same vertices, of which the second uses a part. A fault is, at a vertex that is not locked,
 *   - triangles that form no single fan, or two triangles with the same three vertices
 *   - a border edge that was not there, or that is gone
 *   - an edge whose two triangles are folded onto each other
 * or, of a component, that it fell apart, vanished, or changed its Euler characteristic. A surface without faults is
 * homeomorphic to the one before: a component is known by its border, its orientation and its Euler characteristic.
 */
#ifndef SURFACE_FAULTS_H
#define SURFACE_FAULTS_H

#include <stdint.h>

/* What is known of the surface before. */
typedef struct surface_shape {
    uint64_t vertex_count;
    const float *positions;
    uint32_t *border_next, *border_previous; /* of each vertex: along the border; NO_VERTEX where it has none */
    uint32_t *roots;                         /* of each vertex: the lowest one of its component */
    int64_t *balances;                       /* of roots: twice the component's vertices, less its triangles */
    uint64_t *triangle_counts;               /* of roots: the component's triangles */
} surface_shape;

#define NO_VERTEX UINT32_MAX

/* Takes the shape of a surface, to be released in any case, and locks, in `locked`, a byte for each vertex, the
 * vertices at which it has faults of its own. fold_cosine: of the angle between the normals of two triangles from which
 * on they are folded. Returns 0, or STATUS_FAILED with its text (failure.h) where memory runs out. */
int surface_shape_take(const float *positions, uint64_t vertex_count, const uint32_t *triangles,
                       uint64_t triangle_count, double fold_cosine, uint8_t *locked, surface_shape *out);
void surface_shape_release(surface_shape *shape);

typedef struct surface_faults {
    uint64_t vertices;   /* with faults of their own */
    uint64_t components; /* with no such vertex, and a fault all the same */
    uint64_t smallest;   /* triangles that the smallest of these had; UINT64_MAX where there are none */
} surface_faults;

/* Compares. marks, a byte for each vertex, zeroed before: 1 of vertices with faults; MARK_COMPONENT of all vertices of
 * a component that counts as one. Returns as above. */
enum { MARK_COMPONENT = 2 };
int surface_faults_find(const surface_shape *before, const uint32_t *triangles, uint64_t triangle_count,
                        double fold_cosine, const uint8_t *locked, uint8_t *marks, surface_faults *out);

#endif
