/* cell_faces.h - the faces of polyhedra, of which files have a stream of numbers per cell, or lists */
#ifndef CELL_FACES_H
#define CELL_FACES_H

#include "dataset/dataset.h"

enum { CELL_POLYHEDRON = 42 };

/* Fills the block's cell_faces, face_offsets and face_points from streams of numbers, one per polyhedron: the count of
 * its faces, then, face by face, the count of its points and these points. ends[c] is where the stream of cell c ends.
 * of_all: every cell has a stream, which begins where that of the cell before it ends; else polyhedra alone have one,
 * which begins where that of the polyhedron before it ends. The first begins at 0. Needs the block's counts and types;
 * path is for messages. STATUS_INPUT where a cell's numbers are not exactly such a stream, or name a point that does
 * not exist. */
int cell_faces_take(dataset *d, dataset_block *b, const char *path, const int64_t *stream, uint64_t length,
                    const int64_t *ends, int of_all);

/* Faces that are listed once, and named by all cells that they bound. Each part begins where the one before it ends. */
typedef struct face_lists {
    const int64_t *cell_ends; /* of each cell: where its part of `faces` ends */
    const int64_t *faces;     /* indices of faces, below face_count */
    const int64_t *face_ends; /* of each face: where its part of `points` ends */
    const int64_t *points;
    int64_t face_count;
} face_lists;

/* Fills the same from such lists. Each has to be as long as the others ask for. STATUS_INPUT where ends fall, a face or
 * point does not exist, or the faces of all cells have more than 16 times the points of the faces. */
int cell_faces_gather(dataset *d, dataset_block *b, const char *path, const face_lists *lists);

#endif
