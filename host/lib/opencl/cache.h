/*
 * cache.h - a folder of files that save work and may vanish at any time
 *
 * It is TETRACUBES_CACHE_DIR, else XDG_CACHE_HOME/tetracubes, else HOME/.cache/tetracubes, of the environment; none
 * where TETRACUBES_CACHE_DIR is empty. A file appears whole or not at all: it is written beside and renamed, so that
 * processes may share the folder. A file that cannot be read or written is treated as missing.
 *
 * Files are handed to drivers as machine code. So folder and file have to be this user's or root's, and nobody else may
 * be able to write to them; others are neither read nor replaced.
 */
#ifndef CACHE_H
#define CACHE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct cache_text {
    char *bytes; /* from malloc, with a zero behind the last */
    size_t count;
} cache_text;

/* The whole of a regular file; false, and nothing to free, where there is none or it may not or cannot be read. */
bool cache_read(const char *name, cache_text *out);

/* Replaces the file; makes the folder where it is missing. False where it cannot be written. */
bool cache_write(const char *name, const void *bytes, size_t count);

/* The name of the file with its folder; false where there is no folder. */
bool cache_path(const char *name, char *path, size_t bytes);

/* True where a cache folder is configured, whether it exists yet or not. */
bool cache_is_on(void);

#endif
