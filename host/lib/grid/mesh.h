/*
 * mesh.h - the mesh that both engines fill, in host memory that is kept between extractions
 */
#ifndef MESH_H
#define MESH_H

#include "base/host_block.h"
#include "tetracubes.h"

#include <stdbool.h>

struct tc_mesh {
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t active_cell_count;
    bool has_normals;
    double origin[3]; /* that positions are relative to */
    host_block positions;
    host_block normals;
    host_block triangles;
    uint32_t slab_count;
    tc_timings timings;
};

/* Sets the counts and reserves the memory; checks that indices fit 32 bits. */
tc_status mesh_allocate(tc_mesh *mesh, uint64_t vertex_count, uint64_t triangle_count, bool normals);

/* No vertices, no triangles; memory is kept. */
void mesh_clear(tc_mesh *mesh);

enum { MESH_BYTES_PER_VERTEX = 12, MESH_BYTES_PER_TRIANGLE = 12 };

#endif
