/* gunzip.h - a file that is packed by gzip as a whole, whatever its format: unpacked into memory */
#ifndef GUNZIP_H
#define GUNZIP_H

#include "file/mapping.h"

/* Whether the file begins as gzip's do. */
int gunzip_begins(const mapping *file);

/* Unpacks a mapped file: until mapping_restore, its name stands for what is in it, and the caller has to map it again.
 * 0, or a status with its message: damaged, or no memory. */
int gunzip(const char *path, const mapping *packed);

#endif
