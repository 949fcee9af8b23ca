/*
 * far.h - whether a grid lies so far from a point that float32 is too coarse for coordinates relative to this point
 *
 * Along an axis it does where its distance from the point exceeds both
 *   - 512 times its smallest cell: float32 leaves less than 15 bits within a cell;
 *   - 8 times its own size: a point close to the grid gains at least 3 bits.
 * The library decides by this on the origin of a grid, the tool on an origin that several blocks share.
 */
#ifndef FAR_H
#define FAR_H

#include <math.h>

static const double far_cells = 512, far_sizes = 8;

/* The distance of the point from low or high, whichever is farther away. */
static inline double far_reach(double low, double high, double point) {
    return fmax(fabs(low - point), fabs(high - point));
}

/* Along one axis, from low to high; cell: the size of the smallest cell. Never so for a grid without extent. */
static inline int lies_far(double low, double high, double cell, double point) {
    const double size = high - low, reach = far_reach(low, high, point);
    return size > 0 && reach > far_sizes * size && reach > far_cells * cell;
}

#endif
