/* value_names.h - names of values in files whose names are words: letters, digits and '_', each once */
#ifndef VALUE_NAMES_H
#define VALUE_NAMES_H

#include <stddef.h>

enum { VALUE_NAME_BYTES = 128 };

typedef char value_name[VALUE_NAME_BYTES];

/* Makes names[count] of a name of any bytes and what is put behind it: other characters become '_', and '_' is appended
 * to what is one of `own`, the names that the format has itself (NULL after the last), or of the names before. */
void value_name_make(const char *name, const char *behind, const char *const *own, value_name *names, size_t count);

#endif
