/*
 * label_cells.h - label maps whose labels belong to cells: their centres are the samples
 */
#ifndef LABEL_CELLS_H
#define LABEL_CELLS_H

#include "dataset/dataset.h"
#include "dataset/request.h"

/* Where the request chooses a field of cells, the dataset's block, which is structured, becomes the grid of its cells'
 * centres, with the cells' fields as those of its points: an average of labels would be none. Returns 0 or a status. */
int label_cells_take(const read_request *request, dataset *d);

#endif
