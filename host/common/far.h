/*
 * far.h - when a grid lies too far from the point that its coordinates count from
 *
 * Along an axis it does where it is farther away than 512 times its smallest cell, so that float32 leaves less than 15
 * bits within a cell, and than 8 times its own size, so that moving it gains at least 3 bits. The library decides by
 * this on the origin of a grid, the tool on an origin that several blocks share.
 */
#ifndef FAR_H
#define FAR_H

#include <math.h>

static const double far_cells = 512, far_sizes = 8;

/* The largest distance of low and high from the point. */
static inline double far_reach(double low, double high, double point) {
    return fmax(fabs(low - point), fabs(high - point));
}

/* Never of a grid without size. cell: the smallest one's size. */
static inline int lies_far(double low, double high, double cell, double point) {
    const double size = high - low, reach = far_reach(low, high, point);
    return size > 0 && reach > far_sizes * size && reach > far_cells * cell;
}

#endif
