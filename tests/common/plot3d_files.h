/*
 * plot3d_files.h - what the tests of the Plot3D reader share: files of every form, laid out here number by number by
 * code that shares nothing with the reader, and the reading of a pair of them
 */
#ifndef PLOT3D_FILES_H
#define PLOT3D_FILES_H

#include "read_files.h"

#include "plot3d/plot3d.h"

enum { TEXT, RECORDS_4, RECORDS_8, BINARY };
enum { GRID_ONLY, SOLUTION, OVERFLOW_5, OVERFLOW_8, FUNCTION };
enum { TEST_VARIABLES = 3, MAX_BLOCKS = 3 };

typedef struct variant {
    int encoding, big, value_bytes, iblank, content;
    int blocks; /* 0: single-block */
} variant;

static const int64_t block_dims[MAX_BLOCKS][3] = {{4, 3, 2}, {2, 5, 3}, {3, 3, 3}};

static inline int block_count(const variant *v) { return v->blocks ? v->blocks : 1; }

static inline uint64_t block_points(int block) {
    return (uint64_t)(block_dims[block][0] * block_dims[block][1] * block_dims[block][2]);
}

static inline int variable_count(int content) {
    static const int counts[] = {0, 5, 5, 8, TEST_VARIABLES};
    return counts[content];
}

/* Variable -1, -2, -3: x, y, z. */
static inline double plot3d_value(const variant *v, int block, int variable, uint64_t point) {
    uint64_t index = (uint64_t)(block * 1009 + (variable + 4) * 107) + point;
    return test_value(v->value_bytes == 8 && v->encoding != TEXT ? TC_F64 : TC_F32, index);
}

/* As found in files: solid walls, neighbours, free points; every fifth is blanked. */
static inline int iblank_value(int block, uint64_t point) {
    static const int values[] = {-1, 1, 0, 2, -7};
    return values[(point + (uint64_t)block) % 5];
}

static inline void put_integer(bytes *b, const variant *v, int64_t value) {
    if (v->encoding == TEXT)
        bytes_text(b, " %" PRId64, value);
    else
        bytes_put(b, (uint64_t)value & 0xffffffffU, 4, v->big);
}

static inline void put_value(bytes *b, const variant *v, double value) {
    if (v->encoding == TEXT)
        bytes_text(b, " %.9g", value);
    else
        bytes_value(b, v->value_bytes == 8 ? TC_F64 : TC_F32, value, v->big);
}

/* Moves the payload into the file, as a record where the encoding has them. */
static inline void put_record(bytes *file, const variant *v, bytes *payload) {
    size_t mark = v->encoding == RECORDS_4 ? 4 : v->encoding == RECORDS_8 ? 8 : 0;
    if (mark) bytes_put(file, payload->size, mark, v->big);
    if (payload->size) bytes_add(file, payload->data, payload->size);
    if (mark) bytes_put(file, payload->size, mark, v->big);
    if (v->encoding == TEXT) bytes_text(file, "\n");
    bytes_free(payload);
}

static inline bytes plot3d_header(const variant *v, int content) {
    bytes file = {0}, record = {0};
    if (v->blocks) {
        put_integer(&record, v, v->blocks);
        put_record(&file, v, &record);
    }
    for (int n = 0; n < block_count(v); n++) {
        for (int a = 0; a < 3; a++) put_integer(&record, v, block_dims[n][a]);
        if (content == FUNCTION) put_integer(&record, v, TEST_VARIABLES);
    }
    if (content == OVERFLOW_5 || content == OVERFLOW_8) {
        put_integer(&record, v, variable_count(content));
        put_integer(&record, v, content == OVERFLOW_8 ? 3 : 0);
    }
    put_record(&file, v, &record);
    return file;
}

static inline bytes grid_file(const variant *v) {
    bytes file = plot3d_header(v, GRID_ONLY), record = {0};
    for (int n = 0; n < block_count(v); n++) {
        for (int a = 0; a < 3; a++)
            for (uint64_t i = 0; i < block_points(n); i++) put_value(&record, v, plot3d_value(v, n, -1 - a, i));
        for (uint64_t i = 0; v->iblank && i < block_points(n); i++) put_integer(&record, v, iblank_value(n, i));
        put_record(&file, v, &record);
    }
    return file;
}

static inline void put_parameters(bytes *file, const variant *v) {
    bytes record = {0};
    int is_overflow = v->content != SOLUTION;
    for (int i = 0; i < (is_overflow ? 7 : 4); i++) put_value(&record, v, 0.5 * i);
    if (is_overflow) put_integer(&record, v, 2);
    for (int i = 0; is_overflow && i < 6 + (v->content == OVERFLOW_8 ? 3 : 2); i++) put_value(&record, v, i + 1);
    put_record(file, v, &record);
}

static inline bytes data_file(const variant *v) {
    bytes file = plot3d_header(v, v->content), record = {0};
    for (int n = 0; n < block_count(v); n++) {
        if (v->content != FUNCTION) put_parameters(&file, v);
        for (int f = 0; f < variable_count(v->content); f++)
            for (uint64_t i = 0; i < block_points(n); i++) put_value(&record, v, plot3d_value(v, n, f, i));
        put_record(&file, v, &record);
    }
    return file;
}

/* second may be NULL. */
static inline int read_plot3d(const char *first, const char *second, dataset *out) {
    read_request request;
    mapping mapped;
    memset(out, 0, sizeof *out);
    read_request_init(&request, first);
    request.path2 = second;
    int status = mapping_open(first, &mapped);
    if (!status) status = plot3d_read(&request, &mapped, out);
    mapping_close(&mapped);
    if (status) dataset_release(out);
    return status;
}

static inline const dataset_field *find_field(const dataset_block *block, const char *name) {
    for (int n = 0; n < block->field_count; n++)
        if (!strcmp(block->fields[n].name, name)) return &block->fields[n];
    return NULL;
}

static inline double field_value(const dataset_field *f, uint64_t i) {
    return f->type == TC_F64 ? ((const double *)f->values)[i] : (double)((const float *)f->values)[i];
}

#endif
