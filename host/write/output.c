/*
 * output.c - buffered writing beside the final name, then rename
 *
 * Which way a target is written:
 *   what standard output is already    through that descriptor: its offset and append mode hold
 *   exists, not a regular file         opened and written directly
 *   regular file, or nothing yet       temporary file in the same folder, renamed over it at the end; an existing
 *                                      file's permission bits are kept, a symbolic link's target is what is replaced
 * The temporary file is made by open(O_EXCL), not mkstemp, so that the kernel applies the umask.
 */
#include "output.h"

#include "exit_status.h"
#include "failure.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { NAME_KEPT = 200, ATTEMPTS = 100 };

static const char *advice(int error) {
    switch (error) {
    case ENOSPC:
    case EDQUOT:
        return "free space or name a file on another disk";
    case EFBIG:
        return "raise the limit on file sizes (ulimit -f) or name a file on another disk";
    case ENOENT:
        return "create the folder first";
    case EISDIR:
        return "name a file in it";
    default:
        return "name a file that can be written";
    }
}

static int fail_write(const char *name, int error) {
    return fail(STATUS_FAILED, "%s: cannot be written: %s; %s", name, strerror(error), advice(error));
}

static int is_standard_output(const struct stat *target) {
    struct stat standard;
    return fstat(STDOUT_FILENO, &standard) == 0 && standard.st_dev == target->st_dev &&
           standard.st_ino == target->st_ino;
}

/* Length of the folder's part of path, with its slash. */
static size_t folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* Opens a fresh file beside o->path. Returns errno. */
static int open_temporary(output *o) {
    size_t folder = folder_length(o->path), size = strlen(o->path) + sizeof "..XXXXXX.tmp";
    o->temporary = malloc(size);
    if (!o->temporary) return ENOMEM;
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    uint32_t suffix = (uint32_t)now.tv_nsec ^ (uint32_t)getpid() << 8;
    for (int attempt = 0; attempt < ATTEMPTS; attempt++, suffix = suffix * 1664525 + 1013904223) {
        snprintf(o->temporary, size, "%.*s.%.*s.%06x.tmp", (int)folder, o->path, NAME_KEPT, o->path + folder,
                 (unsigned)(suffix >> 8));
        o->fd = open(o->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (o->fd >= 0 || errno != EEXIST) break;
    }
    if (o->fd >= 0) return 0;
    int error = errno;
    free(o->temporary); /* not ours to unlink */
    o->temporary = NULL;
    return error;
}

/* Opens the file that replaces the existing one. Returns errno. */
static int open_replacement(output *o, const struct stat *existing) {
    char *resolved = realpath(o->name, NULL);
    if (!resolved) return errno;
    free(o->path);
    o->path = resolved;
    if (access(o->path, W_OK) != 0) return errno;
    int error = open_temporary(o);
    if (!error) (void)fchmod(o->fd, existing->st_mode & 0777); /* file systems without permissions refuse: no matter */
    return error;
}

static int open_target(output *o) {
    struct stat existing;
    if (o->path[folder_length(o->path)] == '\0') return o->path[0] ? EISDIR : ENOENT;
    if (stat(o->path, &existing) != 0) return errno == ENOENT ? open_temporary(o) : errno;
    if (S_ISDIR(existing.st_mode)) return EISDIR;
    if (is_standard_output(&existing))
        o->fd = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    else if (S_ISREG(existing.st_mode))
        return open_replacement(o, &existing);
    else
        o->fd = open(o->path, O_WRONLY | O_NOCTTY | O_CLOEXEC);
    return o->fd >= 0 ? 0 : errno;
}

static void write_all(output *o, const unsigned char *data, size_t bytes) {
    while (bytes > 0 && !o->error) {
        ssize_t written = write(o->fd, data, bytes);
        if (written > 0) {
            data += written;
            bytes -= (size_t)written;
        } else if (written == 0) {
            o->error = ENOSPC;
        } else if (errno != EINTR) {
            o->error = errno;
        }
    }
}

static void flush(output *o) {
    write_all(o, o->buffer, o->used);
    o->used = 0;
}

/* Closes and frees; removes what has not been renamed. */
static void release(output *o) {
    if (o->fd >= 0 && close(o->fd) != 0 && !o->error) o->error = errno;
    if (o->temporary && !o->error && rename(o->temporary, o->path) != 0) o->error = errno;
    if (o->temporary && o->error) unlink(o->temporary);
    free(o->temporary);
    free(o->path);
    free(o->buffer);
}

int output_open(output *o, const char *path) {
    *o = (output){.name = path, .fd = -1, .path = strdup(path), .buffer = malloc(OUTPUT_BUFFER)};
    o->error = o->path && o->buffer ? open_target(o) : ENOMEM;
    if (!o->error) return 0;
    int error = o->error;
    release(o);
    *o = (output){.fd = -1};
    return fail_write(path, error);
}

unsigned char *output_reserve(output *o, size_t bytes) {
    if (o->used + bytes > OUTPUT_BUFFER) flush(o);
    return o->buffer + o->used;
}

void output_text(output *o, const char *format, ...) {
    enum { MOST = 1024 };
    char *room = (char *)output_reserve(o, MOST);
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(room, MOST, format, arguments);
    va_end(arguments);
    output_advance(o, length < MOST ? (size_t)length : MOST - 1);
}

int output_close(output *o) {
    flush(o);
    release(o);
    return o->error ? fail_write(o->name, o->error) : 0;
}
