/* piece_boxes.h - which cells of a structured grid are whose */
#ifndef VTK_PARALLEL_PIECE_BOXES_H
#define VTK_PARALLEL_PIECE_BOXES_H

#include "vtk_parallel/pieces.h"

/* Indices of cells, from low to before high. */
typedef struct cell_box {
    int64_t low[3], high[3];
} cell_box;

/* Fills the box of each piece: the cells of its extent that are no ghost cells. STATUS_INPUT unless they fill the whole
 * extent, each cell once; where the whole is flat along an axis, it counts as one cell deep. */
int piece_boxes_find(const piece_list *list, cell_box *boxes);

/* Its cells; UINT64_MAX where they are more than can be counted. */
uint64_t box_volume(const cell_box *box);

#endif
