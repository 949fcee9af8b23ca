/*
 * output_group.h - outputs that appear under their names together, once all of them are complete
 *
 * An output that is complete waits under its temporary name, and is locked, so that no other process takes it for one
 * that was left. If a later output fails, none of the group appears. What is no regular file is written directly, and
 * does not wait.
 */
#ifndef OUTPUT_GROUP_H
#define OUTPUT_GROUP_H

#include "output.h"

typedef struct output_group {
    output *waiting; /* from malloc */
    size_t count, capacity;
} output_group;

/* In place of output_close: the output is complete and waits in the group. Returns 0 or a status with its text; the
 * output is then removed. */
int output_wait(output *o, output_group *group);

/* Puts all files under their names and empties the group. Where one cannot be put there, it and those behind it are
 * removed. Returns 0 or a status with its text. */
int output_group_publish(output_group *group);

/* Removes what waits, and frees. */
void output_group_discard(output_group *group);

#endif
