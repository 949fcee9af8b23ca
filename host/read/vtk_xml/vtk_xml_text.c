/*
 * vtk_xml_text.c - numbers that a VTK XML file holds as text; see vtk_xml_text.h
 *
 * Decimals of up to 15 digits with a power of ten of up to 22 are exact in double after one multiplication or division
 * (Clinger 1990); strtod takes the others.
 */
#include "vtk_xml/vtk_xml_text.h"

#include "exit_status.h"
#include "failure.h"
#include "file/number_text.h"
#include "stored_types.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { WORD_BYTES = 1152, EXACT_DIGITS = 15, EXACT_POWER = 22 }; /* a double to its last decimal: 1,075 digits */

static const double powers_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                       1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static int is_digit(char c) { return c >= '0' && c <= '9'; }

/* Returns 0 where the word is no plain decimal of few digits. */
static int parse_short_decimal(const char *word, double *value) {
    int is_negative = *word == '-', digits = 0, power = 0, exponent = 0;
    uint64_t mantissa = 0;
    if (*word == '-' || *word == '+') word++;
    for (; is_digit(*word); word++, digits++) mantissa = 10 * mantissa + (uint64_t)(*word - '0');
    if (*word == '.')
        for (word++; is_digit(*word); word++, digits++, power--) mantissa = 10 * mantissa + (uint64_t)(*word - '0');
    if (!digits || digits > EXACT_DIGITS) return 0;
    if (*word == 'e' || *word == 'E') {
        int is_small = *++word == '-';
        if (*word == '-' || *word == '+') word++;
        if (!is_digit(*word)) return 0;
        for (; is_digit(*word) && exponent < 1000; word++) exponent = 10 * exponent + (*word - '0');
        power += is_small ? -exponent : exponent;
    }
    if (*word || power > EXACT_POWER || power < -EXACT_POWER) return 0;
    *value = power < 0 ? (double)mantissa / powers_of_ten[-power] : (double)mantissa * powers_of_ten[power];
    if (is_negative) *value = -*value;
    return 1;
}

static int parse_real(const char *word, double *value) {
    char *end;
    if (parse_short_decimal(word, value)) return 1;
    *value = strtod(word, &end);
    return end != word && !*end;
}

/* Parses an integer as absolute value and sign. */
static int parse_integer(const char *word, int *is_negative, uint64_t *value) {
    *is_negative = *word == '-';
    *value = 0;
    if (*word == '-' || *word == '+') word++;
    if (!is_digit(*word)) return 0;
    for (; is_digit(*word); word++)
        if (__builtin_mul_overflow(*value, 10u, value) ||
            __builtin_add_overflow(*value, (uint64_t)(*word - '0'), value))
            return 0;
    return !*word;
}

/* Writes one number as an element in this machine's byte order. Returns 0 where the word is none, or out of range. */
static int store_number(const char *word, int element, unsigned char *to) {
    double wide;
    uint64_t absolute;
    int is_negative;
    if (!element_is_real(element))
        return parse_integer(word, &is_negative, &absolute) && element_put_integer(element, absolute, is_negative, to);
    if (!parse_real(word, &wide)) return 0;
    float narrow = (float)wide;
    memcpy(to, element == TC_F32 ? (void *)&narrow : (void *)&wide, element_bytes(element));
    return 1;
}

/* Stores the number that a word is. Where the word has several numbers, stores the first and moves *at back to the
 * second. A number that ends where a long word is cut is not known whole. Returns 0 where there is no number. */
static int take_word(const char *word, size_t length, int is_cut, int element, unsigned char *to,
                     const unsigned char **at) {
    char number[WORD_BYTES];
    if (!is_cut && store_number(word, element, to)) return 1;
    size_t used = number_copy(word, length, number, sizeof number);
    if (!used || (is_cut && used == length) || !store_number(number, element, to)) return 0;
    *at -= length - used;
    return 1;
}

int vtk_xml_take_text(const xml_array *array, uint64_t count, const char *label, void *to, int *more) {
    const unsigned char *at = array->text, *end = array->text_end;
    size_t bytes = element_bytes(array->element);
    unsigned char *value = to;
    char word[WORD_BYTES];
    for (uint64_t i = 0; i < count; i++, value += bytes) {
        size_t length = 0;
        while (at < end && *at <= ' ') at++;
        while (end > at && *at > ' ' && length < WORD_BYTES - 1) word[length++] = (char)*at++;
        word[length] = 0;
        if (!length)
            return fail(STATUS_INPUT,
                        "%s has %" PRIu64 " numbers of text, but %" PRIu64 " are needed; the file is damaged or cut",
                        label, i, count);
        if (!take_word(word, length, end > at && *at > ' ', array->element, value, &at))
            return fail(STATUS_INPUT, "%s: its number %" PRIu64 ", '%.40s', is no number of its type", label, i + 1,
                        word);
    }
    *more = at < end;
    return 0;
}
