/*
 * output.c - large writes beside the final name, then rename
 *
 * Records are encoded in blocks by several threads. A thread takes the next block, encodes it in a buffer of its own,
 * waits for the block's turn and writes it, so that one writes while others encode and the file grows in order, also
 * where it is a pipe.
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
#include "parallel.h"
#include "truncation.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { NAME_KEPT = 200, ATTEMPTS = 100, WRITE_MOST = 1 << 26 };

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

/* Closes and frees; removes what has not been renamed. */
static void release(output *o) {
    if (o->fd >= 0 && close(o->fd) != 0 && !o->error) o->error = errno;
    if (o->temporary && !o->error && rename(o->temporary, o->path) != 0) o->error = errno;
    if (o->temporary && o->error) unlink(o->temporary);
    free(o->temporary);
    free(o->path);
}

int output_open(output *o, const char *path) {
    *o = (output){.name = path, .fd = -1, .path = strdup(path)};
    o->error = o->path ? open_target(o) : ENOMEM;
    if (!o->error) return 0;
    int error = o->error;
    release(o);
    *o = (output){.fd = -1};
    return fail_write(path, error);
}

/* Where a file system has no such call, or no room, writing will tell. */
void output_expect(output *o, uint64_t bytes) {
    if (o->temporary && bytes > 0 && bytes <= INT64_MAX) (void)fallocate(o->fd, FALLOC_FL_KEEP_SIZE, 0, (off_t)bytes);
}

static int (*stop_asked)(void);

void output_stop_when(int (*asked)(void)) { stop_asked = asked; }

void output_bytes(output *o, const void *data, uint64_t bytes) {
    const unsigned char *from = data;
    while (bytes > 0 && !o->error) {
        ssize_t written = write(o->fd, from, bytes < WRITE_MOST ? bytes : WRITE_MOST);
        if (stop_asked && stop_asked()) o->error = ECANCELED;
        if (written > 0) {
            from += written;
            bytes -= (uint64_t)written;
        } else if (written == 0) {
            o->error = ENOSPC;
        } else if (errno != EINTR) {
            o->error = errno;
            if (errno == EFAULT) truncation_note();
        }
    }
}

/* ---------------------------------------------------------------------------------------------------------- records */

typedef struct records {
    output *o; /* belongs to the thread whose block's turn it is */
    uint64_t count, per_block;
    output_encode *encode;
    const void *source;

    pthread_mutex_t lock;
    pthread_cond_t turned;
    uint64_t next; /* first record that nobody has taken */
    uint64_t turn; /* first record that is not written */
    int stopped;   /* after an error no more blocks are taken */
} records;

/* Takes the next block. Returns 0 where there is none. */
static int take_block(records *r, uint64_t *first, uint64_t *end) {
    pthread_mutex_lock(&r->lock);
    *first = r->stopped ? r->count : r->next;
    *end = r->count - *first < r->per_block ? r->count : *first + r->per_block;
    r->next = *end;
    pthread_mutex_unlock(&r->lock);
    return *first < *end;
}

static void write_in_turn(records *r, const unsigned char *data, size_t bytes, uint64_t first, uint64_t end) {
    pthread_mutex_lock(&r->lock);
    while (r->turn != first) pthread_cond_wait(&r->turned, &r->lock);
    pthread_mutex_unlock(&r->lock);
    output_bytes(r->o, data, bytes);
    pthread_mutex_lock(&r->lock);
    r->turn = end;
    r->stopped = r->o->error != 0;
    pthread_cond_broadcast(&r->turned);
    pthread_mutex_unlock(&r->lock);
}

static void encode_blocks(void *shared) {
    records *r = shared;
    unsigned char *buffer = malloc(OUTPUT_BLOCK);
    uint64_t first, end;
    while (buffer && take_block(r, &first, &end))
        write_in_turn(r, buffer, (size_t)(r->encode(r->source, first, end, buffer) - buffer), first, end);
    free(buffer);
}

void output_records(output *o, uint64_t count, size_t record_bytes, output_encode *encode, const void *source) {
    records r = {.o = o,
                 .count = count,
                 .per_block = OUTPUT_BLOCK / record_bytes,
                 .encode = encode,
                 .source = source,
                 .lock = PTHREAD_MUTEX_INITIALIZER,
                 .turned = PTHREAD_COND_INITIALIZER,
                 .stopped = o->error != 0};
    if (count == 0) return;
    parallel_run((count - 1) / r.per_block + 1, encode_blocks, &r);
    if (r.turn < count && !o->error) o->error = ENOMEM; /* no thread had memory for its buffer */
}

int output_close(output *o) {
    if (truncation_seen()) o->error = EFAULT; /* what was written may be zeros in place of an input file */
    release(o);
    if (truncation_seen()) return truncation_status();
    return o->error ? fail_write(o->name, o->error) : 0;
}
