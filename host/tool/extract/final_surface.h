/* final_surface.h - a surface as it is reported and written: the engine's mesh, or what --drop-degenerate leaves of it
 */
#ifndef FINAL_SURFACE_H
#define FINAL_SURFACE_H

#include "carried_fields.h"
#include "engine.h"
#include "mesh_collapse.h"
#include "report.h"

/* The mesh, and where triangles of zero area were dropped (mesh_collapse.h) the memory that it is in. */
typedef struct final_surface {
    tc_mesh_data mesh;
    const mesh_part *parts; /* what each of its blocks gave to it */
    int part_count;

    collapsed_mesh collapsed; /* from here on: only where triangles were dropped */
    float *values[CHANNEL_COUNT];
    mesh_part *own_parts;
} final_surface;

/* The engine's surface, as it is; to be released. */
void final_surface_begin(const engine *e, block_range blocks, const tc_mesh_data *mesh, final_surface *out);

/* Drops the triangles, and adds to s how many. Returns 0 or STATUS_FAILED. */
int final_surface_drop_degenerate(final_surface *shown, surface_report *s);

/* Notices of what dropping could not mend, in all meshes of the surface. s has the summary of what is left. */
void final_surface_tell_dropped(const surface_report *s);

/* Brings the fields that were carried onto the engine's vertices to the vertices that are left. Returns 0 or
 * STATUS_FAILED. */
int final_surface_carry(const final_surface *shown, carried_fields *fields);

void final_surface_release(final_surface *shown);

#endif
