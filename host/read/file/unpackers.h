/* unpackers.h - one function per library that unpacks, each in a file of its own; and what these share */
#ifndef UNPACKERS_H
#define UNPACKERS_H

#include <stddef.h>
#include <stdint.h>

enum { UNPACK_CHUNK = 1 << 30 };

/* Where unpacked bytes go: skipped ones into a scratch buffer, then those wanted into the result, then one more byte
 * into the scratch buffer. Asking for this one makes the library read the stream's end, with its check sum. */
typedef struct target {
    unsigned char scratch[65536];
    unsigned char *out;
    uint64_t skip, bytes; /* still wanted */
    int more;             /* whether more came than was wanted */
    int is_counted;       /* the stream may end before what is wanted */
} target;

/* STATUS_INPUT, with the message for packed data that a library finds damaged. */
int unpack_damaged(const char *path, const char *detail);

/* Room for the next bytes. */
unsigned char *target_space(target *t, uint64_t *capacity);

/* Notes that `count` bytes came. Returns 1 where that is more than was wanted. */
int target_took(target *t, uint64_t count);

/* The stream has ended: stream_ended allows that where bytes are only counted, stream_ends_early fails. */
int stream_ended(const char *path, const target *t, uint64_t wanted);
int stream_ends_early(const char *path, uint64_t got, uint64_t wanted);

/* By zlib, of gzip and zlib streams; by libbz2. */
int inflate_stream(const char *path, const unsigned char *in, size_t in_bytes, target *t, uint64_t wanted);
int bunzip_stream(const char *path, const unsigned char *in, size_t in_bytes, target *t, uint64_t wanted);

/* By liblz4, of a block; by liblzma, of an xz stream of LZMA2: the first `bytes` of what they hold. */
int unpack_lz4(const char *path, const unsigned char *in, uint64_t in_bytes, unsigned char *out, uint64_t bytes);
int unpack_lzma(const char *path, const unsigned char *in, uint64_t in_bytes, unsigned char *out, uint64_t bytes);

#endif
