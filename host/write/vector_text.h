/* vector_text.h - vectors as lines of text, for formats that are text */
#ifndef VECTOR_TEXT_H
#define VECTOR_TEXT_H

#include "formats.h"

/* A line for every vertex of the file: `before`, then three numbers that read back as the same floats. */
void write_vectors(output *o, const shown_mesh *s, const char *before, const float *vectors);

/* The same of coordinates: as doubles where the mesh lies far from zero. */
void write_positions(output *o, const shown_mesh *s, const char *before);

#endif
