/* file_text.c - text of a header that grows as it is made; see file_text.h */
#include "file_text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Room for `more` bytes and the zero behind them. */
static char *reserve_memory(file_text *t, size_t more) {
    char *bytes = t->has_failed ? NULL : realloc(t->bytes, t->length + more + 1);
    t->has_failed = bytes == NULL;
    if (bytes) t->bytes = bytes;
    return bytes ? bytes + t->length : NULL;
}

void text_add(file_text *t, const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    char *to = length >= 0 ? reserve_memory(t, (size_t)length) : NULL;
    if (to) {
        vsnprintf(to, (size_t)length + 1, format, again);
        t->length += (size_t)length;
    }
    va_end(arguments);
    va_end(again);
}

void text_fill(file_text *t, char c, size_t count) {
    char *to = reserve_memory(t, count);
    if (!to) return;
    memset(to, c, count);
    to[count] = 0;
    t->length += count;
}

void text_release(file_text *t) {
    free(t->bytes);
    *t = (file_text){0};
}
