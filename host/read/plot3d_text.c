/*
 * plot3d_text.c - the numbers of a Plot3D file that is text, as Fortran's list-directed output writes them
 *
 * Words are separated by white space and commas; "3*0.5" stands for three values; exponents may be marked by D, or, of
 * three digits, by nothing ("0.1-101"). A first pass counts, so that memory is taken once and never more than the text
 * can account for.
 */
#include "plot3d.h"

#include "exit_status.h"
#include "failure.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum {
    WORD_BYTES = 64,
    SNIFFED_BYTES = 512,
    FREE_NUMBERS = 1 << 24, /* any text may have so many by repeats; */
    NUMBERS_PER_BYTE = 1024 /* beyond, so many for each of its bytes */
};

typedef struct text_reader {
    const char *path;
    const unsigned char *next, *end;
    uint64_t count, limit; /* numbers read so far; at most */
} text_reader;

static int is_separator(int c) { return isspace(c) || c == ','; }

int plot3d_is_text(const mapping *mapped) {
    size_t count = mapped->size < SNIFFED_BYTES ? mapped->size : SNIFFED_BYTES;
    for (size_t i = 0; i < count; i++)
        if (!isspace(mapped->bytes[i]) && (mapped->bytes[i] < ' ' || mapped->bytes[i] > '~')) return 0;
    return count > 0;
}

/* The next word, with a terminating zero; its length, 0 at the end of the text, -1 where it is too long. */
static int next_text_word(text_reader *text, char word[WORD_BYTES]) {
    int length = 0;
    while (text->next < text->end && is_separator(*text->next)) text->next++;
    for (; text->next < text->end && !is_separator(*text->next); text->next++) {
        if (length == WORD_BYTES - 1) return -1;
        word[length++] = (char)*text->next;
    }
    word[length] = 0;
    return length;
}

/* Takes Fortran's exponents too. Nonzero where the whole word is a number. */
static int parse_number(const char *word, double *value) {
    char c_word[WORD_BYTES + 1], *end;
    int length = 0, has_exponent = 0;
    for (const char *p = word; *p; p++) {
        int is_letter = strchr("dDeE", *p) != NULL;
        int is_bare = (*p == '+' || *p == '-') && p > word && (isdigit((unsigned char)p[-1]) || p[-1] == '.');
        if (is_bare && !has_exponent) c_word[length++] = 'e';
        has_exponent |= is_letter || is_bare;
        c_word[length++] = (char)(is_letter ? 'e' : *p);
        if (length >= WORD_BYTES) return 0;
    }
    c_word[length] = 0;
    *value = strtod(c_word, &end);
    return end > c_word && !*end;
}

/* "3*0.5": how often, and what. Nonzero where the word is that or a plain number. */
static int parse_repeated(const char *word, uint64_t *repeats, double *value) {
    const char *star = strchr(word, '*');
    *repeats = 1;
    if (!star) return parse_number(word, value);
    *repeats = 0;
    for (const char *p = word; p < star; p++) {
        /* The word ends with a zero. NOLINTNEXTLINE(clang-analyzer-core.uninitialized.ArraySubscript) */
        if (!isdigit((unsigned char)*p) || *repeats > UINT64_MAX / 100) return 0;
        *repeats = 10 * *repeats + (uint64_t)(*p - '0');
    }
    return *repeats > 0 && parse_number(star + 1, value);
}

/* Counts, and stores where numbers is not NULL. */
static int read_numbers(text_reader *text, double *numbers) {
    char word[WORD_BYTES];
    int length;
    while ((length = next_text_word(text, word)) > 0) {
        uint64_t repeats;
        double value;
        if (!parse_repeated(word, &repeats, &value))
            return fail(STATUS_INPUT,
                        "%s: its value %" PRIu64 ", '%.30s', is no number; the file is damaged or no Plot3D file",
                        text->path, text->count + 1, word);
        if (repeats > text->limit - text->count)
            return fail(STATUS_INPUT,
                        "%s: its repeat counts make more than %" PRIu64
                        " values of a text of this size; write them out",
                        text->path, text->limit);
        for (uint64_t i = 0; numbers && i < repeats; i++) numbers[text->count + i] = value;
        text->count += repeats;
    }
    if (length < 0)
        return fail(STATUS_INPUT, "%s: its value %" PRIu64 " has more than %d characters; the file is damaged",
                    text->path, text->count + 1, WORD_BYTES - 1);
    return 0;
}

int plot3d_numbers(const char *path, const mapping *mapped, double **numbers, uint64_t *count) {
    uint64_t limit = mapped->size * NUMBERS_PER_BYTE;
    text_reader text = {path, mapped->bytes, mapped->bytes + mapped->size, 0,
                        limit > FREE_NUMBERS ? limit : FREE_NUMBERS};
    text_reader again = text;
    *numbers = NULL;
    int status = read_numbers(&text, NULL);
    if (status) return status;
    *numbers = calloc(text.count + 1, sizeof **numbers);
    if (!*numbers) return fail(STATUS_FAILED, "%s: no memory for its %" PRIu64 " values", path, text.count);
    *count = text.count;
    return read_numbers(&again, *numbers);
}
