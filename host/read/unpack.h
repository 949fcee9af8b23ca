/*
 * unpack.h - gzip, zlib and bzip2 streams whose unpacked size is known from a header
 *
 * Before memory is taken, the size that the header declares is compared with what so many packed bytes can hold.
 * Deflate cannot pack better than 1,032 : 1. bzip2 packs constant data almost without bound, so its limit, 50,000 : 1,
 * is a choice: far above any measured volume, low enough that a small file cannot ask for much memory.
 */
#ifndef UNPACK_H
#define UNPACK_H

#include <stddef.h>
#include <stdint.h>

typedef enum encoding { ENCODING_RAW, ENCODING_TEXT, ENCODING_DEFLATE, ENCODING_BZIP2 } encoding;

/* STATUS_INPUT where so many packed bytes cannot hold so many unpacked ones, or this program lacks the library. */
int unpack_check(const char *path, encoding packed, size_t packed_bytes, uint64_t unpacked_bytes);

/* Unpacks, drops the first skip bytes and writes the next `bytes` to out; *more, where given, tells whether the stream
 * holds more than that. Several members one after another count as one stream. STATUS_INPUT where the stream is damaged
 * or ends early. */
int unpack(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, uint64_t skip, void *out,
           uint64_t bytes, int *more);

#endif
