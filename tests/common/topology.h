/*
 * topology.h - whether a triangle mesh is an oriented manifold, from its indices alone
 */
#ifndef TOPOLOGY_H
#define TOPOLOGY_H

#include <stdint.h>

typedef struct topology {
    uint64_t boundary_edges; /* with one triangle */
    uint64_t bad_edges;      /* with more than two, or two that pass it in the same direction */
    uint64_t bad_triangles;  /* an index out of range, or twice the same */
    uint64_t fans;           /* of triangles around vertices: as many as vertices where the mesh is a manifold */
    uint64_t orphans;        /* vertices without a triangle */
    int64_t euler_characteristic;
    double volume; /* enclosed by a closed mesh, positive where it faces outward */
} topology;

/* Exits where memory runs out. */
void topology_of(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                 topology *result);

#endif
