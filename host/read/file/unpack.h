/*
 * unpack.h - gzip, zlib and bzip2 streams whose unpacked size is known from a header
 *
 * Before memory is taken, the size that the header declares is compared with what the packed bytes can hold at most.
 * For deflate the ratio is 1,032 : 1, as two bits give at most 258 bytes. For bzip2 it is 2,000,000 : 1, as a block of
 * at least 193 bits gives at most 51 x 900,000 bytes; libbz2 itself packs a constant volume 1,368,000 : 1. So even a
 * small file may be right to ask for much memory: where more than 50,000 : 1 is declared, the stream is unpacked once
 * to be counted, before memory is taken.
 */
#ifndef UNPACK_H
#define UNPACK_H

#include <stddef.h>
#include <stdint.h>

typedef enum encoding { ENCODING_RAW, ENCODING_TEXT, ENCODING_HEX, ENCODING_DEFLATE, ENCODING_BZIP2 } encoding;

/* STATUS_INPUT where so many packed bytes cannot hold so many unpacked ones, or this program lacks the library. */
int unpack_check(const char *path, encoding packed, size_t packed_bytes, uint64_t unpacked_bytes);

/* STATUS_INPUT where there are more than `most` unpacked bytes to a packed one. */
int unpack_ratio_check(const char *path, uint64_t packed_bytes, uint64_t unpacked_bytes, uint64_t most);

/* Unpacks, drops the first skip bytes and writes the next `bytes` to out; *more, where given, tells whether the stream
 * holds more than that. Several members one after another count as one stream. STATUS_INPUT where the stream is damaged
 * or ends early. */
int unpack(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, uint64_t skip, void *out,
           uint64_t bytes, int *more);

/* *unpacked: how many bytes the stream gives; counting ends at `most`. STATUS_INPUT where it is damaged or cut before.
 */
int unpack_count(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, uint64_t most,
                 uint64_t *unpacked);

/* unpack_check; where the ratio is doubtful, the stream is counted, too: STATUS_INPUT where it gives fewer bytes. */
int unpack_prove(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, uint64_t unpacked_bytes);

#endif
