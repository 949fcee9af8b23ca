/* unpack_bzip2.c - bzip2 streams, through libbz2 */
#include "file/unpackers.h"

#include "exit_status.h"
#include "failure.h"

#include <bzlib.h>

int bunzip_stream(const char *path, const unsigned char *in, size_t in_bytes, target *t, uint64_t wanted) {
    bz_stream stream = {0};
    if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return fail(STATUS_FAILED, "bzip2: out of memory");
    int status = 0;
    size_t left = in_bytes;
    stream.next_in = (char *)(uintptr_t)in;
    for (;;) {
        uint64_t capacity;
        stream.next_out = (char *)target_space(t, &capacity);
        stream.avail_out = (unsigned)capacity;
        unsigned given = left < UNPACK_CHUNK ? (unsigned)left : UNPACK_CHUNK;
        stream.avail_in = given;
        int code = BZ2_bzDecompress(&stream);
        unsigned used = given - stream.avail_in;
        uint64_t came = capacity - stream.avail_out;
        left -= used;
        if (target_took(t, came)) break;
        if (code == BZ_STREAM_END) {
            if (!t->skip && !t->bytes) break;
            char *rest = stream.next_in;
            BZ2_bzDecompressEnd(&stream);
            stream = (bz_stream){0};
            if (left < 4) return stream_ended(path, t, wanted);
            if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return fail(STATUS_FAILED, "bzip2: out of memory");
            stream.next_in = rest;
            continue;
        }
        if (code == BZ_MEM_ERROR)
            status = fail(STATUS_FAILED, "bzip2: out of memory");
        else if (code != BZ_OK)
            status = unpack_damaged(path, "bzip2");
        else if (!left && !used && !came)
            status = stream_ends_early(path, wanted - t->bytes - t->skip, wanted);
        if (status) break;
    }
    BZ2_bzDecompressEnd(&stream);
    return status;
}
