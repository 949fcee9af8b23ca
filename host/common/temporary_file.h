/*
 * temporary_file.h - files without a name, for arrays that are larger than memory
 *
 * They are in the folder that TMPDIR names, else in /var/tmp, which is on a disk (/tmp may be in memory). They are gone
 * when the last descriptor or mapping of them is.
 */
#ifndef TEMPORARY_FILE_H
#define TEMPORARY_FILE_H

#include <stdint.h>

/* Whether so many bytes are more than the process should take of its memory. */
int temporary_file_is_better(uint64_t bytes);

/* A file of that size, 0 for one that grows, with room on the disk for all of it. -1, with its message, where there is
 * none. */
int temporary_file(uint64_t bytes);

#endif
