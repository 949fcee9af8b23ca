/*
 * vtk_xml_data.c - the values of one array of a VTK XML file; see vtk_xml_data.h
 *
 * Binary data begins with numbers of 4 or 8 bytes:
 *
 *     not compressed   bytes of data; then the data
 *     compressed       blocks, bytes of an unpacked block, bytes of the unpacked last block where it is shorter (else
 *                      0), bytes of each packed block; then the packed blocks
 *
 * In base64, header and data are encoded together where they are not compressed; else each is encoded on its own, with
 * padding between them. Here every group of four characters is decoded by itself, so that both forms are read alike.
 */
#include "vtk_xml/vtk_xml_data.h"

#include "dataset/layout.h"
#include "exit_status.h"
#include "failure.h"
#include "parallel.h"
#include "vtk_xml/vtk_xml_text.h"

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How often the bytes of a file may be decoded. Arrays can share data, as those of VTK's time steps do; without a bound
 * a small file could ask for much memory. */
enum { SHARED_MOST = 16 };

enum { SHARE_BYTES = 256 << 10 }; /* unpacked, for which another thread is worth while */

static int is_cut(const xml_values *v) {
    return fail(STATUS_INPUT, "%s ends before its %" PRIu64 " values do; the file is damaged or cut", v->label,
                v->count);
}

/* --------------------------------------------------------------------------------------------------------- sources */

/* What a character stands for, plus 1; 0 where it is none of the 64. */
/* clang-format off */
static const unsigned char base64_values[256] = {
    ['A'] =  1,  2,  3,  4,  5,  6,  7,  8,  9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26,
    ['a'] = 27, 28, 29, 30, 31, 32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47, 48, 49, 50, 51, 52,
    ['0'] = 53, 54, 55, 56, 57, 58, 59, 60, 61, 62,
    ['+'] = 63, ['/'] = 64};
/* clang-format on */

/* Decodes the next four characters, white space between them skipped. Returns the bytes they stand for, 1 to 3; 0 where
 * none can be had. */
static size_t decode_group(xml_source *s, unsigned char *to) {
    unsigned char group[4];
    size_t count = 0;
    for (; count < 4 && s->at < s->end; s->at++)
        if (*s->at > ' ') group[count++] = *s->at;
    if (count < 4) return 0;
    size_t bytes = group[3] != '=' ? 3 : group[2] != '=' ? 2 : 1;
    uint32_t bits = 0;
    for (size_t i = 0; i < 4; i++) {
        unsigned value = base64_values[group[i]];
        if (!value && i <= bytes) return 0;
        bits = bits << 6 | (value ? value - 1 : 0);
    }
    for (size_t i = 0; i < bytes; i++) to[i] = (unsigned char)(bits >> (16 - 8 * i));
    return bytes;
}

static unsigned char *take_kept(xml_source *s, unsigned char *to, uint64_t *bytes) {
    size_t count = *bytes < s->kept_count ? (size_t)*bytes : s->kept_count;
    memcpy(to, s->kept, count);
    memmove(s->kept, s->kept + count, s->kept_count - count);
    s->kept_count -= count;
    *bytes -= count;
    return to + count;
}

/* Copies the next bytes. Returns 0 where there are not as many, or they are no base64. */
static int source_take(xml_source *s, unsigned char *to, uint64_t bytes) {
    if (!s->is_base64) {
        if ((uint64_t)(s->end - s->at) < bytes) return 0;
        memcpy(to, s->at, (size_t)bytes);
        s->at += bytes;
        return 1;
    }
    to = take_kept(s, to, &bytes);
    while (bytes) {
        const unsigned char *at = s->at;
        for (; bytes >= 3 && s->end - at >= 4; at += 4, to += 3, bytes -= 3) {
            unsigned a = base64_values[at[0]], b = base64_values[at[1]], c = base64_values[at[2]],
                     d = base64_values[at[3]];
            if (!a || !b || !c || !d) break;
            uint32_t bits = (a - 1) << 18 | (b - 1) << 12 | (c - 1) << 6 | (d - 1);
            to[0] = (unsigned char)(bits >> 16);
            to[1] = (unsigned char)(bits >> 8);
            to[2] = (unsigned char)bits;
        }
        s->at = at;
        if (!bytes) break;
        s->kept_count = decode_group(s, s->kept);
        if (!s->kept_count) return 0;
        to = take_kept(s, to, &bytes);
    }
    return 1;
}

/* An upper bound of the bytes that are left. */
static uint64_t source_left(const xml_source *s) {
    uint64_t stored = (uint64_t)(s->end - s->at);
    return s->is_base64 ? stored / 4 * 3 + s->kept_count : stored;
}

/* Takes a number of the header; sets *good to 0 where there is none. */
static uint64_t take_number(const xml_document *doc, xml_source *s, int *good) {
    unsigned char bytes[8];
    uint32_t narrow;
    uint64_t wide;
    if (!source_take(s, bytes, doc->header_bytes)) {
        *good = 0;
        return 0;
    }
    memcpy(&narrow, bytes, 4);
    memcpy(&wide, bytes, 8);
    if (doc->header_bytes == 4) return doc->swapped ? __builtin_bswap32(narrow) : narrow;
    return doc->swapped ? __builtin_bswap64(wide) : wide;
}

/* ----------------------------------------------------------------------------------------------------------- sizes */

static int has_too_few(const xml_values *v, uint64_t bytes) {
    return fail(STATUS_INPUT,
                "%s has %" PRIu64 " bytes of data, but %" PRIu64 " values need %" PRIu64
                "; the file is damaged or cut, or its header_type or byte_order is wrong",
                v->label, bytes, v->count, v->bytes);
}

static int are_too_many(const xml_values *v) {
    return fail(STATUS_INPUT, "%s: too many arrays share the same data; the file is damaged", v->label);
}

static uint64_t file_bytes(const xml_document *doc) { return (uint64_t)(doc->end - doc->bytes); }

int vtk_xml_note_taken(xml_document *doc, const xml_values *v, uint64_t stored) {
    int too_many = __builtin_add_overflow(doc->taken, stored, &doc->taken);
    return too_many || doc->taken / SHARED_MOST > file_bytes(doc) ? are_too_many(v) : 0;
}

/* All that is unpacked of a file is bounded as one stream of its size would be. */
static int note_unpacked(xml_document *doc, const xml_values *v) {
    int too_many = __builtin_add_overflow(doc->unpacked, v->bytes, &doc->unpacked);
    return too_many || unpack_block_check(v->label, doc->packed, file_bytes(doc), doc->unpacked) ? are_too_many(v) : 0;
}

static int open_plain(xml_document *doc, xml_values *v) {
    int good = 1;
    uint64_t held = take_number(doc, &v->data, &good);
    size_t element_size = element_bytes(v->array->element);
    if (!good) return is_cut(v);
    if (held < v->bytes) return has_too_few(v, held);
    if (source_left(&v->data) < v->bytes) return has_too_few(v, source_left(&v->data));
    v->more = held > v->bytes;
    if (!v->data.is_base64) v->stored = v->data.at;
    if (!v->data.is_base64 && (!doc->swapped || element_size == 1) && (uintptr_t)v->data.at % element_size == 0) {
        v->in_place = v->data.at;
        return 0;
    }
    return vtk_xml_note_taken(doc, v, v->bytes);
}

/* Goes over the sizes of all blocks; v->data is then where the blocks begin. */
static int open_blocks(xml_document *doc, xml_values *v) {
    int good = 1;
    uint64_t count = take_number(doc, &v->data, &good), last, unpacked, packed = 0;
    v->block_bytes = take_number(doc, &v->data, &good);
    last = take_number(doc, &v->data, &good);
    v->sizes = v->data;
    if (!good || count > source_left(&v->data) / doc->header_bytes) return is_cut(v);
    if (last > v->block_bytes || __builtin_mul_overflow(count, v->block_bytes, &unpacked))
        return fail(STATUS_INPUT, "%s: the sizes of its compressed blocks make no sense; the file is damaged",
                    v->label);
    if (count && last) unpacked -= v->block_bytes - last;
    for (uint64_t i = 0; i < count; i++) {
        uint64_t size = take_number(doc, &v->data, &good);
        if (size > v->largest_block) v->largest_block = size;
        if (!good || __builtin_add_overflow(packed, size, &packed)) return is_cut(v);
    }
    if (packed > source_left(&v->data)) return is_cut(v);
    if (unpacked < v->bytes) return has_too_few(v, unpacked);
    v->more = unpacked > v->bytes;
    int status = unpack_block_check(v->label, doc->packed, packed, unpacked);
    if (!status) status = note_unpacked(doc, v);
    return status ? status : vtk_xml_note_taken(doc, v, packed);
}

/* A digit each and a space between. */
static int open_text(const xml_values *v) {
    uint64_t most = v->array->text ? ((uint64_t)(v->array->text_end - v->array->text) + 1) / 2 : 0;
    if (most >= v->count) return 0;
    return fail(STATUS_INPUT,
                "%s has at most %" PRIu64 " numbers of text, but %" PRIu64 " are needed; the file is damaged or cut",
                v->label, most, v->count);
}

static int find_data(const xml_document *doc, xml_values *v) {
    const xml_array *array = v->array;
    if (array->format == FORMAT_BINARY) {
        v->data = (xml_source){.at = array->text, .end = array->text_end, .is_base64 = 1};
        return array->text ? 0 : is_cut(v);
    }
    if (!doc->appended) return fail(STATUS_INPUT, "%s lies in appended data, of which the file has none", v->label);
    if (array->offset > (uint64_t)(doc->end - doc->appended))
        return fail(STATUS_INPUT, "%s begins at %" PRIu64 " of the appended data, which is only %" PRIu64 " bytes long",
                    v->label, array->offset, (uint64_t)(doc->end - doc->appended));
    v->data = (xml_source){.at = doc->appended + array->offset, .end = doc->end, .is_base64 = !doc->appended_is_raw};
    return 0;
}

/* Returns where the array begins in the label. */
static size_t make_label(const xml_document *doc, const xml_array *array, char *label, size_t bytes) {
    static const char *const sections[] = {"", "", "", "of Points", "of Cells", "of Coordinates"};
    const char *name = doc->names + array->name;
    if (*name)
        snprintf(label, bytes, "%.380s: its array '%.60s'", doc->path, name);
    else
        snprintf(label, bytes, "%.380s: its array %s", doc->path,
                 *sections[array->section] ? sections[array->section] : "without a name");
    return strnlen(doc->path, 380) + 2;
}

int vtk_xml_open(xml_document *doc, const xml_array *array, uint64_t count, xml_values *out) {
    *out = (xml_values){.doc = doc, .array = array, .count = count};
    xml_values *v = out;
    v->label_array = make_label(doc, array, v->label, sizeof v->label);
    if (array->element < 0)
        return fail(STATUS_INPUT, "%s holds no numbers of a type that is read, but '%s'", v->label, array->type);
    if (array->is_bits && array->section > SECTION_CELL_DATA)
        return fail(STATUS_INPUT, "%s is of type Bit, which is read of fields alone", v->label);
    if (__builtin_mul_overflow(count, element_bytes(array->element), &v->bytes) || v->bytes > INT64_MAX / 8)
        return fail(STATUS_INPUT, "%s should have %" PRIu64 " values; the file is damaged", v->label, count);
    if (!count) return 0;
    if (array->format == FORMAT_TEXT) return open_text(v);
    v->is_compressed = doc->compressor[0] != 0;
    if (v->is_compressed && doc->packed == PACKING_UNKNOWN)
        return fail(STATUS_INPUT,
                    "%s is compressed by %s, which is unknown; write the file with vtkZLibDataCompressor, or without "
                    "compression",
                    v->label, doc->compressor);
    int status = find_data(doc, v);
    if (status) return status;
    return v->is_compressed ? open_blocks(doc, v) : open_plain(doc, v);
}

/* ---------------------------------------------------------------------------------------------------------- values */

/* Blocks are taken in order under the lock, and unpacked by several threads. */
typedef struct block_work {
    pthread_mutex_t lock;
    xml_values *v;
    unsigned char *to;  /* where the next block goes */
    uint64_t left;      /* bytes that are still wanted */
    int status;         /* of the first failure, */
    char message[1024]; /* and its message, as each thread records its own */
} block_work;

/* Called under the lock. */
static void note_failure(block_work *w, int status) {
    if (w->status) return;
    w->status = status;
    snprintf(w->message, sizeof w->message, "%s", failure_text());
}

/* Takes the next block; base64 is decoded to `packed`. Returns 0 where there is none. */
static int take_block(block_work *w, unsigned char *packed, const unsigned char **from, uint64_t *size,
                      unsigned char **to, uint64_t *wanted) {
    xml_values *v = w->v;
    int good = 1;
    pthread_mutex_lock(&w->lock);
    int is_there = w->left && !w->status;
    if (is_there) {
        *size = take_number(v->doc, &v->sizes, &good);
        *from = v->data.is_base64 ? packed : v->data.at;
        if (v->data.is_base64)
            good = good && source_take(&v->data, packed, *size);
        else
            v->data.at += *size;
        *to = w->to;
        *wanted = w->left < v->block_bytes ? w->left : v->block_bytes;
        w->to += *wanted;
        w->left -= *wanted;
        if (!good) note_failure(w, is_cut(v));
    }
    pthread_mutex_unlock(&w->lock);
    return is_there && good;
}

static void unpack_blocks(void *shared) {
    block_work *w = shared;
    const unsigned char *from;
    unsigned char *packed = malloc(w->v->data.is_base64 ? (size_t)w->v->largest_block + 1 : 1), *to;
    uint64_t size, wanted;
    while (packed && take_block(w, packed, &from, &size, &to, &wanted)) {
        int status = unpack_block(w->v->label, w->v->doc->packed, from, size, to, wanted);
        if (!status) continue;
        pthread_mutex_lock(&w->lock);
        note_failure(w, status);
        pthread_mutex_unlock(&w->lock);
    }
    free(packed);
}

static int take_blocks(xml_values *v, unsigned char *to) {
    block_work w = {.lock = PTHREAD_MUTEX_INITIALIZER, .v = v, .to = to, .left = v->bytes};
    parallel_run(v->bytes / SHARE_BYTES + 1, unpack_blocks, &w);
    if (w.status) return fail(w.status, "%s", w.message);
    return w.left ? fail(STATUS_FAILED, "%s: no memory for its compressed blocks", v->label) : 0;
}

int vtk_xml_take(xml_values *v, void *to) {
    size_t element_size = element_bytes(v->array->element);
    int status = 0;
    if (!v->count) return 0;
    if (v->array->format == FORMAT_TEXT) return vtk_xml_take_text(v->array, v->count, v->label, to, &v->more);
    if (v->is_compressed)
        status = take_blocks(v, to);
    else if (!source_take(&v->data, to, v->bytes))
        status = is_cut(v);
    if (status || !v->doc->swapped || element_size == 1) return status;
    layout swap = {.element = (int)element_sample_type(v->array->element), /* of 64-bit integers the bytes alone */
                   .swapped = 1,
                   .dims = {(int64_t)v->count, 1, 1},
                   .stride = {1, 0, 0}};
    return layout_gather(v->label, &swap, to, to);
}
