/* unpack_lzma.c - xz streams of LZMA2, through liblzma */
#include "file/unpackers.h"

#include "exit_status.h"
#include "failure.h"

#include <lzma.h>

enum { LZMA_MEMORY = 1 << 27 };

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

int unpack_lzma(const char *path, const unsigned char *in, uint64_t in_bytes, unsigned char *out, uint64_t bytes) {
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
