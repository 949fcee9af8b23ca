/* output_target.h - where an output goes; for output.c */
#ifndef OUTPUT_TARGET_H
#define OUTPUT_TARGET_H

#include "output.h"

/* Opens what o->path names, which may be replaced by another text from malloc; fills fd, and temporary and lock where
 * there is a file to be renamed. Returns 0 or an errno; the rest of *o is to be released in any case. */
int output_target_open(output *o);

/* What opening the file would fail with, as far as that can be seen: an errno, 0 for nothing. *path, from malloc, may
 * be replaced. */
int output_target_obstacle(char **path);

#endif
