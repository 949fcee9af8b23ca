/* final_surface.h - --drop-degenerate: a surface without its triangles of zero area (mesh_collapse.h), with all that
 * belongs to it */
#ifndef FINAL_SURFACE_H
#define FINAL_SURFACE_H

#include "carried_fields.h"
#include "engine.h"
#include "mesh_collapse.h"
#include "report.h"

/* A surface as it is shown and written: that of the engine, or what is left of it. */
typedef struct final_surface {
    tc_mesh_data mesh;
    const mesh_part *parts; /* what each of its blocks gave to it */
    int part_count;

    collapsed_mesh collapsed; /* these where triangles were dropped */
    float *positions, *normals;
    mesh_part *own_parts;
} final_surface;

/* The engine's surface, as it is; to be released. */
void final_surface_begin(const engine *e, block_range blocks, const tc_mesh_data *mesh, final_surface *out);

/* Drops the triangles, and adds to s how many. Returns 0 or STATUS_FAILED. */
int final_surface_drop_degenerate(final_surface *shown, surface_report *s);

/* What dropping has left undone in all meshes of the surface, as notices. s has the summary of what is left. */
void final_surface_tell_dropped(const surface_report *s);

/* The fields that were carried to the engine's surface, brought to the one that is shown. Returns 0 or STATUS_FAILED.
 */
int final_surface_carry(const final_surface *shown, carried_fields *fields);

void final_surface_release(final_surface *shown);

#endif
