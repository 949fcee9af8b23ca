/* cell_sizes.h - where the cells of a block lie, and how thin they are */
#ifndef CELL_SIZES_H
#define CELL_SIZES_H

#include "blocks.h"

typedef struct cell_range {
    double low[3], high[3]; /* the box of the cells; low above high where there is none */
    double least[3];        /* least size of a cell along each axis that is not 0; infinite where all are */
    double thickness;       /* least distance of two opposite sides, or of a corner and its opposite side, that is not
                               0; infinite where all are */
} cell_range;

/* Looks at all cells, or, where `all` is 0, at some thousands spread evenly. */
void cell_range_find(const prepared_block *b, int all, cell_range *out);

/* Whether float32 coordinates of all cells may count from 0, 0, 0: the thinnest cell that is looked at measures 1,024
 * of their steps at the least. Of a region of a grid (--roi) all of the grid is looked at, so that regions agree. */
int blocks_suit_world(const block_list *list);

/* Where coordinates count from, and how many binary digits they have: 24 or 53. */
typedef struct coordinate_numbers {
    double zero[3];
    int digits;
} coordinate_numbers;

/* The distance from such a number to the next. */
double step_at(double value, int digits);

/* For every point: how many steps of its coordinates its thickest cell measures in that cell's thinnest direction; 0
 * where that is not known. From malloc; NULL, with STATUS_FAILED's text set, where memory runs out. */
float *cell_steps(const prepared_block *b, const coordinate_numbers *numbers);

#endif
