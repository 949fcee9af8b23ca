/*
 * surface_files.h - the files of extract: their names, checks before any work, writing
 *
 * One file per isovalue, or with --blocks separate one per isovalue and block, named by "_b0", "_b1", ... before the
 * ending.
 */
#ifndef SURFACE_FILES_H
#define SURFACE_FILES_H

#include "carried_fields.h"
#include "result_mesh.h"
#include "output_group.h"
#include "precision.h"

/* STATUS_USAGE where -o, --format, --blocks and --carry do not fit together, or would overwrite an input; STATUS_FAILED
 * where a file cannot be written. d is NULL before the input is read: then less is known of it. */
int surface_files_check(const options *o, const dataset *d);

/* Adds to s where the numbers in the mesh's file will be coarse. Returns STATUS_USAGE where coordinates are beyond
 * float32 and the file has nothing larger. */
int surface_files_count_coarse(const options *o, const surface_source *source, const result_mesh *mesh,
                               surface_report *s);

/* Notices: which point the file's coordinates count from, where it is not the input's own; where its numbers are coarse
 * (precision.h). */
void surface_files_tell_precision(const options *o, int block_count, const surface_report *s);

/* Writes a mesh to the file of the isovalue, or with --blocks separate of the isovalue and the block. The file says in
 * which space and units the input's coordinates are, and waits in the group. */
int surface_files_write(const options *o, const dataset *d, const typed_isovalue *iso, int block,
                        const result_mesh *mesh, const carried_fields *fields, output_group *group);

/* Names the files of the isovalue for people; from malloc, NULL with its failure's text without memory. */
char *surface_files_describe(const options *o, const typed_isovalue *iso, int block_count);

#endif
