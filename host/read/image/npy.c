/*
 * npy.c - arrays of numpy, .npy, versions 1 to 3
 *
 * Source: "The .npy format", numpy.lib.format. The header is a dictionary as Python writes it, with the keys descr,
 * fortran_order and shape; samples follow. array_axes.h says what axes are.
 */
#include "image/image.h"

#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "image/array_axes.h"
#include "image/source.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { HEADER_BYTES = 1 << 20, WORD_BYTES = 64 };

typedef struct npy_header {
    const char *path;
    const unsigned char *at, *end; /* what is left of the header */
    char descr[WORD_BYTES];
    int element, is_big_endian, is_fortran;
    int dimension;
    int64_t shape[ARRAY_AXES_MOST]; /* first axis first */
    int has_descr, has_order, has_shape;
    uint64_t start; /* of the samples */
} npy_header;

static int damaged(const npy_header *h, const char *what) {
    return fail(STATUS_INPUT, "%s: %s; its header is damaged: write it by numpy.save", h->path, what);
}

/* ---------------------------------------------------------------------------------------------- Python's dictionary */

static int next_character(npy_header *h) {
    while (h->at < h->end && strchr(" \t\r\n", *h->at)) h->at++;
    return h->at < h->end ? *h->at : -1;
}

static int take(npy_header *h, char wanted) {
    if (next_character(h) != wanted) return 0;
    h->at++;
    return 1;
}

/* 'word' or "word". Returns 0 where there is none, or it is too long. */
static int take_string(npy_header *h, char word[WORD_BYTES]) {
    const int quote = next_character(h);
    size_t length = 0;
    if (quote != '\'' && quote != '"') return 0;
    for (h->at++; h->at < h->end && *h->at != quote && length < WORD_BYTES - 1; h->at++) word[length++] = (char)*h->at;
    word[length] = '\0';
    return h->at < h->end && *h->at++ == quote;
}

/* Digits, behind which Python 2 wrote an L. */
static int take_integer(npy_header *h, int64_t *value) {
    const int first = next_character(h);
    if (first < '0' || first > '9') return 0;
    for (*value = 0; h->at < h->end && *h->at >= '0' && *h->at <= '9'; h->at++)
        if (__builtin_mul_overflow(*value, 10, value) || __builtin_add_overflow(*value, *h->at - '0', value)) return 0;
    if (h->at < h->end && *h->at == 'L') h->at++;
    return 1;
}

static int take_word(npy_header *h, const char *word) {
    const size_t length = strlen(word);
    (void)next_character(h);
    if ((size_t)(h->end - h->at) < length || memcmp(h->at, word, length) != 0) return 0;
    h->at += length;
    return 1;
}

/* ------------------------------------------------------------------------------------------------------------- keys */

/* The type that numpy's letter and bytes, "u1" or "f8", stand for: that of the tables whose name has the letter and so
 * many bits. */
static int element_of(const char *kind) {
    static const char *const names[] = {
#define ELEMENT_NAME(element, name, ...) [element] = #name,
        STORED_TYPES(ELEMENT_NAME)
#undef ELEMENT_NAME
    };
    if (strcmp(kind, "b1") == 0) return TC_U8;
    for (int element = 0; element < ELEMENT_COUNT; element++)
        if (kind[0] == names[element][0] && kind[1] == (char)('0' + element_bytes(element)) && !kind[2]) return element;
    return -1;
}

static int parse_descr(npy_header *h) {
    h->has_descr = 1;
    if (next_character(h) == '[')
        return fail(STATUS_INPUT, "%s: holds records of several values; save one of them: numpy.save(name, a['field'])",
                    h->path);
    if (!take_string(h, h->descr)) return damaged(h, "its 'descr' is no type");
    h->is_big_endian = h->descr[0] == '>' || (h->descr[0] == '=' && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    h->element = strchr("<>=|", h->descr[0]) && h->descr[0] ? element_of(h->descr + 1) : -1;
    if (h->element >= 0) return 0;
    return fail(STATUS_INPUT,
                "%s: its type '%.40s' cannot be read; integers of 8 to 64 bits, float32 and float64 can: "
                "numpy.save(name, a.astype('float32'))",
                h->path, h->descr);
}

static int parse_order(npy_header *h) {
    h->has_order = 1;
    h->is_fortran = take_word(h, "True");
    return h->is_fortran || take_word(h, "False") ? 0 : damaged(h, "its 'fortran_order' is neither True nor False");
}

static int parse_shape(npy_header *h) {
    h->has_shape = 1;
    h->dimension = 0;
    if (!take(h, '(')) return damaged(h, "its 'shape' is no tuple");
    while (!take(h, ')')) {
        int64_t size;
        if (!take_integer(h, &size)) return damaged(h, "its 'shape' has no whole numbers");
        if (h->dimension == ARRAY_AXES_MOST)
            return fail(STATUS_INPUT, "%s: has more than %d axes; save a part of the array", h->path, ARRAY_AXES_MOST);
        h->shape[h->dimension++] = size;
        if (!take(h, ',') && next_character(h) != ')') return damaged(h, "its 'shape' has no end");
    }
    return h->dimension ? 0 : fail(STATUS_INPUT, "%s: holds a single number, not a volume", h->path);
}

static int parse_dictionary(npy_header *h) {
    if (!take(h, '{')) return damaged(h, "its header is no dictionary");
    while (!take(h, '}')) {
        char key[WORD_BYTES];
        if (!take_string(h, key) || !take(h, ':')) return damaged(h, "its header has no key where one should be");
        int status = !strcmp(key, "descr")           ? parse_descr(h)
                     : !strcmp(key, "fortran_order") ? parse_order(h)
                     : !strcmp(key, "shape")         ? parse_shape(h)
                                                     : damaged(h, "its header has a key that the format does not have");
        if (status) return status;
        if (!take(h, ',') && next_character(h) != '}') return damaged(h, "its header has no end");
    }
    if (!h->has_descr) return damaged(h, "its header has no 'descr'");
    if (!h->has_order) return damaged(h, "its header has no 'fortran_order'");
    return h->has_shape ? 0 : damaged(h, "its header has no 'shape'");
}

/* Magic, version and length of the header, then its dictionary. */
static int parse_header(npy_header *h, const mapping *file) {
    enum { MAGIC = 6, BEFORE = MAGIC + 2 };
    const unsigned char *b = file->bytes;
    if (file->size < BEFORE + 4 || memcmp(b, "\x93NUMPY", MAGIC) != 0) return damaged(h, "does not begin as .npy does");
    if (b[MAGIC] < 1 || b[MAGIC] > 3)
        return fail(STATUS_INPUT, "%s: is of version %d of the format .npy; 1 to 3 can be read", h->path, b[MAGIC]);
    const size_t digits = b[MAGIC] == 1 ? 2 : 4;
    uint64_t length = 0;
    for (size_t n = 0; n < digits; n++) length |= (uint64_t)b[BEFORE + n] << 8 * n;
    h->start = BEFORE + digits + length;
    if (length > HEADER_BYTES || h->start > file->size) return damaged(h, "its header is longer than the file");
    h->at = b + BEFORE + digits;
    h->end = h->at + length;
    return parse_dictionary(h);
}

int npy_read(const read_request *request, const mapping *file, dataset *out) {
    npy_header h = {.path = request->path, .element = -1};
    axes stored;
    layout l;
    int status;
    if ((status = dataset_image_begin(out)) || (status = parse_header(&h, file))) return status;
    array_axes_list(h.shape, h.dimension, h.is_fortran, &stored);
    if ((status = layout_make(h.path, &stored, h.element, request, &l))) return status;
    if (h.is_fortran) {
        array_axes_turn(h.shape, h.dimension, &l);
        dataset_notice(out, "its array is in Fortran order: its last axis is x all the same");
    }
    l.swapped = h.is_big_endian == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
    for (int a = 0; a < 3; a++) out->blocks->matrix[a][a] = 1;
    if ((status = world_complete(request, h.path, out->blocks->matrix))) return status;
    source from = {.header_path = h.path, .start = h.start, .axes = &stored, .axes_per_file = stored.count};
    snprintf(out->format, sizeof out->format, "numpy");
    return source_load(request, &from, &l, out);
}
