/*
 * half_edges.h - half-edges of a list of triangles, and sets of their corners: what the files of this room share
 *
 * Corner c of triangle n has the index 3 n + c. So has its half-edge, which runs from this corner to the next one of
 * the triangle. An edge is the pair of its vertices, as one number: the lower one << 32 | the higher one.
 */
#ifndef HALF_EDGES_H
#define HALF_EDGES_H

#include <stdint.h>
#include <stdlib.h>

#define NO_INDEX UINT64_MAX

static inline uint64_t next_corner(uint64_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

static inline uint64_t previous_corner(uint64_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

static inline uint64_t edge_between(uint32_t a, uint32_t b) {
    return (uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a);
}

static inline uint32_t edge_lower(uint64_t edge) { return (uint32_t)(edge >> 32); }

static inline uint32_t edge_higher(uint64_t edge) { return (uint32_t)edge; }

/* For qsort and bsearch over edges. */
static inline int edge_compare(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Sets of corners by union-find. The lowest corner of a set is its root. */
static inline uint64_t set_root(uint64_t *parents, uint64_t corner) {
    while (parents[corner] != corner) corner = parents[corner] = parents[parents[corner]];
    return corner;
}

static inline void set_unite(uint64_t *parents, uint64_t a, uint64_t b) {
    a = set_root(parents, a);
    b = set_root(parents, b);
    parents[a > b ? a : b] = a > b ? b : a;
}

/* Zeroed memory for one element more than count; NULL where there is none. */
static inline void *array_allocate(uint64_t count, size_t bytes) {
    return count < PTRDIFF_MAX / bytes ? calloc((size_t)count + 1, bytes) : NULL;
}

#endif
