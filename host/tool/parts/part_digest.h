/*
 * part_digest.h - what tells that a part's file is as it was written
 *
 * XXH64 of each array by itself, as pieces come array by array, and then of the header and these.
 */
#ifndef PART_DIGEST_H
#define PART_DIGEST_H

#include "part_header.h"

typedef struct part_digest part_digest;

/* NULL, with the message of STATUS_FAILED, without memory. */
part_digest *part_digest_begin(const part_layout *l);

/* The next bytes of an array. */
void part_digest_add(part_digest *d, int array, const void *bytes, size_t size);

/* The line that ends the file, PART_DIGEST_BYTES of them and a zero. */
void part_digest_line(const part_digest *d, const void *header, size_t header_bytes, char line[PART_DIGEST_BYTES + 1]);

/* Accepts NULL. */
void part_digest_free(part_digest *d);

#endif
