/*
 * vtk_xml_files.h - VTK XML files made by tests, in every encoding that the format has
 *
 * Text goes to the writer's `text`, arrays by array_add; vtk_xml_finish makes the whole file.
 */
#ifndef VTK_XML_FILES_H
#define VTK_XML_FILES_H

#include "read_files.h"
#include "vtk_xml/vtk_xml.h"

#ifdef HAVE_LZ4
#include <lz4.h>
#endif
#ifdef HAVE_LZMA
#include <lzma.h>
#endif

enum { BY_ZLIB = 1, BY_LZ4, BY_LZMA }; /* of compressed data */
enum { AS_TEXT, AS_INLINE, AS_APPENDED_RAW, AS_APPENDED_BASE64 };

typedef struct vtk_shape {
    int encoding, header_bytes, big, is_compressed; /* 0 or what by */
    size_t block_bytes;                             /* of compressed data */
    int line_breaks;                                /* within base64 */
} vtk_shape;

typedef struct vtk_writer {
    vtk_shape shape;
    bytes text, appended;
} vtk_writer;

static const char *const vtk_types[] = {"UInt8", "Int8",    "UInt16",  "Int16", "UInt32",
                                        "Int32", "Float32", "Float64", "Int64", "UInt64"};

static inline void add_base64(bytes *to, const bytes *from, int line_breaks) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < from->size; i += 3) {
        size_t count = from->size - i < 3 ? from->size - i : 3;
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; k++) bits = bits << 8 | (k < count ? from->data[i + k] : 0);
        char group[4];
        for (size_t k = 0; k < 4; k++) group[k] = k <= count ? digits[bits >> (18 - 6 * k) & 63] : '=';
        bytes_add(to, group, 2);
        if (line_breaks && i % 5 == 0) bytes_add(to, "\n ", 2);
        bytes_add(to, group + 2, 2);
    }
}

/* What the readers were built with. */
static inline int can_pack(int by) {
#ifdef HAVE_LZ4
    if (by == BY_LZ4) return 1;
#endif
#ifdef HAVE_LZMA
    if (by == BY_LZMA) return 1;
#endif
    return by == BY_ZLIB;
}

static inline bytes packed_block(int by, const unsigned char *data, size_t size) {
    bytes b = {malloc(2 * size + 1000), 0};
    (void)by;
#ifdef HAVE_LZ4
    if (by == BY_LZ4)
        b.size = (size_t)LZ4_compress_default((const char *)data, (char *)b.data, (int)size, 2 * (int)size + 1000);
#endif
#ifdef HAVE_LZMA
    if (by == BY_LZMA) lzma_easy_buffer_encode(1, LZMA_CHECK_CRC32, NULL, data, size, b.data, &b.size, 2 * size + 1000);
#endif
    if (b.size) return b;
    bytes_free(&b);
    return gzipped(data, size, AS_ZLIB);
}

/* Blocks packed one by one, and the header that tells their sizes. */
static inline void pack_blocks(const vtk_shape *s, const bytes *data, bytes *header, bytes *packed) {
    size_t count = (data->size + s->block_bytes - 1) / s->block_bytes;
    bytes_put(header, count, (size_t)s->header_bytes, s->big);
    bytes_put(header, s->block_bytes, (size_t)s->header_bytes, s->big);
    bytes_put(header, data->size % s->block_bytes, (size_t)s->header_bytes, s->big);
    for (size_t i = 0; i < count; i++) {
        size_t at = i * s->block_bytes, left = data->size - at;
        bytes block = packed_block(s->is_compressed, data->data + at, left < s->block_bytes ? left : s->block_bytes);
        bytes_put(header, block.size, (size_t)s->header_bytes, s->big);
        bytes_add(packed, block.data, block.size);
        bytes_free(&block);
    }
}

static inline void add_binary(const vtk_shape *s, const bytes *data, int is_base64, bytes *to) {
    bytes header = {0}, rest = {0};
    if (s->is_compressed) {
        pack_blocks(s, data, &header, &rest);
    } else {
        bytes_put(&header, data->size, (size_t)s->header_bytes, s->big);
        bytes_add(is_base64 ? &header : &rest, data->data, data->size);
    }
    if (is_base64) {
        add_base64(to, &header, s->line_breaks);
        add_base64(to, &rest, s->line_breaks);
    } else {
        bytes_add(to, header.data, header.size);
        if (rest.size) bytes_add(to, rest.data, rest.size);
    }
    bytes_free(&header);
    bytes_free(&rest);
}

/* Adds a DataArray of the stored type. */
static inline void array_add(vtk_writer *w, int type, const char *name, int components, const double *values,
                             uint64_t count) {
    const vtk_shape *s = &w->shape;
    static const char *const formats[] = {"ascii", "binary", "appended", "appended"};
    bytes_text(&w->text, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"%s\"", vtk_types[type],
               name, components, formats[s->encoding]);
    if (s->encoding >= AS_APPENDED_RAW) {
        while (s->encoding == AS_APPENDED_RAW && w->appended.size % 8 != (size_t)(s->header_bytes == 4 ? 4 : 0))
            bytes_add(&w->appended, "", 1);
        bytes_text(&w->text, " offset=\"%zu\"/>\n", w->appended.size);
    } else {
        bytes_text(&w->text, ">\n ");
    }
    bytes data = {0};
    for (uint64_t i = 0; i < count; i++) {
        if (s->encoding != AS_TEXT)
            bytes_value(&data, type, values[i], s->big);
        else if (type == TC_F32 || type == TC_F64)
            bytes_text(&data, "%.17g%s", values[i], i % 7 == 6 ? "\n" : " ");
        else
            bytes_text(&data, "%.0f%s", values[i], i % 7 == 6 ? "\n" : " ");
    }
    if (s->encoding == AS_TEXT && data.size)
        bytes_add(&w->text, data.data, data.size);
    else if (s->encoding == AS_INLINE)
        add_binary(s, &data, 1, &w->text);
    else if (s->encoding >= AS_APPENDED_RAW)
        add_binary(s, &data, s->encoding == AS_APPENDED_BASE64, &w->appended);
    if (s->encoding < AS_APPENDED_RAW) bytes_text(&w->text, "\n</DataArray>\n");
    bytes_free(&data);
}

static inline void vtk_xml_begin(vtk_writer *w, const vtk_shape *shape, const char *type) {
    static const char *const compressors[] = {"", " compressor=\"vtkZLibDataCompressor\"",
                                              " compressor=\"vtkLZ4DataCompressor\"",
                                              " compressor=\"vtkLZMADataCompressor\""};
    *w = (vtk_writer){.shape = *shape};
    bytes_text(&w->text, "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"%s\" byte_order=\"%s\"%s%s>\n", type,
               shape->header_bytes == 8 ? "1.0" : "0.1", shape->big ? "BigEndian" : "LittleEndian",
               shape->header_bytes == 8 ? " header_type=\"UInt64\"" : "", compressors[shape->is_compressed]);
}

/* The file, to be freed; frees the writer. The appended data begins at a multiple of eight. */
static inline bytes vtk_xml_finish(vtk_writer *w) {
    bytes file = w->text;
    if (w->appended.size) {
        bytes_text(&file, "<AppendedData encoding=\"%s\">\n", w->shape.encoding == AS_APPENDED_RAW ? "raw" : "base64");
        while (file.size % 8 != 7) bytes_text(&file, " ");
        bytes_text(&file, "_");
        bytes_add(&file, w->appended.data, w->appended.size);
        bytes_text(&file, "\n</AppendedData>\n");
    }
    bytes_text(&file, "</VTKFile>\n");
    bytes_free(&w->appended);
    *w = (vtk_writer){.shape = w->shape};
    return file;
}

static inline int read_path(const char *path, dataset *out) {
    read_request request;
    mapping file;
    *out = (dataset){0};
    read_request_init(&request, path);
    fail(0, "(no text)");
    int status = mapping_open(path, &file);
    if (!status) status = vtk_xml_read(&request, &file, out);
    mapping_close(&file);
    return status;
}

static inline int read_bytes(const char *name, const bytes *file, dataset *out) {
    return read_path(file_write(name, file->data, file->size), out);
}

static inline double field_value(const dataset_field *f, uint64_t i) { return value_at(f->type, f->values, i); }

#endif
