/* bytes.h - values taken from an input of the fuzzer, one after the other; zeros where it ends */
#ifndef BYTES_H
#define BYTES_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct bytes {
    const uint8_t *at;
    size_t left;
} bytes;

static inline void bytes_take(bytes *b, void *to, size_t size) {
    size_t taken = b->left < size ? b->left : size;
    memset(to, 0, size);
    if (taken) memcpy(to, b->at, taken);
    b->at += taken;
    b->left -= taken;
}

static inline uint8_t bytes_u8(bytes *b) {
    uint8_t value;
    bytes_take(b, &value, sizeof value);
    return value;
}

static inline int64_t bytes_i64(bytes *b) {
    int64_t value;
    bytes_take(b, &value, sizeof value);
    return value;
}

static inline double bytes_f64(bytes *b) {
    double value;
    bytes_take(b, &value, sizeof value);
    return value;
}

/* Memory of the exact size, to be freed. */
static inline void *bytes_array(bytes *b, size_t size) {
    void *array = malloc(size);
    if (size) bytes_take(b, array, size);
    return array;
}

#endif
