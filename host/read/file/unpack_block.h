/*
 * unpack_block.h - single compressed blocks of VTK XML files: zlib streams, raw LZ4 blocks, xz streams of LZMA2
 *
 * As with unpack.h, a size that so many packed bytes cannot reach is refused before memory is taken: LZ4 packs no
 * better than 255 : 1, LZMA2 no better than about 7,050 : 1 (14 bits of the least probability, 1/46 bit each, for a
 * repeated match of 273 bytes). The dictionary that an xz stream asks for is bounded.
 */
#ifndef UNPACK_BLOCK_H
#define UNPACK_BLOCK_H

#include <stddef.h>
#include <stdint.h>

typedef enum packing { PACKING_UNKNOWN, PACKING_ZLIB, PACKING_LZ4, PACKING_LZMA } packing;

/* Of a compressor as VTK names it. */
packing packing_of(const char *compressor);

/* STATUS_INPUT where so many packed bytes cannot hold so many unpacked ones, or this program lacks the library. */
int unpack_block_check(const char *path, packing packed, uint64_t packed_bytes, uint64_t unpacked_bytes);

/* Writes the first `bytes` of what the block holds. STATUS_INPUT where it is damaged or holds fewer. */
int unpack_block(const char *path, packing packed, const unsigned char *in, uint64_t in_bytes, unsigned char *out,
                 uint64_t bytes);

#endif
