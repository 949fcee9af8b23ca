/*
 * output.h - a file that appears under its name only when it is complete
 *
 * A file is written from its beginning to its end; or in passes, of which each goes through the whole file and writes
 * the records that it has, at their place (output_rewind).
 *
 * Data goes to .NAME.XXXXXX.tmp in the final folder, which output_close renames. Where a process was killed and left
 * such a file, the next output of that name removes it. Errors are sticky: after the first one everything is dropped,
 * and output_close reports it, so that writers need not look.
 *
 *     output o;
 *     int status = output_open(&o, path);
 *     if (status) return status;
 *     ... output_expect, output_bytes, output_records ...
 *     return output_close(&o);
 */
#ifndef OUTPUT_H
#define OUTPUT_H

#include <stddef.h>
#include <stdint.h>

enum {
    OUTPUT_BLOCK = 1 << 20
}; /* bytes of records that a thread writes in one turn; large, so that turns cost little */

typedef struct output {
    const char *name; /* as the caller gave it, for messages; borrowed */
    char *path;       /* final name, symbolic links resolved */
    char *temporary;  /* NULL where the target is written directly */
    int fd;
    int lock;  /* the temporary file once more: its lock is held until it is gone */
    int error; /* errno of the first failure */
    int in_passes;
    uint64_t position; /* in passes: where the next byte goes */
    uint64_t expected; /* bytes of the file that room was asked for */
} output;

/* Of `count` records that a file has one after the other, those from `first` to end - 1. */
typedef struct record_span {
    uint64_t count, first, end;
} record_span;

/* Encodes the records first to end - 1 at `to`, of OUTPUT_BLOCK bytes; returns the address behind. Several threads call
 * it at once. */
typedef unsigned char *output_encode(const void *source, uint64_t first, uint64_t end, unsigned char *to);

/* From now on all outputs call `asked` between writes. Where it returns nonzero they end, and output_close fails. */
void output_stop_when(int (*asked)(void));

/* Whether the name is "-": standard output. */
int output_is_dash(const char *path);

/* Whether the output would be a file of its own, which can be written in passes. */
int output_is_file(const char *path);

/* 0 where output_open would open the file, as far as that can be told without making one, else STATUS_FAILED with its
 * text: to be called before any work is done. */
int output_check(const char *path);

/* Returns 0 or STATUS_FAILED with its message; the output then needs no output_close. path must outlive the output. */
int output_open(output *o, const char *path);

/* Announces how many bytes the file will have: room for all at once costs a third less than piece by piece. */
void output_expect(output *o, uint64_t bytes);

/* Writes what lies in memory as it should lie in the file. */
void output_bytes(output *o, const void *data, uint64_t bytes);

/* Writes records 0 to count - 1, each of at most record_bytes bytes when encoded. */
void output_records(output *o, uint64_t count, size_t record_bytes, output_encode *encode, const void *source);

/* Writes the span's records, of record_bytes bytes each, and goes on behind the last of all; in memory they lie from
 * the span's first on where encode is NULL. Other spans than all records are for files that are written in passes. */
void output_span(output *o, record_span span, size_t record_bytes, output_encode *encode, const void *source);

/* Begins the next pass, the first one too. Sets an error where the output is no file of its own. */
void output_rewind(output *o);

/* What has gone wrong so far: 0, or STATUS_FAILED with its message. */
int output_status(const output *o);

/* Ends writing; the file stays under its temporary name. A failure is told by output_close. */
void output_finish(output *o);

/* Puts the file under its name, or removes it. Returns 0 or a status with its message: STATUS_FAILED, or STATUS_INPUT
 * where an input file became shorter meanwhile. */
int output_close(output *o);

/* Removes the file in place of output_close. */
void output_discard(output *o);

#endif
