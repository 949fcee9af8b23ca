/* mapping.h - whole files mapped into memory, read-only */
#ifndef MAPPING_H
#define MAPPING_H

#include <stddef.h>

typedef struct mapping {
    const unsigned char *bytes; /* page-aligned; NULL for an empty file */
    size_t size;
} mapping;

/* Maps a regular file. 0 or STATUS_INPUT with text, *m zeroed. */
int mapping_open(const char *path, mapping *m);

/* Accepts a zeroed mapping; zeroes it. */
void mapping_close(mapping *m);

#endif
