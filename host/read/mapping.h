/* mapping.h - whole files, or standard input, mapped into memory, read-only */
#ifndef MAPPING_H
#define MAPPING_H

#include "file_list.h"

#include <stddef.h>

typedef struct mapping {
    const unsigned char *bytes; /* page-aligned; NULL for an empty file */
    size_t size;
    file_identity identity;
} mapping;

/* Maps a regular file, or what comes but once: "-", all of standard input, or a pipe by its name. That is read into
 * memory and can be mapped as often as one likes. 0 or a status with text, *m zeroed. */
int mapping_open(const char *path, mapping *m);

/* Whether path stands for standard input: "-", "/dev/stdin". */
int mapping_is_standard_input(const char *path);

/* Whether path is standard input, another open file by its number, or a pipe: it has no ending that tells the format,
 * and no other files lie beside it. */
int mapping_is_stream(const char *path);

/* Accepts a zeroed mapping; zeroes it. */
void mapping_close(mapping *m);

#endif
