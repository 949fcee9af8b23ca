/* obstacle.h - why extract can make no surface of an input, whatever the isovalue: for info, which advises then on none
 */
#ifndef OBSTACLE_H
#define OBSTACLE_H

#include "dataset.h"
#include "options.h"
#include "select.h"

enum { OBSTACLE_BYTES = 1024 };

/* Writes the reason, or "". The field may be NULL, where it is not chosen yet: then only the grid is looked at.
 * Unstructured blocks are cut into tetrahedra, as extract does, with its notices. 0, or a status with its text. */
int obstacle_find(const options *o, const dataset *d, const scalar *field, char reason[OBSTACLE_BYTES]);

#endif
