/* used_points.h - the points of a block that a surface can depend on: corners of cells of three dimensions */
#ifndef USED_POINTS_H
#define USED_POINTS_H

#include "dataset.h"

enum point_use { POINTS_NONE_USED, POINTS_SOME_USED, POINTS_ALL_USED };

/* Sets used[n], which is zero, to 1 where a cell of three dimensions that is not blanked has the point as a corner.
 * blanked_cells may be NULL. Structured blocks without such cells are not gone through: used may stay as it is where
 * all points are. */
enum point_use used_points_mark(const dataset_block *b, const uint8_t *blanked_cells, uint8_t *used);

#endif
