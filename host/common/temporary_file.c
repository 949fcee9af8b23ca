#include "temporary_file.h"

#include "exit_status.h"
#include "failure.h"
#include "host_memory.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t asked_from = 64 << 20; /* less is not worth a look at what the system has */

int temporary_file_is_better(uint64_t bytes) { return bytes >= asked_from && bytes > host_memory_available() / 4 * 3; }

static int fail_file(const char *folder, int error) {
    return fail(
        STATUS_FAILED,
        "an array of the input is larger than memory, and no temporary file can have it in %s: %s; name a folder "
        "with room by TMPDIR",
        folder, strerror(error));
}

int temporary_file(uint64_t bytes) {
    const char *named = getenv("TMPDIR"), *folder = named && *named ? named : "/var/tmp";
    const int file = open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file < 0) {
        fail_file(folder, errno);
        return -1;
    }
    const int error = bytes > INT64_MAX ? EFBIG : bytes ? posix_fallocate(file, 0, (off_t)bytes) : 0;
    if (!error) return file;
    close(file);
    fail_file(folder, error);
    return -1;
}
