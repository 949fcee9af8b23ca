/* mapping.h - whole files, or standard input, mapped into memory, read-only */
#ifndef MAPPING_H
#define MAPPING_H

#include "file/file_list.h"

#include <stddef.h>

typedef struct mapping {
    const unsigned char *bytes; /* page-aligned; NULL for an empty file */
    size_t size;
    file_identity identity;
} mapping;

/* Maps a regular file, or what can be read only once: a pipe by its name, or standard input, "-". This is read to its
 * end into memory, and can then be mapped any number of times. 0, or a status with its message and *m zeroed. */
int mapping_open(const char *path, mapping *m);

/* Whether path stands for standard input: "-", "/dev/stdin". */
int mapping_is_standard_input(const char *path);

/* Whether path is standard input, another open file by its descriptor, or a pipe: then its ending tells no format, and
 * no other file lies beside it. */
int mapping_is_stream(const char *path);

/* From now on path, a file that can be opened, stands for another one: an open descriptor, taken over. 0, or a status
 * with its message, and the descriptor is closed. mapping_restore ends that, but for standard input and pipes, whose
 * bytes came only once. */
int mapping_replace(const char *path, int instead);
void mapping_restore(const char *path);

/* Whether another one stands for it. */
int mapping_is_replaced(const char *path);

/* Unmaps and zeroes. Accepts a zeroed mapping. */
void mapping_close(mapping *m);

#endif
