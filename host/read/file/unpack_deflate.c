/* unpack_deflate.c - gzip and zlib streams, through zlib */
#include "file/unpackers.h"

#include "exit_status.h"
#include "failure.h"

#include <zlib.h>

int inflate_stream(const char *path, const unsigned char *in, size_t in_bytes, target *t, uint64_t wanted) {
    z_stream stream = {0};
    if (inflateInit2(&stream, 15 + 32) != Z_OK) return fail(STATUS_FAILED, "zlib: out of memory");
    int status = 0;
    size_t left = in_bytes;
    stream.next_in = (Bytef *)(uintptr_t)in;
    for (;;) {
        uint64_t capacity;
        stream.next_out = target_space(t, &capacity);
        stream.avail_out = (uInt)capacity;
        uInt given = left < UNPACK_CHUNK ? (uInt)left : UNPACK_CHUNK;
        stream.avail_in = given;
        int code = inflate(&stream, Z_NO_FLUSH);
        left -= given - stream.avail_in;
        if (target_took(t, capacity - stream.avail_out)) break;
        if (code == Z_STREAM_END) {
            int another = left > 2 && stream.next_in[0] == 0x1f && stream.next_in[1] == 0x8b;
            if (!t->skip && !t->bytes && !another) break;
            if (another && inflateReset(&stream) == Z_OK) continue;
            status = stream_ended(path, t, wanted);
            break;
        }
        if (code == Z_MEM_ERROR)
            status = fail(STATUS_FAILED, "zlib: out of memory");
        else if (code == Z_BUF_ERROR && !left)
            status = t->is_counted ? unpack_damaged(path, "it is cut")
                                   : stream_ends_early(path, wanted - t->bytes - t->skip, wanted);
        else if (code != Z_OK)
            status = unpack_damaged(path, stream.msg ? stream.msg : "zlib");
        if (status) break;
    }
    inflateEnd(&stream);
    return status;
}
