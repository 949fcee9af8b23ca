/* value_names.c - names of values that are words; see value_names.h */
#include "value_names.h"

#include <stdio.h>
#include <string.h>

enum { NAME_KEPT = 100 };

static int is_taken(const char *name, const char *const *own, const value_name *names, size_t count) {
    for (; *own; own++)
        if (strcmp(name, *own) == 0) return 1;
    for (size_t i = 0; i < count; i++)
        if (strcmp(name, names[i]) == 0) return 1;
    return 0;
}

void value_name_make(const char *name, const char *behind, const char *const *own, value_name *names, size_t count) {
    char *to = names[count];
    size_t length = 0;
    for (const char *c = name; *c && length < NAME_KEPT; c++) {
        int is_word = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9');
        to[length++] = (char)(is_word ? *c : '_');
    }
    to[length] = '\0';
    if (!length) length = (size_t)snprintf(to, VALUE_NAME_BYTES, "field");
    length += (size_t)snprintf(to + length, VALUE_NAME_BYTES - length, "%s", behind);
    while (is_taken(to, own, names, count) && length < VALUE_NAME_BYTES - 1) {
        to[length++] = '_';
        to[length] = 0;
    }
}
