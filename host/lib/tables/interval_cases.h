/*
 * interval_cases.h - the 81 cases of a tetrahedron whose corners are below, within or above an interval
 *
 * Corners are in the order of their sample numbers. Where corners p, q, r, s are such that (q - p) x (r - p) . (s - p)
 * is positive, so are the tetrahedra of the table; else the last two vertices of each change places.
 */
#ifndef INTERVAL_CASES_H
#define INTERVAL_CASES_H

#include "tables/tables.h"

#include <stdbool.h>

/* Vertices of a case: a corner; the crossing of the low bound on an edge (tetrahedron_edges), or of the high bound. In
 * this order polyhedra are cut into tetrahedra. */
enum {
    INTERVAL_CORNER,
    INTERVAL_LOW = 4,
    INTERVAL_HIGH = 10,
    INTERVAL_VERTICES = 16,
    INTERVAL_CASES = 81,
    INTERVAL_PARTS_MOST = 6
};

/* Where a sample is. */
enum { SAMPLE_BELOW, SAMPLE_WITHIN, SAMPLE_ABOVE };

/* Digit c to the base 3 of a case's number tells where corner c is. */
typedef struct interval_case {
    uint8_t count;
    uint8_t parts[INTERVAL_PARTS_MOST][4];
} interval_case;

void interval_cases_derive(interval_case cases[INTERVAL_CASES]);

/* A tetrahedron of a cube, its corners in the order of their sample numbers, which is that of the corners' numbers. */
typedef struct ordered_tetrahedron {
    uint8_t corners[4];
    bool is_odd; /* in this order its volume is negative */
} ordered_tetrahedron;

ordered_tetrahedron tetrahedron_order(unsigned parity, unsigned tetrahedron);

/* Brings four numbers into rising order; whether that takes an odd number of exchanges. */
bool corners_sort(uint32_t corners[4]);

#endif
