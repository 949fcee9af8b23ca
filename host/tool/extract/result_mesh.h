/* result_mesh.h - a mesh as it is reported and written: the engine's, or what --drop-degenerate and --simplify leave of
 * it */
#ifndef RESULT_MESH_H
#define RESULT_MESH_H

#include "carried_fields.h"
#include "engine.h"
#include "mesh_collapse.h"
#include "report.h"

/* The mesh, and where it has not all of the engine's triangles the memory that it is in. */
typedef struct result_mesh {
    tc_mesh_data mesh;
    const mesh_part *parts; /* what each of its blocks gave to it */
    int part_count;
    int suits_world; /* as of the engine */

    uint32_t *sources; /* of each vertex: the engine's. This and the rest: NULL where nothing was left out */
    uint32_t *triangles;
    float *values[CHANNEL_COUNT];
    mesh_part *own_parts;
} result_mesh;

/* The engine's surface, as it is; to be released. */
void result_mesh_begin(const engine *e, block_range blocks, const tc_mesh_data *mesh, result_mesh *out);

/* Keeps only these triangles of the mesh, with these vertices: sources are those of the mesh so far, ascending, and
 * vertices and triangles of each part still follow each other. Both arrays are the result's from here on, after a
 * failure too. Returns 0 or STATUS_FAILED. */
int result_mesh_keep(result_mesh *result, uint64_t vertex_count, uint32_t *sources, uint64_t triangle_count,
                     uint32_t *triangles);

/* Drops triangles of zero area, and adds to s how many. Returns 0 or STATUS_FAILED. */
int result_mesh_drop_degenerate(result_mesh *result, surface_report *s);

/* Notices of what dropping could not mend, in all meshes of the surface. s has the summary of what is left. */
void result_mesh_tell_dropped(const surface_report *s);

/* Brings the fields that were carried onto the engine's vertices to the vertices that are left. Returns 0 or
 * STATUS_FAILED. */
int result_mesh_carry(const result_mesh *result, carried_fields *fields);

void result_mesh_release(result_mesh *result);

#endif
