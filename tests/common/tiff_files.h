/* tiff_files.h - TIFF files that tests write, page by page, in every form that is read but LZW and its like */
#ifndef TIFF_FILES_H
#define TIFF_FILES_H

#include "read_files.h"

enum { TIFF_NONE = 1, TIFF_DEFLATE = 8, TIFF_PACKBITS = 32773 };

typedef struct tiff_form {
    int type; /* of samples */
    int is_big_endian, is_big_tiff;
    int compression;
    int width, height, samples;
    int rows;                /* of a strip */
    int tile;                /* side of square tiles; 0: strips */
    const char *description; /* NULL: none */
    double resolution[2];    /* 0: none */
    int subfile;             /* kind of page */
} tiff_form;

/* Tags, types and numbers of values, whose values lie in the file already where they have no room. */
typedef struct tiff_tags {
    bytes entries;
    int count;
} tiff_tags;

static inline void tiff_tag(tiff_tags *t, const tiff_form *f, int tag, int type, uint64_t count, uint64_t value) {
    const int big = f->is_big_endian;
    const size_t room = f->is_big_tiff ? 8 : 4, size = count > 1 ? room : type == 3 ? 2 : type == 4 ? 4 : room;
    bytes_put(&t->entries, (uint64_t)tag, 2, big);
    bytes_put(&t->entries, (uint64_t)type, 2, big);
    bytes_put(&t->entries, count, room, big);
    bytes_put(&t->entries, value, size, big);
    bytes_put(&t->entries, 0, room - size, big);
    t->count++;
}

/* Literal runs. */
static inline bytes packbits(const unsigned char *data, size_t size) {
    bytes b = {0};
    for (size_t at = 0; at < size; at += 100) {
        const size_t count = size - at < 100 ? size - at : 100;
        bytes_put(&b, count - 1, 1, 0);
        bytes_add(&b, data + at, count);
    }
    return b;
}

/* Rows y0 to y1 - 1 and columns x0 to x1 - 1, those behind the page as zeros. */
static inline bytes tiff_part(const tiff_form *f, uint64_t first, int x0, int x1, int y0, int y1) {
    bytes b = {0};
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++)
            for (int c = 0; c < f->samples; c++) {
                const uint64_t n = first + (uint64_t)((y * f->width + x) * f->samples + c);
                const int is_inside = x < f->width && y < f->height;
                bytes_value(&b, f->type, is_inside ? test_value(f->type, n) : 0, f->is_big_endian);
            }
    bytes packed = f->compression == TIFF_DEFLATE    ? gzipped(b.data, b.size, AS_ZLIB)
                   : f->compression == TIFF_PACKBITS ? packbits(b.data, b.size)
                                                     : b;
    if (packed.data != b.data) bytes_free(&b);
    return packed;
}

/* Adds numbers of a tag; where they begin, or the number itself where there is one. */
static inline uint64_t tiff_numbers(bytes *file, const tiff_form *f, const uint64_t *values, int count) {
    const uint64_t at = file->size;
    for (int n = 0; n < count; n++) bytes_put(file, values[n], f->is_big_tiff ? 8 : 4, f->is_big_endian);
    return count == 1 ? values[0] : at;
}

/* Adds a page of samples first, first + 1, ...,. *link: where the address
 * of the next page belongs. */
static inline void tiff_page(bytes *file, const tiff_form *f, uint64_t first, size_t *link) {
    enum { PARTS_MOST = 64 };
    const int big = f->is_big_endian, wide = f->is_big_tiff ? 16 : 4;
    uint64_t offsets[PARTS_MOST], sizes[PARTS_MOST];
    int parts = 0;
    const int step_y = f->tile ? f->tile : f->rows, step_x = f->tile ? f->tile : f->width;
    for (int y = 0; y < f->height; y += step_y)
        for (int x = 0; x < f->width; x += step_x, parts++) {
            const int end = !f->tile && y + step_y > f->height ? f->height : y + step_y;
            bytes part = tiff_part(f, first, x, x + step_x, y, end);
            offsets[parts] = file->size;
            sizes[parts] = part.size;
            bytes_add(file, part.data, part.size);
            bytes_free(&part);
        }
    const uint64_t at_offsets = tiff_numbers(file, f, offsets, parts), at_sizes = tiff_numbers(file, f, sizes, parts);
    const size_t text = file->size;
    if (f->description) bytes_add(file, f->description, strlen(f->description) + 1);
    size_t resolution[2];
    for (int axis = 0; axis < 2; axis++) {
        resolution[axis] = file->size;
        bytes_put(file, (uint64_t)(f->resolution[axis] * 1000), 4, big);
        bytes_put(file, 1000, 4, big);
    }
    const uint64_t bits = 8 * stored_bytes(f->type);
    const size_t at_bits = file->size;
    for (int c = 0; c < f->samples; c++) bytes_put(file, bits, 2, big);
    const int format = f->type == TC_F32 || f->type == TC_F64                                                ? 3
                       : f->type == TC_I8 || f->type == TC_I16 || f->type == TC_I32 || f->type == STORED_I64 ? 2
                                                                                                             : 1;
    tiff_tags t = {{NULL, 0}, 0};
    if (f->subfile) tiff_tag(&t, f, 254, 4, 1, (uint64_t)f->subfile);
    tiff_tag(&t, f, 256, 4, 1, (uint64_t)f->width);
    tiff_tag(&t, f, 257, 4, 1, (uint64_t)f->height);
    const uint64_t three = bits | bits << 16 | bits << 32; /* BigTIFF has room for them, little-endian here */
    tiff_tag(&t, f, 258, 3, (uint64_t)f->samples, f->samples == 1 ? bits : f->is_big_tiff ? three : at_bits);
    tiff_tag(&t, f, 259, 3, 1, (uint64_t)f->compression);
    tiff_tag(&t, f, 262, 3, 1, f->samples == 3 ? 2 : 1);
    if (f->description) tiff_tag(&t, f, 270, 2, strlen(f->description) + 1, text);
    if (!f->tile) tiff_tag(&t, f, 273, wide, (uint64_t)parts, at_offsets);
    tiff_tag(&t, f, 277, 3, 1, (uint64_t)f->samples);
    if (!f->tile) tiff_tag(&t, f, 278, 4, 1, (uint64_t)f->rows);
    if (!f->tile) tiff_tag(&t, f, 279, wide, (uint64_t)parts, at_sizes);
    for (int axis = 0; axis < 2; axis++)
        if (f->resolution[axis] > 0 && !f->is_big_tiff) tiff_tag(&t, f, 282 + axis, 5, 1, resolution[axis]);
    if (f->samples > 1) tiff_tag(&t, f, 284, 3, 1, 1);
    if (f->tile) tiff_tag(&t, f, 322, 4, 1, (uint64_t)f->tile);
    if (f->tile) tiff_tag(&t, f, 323, 4, 1, (uint64_t)f->tile);
    if (f->tile) tiff_tag(&t, f, 324, wide, (uint64_t)parts, at_offsets);
    if (f->tile) tiff_tag(&t, f, 325, wide, (uint64_t)parts, at_sizes);
    tiff_tag(&t, f, 339, 3, 1, (uint64_t)format);
    bytes address = {0};
    bytes_put(&address, file->size, f->is_big_tiff ? 8 : 4, big);
    memcpy(file->data + *link, address.data, address.size);
    bytes_put(file, (uint64_t)t.count, f->is_big_tiff ? 8 : 2, big);
    bytes_add(file, t.entries.data, t.entries.size);
    *link = file->size;
    bytes_put(file, 0, f->is_big_tiff ? 8 : 4, big);
    bytes_free(&address);
    bytes_free(&t.entries);
}

/* The header; *link as above. */
static inline bytes tiff_begin(const tiff_form *f, size_t *link) {
    bytes file = {0};
    bytes_text(&file, f->is_big_endian ? "MM" : "II");
    bytes_put(&file, f->is_big_tiff ? 43 : 42, 2, f->is_big_endian);
    if (f->is_big_tiff) bytes_put(&file, 8, 2, f->is_big_endian);
    if (f->is_big_tiff) bytes_put(&file, 0, 2, f->is_big_endian);
    *link = file.size;
    bytes_put(&file, 0, f->is_big_tiff ? 8 : 4, f->is_big_endian);
    return file;
}

/* A file of that many pages, whose samples begin with number `first`. */
static inline bytes tiff_file(const tiff_form *f, int pages, uint64_t first) {
    size_t link;
    bytes file = tiff_begin(f, &link);
    for (int n = 0; n < pages; n++)
        tiff_page(&file, f, first + (uint64_t)(n * f->width * f->height * f->samples), &link);
    return file;
}

#endif
