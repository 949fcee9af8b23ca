/* part_file.h - the file of a part, written piece by piece as a stream makes them */
#ifndef PART_FILE_H
#define PART_FILE_H

#include "output_group.h"
#include "part_header.h"
#include "vertex_values.h"

typedef struct part_file part_file;

/* Opens it for so many vertices and triangles as the header says; the file waits in the group when it is closed. *file
 * is to be closed or discarded; NULL after a failure. path outlives it, the header need not. */
int part_file_open(const char *path, const part_header *header, output_group *group, part_file **file);

/* The next piece, whose first vertex and triangle have these numbers in the part; fields of its vertices. */
int part_file_add(part_file *file, uint64_t first_vertex, uint64_t first_triangle, const tc_mesh_data *piece,
                  const vertex_array *fields);

/* Both accept NULL, and free the part_file. */
int part_file_close(part_file *file);
void part_file_discard(part_file *file);

#endif
