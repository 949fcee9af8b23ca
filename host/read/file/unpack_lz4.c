/* unpack_lz4.c - raw LZ4 blocks, through liblz4 */
#include "file/unpackers.h"

#include "exit_status.h"
#include "failure.h"

#include <lz4.h>

int unpack_lz4(const char *path, const unsigned char *in, uint64_t in_bytes, unsigned char *out, uint64_t bytes) {
    if (in_bytes > LZ4_MAX_INPUT_SIZE || bytes > LZ4_MAX_INPUT_SIZE)
        return fail(STATUS_INPUT, "%s: has compressed blocks larger than LZ4's, of up to %d bytes; the file is damaged",
                    path, LZ4_MAX_INPUT_SIZE);
    int made = LZ4_decompress_safe_partial((const char *)in, (char *)out, (int)in_bytes, (int)bytes, (int)bytes);
    return made == (int)bytes ? 0 : unpack_damaged(path, "LZ4");
}
