/* no_surface.h - why extract could make no surface of an input, whatever the isovalue; info then suggests no isovalue
 */
#ifndef NO_SURFACE_H
#define NO_SURFACE_H

#include "command_line/options.h"
#include "dataset/dataset.h"
#include "field/select.h"

enum { NO_SURFACE_BYTES = 1024 };

/* Writes the reason, or "". The field is NULL where none is chosen: then only the grid is looked at. Unstructured
 * blocks are cut into tetrahedra, as extract does, with its notices. Returns 0, or a status with its text. */
int no_surface_reason(const options *o, const dataset *d, const scalar *field, char reason[NO_SURFACE_BYTES]);

#endif
