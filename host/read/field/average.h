/* average.h - values of cells averaged to points */
#ifndef AVERAGE_H
#define AVERAGE_H

#include "dataset/dataset.h"

/*
 * Every point gets the mean of the present cells around it, summed in double in the order of cells: f64 for u32, i32
 * and f64, else f32. A cell is present where it is three-dimensional, neither it nor one of its points is blanked, and
 * all its values are finite. A point without one becomes NaN. 0 or STATUS_FAILED; the values are the dataset's.
 */
int average_to_points(dataset *d, const dataset_block *b, const uint8_t *blanked_cells, const dataset_field *of_cells,
                      dataset_field *out);

#endif
