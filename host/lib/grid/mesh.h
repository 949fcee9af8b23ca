/*
 * mesh.h - the mesh that both engines fill, in host memory that is kept between extractions
 */
#ifndef MESH_H
#define MESH_H

#include "base/channels.h"
#include "base/host_block.h"
#include "tetracubes.h"

struct tc_mesh {
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t active_cell_count;
    double origin[3]; /* that positions are relative to */
    channel_set made;
    host_block channels[CHANNEL_COUNT];
    host_block triangles;
    bool has_labels; /* of a label map */
    host_block boundary_labels;
    uint32_t slab_count;
    tc_timings timings;
};

/* Sets the counts and reserves the memory; checks that indices fit 32 bits. */
tc_status mesh_allocate(tc_mesh *mesh, uint64_t vertex_count, uint64_t triangle_count, channel_set made);

/* The same of a label map's surfaces: positions, triangles and their labels. */
tc_status mesh_allocate_labelled(tc_mesh *mesh, uint64_t vertex_count, uint64_t triangle_count);

/* No vertices, no triangles; memory is kept. */
void mesh_clear(tc_mesh *mesh);

#endif
