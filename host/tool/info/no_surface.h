/* no_surface.h - why extract can make no surface of an input, whatever the isovalue: for info, which advises then on
 * none
 */
#ifndef NO_SURFACE_H
#define NO_SURFACE_H

#include "dataset.h"
#include "command_line/options.h"
#include "select.h"

enum { NO_SURFACE_BYTES = 1024 };

/* Writes the reason, or "". The field may be NULL, where it is not chosen yet: then only the grid is looked at.
 * Unstructured blocks are cut into tetrahedra, as extract does, with its notices. 0, or a status with its text. */
int no_surface_reason(const options *o, const dataset *d, const scalar *field, char reason[NO_SURFACE_BYTES]);

#endif
