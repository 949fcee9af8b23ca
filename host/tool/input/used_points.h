/* used_points.h - the points of a block that a surface can depend on: corners of cells of three dimensions */
#ifndef USED_POINTS_H
#define USED_POINTS_H

#include "dataset/dataset.h"

enum point_use { POINTS_NONE_USED, POINTS_SOME_USED, POINTS_ALL_USED };

/* Sets used[n], zero so far, to 1 where a cell of three dimensions that is not blanked has the point as a corner.
 * blanked_cells may be NULL. Where all points of a structured block are used, or none, `used` may stay as it is. */
enum point_use used_points_mark(const dataset_block *b, const uint8_t *blanked_cells, uint8_t *used);

/* How many of a mask's points or cells are set; 0 where there is no mask. */
uint64_t count_set(const uint8_t *mask, int64_t count);

#endif
