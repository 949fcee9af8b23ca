/*
 * coordinates.h - coordinates of rectilinear and curvilinear grids: moved to their origin (origin.h), checked, and
 * which way round the grid is
 *
 * Winding has one sign per grid: that of the Jacobian's integral over its cubes. Over one cube that is the flux of
 * position / 3 through its six faces, a face's being the mean of its two triangulations'. Where two cubes that both
 * count meet, their faces cancel, so only faces with one such cube are visited. Cubes that are left out, being blanked
 * or having a missing corner, do not count (where samples are in a cl_mem: a blanked corner, or one that is nowhere).
 * The sum is made in double, in one order. Where it is 0 the grid counts as not mirrored. Of a rectilinear grid the
 * sign is that of the product of its axes' directions, from the first position to the last.
 */
#ifndef COORDINATES_H
#define COORDINATES_H

#include "grid/grid.h"

#include <math.h>

/* Whether a coordinate is finite, and so are its differences from others. */
static inline bool coordinate_usable(float value) { return fabsf(value) < 0x1p127f; }

/* Sets the origin that fits the grid, of which given_axes or given_points, dims and what is missing are looked at. */
void coordinates_origin(tc_grid *grid);

/* Sets the grid's origin (NULL: the one that fits it), its axes or points relative to that, and whether it is mirrored.
 * TC_ERROR_DATA for coordinates of a present sample that are not finite, or so large that their difference may not be:
 * 2^127 and beyond. Everything but the device is described already. */
tc_status coordinates_take(tc_grid *grid, const double *origin);

#endif
