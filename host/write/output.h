/*
 * output.h - a file that appears under its name only when it is complete
 *
 * Data goes to .NAME.XXXXXX.tmp in the final folder through a buffer and is renamed by output_close. Errors are sticky:
 * after the first one, everything is dropped, and output_close tells of it; writers need not look.
 *
 *     output o;
 *     int status = output_open(&o, path);
 *     if (status) return status;
 *     ... output_reserve, output_advance, output_text ...
 *     return output_close(&o);
 */
#ifndef OUTPUT_H
#define OUTPUT_H

#include <endian.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum {
    OUTPUT_BLOCK =
        1 << 20, /* the most that can be reserved at once, and the least that a write() gets before the last */
    OUTPUT_BUFFER = 2 * OUTPUT_BLOCK,
};

typedef struct output {
    const char *name; /* as the caller gave it, for messages; borrowed */
    char *path;       /* final name, symbolic links resolved */
    char *temporary;  /* NULL where the target is written directly */
    int fd;
    int error; /* errno of the first failure */
    size_t used;
    unsigned char *buffer;
} output;

/* Returns 0 or STATUS_FAILED with its text; the output then needs no output_close. path must outlive the output. */
int output_open(output *o, const char *path);

/* Room for bytes (at most OUTPUT_BLOCK) more. */
unsigned char *output_reserve(output *o, size_t bytes);

/* The bytes at the last reserve's room have been filled. */
static inline void output_advance(output *o, size_t bytes) { o->used += bytes; }

/* Where a block of records that starts at first ends: count records in all, as many as can be reserved at once. */
static inline uint64_t output_block_end(uint64_t first, uint64_t count, size_t record_bytes) {
    uint64_t most = OUTPUT_BLOCK / record_bytes;
    return count - first < most ? count : first + most;
}

/* Formatted text of at most 1,023 bytes. */
void output_text(output *o, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Writes what is left and puts the file under its name, or removes it. Returns 0 or STATUS_FAILED with its text. */
int output_close(output *o);

/* Little-endian numbers, at any alignment; return the address behind. */
static inline unsigned char *put_u32(unsigned char *to, uint32_t value) {
    value = htole32(value);
    memcpy(to, &value, sizeof value);
    return to + sizeof value;
}

static inline unsigned char *put_floats(unsigned char *to, const float *values, int count) {
    for (int i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, values + i, sizeof bits);
        to = put_u32(to, bits);
    }
    return to;
}

#endif
