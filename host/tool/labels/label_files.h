/*
 * label_files.h - the files of labels: one of all surfaces, or with --separate one of each label, named by it; and
 * their picture (--preview)
 */
#ifndef LABEL_FILES_H
#define LABEL_FILES_H

#include "command_line/options.h"
#include "dataset/dataset.h"
#include "mesh_labels.h"
#include "output_group.h"

/* STATUS_USAGE where -o, --preview and the other options do not fit together, or would overwrite an input;
 * STATUS_FAILED where a file cannot be written. d is NULL before the input is read. */
int label_files_check(const options *o, const dataset *d);

/* The file of all labels, or with --separate of this one, which stands for % in the name, or goes with _ before its
 * ending; from malloc, NULL with its failure's text without memory. */
char *label_file_name(const options *o, uint32_t label);

/* Writes the mesh to path; it waits in the group. suits_world, here and below: of blocks_suit_world. */
int label_file_write(const options *o, const dataset *d, int suits_world, const char *path, const tc_mesh_data *mesh,
                     output_group *group);

/* The file of the picture, from malloc as that above. */
char *label_preview_name(const options *o);

/* Notices of what the file's format cannot hold. */
void label_files_tell(const options *o, int suits_world, const tc_mesh_data *mesh);

#endif
