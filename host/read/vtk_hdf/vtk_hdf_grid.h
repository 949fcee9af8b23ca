/* vtk_hdf_grid.h - an unstructured grid of VTKHDF, as far as it is read */
#ifndef VTK_HDF_GRID_H
#define VTK_HDF_GRID_H

#include "dataset/request.h"
#include "vtk_hdf/vtk_hdf_array.h"

#define ROOT "/VTKHDF/"

enum { NAME_BYTES = 256 };

/* What of the arrays belongs to the step that is read. */
typedef struct hdf_step {
    int64_t number, count;       /* of how many; count 0: the file has none */
    hdf_rows parts;              /* in the arrays that count */
    int64_t points, cells, ends; /* where it begins in those of points and cells, */
    int64_t corners;             /* and in Connectivity */
} hdf_step;

typedef struct hdf_grid {
    hdf_reader *r;
    const read_request *request;
    dataset parts; /* a block each */
    hdf_step step;
    const int64_t *point_counts, *cell_counts, *corner_counts; /* of each part */
    int64_t part_count, point_count, cell_count, corner_count; /* and in all */
} hdf_grid;

/* Adds the fields at points, or on cells, to the blocks of all parts, which have their counts; and what is blanked. */
int hdf_load_fields(hdf_grid *g, int on_cells);

#endif
