#include "base/structs.h"

#include "failure.h"

#include <string.h>

/* A size that a header of this library or of an older one gave the struct at `at`. Sizes end on the boundaries that
 * pointers keep, so that none is ever cut. */
static tc_status struct_size_get(const void *at, size_t known_bytes, const char *what, size_t *bytes) {
    *bytes = 0;
    if (at) memcpy(bytes, at, sizeof *bytes);
    if (*bytes >= sizeof *bytes && *bytes % sizeof *bytes == 0 && *bytes <= known_bytes) return TC_OK;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "%s: %s", what,
                           !at                    ? "none given"
                           : *bytes > known_bytes ? "made for a newer library, or never initialised"
                                                  : "never initialised: call its _init function, or set struct_size");
}

tc_status struct_copy_in(void *to, size_t to_bytes, const void *from, const char *what) {
    size_t bytes;
    tc_status status = struct_size_get(from, to_bytes, what, &bytes);
    if (status) return status;
    memcpy(to, from, bytes);
    memcpy(to, &to_bytes, sizeof to_bytes);
    return TC_OK;
}

tc_status struct_clear(void *out, size_t known_bytes, const char *what) {
    size_t bytes;
    tc_status status = struct_size_get(out, known_bytes, what, &bytes);
    if (!status) memset((char *)out + sizeof bytes, 0, bytes - sizeof bytes);
    return status;
}

void struct_copy_out(void *out, const void *from) {
    size_t bytes;
    memcpy(&bytes, out, sizeof bytes);
    memcpy((char *)out + sizeof bytes, (const char *)from + sizeof bytes, bytes - sizeof bytes);
}
