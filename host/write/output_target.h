/* output_target.h - where an output goes; for output.c */
#ifndef OUTPUT_TARGET_H
#define OUTPUT_TARGET_H

#include "output.h"

/* Opens what o->path names; o->path may become another string from malloc. Fills fd and, where a file is to be renamed,
 * temporary and lock. Returns 0 or an errno; *o is to be released in any case. */
int output_target_open(output *o);

/* The errno that opening the file would fail with, as far as that can be told; 0: none. *path, from malloc, may become
 * another string from malloc. */
int output_target_obstacle(char **path);

#endif
