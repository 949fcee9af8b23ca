/*
 * loop.h - a loop of crossed edges, cut into a disk of triangles
 */
#ifndef LOOP_H
#define LOOP_H

#include <stdint.h>

enum { LOOP_MOST = 30 }; /* edges */

/* What a chord between two edges of the loop costs. */
typedef int32_t chord_cost(const void *context, uint8_t a, uint8_t b);

/* Cuts a loop by the chords whose costs have the least sum; of equal ones the first is taken. Stores triangles that
 * wind as the loop does, two fewer than it has edges, and returns how many. */
unsigned loop_triangulate(const uint8_t *edges, int count, chord_cost *cost, const void *context,
                          uint8_t triangles[][3]);

#endif
