/*
 * slices.h - volumes in files of one or more slices each: a folder, or names with a number in them
 *
 * A folder stands for its TIFF files, in the order of their names, where numbers count as numbers: s2.tif before
 * s10.tif. In a name like slices/%04d.tif the number has at least so many digits; all files of such names are taken, by
 * their numbers, of which none may be left out.
 */
#ifndef SLICES_H
#define SLICES_H

#include <stddef.h>
#include <stdint.h>

typedef struct slice_list {
    char **paths; /* from malloc */
    size_t count, capacity;
} slice_list;

/* Whether the name is that of a folder, or has such a number in it and is itself the name of no file. */
int slices_are_named(const char *path);

/* Lists the files. 0, or a status with its message: none, a number is left out, or the folder cannot be read. To be
 * released in any case. */
int slices_list(const char *path, slice_list *list);

/* Whether the files' names differ in one number, whose steps are not all alike, as where a slice is lost: gap[0] and
 * gap[1] are the numbers on either side of the first longer step. */
int slices_have_gap(const slice_list *list, int64_t gap[2]);
void slices_release(slice_list *list);

#endif
