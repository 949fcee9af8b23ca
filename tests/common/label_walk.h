/*
 * label_walk.h - surfaces of a label map against its samples: every triangle in its tetrahedron, every label by itself
 *
 * Shares nothing with the library: tetrahedra are those of split.h, the surface of one label is what signs.h expects of
 * the samples that are equal to it.
 */
#ifndef LABEL_WALK_H
#define LABEL_WALK_H

#include "tetracubes.h"

/* The first fault of a mesh that was made without smoothing of a complete uniform grid in index space, of u8 labels
 * below 32; in words that stay valid until the next call, NULL where there is none. Exits where memory runs out. */
const char *label_walk_fault(const tc_grid_options *grid, const tc_mesh_data *mesh);

/* The parts that it consists of. Each triangle lies in a tetrahedron of the split that has both its labels, between
 * corners of these, and faces those of the second; the first is the lower one, or the second is background. Tetrahedra
 * have as many triangles as their labels ask for. */
const char *label_places_fault(const tc_grid_options *grid, const tc_mesh_data *mesh);

/* At each edge there are two triangles with the same labels, three with those of three, or one, at the grid's border.
 */
const char *label_junctions_fault(const tc_grid_options *grid, const tc_mesh_data *mesh);

/* The triangles that have a label are an oriented manifold, with the Euler characteristic, the fans and the borders of
 * the surface of that label against all others. */
const char *label_topology_fault(const tc_grid_options *grid, const tc_mesh_data *mesh, uint32_t label);

#endif
