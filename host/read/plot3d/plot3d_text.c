/*
 * plot3d_text.c - the numbers of a Plot3D file that is text, as Fortran's list-directed output writes them
 *
 * Words are separated by white space and commas; "3*0.5" stands for three values; numbers are Fortran's
 * (number_text.h), in columns of fixed width too. A first pass counts, so that memory is taken once and never more than
 * the text can account for.
 */
#include "plot3d/plot3d_text.h"

#include "exit_status.h"
#include "failure.h"
#include "file/number_text.h"

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

/* The next word, with a terminating zero, or as much of it as there is room for; its length, 0 at the end of the text.
 */
static size_t next_text_word(text_reader *text, char word[WORD_BYTES]) {
    size_t length = 0;
    while (text->next < text->end && is_separator(*text->next)) text->next++;
    for (; text->next < text->end && !is_separator(*text->next) && length < WORD_BYTES - 1; text->next++)
        word[length++] = (char)*text->next;
    word[length] = 0;
    return length;
}

/* "3*0.5": how often, and what. Returns the characters of that or of a plain number, fewer than the word has where
 * others follow; 0 where it is neither. */
static size_t parse_repeated(const char *word, size_t length, uint64_t *repeats, double *value) {
    char number[WORD_BYTES];
    size_t digits = strspn(word, "0123456789"), skipped = 0;
    *repeats = 1;
    if (word[digits] == '*') {
        *repeats = 0;
        for (const char *p = word; *p != '*'; p++) {
            if (*repeats > UINT64_MAX / 100) return 0;
            *repeats = 10 * *repeats + (uint64_t)(*p - '0');
        }
        if (!*repeats) return 0;
        skipped = digits + 1;
    }
    size_t used = number_copy(word + skipped, length - skipped, number, sizeof number);
    *value = strtod(number, NULL);
    return used ? skipped + used : 0;
}

/* Counts, and stores where numbers is not NULL. */
static int read_numbers(text_reader *text, double *numbers) {
    char word[WORD_BYTES];
    size_t length;
    while ((length = next_text_word(text, word)) > 0) {
        uint64_t repeats;
        double value;
        int is_cut = text->next < text->end && !is_separator(*text->next);
        size_t used = parse_repeated(word, length, &repeats, &value);
        if (is_cut && (!used || used == length))
            return fail(STATUS_INPUT, "%s: its value %" PRIu64 " has more than %d characters; the file is damaged",
                        text->path, text->count + 1, WORD_BYTES - 1);
        if (!used)
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
        text->next -= length - used;
    }
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
