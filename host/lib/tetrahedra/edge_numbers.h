/*
 * edge_numbers.h - crossed edges numbered in the order in which they are met first: how slabs of a complex share
 * vertices
 *
 * In the host's memory, 16 to 32 bytes per edge. The edges are kept by number, and a table with open addressing, half
 * full at most, has the numbers.
 */
#ifndef EDGE_NUMBERS_H
#define EDGE_NUMBERS_H

#include "tetracubes.h"

#include <stdbool.h>

typedef struct edge_numbers {
    uint64_t *edges; /* by number */
    uint32_t *slots;
    uint64_t count, slot_count; /* slots: a power of two, or 0 */
} edge_numbers;

/* The number of the edge of two points, low < high; a new edge gets the next number. TC_ERROR_MEMORY, or TC_ERROR_LIMIT
 * where 32 bits do not suffice. */
tc_status edge_numbers_find(edge_numbers *n, uint32_t low, uint32_t high, uint32_t *number);

/* The edge's number, UINT32_MAX where it has none. */
uint32_t edge_numbers_get(const edge_numbers *n, uint32_t low, uint32_t high);

void edge_numbers_release(edge_numbers *n);

#endif
