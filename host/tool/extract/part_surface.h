/* part_surface.h - what all parts of a surface have in common: how it is made, and of what */
#ifndef PART_SURFACE_H
#define PART_SURFACE_H

#include "carried_fields.h"

#include <jansson.h>

/* The object "surface" of part_header.h; suits_world: of blocks_suit_world; NULL, with the message of a status, where
 * it cannot be made.
 *
 * The volume is told by the sizes of its files and by hashes: of where the grid lies, and of samples from all over it,
 * so that no part need read all of a volume. */
json_t *part_surface_make(const options *o, const dataset *d, const scalar *field, const carried_fields *carried,
                          const tc_grid_options *grid, const tc_extract_options *how, const void *samples,
                          const uint8_t *blanked_samples, int suits_world);

#endif
