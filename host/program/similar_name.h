/* similar_name.h - the name that a mistyped one was probably meant to be */
#ifndef SIMILAR_NAME_H
#define SIMILAR_NAME_H

#include <stddef.h>

/* The name among `count` names that takes the fewest edits to make of the typed one, or NULL where none is close enough
 * to be worth a suggestion. NULLs among the names are passed over. */
const char *similar_name(const char *typed, const char *const *names, size_t count);

#endif
