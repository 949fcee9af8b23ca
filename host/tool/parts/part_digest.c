#include "part_digest.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

struct part_digest {
    int array_count;
    XXH64_state_t **arrays;
};

part_digest *part_digest_begin(const part_layout *l) {
    part_digest *d = calloc(1, sizeof *d);
    if (d) d->arrays = calloc((size_t)l->array_count, sizeof *d->arrays);
    int is_there = d && d->arrays;
    for (int n = 0; is_there && n < l->array_count; n++) {
        d->arrays[n] = XXH64_createState();
        is_there = d->arrays[n] && XXH64_reset(d->arrays[n], 0) == XXH_OK;
        if (d->arrays[n]) d->array_count = n + 1;
    }
    if (is_there) return d;
    part_digest_free(d);
    fail(STATUS_FAILED, "out of memory for the digest of a part");
    return NULL;
}

void part_digest_add(part_digest *d, int array, const void *bytes, size_t size) {
    if (size) XXH64_update(d->arrays[array], bytes, size);
}

void part_digest_line(const part_digest *d, const void *header, size_t header_bytes, char line[PART_DIGEST_BYTES + 1]) {
    uint64_t all = XXH64(header, header_bytes, 0);
    for (int n = 0; n < d->array_count; n++) {
        const uint64_t one = XXH64_digest(d->arrays[n]);
        all = XXH64(&one, sizeof one, all);
    }
    char text[32];
    snprintf(text, sizeof text, "xxh64 %016" PRIx64, all);
    snprintf(line, PART_DIGEST_BYTES + 1, "%-*s\n", PART_DIGEST_BYTES - 1, text);
}

void part_digest_free(part_digest *d) {
    if (!d) return;
    for (int n = 0; n < d->array_count; n++) XXH64_freeState(d->arrays[n]);
    free(d->arrays);
    free(d);
}
