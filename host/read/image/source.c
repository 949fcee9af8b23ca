/* source.c - brings the samples that a header describes; see source.h */
#include "image/source.h"

#include "dataset/array_memory.h"
#include "dataset/region.h"
#include "exit_status.h"
#include "failure.h"
#include "file/mapping.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where the data starts in a mapped file, after skips. */
static int find_start(const source *from, const char *path, const mapping *m, uint64_t bytes, uint64_t *start) {
    uint64_t at = from->files.count ? 0 : from->start;
    if (from->byte_skip < 0 && from->encoding == ENCODING_RAW) {
        uint64_t behind = (uint64_t)(SKIP_FROM_END - from->byte_skip), held = m->size < at ? 0 : m->size - at;
        if (held < bytes || held - bytes < behind)
            return fail(STATUS_INPUT,
                        "%s: holds %" PRIu64 " bytes of data, but its header asks for %" PRIu64 " and %" PRIu64
                        " behind them; the header is wrong or the file is cut",
                        path, held, bytes, behind);
        *start = m->size - behind - bytes;
        return 0;
    }
    if (from->byte_skip < 0)
        return fail(STATUS_INPUT,
                    "%s: asks to skip %" PRId64 " bytes; only -1 with raw data, or 0 and more, is possible",
                    from->header_path, from->byte_skip);
    for (int64_t line = 0; line < from->line_skip; line++) {
        const unsigned char *end = at < m->size ? memchr(m->bytes + at, '\n', m->size - at) : NULL;
        if (!end)
            return fail(STATUS_INPUT, "%s: its header asks to skip %" PRId64 " lines, but it has only %" PRId64, path,
                        from->line_skip, line);
        at = (uint64_t)(end - m->bytes) + 1;
    }
    if (__builtin_add_overflow(at, (uint64_t)from->byte_skip, &at) || at > m->size)
        return fail(STATUS_INPUT,
                    "%s: is %zu bytes long, but its data should start behind that; the header is wrong or "
                    "the file is cut",
                    path, m->size);
    *start = at;
    return 0;
}

/* Whether `available` stored bytes, which are not packed, can hold what the header declares for this file. */
static int check_size(const source *from, const char *path, uint64_t available, uint64_t bytes, size_t element_size) {
    switch (from->encoding) {
    case ENCODING_TEXT: /* a digit each and a space between */
        if (available >= 2 * (bytes / element_size) - 1) return 0;
        return fail(STATUS_INPUT,
                    "%s: holds %" PRIu64 " characters of text, too few for %" PRIu64
                    " numbers; the header is wrong or the file is cut",
                    path, available, bytes / element_size);
    case ENCODING_HEX:
        if (available / 2 >= bytes) return 0;
        return fail(STATUS_INPUT,
                    "%s: holds %" PRIu64 " hexadecimal digits, but its header asks for %" PRIu64
                    " bytes; the header is wrong or the file is cut",
                    path, available, bytes);
    default:
        if (available >= bytes) return 0;
        return fail(STATUS_INPUT,
                    "%s: holds %" PRIu64 " bytes of data, but its header asks for %" PRIu64
                    "; the header is wrong or the file is cut",
                    path, available, bytes);
    }
}

/* Whether the stream can hold what the header declares for this file, before memory is taken for it. */
static int check_stream(const source *from, const char *path, const unsigned char *in, size_t in_bytes,
                        uint64_t bytes) {
    uint64_t needed, skip = (uint64_t)(from->stream_skip < 0 ? SKIP_FROM_END - from->stream_skip : from->stream_skip);
    if (__builtin_add_overflow(bytes, skip, &needed)) needed = UINT64_MAX;
    return unpack_prove(path, from->encoding, in, in_bytes, needed);
}

/* *skip: bytes to skip of what the stream unpacks to. Where the data ends the stream, it is unpacked once to be
 * counted. */
static int find_stream_skip(const source *from, const char *path, const unsigned char *in, size_t in_bytes,
                            uint64_t bytes, uint64_t *skip) {
    enum { BEFORE_MOST = 256 << 20 }; /* a file of a few bytes may unpack for hours */
    *skip = (uint64_t)from->stream_skip;
    if (from->stream_skip >= 0) return 0;
    uint64_t total = 0, needed = bytes + (uint64_t)(SKIP_FROM_END - from->stream_skip), most = needed + BEFORE_MOST;
    int status = unpack_count(path, from->encoding, in, in_bytes, most, &total);
    if (status) return status;
    if (total == most)
        return fail(STATUS_INPUT, "%s: unpacks to more than %d MiB before its data; say how many bytes to skip", path,
                    BEFORE_MOST >> 20);
    if (total < needed)
        return fail(STATUS_INPUT,
                    "%s: unpacks to %" PRIu64 " bytes, but its header asks for %" PRIu64
                    "; the header is wrong or the file is cut",
                    path, total, needed);
    *skip = total - needed;
    return 0;
}

enum { WORD_BYTES = 1152 }; /* of a number: a double to its last decimal, 1,075 digits, and more */

/* Writes one number of text as an element in this machine's byte order. Returns 0 where it is none, or out of range. */
static int store_number(const char *word, int element, unsigned char *to) {
    char *end;
    errno = 0;
    if (element_is_real(element)) {
        double wide = strtod(word, &end);
        float narrow = (float)wide;
        memcpy(to, element == TC_F32 ? (void *)&narrow : (void *)&wide, element_bytes(element));
        return end != word && !*end;
    }
    if (element == ELEMENT_U64) {
        unsigned long long value = strtoull(word, &end, 10);
        memcpy(to, &value, 8);
        return end != word && !*end && !errno && *word != '-';
    }
    long long value = strtoll(word, &end, 10);
    if (end == word || errno) return 0;
    if (*end) { /* 12.0 and 1e3 are whole numbers too */
        double whole = strtod(word, &end);
        if (*end || !(fabs(whole) <= 0x1p53) || whole != floor(whole)) return 0;
        value = (long long)whole;
    }
    return element_put_integer(element, value < 0 ? 0 - (uint64_t)value : (uint64_t)value, value < 0, to);
}

static int is_between(unsigned char c) { return isspace(c) || c == ','; }

/* *more: whether anything follows the last number. */
static int read_text(const char *path, const unsigned char *text, size_t size, int element, unsigned char *to,
                     uint64_t count, int *more) {
    size_t at = 0, bytes = element_bytes(element);
    for (uint64_t i = 0; i < count; i++, to += bytes) {
        char word[WORD_BYTES];
        size_t length = 0;
        while (at < size && is_between(text[at])) at++;
        while (at < size && !is_between(text[at]) && length < sizeof word - 1) word[length++] = (char)text[at++];
        word[length] = 0;
        if (!length)
            return fail(STATUS_INPUT,
                        "%s: has %" PRIu64 " numbers of text, but its header asks for %" PRIu64
                        "; the header is wrong or the file is cut",
                        path, i, count);
        int is_whole = strlen(word) == length && (at == size || is_between(text[at]));
        if (!is_whole || !store_number(word, element, to))
            return fail(STATUS_INPUT, "%s: number %" PRIu64 " of its data, '%.40s', is no number of its type", path,
                        i + 1, word);
    }
    while (at < size && is_between(text[at])) at++;
    *more = at < size;
    return 0;
}

static int hex_digit(unsigned char c) {
    int letter = c | 0x20;
    return isdigit(c) ? c - '0' : letter >= 'a' && letter <= 'f' ? letter - 'a' + 10 : -1;
}

/* Two digits a byte, white space anywhere. *more: whether digits follow. */
static int read_hex(const char *path, const unsigned char *text, size_t size, unsigned char *to, uint64_t bytes,
                    int *more) {
    size_t at = 0;
    for (uint64_t digit = 0;; at++) {
        while (at < size && isspace(text[at])) at++;
        *more = at < size;
        if (digit == 2 * bytes) return 0;
        int value = at < size ? hex_digit(text[at]) : -1;
        if (at == size)
            return fail(STATUS_INPUT, "%s: has %" PRIu64 " hexadecimal digits, but its header asks for %" PRIu64, path,
                        digit, 2 * bytes);
        if (value < 0) return fail(STATUS_INPUT, "%s: byte %zu of its data is no hexadecimal digit", path, at + 1);
        unsigned char *byte = to + digit / 2;
        *byte = (unsigned char)(digit++ & 1 ? *byte | value : value << 4);
    }
}

/* Notes, once, that a file holds more than was used. */
static void notice_rest(const source *from, const char *path, uint64_t rest, dataset *out) {
    if (!rest) return;
    for (int n = 0; n < out->notice_count; n++)
        if (strstr(out->notices[n], "more data than its header")) return;
    dataset_notice(out, "%.160s holds more data than its header asks for; the rest is not used",
                   from->files.count ? path : "it");
}

static int open_part(const source *from, const char *path, dataset *out, mapping *m) {
    return from->files.count ? data_names_open(from->header_path, path, out, m) : dataset_map(out, path, m);
}

/* Copies one file's part of the stored array to `to`; *more: whether the file holds more after it. */
static int take_part(const source *from, const char *path, const unsigned char *in, size_t in_bytes, int element,
                     unsigned char *to, uint64_t bytes, int *more) {
    uint64_t skip;
    int status;
    switch (from->encoding) {
    case ENCODING_RAW:
        memcpy(to, in, (size_t)bytes);
        *more = in_bytes > bytes && from->byte_skip >= 0;
        return 0;
    case ENCODING_TEXT:
        return read_text(path, in, in_bytes, element, to, bytes / element_bytes(element), more);
    case ENCODING_HEX:
        return read_hex(path, in, in_bytes, to, bytes, more);
    default:
        status = find_stream_skip(from, path, in, in_bytes, bytes, &skip);
        if (!status) status = unpack(path, from->encoding, in, in_bytes, skip, to, bytes, more);
        if (from->stream_skip < 0) *more = 0;
        return status;
    }
}

static int is_packed(const source *from) {
    return from->encoding == ENCODING_DEFLATE || from->encoding == ENCODING_BZIP2;
}

/* Checks one file or, where `to` is given, copies its part of the stored array there. */
static int load_part(const source *from, const char *path, const layout *l, uint64_t bytes, unsigned char *to,
                     dataset *out) {
    mapping m;
    uint64_t start = 0;
    int more = 0, status = open_part(from, path, out, &m);
    if (status) return status;
    if ((status = find_start(from, path, &m, bytes, &start))) goto cleanup;
    static const unsigned char nothing[1];
    const unsigned char *in = m.bytes ? m.bytes + start : nothing;
    size_t in_bytes = m.size - (size_t)start;
    if (!is_packed(from)) status = check_size(from, path, in_bytes, bytes, element_bytes(l->element));
    if (is_packed(from) && !to) status = check_stream(from, path, in, in_bytes, bytes);
    if (status || !to) goto cleanup;
    status = take_part(from, path, in, in_bytes, l->element, to, bytes, &more);
    if (!status) notice_rest(from, path, (uint64_t)more, out);
cleanup:
    mapping_close(&m);
    return status;
}

static int no_memory(const char *path, uint64_t bytes) {
    return fail(STATUS_FAILED,
                "%s: needs %" PRIu64 " bytes, which neither memory nor the folder of temporary files has (TMPDIR, else "
                "/var/tmp): name one with room by TMPDIR",
                path, bytes);
}

/* Gathers the volume from the stored array into memory of its own. */
static int gather(const source *from, const layout *l, const unsigned char *stored, dataset *out) {
    uint64_t bytes = 0, count = (uint64_t)l->dims[0] * (uint64_t)l->dims[1] * (uint64_t)l->dims[2];
    count *= (uint64_t)l->components; /* all of them elements stored */
    if (__builtin_mul_overflow(count, sample_bytes(layout_type(l)), &bytes)) bytes = UINT64_MAX;
    void *samples = samples_allocate(bytes);
    if (!samples) return no_memory(from->header_path, bytes);
    int status = layout_gather(from->header_path, l, stored, samples);
    if (status) {
        samples_free(samples);
        return status;
    }
    out->blocks->fields->values = samples;
    return dataset_keep(out, samples);
}

/* Loads one raw file. Where the samples can be used where they lie, nothing is copied. */
static int load_raw(const source *from, const char *path, const layout *l, dataset *out) {
    mapping m;
    uint64_t start = 0;
    int status = open_part(from, path, out, &m);
    if (status) return status;
    if ((status = find_start(from, path, &m, l->bytes, &start)) ||
        (status = check_size(from, path, m.size - start, l->bytes, element_bytes(l->element))))
        goto cleanup;
    if (from->byte_skip >= 0 && !from->goes_on) notice_rest(from, path, m.size - start - l->bytes, out);
    if (layout_is_plain(l, m.bytes + start)) {
        out->blocks->fields->values = m.bytes + start + l->offset * element_bytes(l->element);
        out->mapping = (void *)(uintptr_t)m.bytes;
        out->mapping_bytes = m.size;
        return 0;
    }
    status = gather(from, l, m.bytes + start, out);
cleanup:
    mapping_close(&m);
    return status;
}

/* Each of several files holds the first axes_per_file axes whole, or, where that is all axes, a run along the last. */
static int check_file_count(const source *from) {
    const axes *a = from->axes;
    int64_t files = from->files.count, expected = 1;
    if (files <= 1) return 0;
    if (from->axes_per_file < 1 || from->axes_per_file > a->count)
        return fail(STATUS_INPUT, "%s: says that each data file has %" PRId64 " axes; 1 to %d are possible",
                    from->header_path, from->axes_per_file, a->count);
    if (from->axes_per_file == a->count) {
        if (a->size[a->count - 1] % files == 0) return 0;
        return fail(STATUS_INPUT,
                    "%s: names %" PRId64 " data files, among which its %" PRId64 " slices cannot be shared evenly",
                    from->header_path, files, a->size[a->count - 1]);
    }
    for (int64_t i = from->axes_per_file; i < a->count; i++) expected *= a->size[i];
    if (expected == files) return 0;
    return fail(STATUS_INPUT, "%s: names %" PRId64 " data files, but its sizes ask for %" PRId64, from->header_path,
                files, expected);
}

/* Fills the image, except its matrix and its samples. */
static void describe(const source *from, const layout *l, dataset *out) {
    dataset_block *block = out->blocks;
    dataset_field *field = block->fields;
    block->point_count = block->cell_count = 1;
    for (int axis = 0; axis < 3; axis++) {
        block->dims[axis] = l->dims[axis];
        block->point_count *= l->dims[axis];
        block->cell_count *= l->dims[axis] - 1;
    }
    field->type = layout_type(l);
    field->components = l->components;
    field->is_scaled = l->scaled;
    field->meaning = from->axes->meaning;
    out->frames = l->frames;
}

/* Takes over the stored array: the samples, or what they are gathered from. */
static int take(const source *from, const layout *l, unsigned char *stored, dataset *out) {
    if (layout_is_plain(l, stored)) {
        out->blocks->fields->values = stored + l->offset * element_bytes(l->element);
        return dataset_keep(out, stored);
    }
    int status = gather(from, l, stored, out);
    samples_free(stored);
    return status;
}

static int load(const source *from, const layout *l, dataset *out) {
    int64_t parts = from->files.count ? from->files.count : 1;
    int status = 0;
    if (parts == 1 && from->encoding == ENCODING_RAW)
        return load_raw(from, from->files.count ? from->files.paths[0] : from->header_path, l, out);

    uint64_t part_bytes = l->bytes / (uint64_t)parts;
    unsigned char *stored = NULL;
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t i = 0; i < parts; i++) {
            const char *path = from->files.count ? from->files.paths[i] : from->header_path;
            unsigned char *to = stored ? stored + (uint64_t)i * part_bytes : NULL;
            if ((status = load_part(from, path, l, part_bytes, to, out))) goto cleanup;
        }
        if (!stored && !(stored = samples_allocate(l->bytes))) return no_memory(from->header_path, l->bytes);
    }
    return take(from, l, stored, out);
cleanup:
    samples_free(stored);
    return status;
}

int source_load(const read_request *request, const source *from, const layout *stored, dataset *out) {
    layout cut = *stored;
    int status = check_file_count(from);
    if (status) return status;
    describe(from, stored, out);
    status = region_cut_image(request, out, &cut);
    return status ? status : load(from, &cut, out);
}

int source_take(const read_request *request, const source *from, const layout *stored, void *array, dataset *out) {
    layout cut = *stored;
    describe(from, stored, out);
    int status = region_cut_image(request, out, &cut);
    if (!status) return take(from, &cut, array, out);
    samples_free(array);
    return status;
}
