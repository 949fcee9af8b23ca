/* vtk_legacy_values.h - values of VTK legacy files, and their conversion */
#ifndef VTK_LEGACY_VALUES_H
#define VTK_LEGACY_VALUES_H

#include "vtk_legacy/vtk_legacy_text.h"

/* Decodes `count` values of a stored type that is no text into native ones (bits: TC_U8), `what` naming them. Bytes of
 * a binary file must be there; packed bits begin at a byte. */
int legacy_decode(legacy *r, const char *what, int type, uint64_t count, uint8_t *to);

/* Converts native values of a stored type to the wanted type, as legacy_array says. Returns how many are unfit. */
uint64_t legacy_convert(int type, const uint8_t *from, uint64_t count, int wanted, void *to);

/* Skips a number of text, or a word that is none. */
int legacy_skip_number(legacy *r, const char *what);

#endif
