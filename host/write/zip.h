/*
 * zip.h - a zip archive of arrays that are stored as they are
 *
 * Source: ".ZIP File Format Specification", PKWARE. Sizes and offsets are of 64 bits throughout (zip64), and times are
 * those of no clock, so that the same arrays give the same bytes. A check sum stands in front of its data: records that
 * have to be encoded are encoded twice.
 */
#ifndef ZIP_H
#define ZIP_H

#include "shown_records.h"

enum { ZIP_NAME_MOST = 160 };

typedef struct zip_member {
    char name[ZIP_NAME_MOST];
    uint64_t bytes, offset;
    uint32_t check_sum;
} zip_member;

typedef struct zip_file {
    output *o;
    zip_member *members; /* with room for all that will be added */
    int count;
    uint64_t bytes; /* of what was written */
} zip_file;

/* Adds a file of a header and records. */
void zip_add(zip_file *z, const char *name, const void *header, size_t header_bytes, const record_array *records);

/* Writes the list of all that was added. */
void zip_finish(zip_file *z);

/* The check sum of bytes behind those that `before` is of, which is 0 in front of all. */
uint32_t zip_check_sum(uint32_t before, const void *data, size_t bytes);

#endif
