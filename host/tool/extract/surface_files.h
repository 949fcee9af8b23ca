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
#include "parts/part_file.h"
#include "precision.h"

/* STATUS_USAGE where -o, --format, --blocks and --carry do not fit together, or would overwrite an input; STATUS_FAILED
 * where a file cannot be written. d is NULL before the input is read: then less is known of it. */
int surface_files_check(const options *o, const dataset *d);

/* The same of the names alone that a pattern makes: that of -o, or of another option that writes files beside. */
int surface_names_check(const options *o, const dataset *d, const char *option, const char *pattern);

/* The pattern's file of an isovalue and, with --blocks separate, of a block; from malloc, NULL with its failure's text
 * without memory. */
char *surface_file_name(const options *o, const char *pattern, const typed_isovalue *iso, int block);

/* The point that coordinates in a file count from: --origin-at, else 0, 0, 0 where float32 is fine enough for that.
 * NULL: formats that hold float32 alone have coordinates relative to the mesh's origin (mesh_write.h). */
const double *surface_file_zero(const options *o, int suits_world);

/* Adds to s where the numbers in the mesh's file will be coarse. Returns STATUS_USAGE where coordinates are beyond
 * float32 and the file has nothing larger. */
int surface_files_count_coarse(const options *o, const surface_source *source, const result_mesh *mesh,
                               surface_report *s);

/* The notice that STL, which holds float32 alone, has coordinates that count from the mesh's origin; is_own: from that
 * of each block. */
void surface_files_tell_relative(const double *origin, int is_own);

/* Notices: which point the file's coordinates count from, where it is not the input's own; where its numbers are coarse
 * (precision.h). */
void surface_files_tell_precision(const options *o, int block_count, const surface_report *s);

/* The notice that programs find faults in an STL file with triangles of zero area. */
void surface_files_tell_joined(const options *o, const surface_report *s);

/* Writes a mesh to the file of the isovalue, or with --blocks separate of the isovalue and the block. The file says in
 * which space and units the input's coordinates are, and waits in the group. */
int surface_files_write(const options *o, const dataset *d, const typed_isovalue *iso, int block,
                        const result_mesh *mesh, const carried_fields *fields, output_group *group);

/* The file of a surface whose pieces come one after the other (mesh_file). It waits in the group when it is closed. */
typedef struct piece_file {
    mesh_file *file;
    part_file *part; /* instead: of --part */
    mesh_write_options how;
    char *path;
} piece_file;

/* suits_world: of blocks_suit_world. whole: as for mesh_file_open. part: NULL, or what the file of --part begins with.
 * shared: NULL, or the file that a team writes, which does not wait in the group. *file is to be closed. Returns 0 or a
 * status. */
int surface_files_open_pieces(const options *o, const dataset *d, int suits_world, const typed_isovalue *iso,
                              const tc_mesh_data *whole, const part_header *part, const output_shared *shared,
                              const carried_fields *fields, output_group *group, piece_file **file);

/* The next piece, whose first vertex and triangle have these numbers in the file; fields of its vertices. */
int surface_files_add_piece(piece_file *file, uint64_t first_vertex, uint64_t first_triangle, const tc_mesh_data *piece,
                            const carried_fields *fields);

/* Closes the file; after a failure, status, it is removed. Accepts NULL. Returns 0 or a status. */
int surface_files_close_pieces(piece_file *file, int status);

/* Names the pattern's files of the isovalue: of --blocks separate one for each block. Returns 0 or STATUS_FAILED.
 * *names is to be released in any case. */
int surface_files_name(const options *o, const char *pattern, const typed_isovalue *iso, int block_count,
                       file_names *names);

#endif
