/*
 * gunzip.c - a file that is packed by gzip as a whole; see gunzip.h
 *
 * The last four bytes tell the unpacked size, unless there are several streams, or 4 GiB or more. Where they are found
 * to be wrong, the streams are counted, and unpacked once more.
 */
#include "file/gunzip.h"

#include "exit_status.h"
#include "failure.h"
#include "file/unpack.h"
#include "temporary_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { SIZE_BYTES = 4, PACKED_LEAST = 18, SEVERAL_MOST = 1032 };

int gunzip_begins(const mapping *file) { return file->size >= 3 && memcmp(file->bytes, "\x1f\x8b\x08", 3) == 0; }

static int no_memory(const char *path, uint64_t bytes, int error) {
    return fail(STATUS_FAILED, "%s: no memory for the %" PRIu64 " bytes that it unpacks to: %s; unpack it to a file",
                path, bytes, strerror(error));
}

/* Unpacks so many bytes into the file in memory; *more: whether the streams hold others. */
static int unpack_into(int file, const char *path, const mapping *packed, uint64_t bytes, int *more) {
    if (!bytes) return unpack(path, ENCODING_DEFLATE, packed->bytes, packed->size, 0, &(char){0}, 0, more);
    const int error = bytes > INT64_MAX ? EFBIG : posix_fallocate(file, 0, (off_t)bytes);
    if (error) return no_memory(path, bytes, error);
    void *to = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (to == MAP_FAILED) return no_memory(path, bytes, errno);
    int status = unpack(path, ENCODING_DEFLATE, packed->bytes, packed->size, 0, to, bytes, more);
    munmap(to, bytes);
    return status;
}

/* The unpacked size as the file's end says, 0 where it says nothing. */
static uint64_t size_told(const mapping *packed) {
    uint64_t bytes = 0;
    for (size_t n = 1; n <= SIZE_BYTES && packed->size >= PACKED_LEAST; n++)
        bytes = bytes << 8 | packed->bytes[packed->size - n];
    return bytes;
}

/* Returns 0 where what is told is wrong, and leaves the file empty. */
static int unpack_as_told(int file, const char *path, const mapping *packed) {
    const uint64_t bytes = size_told(packed);
    int more = 1;
    if (packed->size < PACKED_LEAST) return 0;
    if (unpack_check(path, ENCODING_DEFLATE, packed->size, bytes) == 0 &&
        unpack_into(file, path, packed, bytes, &more) == 0 && !more)
        return 1;
    (void)!ftruncate(file, 0);
    return 0;
}

static int unpack_counted(int file, const char *path, const mapping *packed) {
    uint64_t bytes = 0;
    const uint64_t most = (uint64_t)packed->size * SEVERAL_MOST;
    int more, status = unpack_count(path, ENCODING_DEFLATE, packed->bytes, packed->size, most, &bytes);
    return status ? status : unpack_into(file, path, packed, bytes, &more);
}

/* A file in memory, or on the disk where it will be too large for that: volumes are packed to a third, more or less. -1
 * with its message. */
static int open_unpacked(const char *path, const mapping *packed) {
    const uint64_t told = size_told(packed), usual = 3 * (uint64_t)packed->size, bytes = told > usual ? told : usual;
    if (temporary_file_is_better(bytes)) return temporary_file(0);
    const int file = memfd_create("unpacked", MFD_CLOEXEC);
    if (file < 0) no_memory(path, bytes, errno);
    return file;
}

int gunzip(const char *path, const mapping *packed) {
    int status = unpack_check(path, ENCODING_DEFLATE, packed->size, 0);
    if (status) return status;
    const int file = open_unpacked(path, packed);
    if (file < 0) return STATUS_FAILED;
    if (!unpack_as_told(file, path, packed)) status = unpack_counted(file, path, packed);
    if (!status) return mapping_replace(path, file);
    close(file);
    return status;
}
