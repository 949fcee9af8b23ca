/*
 * file_text.h - text of a header that grows as it is made
 *
 * Errors are sticky, as those of an output: after the first one has_failed is set, and nothing is added any more.
 */
#ifndef FILE_TEXT_H
#define FILE_TEXT_H

#include <stddef.h>

typedef struct file_text {
    char *bytes; /* zero-ended; NULL where empty or out of memory */
    size_t length;
    int has_failed;
} file_text;

void text_add(file_text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Adds `count` copies of a character. */
void text_fill(file_text *t, char c, size_t count);

/* Frees and zeroes. */
void text_release(file_text *t);

#endif
