/* cell_sizes.h - where the cells of a block lie, and how large they are along x, y and z */
#ifndef CELL_SIZES_H
#define CELL_SIZES_H

#include "blocks.h"

typedef struct cell_range {
    double low[3], high[3]; /* the box of the cells; low above high where there is none */
    double least[3];        /* least size of a cell along each axis that is not 0; infinite where all are */
} cell_range;

/* Of all cells, or where `all` is 0 of some thousands taken evenly. */
void cell_range_find(const prepared_block *b, int all, cell_range *out);

/* For every point the largest size along each axis of the cells that have it: 3 numbers each, 0 of a point without
 * cells. From malloc; NULL, with STATUS_FAILED's text set, where memory runs out. */
float *cell_sizes(const prepared_block *b);

#endif
