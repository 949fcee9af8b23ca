/* nearest.h - the name that a mistyped one was probably meant to be */
#ifndef NEAREST_H
#define NEAREST_H

#include <stddef.h>

/* Edits between two names: insertions, deletions, replacements and swaps of neighbours, each 1. */
int nearest_distance(const char *a, const char *b);

/* The name of least distance among count names, or NULL where none is close enough to be worth a suggestion. NULLs
 * among the names are passed over. */
const char *nearest_name(const char *typed, const char *const *names, size_t count);

#endif
