/* unpack.c - gzip, zlib and bzip2 streams of known size, through zlib and libbz2; see unpack.h */
#include "unpack.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>

#ifdef HAVE_ZLIB
#include <zlib.h>
#endif
#ifdef HAVE_BZIP2
#include <bzlib.h>
#endif

enum { DEFLATE_LIMIT = 1032, BZIP2_LIMIT = 2000000, DOUBTFUL_FROM = 50000, CHUNK = 1 << 30 };

#if !defined(HAVE_ZLIB) || !defined(HAVE_BZIP2)
static int missing(const char *path, const char *what, const char *option) {
    return fail(STATUS_INPUT, "%s: holds %s data, which this program was built without; unpack it, or build with %s=ON",
                path, what, option);
}
#endif

int unpack_check(const char *path, encoding packed, size_t packed_bytes, uint64_t unpacked_bytes) {
#ifndef HAVE_ZLIB
    if (packed == ENCODING_DEFLATE) return missing(path, "gzip or zlib", "TETRACUBES_ZLIB");
#endif
#ifndef HAVE_BZIP2
    if (packed == ENCODING_BZIP2) return missing(path, "bzip2", "TETRACUBES_BZIP2");
#endif
    return unpack_ratio_check(path, packed_bytes, unpacked_bytes,
                              packed == ENCODING_DEFLATE ? DEFLATE_LIMIT : BZIP2_LIMIT);
}

int unpack_ratio_check(const char *path, uint64_t packed_bytes, uint64_t unpacked_bytes, uint64_t most) {
    if (unpacked_bytes / most <= packed_bytes && packed_bytes) return 0;
    return fail(STATUS_INPUT,
                "%s: declares %" PRIu64 " bytes, but its %" PRIu64 " compressed bytes cannot hold more than %" PRIu64
                " times as many; the header is wrong or the file is cut (or store it uncompressed)",
                path, unpacked_bytes, packed_bytes, most);
}

/* Where the next unpacked bytes go: first into a scratch buffer, then into the result, then one more byte of scratch,
 * so that the end of the stream, with its check sum, is seen. */
typedef struct target {
    unsigned char scratch[65536];
    unsigned char *out;
    uint64_t skip, bytes; /* still wanted */
    int more;             /* whether more came than was wanted */
    int is_counted;       /* the stream may end before what is wanted */
} target;

int unpack_damaged(const char *path, const char *detail) {
    return fail(STATUS_INPUT, "%s: its compressed data is damaged (%s); get the file again", path, detail);
}

static int ends_early(const char *path, uint64_t got, uint64_t wanted) {
    if (got == wanted) return unpack_damaged(path, "it is cut before its check sum");
    return fail(STATUS_INPUT,
                "%s: its compressed data ends after %" PRIu64 " of %" PRIu64
                " bytes; the header is wrong or the file is cut",
                path, got, wanted);
}

#if defined(HAVE_ZLIB) || defined(HAVE_BZIP2)

static unsigned char *target_room(target *t, uint64_t *room) {
    unsigned char *at = t->skip || !t->bytes ? t->scratch : t->out;
    *room = t->skip ? t->skip : t->bytes ? t->bytes : 1;
    uint64_t limit = at == t->scratch ? sizeof t->scratch : CHUNK;
    if (*room > limit) *room = limit;
    return at;
}

/* The stream has ended where it should. */
static int stream_ended(const char *path, const target *t, uint64_t wanted) {
    return t->is_counted ? 0 : ends_early(path, wanted - t->bytes - t->skip, wanted);
}

/* Returns 1 where more came than was wanted. */
static int target_took(target *t, uint64_t count) {
    if (t->skip) {
        t->skip -= count;
    } else if (t->bytes) {
        t->out += count;
        t->bytes -= count;
    } else {
        t->more = count > 0;
    }
    return t->more;
}

#endif

#ifdef HAVE_ZLIB
static int inflate_stream(const char *path, const unsigned char *in, size_t in_bytes, target *t, uint64_t wanted) {
    z_stream stream = {0};
    if (inflateInit2(&stream, 15 + 32) != Z_OK) return fail(STATUS_FAILED, "zlib: out of memory");
    int status = 0;
    size_t left = in_bytes;
    stream.next_in = (Bytef *)(uintptr_t)in;
    for (;;) {
        uint64_t room;
        stream.next_out = target_room(t, &room);
        stream.avail_out = (uInt)room;
        uInt given = left < CHUNK ? (uInt)left : CHUNK;
        stream.avail_in = given;
        int code = inflate(&stream, Z_NO_FLUSH);
        left -= given - stream.avail_in;
        if (target_took(t, room - stream.avail_out)) break;
        if (code == Z_STREAM_END) {
            if (!t->skip && !t->bytes) break;
            int another = left > 2 && stream.next_in[0] == 0x1f && stream.next_in[1] == 0x8b;
            if (another && inflateReset(&stream) == Z_OK) continue;
            status = stream_ended(path, t, wanted);
            break;
        }
        if (code == Z_MEM_ERROR)
            status = fail(STATUS_FAILED, "zlib: out of memory");
        else if (code == Z_BUF_ERROR && !left)
            status = ends_early(path, wanted - t->bytes - t->skip, wanted);
        else if (code != Z_OK)
            status = unpack_damaged(path, stream.msg ? stream.msg : "zlib");
        if (status) break;
    }
    inflateEnd(&stream);
    return status;
}
#endif

#ifdef HAVE_BZIP2
static int bunzip_stream(const char *path, const unsigned char *in, size_t in_bytes, target *t, uint64_t wanted) {
    bz_stream stream = {0};
    if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return fail(STATUS_FAILED, "bzip2: out of memory");
    int status = 0;
    size_t left = in_bytes;
    stream.next_in = (char *)(uintptr_t)in;
    for (;;) {
        uint64_t room;
        stream.next_out = (char *)target_room(t, &room);
        stream.avail_out = (unsigned)room;
        unsigned given = left < CHUNK ? (unsigned)left : CHUNK;
        stream.avail_in = given;
        int code = BZ2_bzDecompress(&stream);
        unsigned used = given - stream.avail_in;
        uint64_t came = room - stream.avail_out;
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
            status = ends_early(path, wanted - t->bytes - t->skip, wanted);
        if (status) break;
    }
    BZ2_bzDecompressEnd(&stream);
    return status;
}
#endif

/* Through the library of the encoding, which is there, as unpack_check has found. */
static int unpack_to(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, target *t,
                     uint64_t wanted) {
#ifdef HAVE_ZLIB
    if (packed == ENCODING_DEFLATE) return inflate_stream(path, in, in_bytes, t, wanted);
#endif
#ifdef HAVE_BZIP2
    if (packed == ENCODING_BZIP2) return bunzip_stream(path, in, in_bytes, t, wanted);
#endif
    (void)in;
    (void)in_bytes;
    (void)t;
    return fail(STATUS_INPUT, "%s: encoding %d does not pack its %" PRIu64 " bytes", path, (int)packed, wanted);
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
    status = unpack_to(path, packed, in, in_bytes, &t, wanted);
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
    status = unpack_to(path, packed, in, in_bytes, &t, most);
    *unpacked = most - t.skip;
    return status;
}

int unpack_prove(const char *path, encoding packed, const unsigned char *in, size_t in_bytes, uint64_t unpacked_bytes) {
    uint64_t gives = 0;
    int status = unpack_check(path, packed, in_bytes, unpacked_bytes);
    if (status || unpacked_bytes / DOUBTFUL_FROM <= in_bytes) return status;
    status = unpack_count(path, packed, in, in_bytes, unpacked_bytes, &gives);
    if (status || gives == unpacked_bytes) return status;
    return ends_early(path, gives, unpacked_bytes);
}
