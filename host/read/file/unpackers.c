#include "file/unpackers.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>

int unpack_damaged(const char *path, const char *detail) {
    return fail(STATUS_INPUT, "%s: its compressed data is damaged (%s); get the file again", path, detail);
}

int stream_ends_early(const char *path, uint64_t got, uint64_t wanted) {
    if (got == wanted) return unpack_damaged(path, "it is cut before its check sum");
    return fail(STATUS_INPUT,
                "%s: its compressed data ends after %" PRIu64 " of %" PRIu64
                " bytes; the header is wrong or the file is cut",
                path, got, wanted);
}

unsigned char *target_space(target *t, uint64_t *capacity) {
    unsigned char *at = t->skip || !t->bytes ? t->scratch : t->out;
    *capacity = t->skip ? t->skip : t->bytes ? t->bytes : 1;
    uint64_t limit = at == t->scratch ? sizeof t->scratch : UNPACK_CHUNK;
    if (*capacity > limit) *capacity = limit;
    return at;
}

int stream_ended(const char *path, const target *t, uint64_t wanted) {
    return t->is_counted ? 0 : stream_ends_early(path, wanted - t->bytes - t->skip, wanted);
}

int target_took(target *t, uint64_t count) {
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
