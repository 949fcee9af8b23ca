/*
 * vtk_hdf_array.c - rows of an array of a VTKHDF file; see vtk_hdf_array.h
 *
 * Arrays that lie in the file in one piece are used there where they can be; chunks are unpacked whole.
 */
#define H5_USE_110_API

#include "vtk_hdf/vtk_hdf_array.h"

#include "dataset/layout.h"
#include "exit_status.h"
#include "failure.h"
#include "file/unpack.h"
#include "stored_types.h"

#include <inttypes.h>
#include <string.h>

/* So many bytes of values to a stored one, as of images: chunks that were never written are zeros. And how often bytes
 * of the file may be taken, as an array may have several names. */
enum { RATIO_MOST = 50000, SHARED_MOST = 16 };

static int is_cut(const hdf_reader *r, const char *name) {
    return fail(STATUS_INPUT, "%s: its array '%.100s' ends behind the end of the file, which is damaged or cut",
                r->h.path, name);
}

/* What lies in the file in one piece. */
static int load_plain(hdf_reader *r, const char *name, uint64_t skip, uint64_t bytes, const void **values) {
    const size_t size = element_bytes(r->h.element);
    uint64_t end;
    if (__builtin_add_overflow(r->h.start, skip, &skip) || __builtin_add_overflow(skip, bytes, &end) ||
        end > r->file.size)
        return is_cut(r, name);
    const unsigned char *at = r->file.bytes + skip;
    if ((!r->h.is_swapped || size == 1) && (uintptr_t)at % size == 0) {
        r->uses_file = 1;
        *values = at;
        return 0;
    }
    void *memory = dataset_allocate(r->out, bytes);
    *values = memory;
    if (!memory) return STATUS_FAILED;
    memcpy(memory, at, (size_t)bytes);
    return 0;
}

static int load_whole(hdf_reader *r, uint64_t all, uint64_t skip, const void **values) {
    int status = unpack_ratio_check(r->h.path, r->h.stored_bytes, all, RATIO_MOST);
    unsigned char *memory = status ? NULL : dataset_allocate(r->out, all);
    if (!memory) return status ? status : STATUS_FAILED;
    *values = memory + skip;
    return hdf5_load(&r->h, memory);
}

static int swap_bytes(const hdf_reader *r, hdf_values *v, uint64_t count) {
    layout swap = {.element = (int)element_sample_type(r->h.element), /* of 64-bit integers the bytes alone */
                   .swapped = 1,
                   .dims = {(int64_t)count, 1, 1},
                   .stride = {1, 0, 0}};
    void *values = (void *)(uintptr_t)v->values; /* memory of the dataset: what is swapped is never used in place */
    return layout_gather(r->h.path, &swap, values, values);
}

static int check_rows(const hdf_reader *r, const char *name, const hdf_rows *rows, hdf_values *out) {
    const hdf5_file *h = &r->h;
    if (h->dimension > 2 || (h->dimension == 2 && (h->shape[1] < 1 || h->shape[1] > INT32_MAX)))
        return fail(STATUS_INPUT, "%s: its array '%.100s' has not one row of values for each point or cell", h->path,
                    name);
    *out = (hdf_values){.rows = rows->count < 0 ? h->shape[0] : rows->count,
                        .components = h->dimension == 2 ? (int)h->shape[1] : 1,
                        .element = h->element};
    if (rows->first < 0 || rows->first > h->shape[0] || out->rows > h->shape[0] - rows->first)
        return fail(STATUS_INPUT,
                    "%s: its array '%.100s' has %" PRId64 " rows, but those from %" PRId64 " on are needed, %" PRId64
                    " of them; the file is damaged",
                    h->path, name, h->shape[0], rows->first, out->rows);
    return 0;
}

int hdf_load(hdf_reader *r, const char *name, hdf_rows rows, hdf_values *out) {
    int status = hdf5_open_array(&r->h, name);
    if (!status) status = check_rows(r, name, &rows, out);
    if (status) return status;
    uint64_t row = element_bytes(r->h.element) * (uint64_t)out->components, all, bytes = row * (uint64_t)out->rows;
    if (__builtin_mul_overflow(row, (uint64_t)r->h.shape[0], &all) || all > INT64_MAX / 8) return is_cut(r, name);
    if (!out->rows) {
        out->values = dataset_allocate(r->out, 1);
        return out->values ? 0 : STATUS_FAILED;
    }
    if (!r->h.stored_bytes) return fail(STATUS_INPUT, "%s: its array '%.100s' was never written", r->h.path, name);
    const uint64_t skip = row * (uint64_t)rows.first;
    r->taken += r->h.layout == H5D_CONTIGUOUS ? bytes : r->h.stored_bytes;
    if (r->taken / SHARED_MOST > r->file.size)
        return fail(STATUS_INPUT, "%s: too many arrays share the same data; the file is damaged", r->h.path);
    status = r->h.layout == H5D_CONTIGUOUS ? load_plain(r, name, skip, bytes, &out->values)
                                           : load_whole(r, all, skip, &out->values);
    if (!status && r->h.is_swapped && element_bytes(r->h.element) > 1)
        status = swap_bytes(r, out, (uint64_t)out->rows * (uint64_t)out->components);
    return status;
}

#define TO_INTEGER(type, name, c_type, ...)                                                                            \
    case type:                                                                                                         \
        for (int64_t n = 0; n < count; n++) to[n] = (int64_t)((const c_type *)from)[n];                                \
        break;

static void to_integers(int64_t *to, const void *from, int64_t count, int element) {
    switch (element) { STORED_INTEGERS(TO_INTEGER) }
}

int hdf_load_integers(hdf_reader *r, const char *name, hdf_rows rows, const int64_t **values, int64_t *count) {
    hdf_values v;
    int status = hdf_load(r, name, rows, &v);
    if (status) return status;
    if (v.components != 1 || element_is_real(v.element))
        return fail(STATUS_INPUT, "%s: its array '%.100s' is not of single integers", r->h.path, name);
    *count = v.rows;
    *values = v.values;
    if (v.element == ELEMENT_I64) return 0;
    int64_t *memory = dataset_allocate(r->out, (uint64_t)v.rows * sizeof *memory);
    *values = memory;
    if (!memory) return STATUS_FAILED;
    to_integers(memory, v.values, v.rows, v.element);
    return 0;
}
