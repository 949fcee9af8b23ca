/* unpack_block.c - see unpack_block.h */
#include "unpack_block.h"

#include "exit_status.h"
#include "failure.h"
#include "unpack.h"

#include <inttypes.h>
#include <string.h>

#ifdef HAVE_LZ4
#include <lz4.h>
#endif
#ifdef HAVE_LZMA
#include <lzma.h>
#endif

enum { LZ4_RATIO = 256, LZMA_RATIO = 8192, LZMA_MEMORY = 1 << 27 };

packing packing_of(const char *compressor) {
    static const char *const names[] = {"vtkZLibDataCompressor", "vtkLZ4DataCompressor", "vtkLZMADataCompressor"};
    for (int n = 0; n < 3; n++)
        if (strcmp(compressor, names[n]) == 0) return (packing)(PACKING_ZLIB + n);
    return PACKING_UNKNOWN;
}

#if !defined(HAVE_LZ4) || !defined(HAVE_LZMA)
static int missing(const char *path, const char *what, const char *option) {
    return fail(STATUS_INPUT,
                "%s: is compressed by %s, which this program was built without; write it with another compressor, or "
                "build with %s=ON",
                path, what, option);
}
#endif

int unpack_block_check(const char *path, packing packed, uint64_t packed_bytes, uint64_t unpacked_bytes) {
#ifndef HAVE_LZ4
    if (packed == PACKING_LZ4) return missing(path, "LZ4", "TETRACUBES_LZ4");
#endif
#ifndef HAVE_LZMA
    if (packed == PACKING_LZMA) return missing(path, "LZMA", "TETRACUBES_LZMA");
#endif
    if (packed == PACKING_ZLIB) return unpack_check(path, ENCODING_DEFLATE, (size_t)packed_bytes, unpacked_bytes);
    return unpack_ratio_check(path, packed_bytes, unpacked_bytes, packed == PACKING_LZ4 ? LZ4_RATIO : LZMA_RATIO);
}

#ifdef HAVE_LZ4
static int unpack_lz4(const char *path, const unsigned char *in, uint64_t in_bytes, unsigned char *out,
                      uint64_t bytes) {
    if (in_bytes > LZ4_MAX_INPUT_SIZE || bytes > LZ4_MAX_INPUT_SIZE)
        return fail(STATUS_INPUT, "%s: has compressed blocks larger than LZ4's, of up to %d bytes; the file is damaged",
                    path, LZ4_MAX_INPUT_SIZE);
    int made = LZ4_decompress_safe_partial((const char *)in, (char *)out, (int)in_bytes, (int)bytes, (int)bytes);
    return made == (int)bytes ? 0 : unpack_damaged(path, "LZ4");
}
#endif

#ifdef HAVE_LZMA
/* Once all bytes are there the stream goes on by one more, so that its end, with its check sum, is seen. */
static lzma_ret decode_lzma(lzma_stream *stream, const unsigned char *in, size_t in_bytes, unsigned char *out,
                            size_t bytes) {
    unsigned char more;
    stream->next_in = in;
    stream->avail_in = in_bytes;
    stream->next_out = out;
    stream->avail_out = bytes;
    lzma_ret code = bytes ? lzma_code(stream, LZMA_FINISH) : LZMA_OK;
    if (code != LZMA_OK || stream->avail_out) return code;
    stream->next_out = &more;
    stream->avail_out = 1;
    code = lzma_code(stream, LZMA_FINISH);
    int is_longer = stream->avail_out == 0;
    stream->next_out = NULL;
    stream->avail_out = 0;
    return is_longer ? LZMA_STREAM_END : code;
}

static int unpack_lzma(const char *path, const unsigned char *in, uint64_t in_bytes, unsigned char *out,
                       uint64_t bytes) {
    lzma_stream stream = LZMA_STREAM_INIT;
    lzma_ret code = lzma_stream_decoder(&stream, LZMA_MEMORY, 0);
    if (code == LZMA_OK) code = decode_lzma(&stream, in, (size_t)in_bytes, out, (size_t)bytes);
    int is_whole = code == LZMA_STREAM_END && !stream.avail_out;
    lzma_end(&stream);
    if (is_whole) return 0;
    if (code == LZMA_MEM_ERROR) return fail(STATUS_FAILED, "liblzma: out of memory");
    if (code == LZMA_MEMLIMIT_ERROR)
        return fail(STATUS_INPUT,
                    "%s: its compressed data asks for a dictionary of more than %d MiB; the file is "
                    "damaged, or write it at a lower level of compression",
                    path, LZMA_MEMORY >> 20);
    return unpack_damaged(
        path, code == LZMA_STREAM_END || code == LZMA_BUF_ERROR || code == LZMA_OK ? "LZMA, it ends early" : "LZMA");
}
#endif

int unpack_block(const char *path, packing packed, const unsigned char *in, uint64_t in_bytes, unsigned char *out,
                 uint64_t bytes) {
    switch (packed) {
#ifdef HAVE_LZ4
    case PACKING_LZ4:
        return unpack_lz4(path, in, in_bytes, out, bytes);
#endif
#ifdef HAVE_LZMA
    case PACKING_LZMA:
        return unpack_lzma(path, in, in_bytes, out, bytes);
#endif
    default:
        return unpack(path, ENCODING_DEFLATE, in, (size_t)in_bytes, 0, out, bytes, NULL);
    }
}
