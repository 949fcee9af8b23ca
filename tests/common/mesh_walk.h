/*
 * mesh_walk.h - a mesh, whole, against the grid that it came from
 *
 * Counts and topology must be those of the signs (signs.h). Walks grid and mesh together in the documented order: every
 * vertex must lie where its crossed edge says, every tetrahedron must have its triangles, on its own crossed edges,
 * facing outward. Knows the split (split.h) and the contract on order, edges and positions; shares no code or table
 * with the library.
 */
#ifndef MESH_WALK_H
#define MESH_WALK_H

#include "tetracubes.h"

#include <stdbool.h>

struct signs; /* signs.h */

/* Uniform, rectilinear and curvilinear grids. The first fault, in words that stay valid until the next call; NULL where
 * there is none. Normals are checked where the mesh has them. */
const char *mesh_fault(const tc_grid_options *grid, double isovalue, const tc_mesh_data *mesh);

/* Parts of it, for meshes that are not in that order. How far from a to b the isovalue lies, as a part of the way;
 * whether a vertex lies there, a being the sample of the lower number, and has that place's normal; whether the grid
 * turns right into left. */
long double crossing_between(const struct signs *s, double isovalue, const int64_t a[3], const int64_t b[3]);
bool vertex_is_right(const struct signs *s, double isovalue, const tc_mesh_data *mesh, uint64_t n, const int64_t a[3],
                     const int64_t b[3]);
bool grid_is_mirrored(const struct signs *s, const tc_mesh_data *mesh);

/* FNV-1a, by words of 32 bits, over positions, normals where there are any, triangles, and their labels where they have
 * some; over positions and tetrahedra. */
uint64_t mesh_bytes_hash(const tc_mesh_data *mesh);
uint64_t interval_bytes_hash(const tc_interval_volume_data *interval);

#endif
