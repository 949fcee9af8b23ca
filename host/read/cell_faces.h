/* cell_faces.h - the faces of polyhedra, of which files have a stream of numbers per cell, or lists */
#ifndef CELL_FACES_H
#define CELL_FACES_H

#include "dataset.h"

enum { CELL_POLYHEDRON = 42 };

/* Fills the block's cell_faces, face_offsets and face_points from a stream: of each polyhedron the number of its faces,
 * then of each face the number of its points and these. ends[c] is where that of cell c ends; it begins where that of
 * the cell before it ends, or, where of_all is 0 and other cells have none, that of the last polyhedron, at first 0.
 * Needs the block's counts and types. path is for messages. STATUS_INPUT where the numbers of a cell are no such
 * stream, to the last, or a point is not there. */
int cell_faces_take(dataset *d, dataset_block *b, const char *path, const int64_t *stream, uint64_t length,
                    const int64_t *ends, int of_all);

/* Faces that stand once for all cells that they bound. */
typedef struct face_lists {
    const int64_t
        *cell_ends;       /* per cell: where its part of `faces` ends; it begins where that of the cell before does */
    const int64_t *faces; /* numbers of faces, below face_count */
    const int64_t *face_ends; /* per face: where its points end */
    const int64_t *points;
    int64_t face_count;
} face_lists;

/* Fills the same from such lists, each as long as the others ask for, and each checked: STATUS_INPUT for ends that do
 * not rise, faces and points that are not there, and more points in the cells than 16 times those of the faces. */
int cell_faces_gather(dataset *d, dataset_block *b, const char *path, const face_lists *lists);

#endif
