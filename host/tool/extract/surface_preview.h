/*
 * surface_preview.h - pictures of surfaces (--preview): their names, checks before any work, drawing
 *
 * One for each file that -o writes, named in the same way, or would write: per isovalue, and with --blocks separate per
 * block.
 */
#ifndef SURFACE_PREVIEW_H
#define SURFACE_PREVIEW_H

#include "output_group.h"
#include "result_mesh.h"

/* STATUS_USAGE where the names do not fit the other options, or would overwrite an input, or the mesh; STATUS_FAILED
 * where a file cannot be written. d is NULL before the input is read. */
int surface_preview_check(const options *o, const dataset *d);

/* Whether --preview can name a picture, another file than -o does. 0 or STATUS_USAGE. */
int preview_check(const options *o);

/* Draws a mesh, in parts as in mesh_write_options, into a file that waits in the group. */
int preview_write(const options *o, const char *path, const tc_mesh_data *mesh, const mesh_part *parts, int part_count,
                  output_group *group);

/* Draws the mesh of the isovalue and, with --blocks separate, the block. The file waits in the group. */
int surface_preview_write(const options *o, const typed_isovalue *iso, int block, const result_mesh *mesh,
                          output_group *group);

#endif
