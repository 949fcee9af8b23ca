/*
 * surface_files.h - the files of extract: their names, what can be refused before any work, and writing
 *
 * One file per isovalue, or with --blocks separate one per isovalue and block, named by "_b0", "_b1", ... before the
 * ending.
 */
#ifndef SURFACE_FILES_H
#define SURFACE_FILES_H

#include "precision.h"

/* STATUS_USAGE where -o, --format, --blocks and --carry do not fit together, or would overwrite an input. */
int surface_files_check(const options *o);

/* Tells which point the file's coordinates count from where that is no matter of course, and where its numbers are
 * coarse (precision.h). The surface is made from source. */
int surface_files_tell_numbers(const options *o, const surface_source *source, const final_surface *shown,
                               precision_verdict *verdict);

/* Writes the surface of all blocks; fields may be NULL. *written, from malloc, names the files for people. */
int surface_files_write(const options *o, const typed_isovalue *iso, const final_surface *shown,
                        const mesh_field *fields, int field_count, char **written);

#endif
