/* zip.c - a zip archive of stored arrays; see zip.h */
#include "zip.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>

enum { VERSION = 45, UNIX_FILE = 3 << 8, READ_WRITE = 0100600, ZIP64 = 1, FIRST_DAY = 1 << 5 | 1, SLICES = 8 };

/* ------------------------------------------------------------------------------------------------------- check sum */

static uint32_t tables[SLICES][256];

static void make_tables(void) {
    for (uint32_t n = 0; n < 256; n++) {
        uint32_t c = n;
        for (int bit = 0; bit < 8; bit++) c = c & 1 ? 0xedb88320u ^ c >> 1 : c >> 1;
        tables[0][n] = c;
    }
    for (int n = 0; n < 256; n++)
        for (int slice = 1; slice < SLICES; slice++)
            tables[slice][n] = tables[slice - 1][n] >> 8 ^ tables[0][tables[slice - 1][n] & 255];
}

/* Eight bytes at a time. */
uint32_t zip_check_sum(uint32_t before, const void *data, size_t bytes) {
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    const unsigned char *at = data;
    uint32_t c = ~before;
    pthread_once(&once, make_tables);
    for (; bytes >= SLICES; bytes -= SLICES, at += SLICES) {
        uint64_t next;
        memcpy(&next, at, sizeof next);
        next ^= c;
        c = 0;
        for (int slice = 0; slice < SLICES; slice++) c ^= tables[SLICES - 1 - slice][next >> 8 * slice & 255];
    }
    for (; bytes; bytes--, at++) c = tables[0][(c ^ *at) & 255] ^ c >> 8;
    return ~c;
}

/* The same of records, encoded block by block where they do not lie in memory. */
static uint32_t sum_records(zip_file *z, uint32_t before, const record_array *r) {
    if (!r->encode) return zip_check_sum(before, r->source, record_array_bytes(r));
    const uint64_t block = OUTPUT_BLOCK / r->record_bytes;
    unsigned char *encoded = malloc(OUTPUT_BLOCK);
    if (!encoded) z->o->error = ENOMEM;
    for (uint64_t first = 0; first < r->span.count && encoded && !z->o->error; first += block) {
        const uint64_t end = r->span.count - first < block ? r->span.count : first + block;
        before = zip_check_sum(before, encoded, (size_t)(r->encode(r->source, first, end, encoded) - encoded));
    }
    free(encoded);
    return before;
}

/* --------------------------------------------------------------------------------------------------------- structs */

/* Numbers of the archive's own structs, one after the other. */
typedef struct zip_text {
    unsigned char bytes[64 + ZIP_NAME_MOST];
    size_t length;
} zip_text;

static void put(zip_text *t, uint64_t value, size_t bytes) {
    memcpy(t->bytes + t->length, &value, bytes);
    t->length += bytes;
}

static void put_name(zip_text *t, const char *name) {
    const size_t length = strlen(name);
    memcpy(t->bytes + t->length, name, length);
    t->length += length;
}

static void put_struct(zip_file *z, const zip_text *t) {
    output_bytes(z->o, t->bytes, t->length);
    z->bytes += t->length;
}

/* What both headers of a file have: flags, method 0, time and date, check sum, and for both sizes that they stand in
 * the field of 64-bit numbers. */
static void put_common(zip_text *t, const zip_member *m, size_t extra_bytes) {
    put(t, 0, 2);
    put(t, 0, 2);
    put(t, 0, 2);
    put(t, FIRST_DAY, 2);
    put(t, m->check_sum, 4);
    put(t, UINT32_MAX, 4);
    put(t, UINT32_MAX, 4);
    put(t, strlen(m->name), 2);
    put(t, extra_bytes, 2);
}

static void put_local_header(zip_file *z, const zip_member *m) {
    zip_text t = {.length = 0};
    put(&t, 0x04034b50, 4);
    put(&t, VERSION, 2);
    put_common(&t, m, 20);
    put_name(&t, m->name);
    put(&t, ZIP64, 2);
    put(&t, 16, 2);
    put(&t, m->bytes, 8);
    put(&t, m->bytes, 8);
    put_struct(z, &t);
}

static void put_central_header(zip_file *z, const zip_member *m) {
    zip_text t = {.length = 0};
    put(&t, 0x02014b50, 4);
    put(&t, VERSION | UNIX_FILE, 2);
    put(&t, VERSION, 2);
    put_common(&t, m, 28);
    put(&t, 0, 2); /* comment, disk, attributes */
    put(&t, 0, 2);
    put(&t, 0, 2);
    put(&t, (uint64_t)READ_WRITE << 16, 4);
    put(&t, UINT32_MAX, 4);
    put_name(&t, m->name);
    put(&t, ZIP64, 2);
    put(&t, 24, 2);
    put(&t, m->bytes, 8);
    put(&t, m->bytes, 8);
    put(&t, m->offset, 8);
    put_struct(z, &t);
}

void zip_add(zip_file *z, const char *name, const void *header, size_t header_bytes, const record_array *records) {
    zip_member *m = &z->members[z->count++];
    *m = (zip_member){.bytes = header_bytes + record_array_bytes(records), .offset = z->bytes};
    memcpy(m->name, name, strnlen(name, ZIP_NAME_MOST - 1));
    m->check_sum = sum_records(z, zip_check_sum(0, header, header_bytes), records);
    put_local_header(z, m);
    output_bytes(z->o, header, header_bytes);
    write_records(z->o, records);
    z->bytes += m->bytes;
}

void zip_finish(zip_file *z) {
    const uint64_t list = z->bytes;
    for (int n = 0; n < z->count; n++) put_central_header(z, &z->members[n]);
    const uint64_t end = z->bytes, count = (uint64_t)z->count;
    zip_text t = {.length = 0};
    put(&t, 0x06064b50, 4); /* the end in 64 bits */
    put(&t, 44, 8);
    put(&t, VERSION | UNIX_FILE, 2);
    put(&t, VERSION, 2);
    put(&t, 0, 8);
    put(&t, count, 8);
    put(&t, count, 8);
    put(&t, end - list, 8);
    put(&t, list, 8);
    put_struct(z, &t);
    t.length = 0;
    put(&t, 0x07064b50, 4); /* where that is */
    put(&t, 0, 4);
    put(&t, end, 8);
    put(&t, 1, 4);
    put(&t, 0x06054b50, 4); /* the end, whose numbers stand there */
    put(&t, 0, 4);
    put(&t, UINT16_MAX, 2);
    put(&t, UINT16_MAX, 2);
    put(&t, UINT32_MAX, 4);
    put(&t, UINT32_MAX, 4);
    put(&t, 0, 2);
    put_struct(z, &t);
}
