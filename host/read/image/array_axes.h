/*
 * array_axes.h - arrays of numpy, and of HDF5 as Python programs write them: what their axes are
 *
 * An array is indexed [z, y, x], whatever its order in memory: its last axis is x. A fourth axis is one of components
 * where it is the last one and has at most four, else one of frames, in front; with five axes there are both.
 */
#ifndef ARRAY_AXES_H
#define ARRAY_AXES_H

#include "dataset/layout.h"

enum { ARRAY_AXES_MOST = 5 };

/* Lists the axes as they lie in memory, fastest first: the last one, or in Fortran's order the first. */
void array_axes_list(const int64_t *shape, int count, int is_fortran, axes *stored);

/* After layout_make: in Fortran's order the axes of space lie as z, y, x. */
void array_axes_turn(const int64_t *shape, int count, layout *l);

#endif
