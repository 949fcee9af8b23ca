/* header_text.c - the lines and values of text headers; see header_text.h */
#include "file/header_text.h"

#include "exit_status.h"
#include "failure.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int header_line(header_text *text, char *line, int *more) {
    *more = 0;
    line[0] = 0;
    if (text->position >= text->size) return 0;
    if (text->line >= HEADER_LINES)
        return fail(STATUS_INPUT, "%s: its header has more than %d lines; this is no header", text->path, HEADER_LINES);
    text->line++;

    const unsigned char *start = text->bytes + text->position;
    size_t rest = text->size - text->position;
    size_t limit = rest < HEADER_LINE_BYTES ? rest : HEADER_LINE_BYTES;
    const unsigned char *end = memchr(start, '\n', limit);
    size_t length = end ? (size_t)(end - start) : limit;
    if (length >= HEADER_LINE_BYTES || memchr(start, 0, length))
        return fail(STATUS_INPUT, "%s: line %lld of its header is %s; the header is damaged or does not end",
                    text->path, (long long)text->line, length >= HEADER_LINE_BYTES ? "too long" : "not text");
    memcpy(line, start, length);
    line[length] = 0;
    for (char *c = line; *c; c++) /* nothing of it is to steer a terminal that it is shown on */
        if (iscntrl((unsigned char)*c) && !isspace((unsigned char)*c)) *c = '?';
    char *trimmed = trim(line);
    memmove(line, trimmed, strlen(trimmed) + 1);
    text->position += length + (end ? 1 : 0);
    *more = 1;
    return 0;
}

int parse_integers(const char *text, int64_t *values, int max) {
    int count = 0;
    for (;;) {
        while (isspace((unsigned char)*text)) text++;
        if (!*text) return count;
        char *end;
        errno = 0;
        long long value = strtoll(text, &end, 10);
        if (end == text || errno || (*end && !isspace((unsigned char)*end)) || count == max) return -1;
        values[count++] = value;
        text = end;
    }
}

int parse_numbers(const char *text, double *values, int max) {
    int count = 0;
    for (;;) {
        while (isspace((unsigned char)*text)) text++;
        if (!*text) return count;
        char *end;
        double value = strtod(text, &end);
        if (end == text || (*end && !isspace((unsigned char)*end)) || count == max) return -1;
        values[count++] = value;
        text = end;
    }
}

char *trim(char *text) {
    while (isspace((unsigned char)*text)) text++;
    size_t length = strlen(text);
    while (length && isspace((unsigned char)text[length - 1])) text[--length] = 0;
    return text;
}

char *next_word(char **text) {
    char *start = *text;
    while (isspace((unsigned char)*start)) start++;
    if (!*start) return NULL;
    char *end = start;
    while (*end && !isspace((unsigned char)*end)) end++;
    *text = *end ? end + 1 : end;
    *end = 0;
    return start;
}

int names_have(const char *names, const char *word) {
    char wanted[64];
    snprintf(wanted, sizeof wanted, "|%.60s|", word);
    return *word && !strchr(word, '|') && strcasestr(names, wanted) != NULL;
}
