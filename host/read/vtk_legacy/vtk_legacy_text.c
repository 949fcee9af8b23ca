/* vtk_legacy_text.c - words, numbers and lines of VTK legacy files; see vtk_legacy_text.h */
#include "vtk_legacy/vtk_legacy_text.h"

#include "control.h"
#include "exit_status.h"
#include "failure.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

int legacy_fail(const legacy *r, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (r->is_binary) return fail(STATUS_INPUT, "%s: %s (at byte %zu)", r->path, text, r->at);
    int64_t line = 1;
    for (size_t n = 0; n < r->at; n++) line += r->bytes[n] == '\n';
    return fail(STATUS_INPUT, "%s: %s (at line %" PRId64 ")", r->path, text, line);
}

int legacy_word(legacy *r, char word[LEGACY_WORD]) {
    size_t length = 0;
    while (r->at < r->size && legacy_is_space(r->bytes[r->at])) r->at++;
    for (; r->at < r->size && !legacy_is_space(r->bytes[r->at]); r->at++) {
        unsigned char c = r->bytes[r->at];
        if (length == LEGACY_WORD - 1)
            return legacy_fail(r,
                               "has a word longer than %d characters where a keyword, name or type must be; it is "
                               "damaged, or an array is longer than it says",
                               LEGACY_WORD - 1);
        word[length++] = (char)(c ? c : '?');
    }
    word[length] = 0;
    control_mask(word, 0);
    return 0;
}

int legacy_need(legacy *r, const char *what, char word[LEGACY_WORD]) {
    int status = legacy_word(r, word);
    if (!status && !*word) status = legacy_fail(r, "ends where %s must be; the file is cut", what);
    return status;
}

int legacy_accept(legacy *r, const char *keyword) {
    size_t at = r->at, length = strlen(keyword);
    while (at < r->size && legacy_is_space(r->bytes[at])) at++;
    if (r->size - at < length || strncasecmp((const char *)r->bytes + at, keyword, length)) return 0;
    at += length;
    if (at < r->size && !legacy_is_space(r->bytes[at])) return 0;
    r->at = at;
    return 1;
}

int legacy_integer(legacy *r, const char *what, int64_t low, int64_t high, int64_t *value) {
    char word[LEGACY_WORD], *end;
    int status = legacy_need(r, what, word);
    if (status) return status;
    errno = 0;
    long long number = strtoll(word, &end, 10);
    if (end == word || *end || errno || number < low || number > high)
        return legacy_fail(r, "says '%.40s' for %s; an integer from %" PRId64 " to %" PRId64 " is needed", word, what,
                           low, high);
    *value = number;
    return 0;
}

int legacy_number(legacy *r, const char *what, double *value) {
    char word[LEGACY_WORD], *end;
    int status = legacy_need(r, what, word);
    if (status) return status;
    *value = strtod(word, &end);
    if (end == word || *end) return legacy_fail(r, "says '%.40s' for %s; a number is needed", word, what);
    return 0;
}

static int hexadecimal(char c) {
    return isdigit((unsigned char)c) ? c - '0' : isxdigit((unsigned char)c) ? tolower((unsigned char)c) - 'a' + 10 : -1;
}

/* Control characters stay encoded: names are printed, and chosen on a command line. */
int legacy_name(legacy *r, char name[LEGACY_WORD]) {
    char word[LEGACY_WORD] = "", plain[LEGACY_WORD];
    size_t length = 0;
    int status = legacy_need(r, "the name of an array", word);
    name[0] = 0;
    if (status) return status;
    for (const char *from = word; *from; from++) {
        int high = *from == '%' ? hexadecimal(from[1]) : -1, low = high >= 0 ? hexadecimal(from[2]) : -1;
        int code = low >= 0 ? 16 * high + low : 0;
        plain[length++] = (char)(code ? code : *from);
        if (code) from += 2;
    }
    plain[length] = 0;
    length = 0;
    for (const char *from = plain; *from && length + (control_bytes(from) ? 6 : 1) < LEGACY_WORD;)
        length += control_encode(&from, name + length);
    name[length] = 0;
    return 0;
}

int legacy_skip_line(legacy *r) {
    int is_blank = 1;
    while (r->at < r->size) {
        unsigned char c = r->bytes[r->at++];
        if (c == '\n') break;
        is_blank &= legacy_is_space(c);
    }
    return is_blank;
}

int legacy_line_goes_on(const legacy *r) {
    size_t at = r->at;
    while (at < r->size && r->bytes[at] != '\n' && legacy_is_space(r->bytes[at])) at++;
    return at < r->size && r->bytes[at] != '\n';
}
