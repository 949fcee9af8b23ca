/* unpack.c - gzip, zlib and bzip2 streams of known size; see unpack.h */
#include "file/unpack.h"

#include "exit_status.h"
#include "failure.h"
#include "file/libraries.h"
#include "file/unpackers.h"

#include <inttypes.h>

enum { DEFLATE_LIMIT = 1032, BZIP2_LIMIT = 2000000, DOUBTFUL_FROM = 50000 };

/* Of the encodings that pack. */
static const struct {
    enum library library;
    const char *holds;
    uint64_t limit; /* so many unpacked bytes to a packed one, at most */
    int (*unpack)(const char *path, const unsigned char *in, size_t in_bytes, target *t, uint64_t wanted);
} packers[] = {
    [ENCODING_DEFLATE] = {LIBRARY_ZLIB, "holds gzip or zlib data", DEFLATE_LIMIT, IF_BUILT(HAVE_ZLIB, inflate_stream)},
    [ENCODING_BZIP2] = {LIBRARY_BZIP2, "holds bzip2 data", BZIP2_LIMIT, IF_BUILT(HAVE_BZIP2, bunzip_stream)},
};

int unpack_check(const char *path, encoding packed, size_t packed_bytes, uint64_t unpacked_bytes) {
    if (!packers[packed].unpack) return library_fail(packers[packed].library, path, packers[packed].holds, "unpack it");
    return unpack_ratio_check(path, packed_bytes, unpacked_bytes, packers[packed].limit);
}

int unpack_ratio_check(const char *path, uint64_t packed_bytes, uint64_t unpacked_bytes, uint64_t most) {
    if (unpacked_bytes / most <= packed_bytes && packed_bytes) return 0;
    return fail(STATUS_INPUT,
                "%s: declares %" PRIu64 " bytes, but its %" PRIu64 " compressed bytes cannot hold more than %" PRIu64
                " times as many; the header is wrong or the file is cut (or store it uncompressed)",
                path, unpacked_bytes, packed_bytes, most);
}

int unpack(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, uint64_t skip, void *out,
           uint64_t bytes, int *more) {
    uint64_t wanted;
    if (more) *more = 0;
    if (__builtin_add_overflow(skip, bytes, &wanted))
        return fail(STATUS_INPUT, "%s: asks to skip %" PRIu64 " bytes; the header is damaged", path, skip);
    int status = unpack_check(path, packed, in_bytes, wanted);
    if (status) return status;
    target t;
    t.out = out;
    t.skip = skip;
    t.bytes = bytes;
    t.more = t.is_counted = 0;
    status = packers[packed].unpack(path, in, in_bytes, &t, wanted);
    if (more) *more = t.more;
    return status;
}

int unpack_count(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, uint64_t most,
                 uint64_t *unpacked) {
    int status = unpack_check(path, packed, in_bytes, 0);
    if (status) return status;
    target t;
    t.out = NULL;
    t.skip = most;
    t.bytes = 0;
    t.more = 0;
    t.is_counted = 1;
    status = packers[packed].unpack(path, in, in_bytes, &t, most);
    *unpacked = most - t.skip;
    return status;
}

int unpack_prove(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, uint64_t unpacked_bytes) {
    uint64_t gives = 0;
    int status = unpack_check(path, packed, in_bytes, unpacked_bytes);
    if (status || unpacked_bytes / DOUBTFUL_FROM <= in_bytes) return status;
    status = unpack_count(path, packed, in, in_bytes, unpacked_bytes, &gives);
    if (status || gives == unpacked_bytes) return status;
    return stream_ends_early(path, gives, unpacked_bytes);
}
