/*
 * mesh.h - the mesh that both engines fill, and the host memory that it lives in
 *
 * New memory costs a page fault per page, which at these speeds is much of the run: blocks are kept between
 * extractions, start at a huge page's boundary and ask for huge pages.
 */
#ifndef MESH_H
#define MESH_H

#include "tetracubes.h"

#include <stdbool.h>

typedef struct host_block {
    void *memory;
    size_t bytes; /* a multiple of 4096 */
} host_block;

/* Makes the block at least so large; its content is lost where it has to grow. Returns 0 or TC_ERROR_MEMORY. */
tc_status host_block_reserve(host_block *block, uint64_t bytes);
void host_block_release(host_block *block);

struct tc_mesh {
    uint64_t vertex_count;
    uint64_t triangle_count;
    uint64_t active_cell_count;
    bool has_normals;
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
