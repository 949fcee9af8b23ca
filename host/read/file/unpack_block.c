/* unpack_block.c - see unpack_block.h */
#include "file/unpack_block.h"

#include "file/libraries.h"
#include "file/unpack.h"
#include "file/unpackers.h"

#include <string.h>

enum { LZ4_RATIO = 256, LZMA_RATIO = 8192 };

static int unpack_zlib(const char *path, const unsigned char *in, uint64_t in_bytes, unsigned char *out,
                       uint64_t bytes) {
    return unpack(path, ENCODING_DEFLATE, in, (size_t)in_bytes, 0, out, bytes, NULL);
}

/* VTK's compressors. For zlib, unpack.h has the library and the limit. */
static const struct {
    const char *compressor;
    enum library library;
    const char *is;
    uint64_t limit; /* so many unpacked bytes to a packed one, at most */
    int (*unpack)(const char *path, const unsigned char *in, uint64_t in_bytes, unsigned char *out, uint64_t bytes);
} packings[] = {
    [PACKING_ZLIB] = {"vtkZLibDataCompressor", LIBRARY_ZLIB, NULL, 0, unpack_zlib},
    [PACKING_LZ4] = {"vtkLZ4DataCompressor", LIBRARY_LZ4, "is compressed by LZ4", LZ4_RATIO,
                     IF_BUILT(HAVE_LZ4, unpack_lz4)},
    [PACKING_LZMA] = {"vtkLZMADataCompressor", LIBRARY_LZMA, "is compressed by LZMA", LZMA_RATIO,
                      IF_BUILT(HAVE_LZMA, unpack_lzma)},
};

packing packing_of(const char *compressor) {
    for (int n = PACKING_ZLIB; n <= PACKING_LZMA; n++)
        if (strcmp(compressor, packings[n].compressor) == 0) return (packing)n;
    return PACKING_UNKNOWN;
}

int unpack_block_check(const char *path, packing packed, uint64_t packed_bytes, uint64_t unpacked_bytes) {
    if (packed == PACKING_ZLIB) return unpack_check(path, ENCODING_DEFLATE, (size_t)packed_bytes, unpacked_bytes);
    if (!packings[packed].unpack)
        return library_fail(packings[packed].library, path, packings[packed].is, "write it with another compressor");
    return unpack_ratio_check(path, packed_bytes, unpacked_bytes, packings[packed].limit);
}

int unpack_block(const char *path, packing packed, const unsigned char *in, uint64_t in_bytes, unsigned char *out,
                 uint64_t bytes) {
    return packings[packed].unpack(path, in, in_bytes, out, bytes);
}
