/* number_text.c - see number_text.h */
#include "file/number_text.h"

#include <string.h>
#include <strings.h>

enum { BARE_EXPONENT = 3 }; /* digits of an exponent that no letter marks */

static int is_digit(char c) { return c >= '0' && c <= '9'; }

static int is_sign(char c) { return c == '+' || c == '-'; }

static size_t digit_run(const char *from, const char *end) {
    const char *at = from;
    while (at < end && is_digit(*at)) at++;
    return (size_t)(at - from);
}

/* The length of a sign, digits and at most one point; 0 where there is no digit. */
static size_t mantissa_length(const char *word, const char *end, int *has_point) {
    const char *at = word;
    if (at < end && is_sign(*at)) at++;
    size_t digits = digit_run(at, end);
    at += digits;
    *has_point = at < end && *at == '.';
    if (*has_point) {
        size_t behind = digit_run(at + 1, end);
        digits += behind;
        at += 1 + behind;
    }
    return digits ? (size_t)(at - word) : 0;
}

/* The digits of an exponent that begin here. Where a point follows, the next number has begun: with the last of three
 * or four digits, or with the point behind two, as Fortran's exponents have two or three. 0: they are none of these. */
static size_t exponent_digits(const char *from, const char *end) {
    size_t digits = digit_run(from, end);
    if (from + digits == end || from[digits] != '.') return digits;
    return digits == 3 || digits == 4 ? digits - 1 : digits == 2 ? digits : 0;
}

/* The length of an exponent with its mark and sign, and of these two alone in *marks; 0: none begins here. */
static size_t exponent_length(const char *from, const char *end, int has_point, size_t *marks) {
    if (from == end) return 0;
    if (is_sign(*from)) {
        size_t digits = digit_run(from + 1, end);
        int is_bare = has_point && digits == BARE_EXPONENT && (from + 1 + digits == end || from[1 + digits] != '.');
        *marks = 1;
        return is_bare ? 1 + digits : 0;
    }
    if (!strchr("eEdDqQ", *from)) return 0;
    *marks = from + 1 < end && is_sign(from[1]) ? 2 : 1;
    size_t digits = exponent_digits(from + *marks, end);
    return digits ? *marks + digits : 0;
}

/* NaN and infinity, with a sign or without. */
static size_t special_length(const char *word, const char *end) {
    static const char *const names[] = {"infinity", "inf", "nan"};
    size_t sign = word < end && is_sign(*word);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        size_t length = strlen(names[n]);
        if ((size_t)(end - word) >= sign + length && !strncasecmp(word + sign, names[n], length)) return sign + length;
    }
    return 0;
}

size_t number_copy(const char *word, size_t length, char *c_word, size_t bytes) {
    const char *end = word + length;
    int has_point = 0;
    size_t mantissa = mantissa_length(word, end, &has_point), marks = 0, exponent = 0, used;
    *c_word = 0;
    if (mantissa) exponent = exponent_length(word + mantissa, end, has_point, &marks);
    used = mantissa ? mantissa + exponent : special_length(word, end);
    if (!used || used + 1 >= bytes) return 0;
    if (used < length && !is_sign(word[used]) && !(exponent && (is_digit(word[used]) || word[used] == '.'))) return 0;
    memcpy(c_word, word, used);
    c_word[used] = 0;
    if (!exponent) return used;
    char *to = c_word + mantissa;
    const char *from = word + mantissa;
    *to++ = 'e';
    if (is_sign(from[marks - 1])) *to++ = from[marks - 1];
    memcpy(to, from + marks, exponent - marks);
    to[exponent - marks] = 0;
    return used;
}
