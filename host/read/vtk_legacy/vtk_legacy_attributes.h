/* vtk_legacy_attributes.h - fields, and what is hidden, of VTK legacy files */
#ifndef VTK_LEGACY_ATTRIBUTES_H
#define VTK_LEGACY_ATTRIBUTES_H

#include "vtk_legacy/vtk_legacy_text.h"

/* The attribute that the keyword begins; *known is 0 where it begins none. */
int legacy_attribute(legacy *r, const char *keyword, int *known);

/* Marks what an array of VTK's ghost flags, or of BLANKING, hides: where (flags & mask) != 0. */
int legacy_blank(legacy *r, int on_cells, const uint8_t *flags, int64_t count, unsigned mask);

#endif
