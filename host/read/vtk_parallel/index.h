/*
 * index.h - what a parallel VTK XML file says: the whole grid, and the files that hold its pieces or blocks
 *
 * The parts of the reader:
 *
 *     index.c           the XML, through expat
 *     vtk_parallel.c    the files that it names, opened and read; blocks
 *     grid_pieces.c     pieces of a structured grid, put where they belong in one
 *     piece_boxes.c     which cells are whose there
 *     cell_pieces.c     pieces of an unstructured grid, joined to one
 *     shared_points.c   the points that these have in common
 *
 * Source: "VTK XML Formats", parallel file formats, in VTK's file format documentation (docs.vtk.org), and what VTK 9
 * writes and reads.
 */
#ifndef VTK_PARALLEL_INDEX_H
#define VTK_PARALLEL_INDEX_H

#include "dataset/data_names.h"
#include "dataset/dataset.h"

/* Points along each axis: from first on, so many. */
typedef struct index_extent {
    int64_t first[3], dims[3];
} index_extent;

typedef struct vtk_index {
    const char *path;
    int is_list;          /* of blocks; else of pieces of one grid, */
    enum block_kind kind; /* of this kind */
    int64_t ghost_levels;
    index_extent whole; /* structured grids */
    double origin[3], spacing[3], direction[9];
    int has_world; /* whether Origin, Spacing or Direction stand there */

    data_names files;
    index_extent *extents; /* structured grids: of each file's piece */
} vtk_index;

/* Fills *index from a mapped file; to be released, also after a failure. */
int vtk_index_parse(const char *path, const mapping *file, vtk_index *index);

/* Frees and zeroes. */
void vtk_index_release(vtk_index *index);

#endif
