/*
 * formats.h - one writer per format, as the dispatcher in write.c calls them
 *
 * A writer puts the whole file into the output, whose errors are sticky: it checks nothing. Counts have been checked
 * against FORMAT_LIMIT before.
 */
#ifndef FORMATS_H
#define FORMATS_H

#include "output.h"
#include "tetracubes.h"

#define FORMAT_LIMIT UINT32_MAX /* vertices in a PLY or OBJ file, triangles in an STL file */

void ply_write(output *o, const tc_mesh_data *mesh, int soup);
void obj_write(output *o, const tc_mesh_data *mesh, int soup);
void stl_write(output *o, const tc_mesh_data *mesh, int soup);

/* The vertex of the mesh that vertex v of the file shows: in a soup the triangles' corners, one after the other. */
static inline uint64_t source_vertex(const tc_mesh_data *mesh, int soup, uint64_t v) {
    return soup ? mesh->triangles[v] : v;
}

/* The vertex of the file at corner c (3 per triangle). */
static inline uint32_t corner_vertex(const tc_mesh_data *mesh, int soup, uint64_t c) {
    return soup ? (uint32_t)c : mesh->triangles[c];
}

static inline uint64_t file_vertex_count(const tc_mesh_data *mesh, int soup) {
    return soup ? 3 * mesh->triangle_count : mesh->vertex_count;
}

#endif
