/* header_text.h - the lines and values of text headers, read from bytes that nobody has checked yet */
#ifndef HEADER_TEXT_H
#define HEADER_TEXT_H

#include <stddef.h>
#include <stdint.h>

enum { HEADER_LINE_BYTES = 16384, HEADER_LINES = 1000000 };

typedef struct header_text {
    const char *path;
    const unsigned char *bytes;
    size_t size;
    size_t position; /* of the next line */
    int64_t line;    /* lines read so far */
} header_text;

/* Copies the next line, without its end and the white space around it, to line[HEADER_LINE_BYTES]. *more is 0 at the
 * end of the text; control characters become '?'. STATUS_INPUT where a line is too long, holds a zero byte, or there
 * are too many. */
int header_line(header_text *text, char *line, int *more);

/* Parse words separated by white space. The number of values, or -1: a word is no such value, or more than max. */
int parse_integers(const char *text, int64_t *values, int max);
int parse_numbers(const char *text, double *values, int max);

/* Cuts white space from both ends, in place. */
char *trim(char *text);

/* Whether a list of names, "|float|double|", has the word, in any case. */
int names_have(const char *names, const char *word);

/* The next word of *text, zero-ended; *text moves behind it. NULL where there is none. */
char *next_word(char **text);

#endif
