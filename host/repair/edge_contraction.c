/*
 * edge_contraction.c - meshopt_simplify, its memory taken before
 *
 * The library is C++: where its allocator finds no memory it throws, which ends a program in C. So all that it needs is
 * taken beforehand, as one block that it gets slices of; a call that needs more than was foreseen takes that from
 * malloc. Slices are given back in any order, all at once when the call has ended.
 */
#include "edge_contraction.h"

#include "exit_status.h"
#include "failure.h"

#include <float.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>

/* Bytes that the versions from 0.18 to 1.2 take: of each vertex adjacency, kind, loops, position, quadric; of each
 * index adjacency and a contraction. */
enum { BYTES_PER_VERTEX = 192, BYTES_PER_INDEX = 40, BYTES_BESIDE = 1 << 20, ALIGNMENT = 64 };

static struct {
    char *bytes;
    size_t size, used;
} block;

static void *slice_take(size_t bytes) {
    const size_t rounded = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    if (rounded <= block.size - block.used) {
        char *slice = block.bytes + block.used;
        block.used += rounded;
        return slice;
    }
    void *beyond = malloc(bytes);
    if (beyond) return beyond;
    fputs("tetracubes: out of memory in meshoptimizer\n", stderr);
    exit(STATUS_FAILED); /* the library cannot be left in another way */
}

static void slice_give_back(void *slice) {
    const char *at = slice;
    if (at < block.bytes || at >= block.bytes + block.size) free(slice);
}

const char *edge_contraction_version(void) {
    static char text[16];
    snprintf(text, sizeof text, "%d.%d", MESHOPTIMIZER_VERSION / 1000, MESHOPTIMIZER_VERSION / 10 % 100);
    return text;
}

int edge_contraction(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                     uint64_t goal, uint32_t *out, uint64_t *out_count) {
    enum { STRIDE = 3 * sizeof *positions };
    const uint64_t indices = 3 * triangle_count;
    block.size = vertex_count * BYTES_PER_VERTEX + indices * BYTES_PER_INDEX + BYTES_BESIDE;
    block.used = 0;
    block.bytes = malloc(block.size);
    if (!block.bytes)
        return fail(STATUS_FAILED, "out of memory to simplify %llu triangles: %llu MB are needed",
                    (unsigned long long)triangle_count, (unsigned long long)(block.size >> 20));
    meshopt_setAllocator(slice_take, slice_give_back);
    *out_count = meshopt_simplify(out, triangles, indices, positions, vertex_count, STRIDE, 3 * goal, FLT_MAX,
                                  meshopt_SimplifyLockBorder, NULL) /
                 3;
    free(block.bytes);
    block.bytes = NULL;
    block.size = 0;
    return 0;
}
