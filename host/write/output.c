/*
 * output.c - large writes beside the final name, then rename
 *
 * Records are encoded in blocks by several threads. A thread takes the next block, encodes it in a buffer of its own,
 * waits for the block's turn and writes it, so that one writes while others encode and the file grows in order, also
 * where it is a pipe.
 */
#include "output.h"

#include "exit_status.h"
#include "failure.h"
#include "output_target.h"
#include "parallel.h"
#include "truncation.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { WRITE_MOST = 1 << 26 };

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
    case ESPIPE:
        return "a mesh that does not fit memory is written at many places of a file: name a file";
    default:
        return "name a file that can be written";
    }
}

static int fail_write(const char *name, int error) {
    return fail(STATUS_FAILED, "%s: cannot be written: %s; %s", name, strerror(error), advice(error));
}

/* Removes what has not been renamed; frees. */
static void release(output *o) {
    if (o->fd >= 0) close(o->fd);
    if (o->temporary && o->error) unlink(o->temporary);
    if (o->lock >= 0) close(o->lock);
    free(o->temporary);
    free(o->path);
    *o = (output){.fd = -1, .lock = -1};
}

int output_check(const char *path) {
    char *copy = strdup(path);
    int error = copy ? output_target_obstacle(&copy) : ENOMEM;
    free(copy);
    return error ? fail_write(path, error) : 0;
}

int output_is_file(const char *path) {
    struct stat there;
    return !output_is_dash(path) && (stat(path, &there) != 0 || S_ISREG(there.st_mode));
}

int output_open(output *o, const char *path) {
    *o = (output){.name = path, .fd = -1, .lock = -1, .path = strdup(path)};
    o->error = o->path ? output_target_open(o) : ENOMEM;
    if (!o->error) return 0;
    int error = o->error;
    release(o);
    return fail_write(path, error);
}

/* Errors are ignored where a file is written in one go: where the file system lacks the call, or room, the writes will
 * show it. One that takes long to make, in passes, is not begun without room. */
void output_expect(output *o, uint64_t bytes) {
    if (!o->temporary || o->error || bytes <= o->expected || bytes > INT64_MAX) return;
    o->expected = bytes;
    if (fallocate(o->fd, FALLOC_FL_KEEP_SIZE, 0, (off_t)bytes) != 0 && o->in_passes && errno == ENOSPC)
        o->error = errno;
}

static int (*stop_asked)(void);

void output_stop_when(int (*asked)(void)) { stop_asked = asked; }

static ssize_t write_some(output *o, const void *from, size_t bytes) {
    return o->in_passes ? pwrite(o->fd, from, bytes, (off_t)o->position) : write(o->fd, from, bytes);
}

void output_bytes(output *o, const void *data, uint64_t bytes) {
    const unsigned char *from = data;
    while (bytes > 0 && !o->error) {
        ssize_t written = write_some(o, from, bytes < WRITE_MOST ? bytes : WRITE_MOST);
        if (stop_asked && stop_asked()) o->error = ECANCELED;
        if (written > 0) {
            o->position += (uint64_t)written;
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

static void write_records_of(output *o, uint64_t first, uint64_t end, size_t record_bytes, output_encode *encode,
                             const void *source) {
    records r = {.o = o,
                 .count = end,
                 .per_block = OUTPUT_BLOCK / record_bytes,
                 .encode = encode,
                 .source = source,
                 .next = first,
                 .turn = first,
                 .lock = PTHREAD_MUTEX_INITIALIZER,
                 .turned = PTHREAD_COND_INITIALIZER,
                 .stopped = o->error != 0};
    if (first >= end) return;
    parallel_run((end - first - 1) / r.per_block + 1, encode_blocks, &r);
    if (r.turn < end && !o->error) o->error = ENOMEM; /* no thread had memory for its buffer */
}

void output_records(output *o, uint64_t count, size_t record_bytes, output_encode *encode, const void *source) {
    write_records_of(o, 0, count, record_bytes, encode, source);
}

void output_span(output *o, record_span span, size_t record_bytes, output_encode *encode, const void *source) {
    const uint64_t begin = o->position;
    o->position = begin + span.first * record_bytes;
    if (encode)
        write_records_of(o, span.first, span.end, record_bytes, encode, source);
    else
        output_bytes(o, source, (span.end - span.first) * record_bytes);
    o->position = begin + span.count * record_bytes;
}

void output_rewind(output *o) {
    if (!o->temporary && !o->error) o->error = ESPIPE;
    o->in_passes = 1;
    o->position = 0;
}

int output_status(const output *o) { return o->error ? fail_write(o->name, o->error) : 0; }

void output_finish(output *o) {
    if (o->fd >= 0 && close(o->fd) != 0 && !o->error) o->error = errno;
    o->fd = -1;
}

int output_close(output *o) {
    output_finish(o);
    if (truncation_seen()) o->error = EFAULT; /* zeros may have been written where pages of an input file were lost */
    if (o->temporary && !o->error && rename(o->temporary, o->path) != 0) o->error = errno;
    int status = o->error ? fail_write(o->name, o->error) : 0;
    if (truncation_seen()) status = truncation_status();
    release(o);
    return status;
}

void output_discard(output *o) {
    o->error = ECANCELED;
    release(o);
}
