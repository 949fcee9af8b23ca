/*
 * read_files.h - what the tests of the readers share: files made at run time in a folder of their own, and the
 * comparison of a volume with the values that went in
 *
 * Bytes are laid out here one by one, by code that shares nothing with the readers.
 */
#ifndef READ_FILES_H
#define READ_FILES_H

#include "expect.h"

#include "exit_status.h"
#include "failure.h"
#include "folder.h"
#include "read.h"
#include "sample_types.h"

#include <bzlib.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

enum { STORED_I64 = TC_F64 + 1, STORED_U64 };

typedef struct bytes {
    unsigned char *data;
    size_t size;
} bytes;

static inline void bytes_add(bytes *b, const void *data, size_t size) {
    b->data = realloc(b->data, b->size + size + 1);
    memcpy(b->data + b->size, data, size);
    b->size += size;
}

__attribute__((format(printf, 2, 3))) static inline void bytes_text(bytes *b, const char *format, ...) {
    char text[4096];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    bytes_add(b, text, (size_t)length);
}

static inline void bytes_free(bytes *b) {
    free(b->data);
    *b = (bytes){0};
}

/* Adds the low `size` bytes of bits, little- or big-endian. */
static inline void bytes_put(bytes *b, uint64_t bits, size_t size, int big) {
    for (size_t i = 0; i < size; i++) {
        unsigned char byte = (unsigned char)(bits >> 8 * (big ? size - 1 - i : i));
        bytes_add(b, &byte, 1);
    }
}

static inline size_t stored_bytes(int type) {
    static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8, 8, 8};
    return sizes[type];
}

/* A value of the type, different for neighbours, using its high bytes too. */
static inline double test_value(int type, uint64_t index) {
    static const double scales[] = {2, 1, 600, 300, 4e7, 2e7, 0.37, 0.73, 1e10, 2e10};
    double value = (double)(index * 37 % 101);
    if (type == TC_I8 || type == TC_I16 || type == TC_I32 || type == STORED_I64 || type >= TC_F32) value -= 50;
    if (type == STORED_U64) value += 50;
    value *= scales[type];
    return type == TC_F32 ? (double)(float)value : value;
}

static inline void bytes_value(bytes *b, int type, double value, int big) {
    float narrow = (float)value;
    uint32_t bits32;
    uint64_t bits64;
    memcpy(&bits32, &narrow, 4);
    memcpy(&bits64, &value, 8);
    if (type == TC_F32)
        bytes_put(b, bits32, 4, big);
    else if (type == TC_F64)
        bytes_put(b, bits64, 8, big);
    else if (type == STORED_U64)
        bytes_put(b, (uint64_t)value, 8, big);
    else
        bytes_put(b, (uint64_t)(int64_t)value, stored_bytes(type), big);
}

static inline bytes test_samples(int type, uint64_t count, int big) {
    bytes b = {0};
    for (uint64_t i = 0; i < count; i++) bytes_value(&b, type, test_value(type, i), big);
    return b;
}

static inline bytes gzipped(const unsigned char *data, size_t size, int window) {
    bytes b = {malloc(size + 1000), 0};
    z_stream z = {0};
    deflateInit2(&z, 6, Z_DEFLATED, window, 8, Z_DEFAULT_STRATEGY);
    z.next_in = (Bytef *)(uintptr_t)data;
    z.avail_in = (uInt)size;
    z.next_out = b.data;
    z.avail_out = (uInt)size + 1000;
    deflate(&z, Z_FINISH);
    b.size = z.total_out;
    deflateEnd(&z);
    return b;
}

enum { AS_GZIP = 15 + 16, AS_ZLIB = 15 };

static inline bytes bzipped(const unsigned char *data, size_t size) {
    unsigned packed = (unsigned)size + 1000;
    bytes b = {malloc(packed), 0};
    BZ2_bzBuffToBuffCompress((char *)b.data, &packed, (char *)(uintptr_t)data, (unsigned)size, 9, 0, 0);
    b.size = packed;
    return b;
}

/* The path of a file in the test's folder; valid for the next seven calls. */
static inline const char *file_path(const char *name) {
    static char paths[8][512];
    static int next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

/* A new file in place of one with this name: of one that is cut short and written again, file systems (ext4) wait for
 * the disk. */
static inline const char *file_write(const char *name, const void *data, size_t size) {
    const char *path = file_path(name);
    unlink(path);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file)) {
        printf("cannot write %s\n", path);
        exit(1);
    }
    return path;
}

static inline const char *file_text(const char *name, const char *text) { return file_write(name, text, strlen(text)); }

/* A file of a header and what stands behind it. */
static inline const char *file_behind(const char *name, const char *header, const bytes *data) {
    bytes file = {0};
    bytes_add(&file, header, strlen(header));
    bytes_add(&file, data->data, data->size);
    const char *path = file_write(name, file.data, file.size);
    bytes_free(&file);
    return path;
}

/* An image as the tests look at it: its dataset, and what its block and field say. */
typedef struct read_image {
    dataset d;
    int64_t dims[3];
    double matrix[3][4];
    tc_type type;
    int components;
    const void *samples;
} read_image;

/* As dataset_read; grids that are no images are refused. *v is zeroed where it fails. */
static inline int image_read(const read_request *request, read_image *v) {
    memset(v, 0, sizeof *v);
    memset(&v->d, 0x55, sizeof v->d);
    int status = dataset_read(request, &v->d);
    if (!status && !v->d.frames) {
        dataset_release(&v->d);
        status = fail(STATUS_INPUT, "%s: is no image", request->path);
    }
    if (status) return status;
    const dataset_block *b = v->d.blocks;
    EXPECT(v->d.block_count == 1 && b->kind == BLOCK_UNIFORM && b->field_count == 1 && !*b->fields->name,
           "%s: an image of %d blocks", request->path, v->d.block_count);
    EXPECT(b->point_count == b->dims[0] * b->dims[1] * b->dims[2] &&
               b->cell_count == (b->dims[0] - 1) * (b->dims[1] - 1) * (b->dims[2] - 1),
           "%s: %" PRId64 " points, %" PRId64 " cells", request->path, b->point_count, b->cell_count);
    memcpy(v->dims, b->dims, sizeof v->dims);
    memcpy(v->matrix, b->matrix, sizeof v->matrix);
    v->type = b->fields->type;
    v->components = b->fields->components;
    v->samples = b->fields->values;
    return 0;
}

static inline void image_release(read_image *v) {
    dataset_release(&v->d);
    memset(v, 0, sizeof *v);
}

static inline double image_value(const read_image *v, uint64_t i) { return value_at(v->type, v->samples, i); }

/* What a volume should be: the stored values at offset + stride * i, of the stored type. */
typedef struct expected {
    int stored;
    int64_t dims[3];
    uint64_t offset, stride; /* stride 0 means 1 */
    const char *format, *space;
    const double *matrix;    /* 12 numbers; NULL: identity */
    double slope, intercept; /* both 0: not scaled */
} expected;

static inline void expect_volume(const char *what, const read_request *request, const expected *e) {
    static const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    read_image v;
    int status = image_read(request, &v);
    EXPECT(status == 0, "%s: status %d: %s", what, status, failure_text());
    if (status) return;
    int is_scaled = e->slope != 0;
    tc_type type = is_scaled || e->stored > TC_F64 ? TC_F64 : (tc_type)e->stored;
    EXPECT(v.type == type, "%s: type %d, not %d", what, v.type, type);
    EXPECT(!memcmp(v.dims, e->dims, sizeof v.dims), "%s: dims %" PRId64 " %" PRId64 " %" PRId64, what, v.dims[0],
           v.dims[1], v.dims[2]);
    EXPECT(!e->format || !strcmp(v.d.format, e->format), "%s: format %s", what, v.d.format);
    EXPECT(!e->space || !strcmp(v.d.space, e->space), "%s: space '%s'", what, v.d.space);
    EXPECT((uintptr_t)v.samples % stored_bytes((int)type) == 0, "%s: samples are not aligned", what);
    for (int i = 0; i < 12; i++) {
        double wanted = (e->matrix ? e->matrix : identity)[i];
        EXPECT(fabs(v.matrix[i / 4][i % 4] - wanted) <= 1e-6 * fabs(wanted), "%s: matrix[%d][%d] is %.9g, not %.9g",
               what, i / 4, i % 4, v.matrix[i / 4][i % 4], wanted);
    }
    uint64_t count = (uint64_t)(e->dims[0] * e->dims[1] * e->dims[2]), wrong = 0;
    for (uint64_t i = 0; i < count && v.type == type; i++) {
        double value = test_value(e->stored, e->offset + i * (e->stride ? e->stride : 1));
        if (is_scaled) value = e->slope * value + e->intercept;
        wrong += image_value(&v, i) != value;
    }
    EXPECT(wrong == 0, "%s: %" PRIu64 " samples are wrong", what, wrong);
    dataset_release(&v.d);
    EXPECT(!v.d.blocks && !v.d.mapping && !v.d.memory, "%s: not zeroed by its release", what);
}

static inline int is_zero(const read_image *v) {
    static const read_image zero;
    return !memcmp(v, &zero, sizeof zero);
}

/* The read must fail with the status, a text that holds every given part, and a zeroed volume. */
static inline void expect_failure(const char *what, const read_request *request, int status, const char *part) {
    read_image v;
    fail(0, "(no text)");
    int got = image_read(request, &v);
    EXPECT(got == status, "%s: status %d, not %d: %s", what, got, status, failure_text());
    EXPECT(strstr(failure_text(), part), "%s: text has no '%s': %s", what, part, failure_text());
    if (got)
        EXPECT(is_zero(&v), "%s: not zeroed", what);
    else
        image_release(&v);
}

static inline read_request request_for(const char *path) {
    read_request request;
    read_request_init(&request, path);
    return request;
}

/* A NIfTI header of either version and byte order, its fields by their place in the format. */
typedef struct nifti_fields {
    int version, big;
    int64_t dim[8];
    int datatype, bits;
    double pixdim[8], vox_offset, slope, intercept;
    int qform, sform;
    double quatern[3], qoffset[3], srow[12];
    const char *magic; /* "n+" or "ni" */
} nifti_fields;

static inline void put_at(bytes *b, size_t at, uint64_t bits, size_t size, int big) {
    bytes field = {0};
    bytes_put(&field, bits, size, big);
    memcpy(b->data + at, field.data, size);
    bytes_free(&field);
}

static inline void put_float(bytes *b, size_t at, double value, const nifti_fields *f) {
    bytes field = {0};
    bytes_value(&field, f->version == 1 ? TC_F32 : TC_F64, value, f->big);
    memcpy(b->data + at, field.data, field.size);
    bytes_free(&field);
}

static inline bytes nifti_header_bytes(const nifti_fields *f) {
    int one = f->version == 1;
    size_t size = one ? 348 : 540, wide = one ? 4 : 8;
    bytes b = {calloc(size + 5, 1), size + 4};
    put_at(&b, 0, size, 4, f->big);
    for (size_t i = 0; i < 8; i++) {
        put_at(&b, one ? 40 + 2 * i : 16 + 8 * i, (uint64_t)f->dim[i], one ? 2 : 8, f->big);
        put_float(&b, one ? 76 + 4 * i : 104 + 8 * i, f->pixdim[i], f);
    }
    put_at(&b, one ? 70 : 12, (uint64_t)f->datatype, 2, f->big);
    put_at(&b, one ? 72 : 14, (uint64_t)f->bits, 2, f->big);
    if (one)
        put_float(&b, 108, f->vox_offset, f);
    else
        put_at(&b, 168, (uint64_t)f->vox_offset, 8, f->big);
    put_float(&b, one ? 112 : 176, f->slope, f);
    put_float(&b, one ? 116 : 184, f->intercept, f);
    put_at(&b, one ? 252 : 344, (uint64_t)f->qform, one ? 2 : 4, f->big);
    put_at(&b, one ? 254 : 348, (uint64_t)f->sform, one ? 2 : 4, f->big);
    for (size_t i = 0; i < 3; i++) {
        put_float(&b, (one ? 256 : 352) + wide * i, f->quatern[i], f);
        put_float(&b, (one ? 268 : 376) + wide * i, f->qoffset[i], f);
    }
    for (size_t i = 0; i < 12; i++) put_float(&b, (one ? 280 : 400) + wide * i, f->srow[i], f);
    snprintf((char *)b.data + (one ? 344 : 4), 4, "%s%d", f->magic, f->version);
    if (!one) memcpy(b.data + 8, "\r\n\032\n", 4);
    return b;
}

/* Fields of a plain single file of the given type and size. */
static inline nifti_fields nifti_plain(int version, int datatype, int bits, int64_t x, int64_t y, int64_t z) {
    return (nifti_fields){.version = version,
                          .dim = {3, x, y, z, 1, 1, 1, 1},
                          .datatype = datatype,
                          .bits = bits,
                          .pixdim = {1, 1, 1, 1, 1, 1, 1, 1},
                          .vox_offset = version == 1 ? 352 : 544,
                          .magic = "n+"};
}

#endif
