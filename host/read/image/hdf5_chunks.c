/*
 * hdf5_chunks.c - the chunks of a dataset; see hdf5_file.h
 *
 * libhdf5 finds each chunk and gives the bytes that are stored. What filters have done to them is undone here: its own
 * way trusts sizes in the file, and crashes where they are wrong. Chunks that were never written hold the fill value.
 */
#define H5_USE_110_API

#include "exit_status.h"
#include "failure.h"
#include "file/unpack.h"
#include "image/hdf5_file.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILTERS_MOST = 8, SUM_BYTES = 4, DEFLATE_MOST = 1032 };

typedef struct chunks {
    const hdf5_file *h;
    hsize_t shape[ARRAY_AXES_MOST], size[ARRAY_AXES_MOST]; /* of the array and of a chunk */
    uint64_t element, bytes;                               /* of an element, and of a whole chunk unpacked */
    H5Z_filter_t filters[FILTERS_MOST];
    int filter_count;
    unsigned char fill[8];
    unsigned char *stored, *whole; /* two buffers that filters go to and fro between */
    uint64_t capacity;             /* of each */
} chunks;

static int damaged(const chunks *c) {
    return fail(STATUS_INPUT, "%s: has a chunk of samples that cannot be read; it is damaged or cut", c->h->path);
}

static int read_filters(chunks *c, hid_t plan) {
    c->filter_count = H5Pget_nfilters(plan);
    for (int n = 0; n < c->filter_count; n++) {
        unsigned flags, more, values[8];
        size_t count = sizeof values / sizeof *values;
        const H5Z_filter_t filter =
            n < FILTERS_MOST ? H5Pget_filter2(plan, (unsigned)n, &flags, &count, values, 0, NULL, &more) : -1;
        if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
            return fail(STATUS_INPUT,
                        "%s: its samples went through filter %d, which cannot be read; gzip, shuffle and fletcher32 "
                        "can: h5repack -f GZIP=6",
                        c->h->path, (int)filter);
        c->filters[n] = filter;
    }
    return 0;
}

/* A chunk may be larger than the array; no file may make it larger than its bytes can hold. */
static int read_plan(chunks *c) {
    const hdf5_file *h = c->h;
    const hid_t plan = H5Dget_create_plist(h->dataset), type = H5Dget_type(h->dataset);
    int status = plan < 0 || type < 0 || H5Pget_chunk(plan, h->dimension, c->size) != h->dimension ? damaged(c) : 0;
    H5D_fill_value_t has_fill = H5D_FILL_VALUE_UNDEFINED;
    if (!status && H5Pfill_value_defined(plan, &has_fill) >= 0 && has_fill == H5D_FILL_VALUE_USER_DEFINED)
        H5Pget_fill_value(plan, type, c->fill);
    if (!status) status = read_filters(c, plan);
    if (plan >= 0) H5Pclose(plan);
    if (type >= 0) H5Tclose(type);
    c->bytes = c->element = element_bytes(h->element);
    for (int axis = 0; axis < h->dimension && !status; axis++)
        if (!c->size[axis] || __builtin_mul_overflow(c->bytes, c->size[axis], &c->bytes)) status = damaged(c);
    if (!status) status = unpack_ratio_check(h->path, h->stored_bytes, c->bytes, DEFLATE_MOST);
    return status;
}

/* Undoes one filter; *bytes: of what is in c->stored before and behind. */
static int undo_filter(chunks *c, int n, uint64_t *bytes, uint64_t wanted) {
    const uint64_t count = *bytes / c->element, rest = *bytes % c->element;
    int more, status;
    switch (c->filters[n]) {
    case H5Z_FILTER_FLETCHER32:
        if (*bytes < SUM_BYTES) return damaged(c);
        *bytes -= SUM_BYTES;
        return 0;
    case H5Z_FILTER_SHUFFLE:
        for (uint64_t b = 0; b < c->element; b++)
            for (uint64_t k = 0; k < count; k++) c->whole[k * c->element + b] = c->stored[b * count + k];
        memcpy(c->whole + count * c->element, c->stored + count * c->element, rest);
        break;
    default:
        status = unpack(c->h->path, ENCODING_DEFLATE, c->stored, *bytes, 0, c->whole, wanted, &more);
        if (status) return status;
        *bytes = wanted;
    }
    unsigned char *swap = c->stored;
    c->stored = c->whole;
    c->whole = swap;
    return 0;
}

/* The filters in the order in which they were not done; a bit of the mask says that one was left out. */
static int undo_filters(chunks *c, uint64_t bytes, uint32_t mask) {
    int status = 0;
    for (int n = c->filter_count - 1; n >= 0 && !status; n--) {
        uint64_t wanted = c->bytes;
        for (int before = 0; before < n; before++)
            if (c->filters[before] == H5Z_FILTER_FLETCHER32 && !(mask >> before & 1)) wanted += SUM_BYTES;
        if (!(mask >> n & 1)) status = undo_filter(c, n, &bytes, wanted);
    }
    return status || bytes == c->bytes ? status : damaged(c);
}

static int take_chunk(chunks *c, const hsize_t *at) {
    hsize_t bytes = 0;
    uint32_t mask = 0;
    haddr_t address = HADDR_UNDEF;
    if (H5Dget_chunk_info_by_coord(c->h->dataset, at, &mask, &address, &bytes) < 0) return damaged(c);
    if (address == HADDR_UNDEF) {
        for (uint64_t n = 0; n < c->bytes; n += c->element) memcpy(c->stored + n, c->fill, c->element);
        return 0;
    }
    if (bytes > c->capacity || H5Dread_chunk(c->h->dataset, H5P_DEFAULT, at, &mask, c->stored) < 0) return damaged(c);
    return undo_filters(c, bytes, mask);
}

/* Copies what of the chunk lies in the array, run by run along the last axis. */
static void put_chunk(const chunks *c, const hsize_t *at, unsigned char *to) {
    const int last = c->h->dimension - 1;
    hsize_t run[ARRAY_AXES_MOST] = {0};
    const hsize_t left = c->shape[last] - at[last], kept = left < c->size[last] ? left : c->size[last];
    for (int axis = last; axis >= 0;) {
        uint64_t from = 0, target = 0;
        for (int a = 0; a <= last; a++) {
            from = from * c->size[a] + (a == last ? 0 : run[a]);
            target = target * c->shape[a] + at[a] + (a == last ? 0 : run[a]);
        }
        memcpy(to + target * c->element, c->stored + from * c->element, kept * c->element);
        for (axis = last - 1; axis >= 0; run[axis--] = 0)
            if (++run[axis] < c->size[axis] && at[axis] + run[axis] < c->shape[axis]) break;
    }
}

int hdf5_load_chunks(const hdf5_file *h, unsigned char *to) {
    chunks c = {.h = h};
    hsize_t at[ARRAY_AXES_MOST] = {0};
    int status = read_plan(&c);
    for (int axis = 0; axis < h->dimension; axis++) c.shape[axis] = (hsize_t)h->shape[axis];
    if (status) return status;
    c.capacity = c.bytes + c.bytes / 8 + 4096; /* what does not pack well becomes a little larger */
    c.stored = malloc(c.capacity);
    c.whole = malloc(c.capacity);
    if (!c.stored || !c.whole)
        status = fail(STATUS_FAILED, "%s: no memory for a chunk of %" PRIu64 " bytes", h->path, c.bytes);
    for (int axis = 0; axis >= 0 && !status;) {
        if (!(status = take_chunk(&c, at))) put_chunk(&c, at, to);
        for (axis = h->dimension - 1; axis >= 0; at[axis--] = 0)
            if ((at[axis] += c.size[axis]) < c.shape[axis]) break;
    }
    free(c.stored);
    free(c.whole);
    return status;
}
