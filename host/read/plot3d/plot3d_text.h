/* plot3d_text.h - Plot3D files of text */
#ifndef PLOT3D_TEXT_H
#define PLOT3D_TEXT_H

#include "file/mapping.h"

#include <stdint.h>

/* Whether the file begins as text; binary ones begin with integers, which hold zero bytes. */
int plot3d_is_text(const mapping *mapped);

/* All numbers of a text, "3*0.5" being three; freed by the caller. STATUS_INPUT where a word is no number, or repeats
 * make more numbers than such a text may have. */
int plot3d_numbers(const char *path, const mapping *mapped, double **numbers, uint64_t *count);

#endif
