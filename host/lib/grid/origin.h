/*
 * origin.h - the point that positions of a mesh are relative to, so that float32 keeps the shape of a grid far from
 * zero
 *
 * A float32 has 24 bits. At 4,600,000 metres they are steps of half a metre: cells of a quarter of a metre collapse.
 * Coordinates are therefore taken in double precision, a point near the grid is subtracted, and the rest is rounded.
 *
 * Along each axis the origin is 0 unless the grid lies far from 0, by the rule of far.h. Else it is the middle of the
 * grid, rounded to a multiple of the power of two that is at least the grid's size: a short number, and coordinates
 * minus it are exact in double precision. Only corners of cells that are present count, so that fill values of points
 * that nothing uses are ignored. The origin depends on the grid alone.
 */
#ifndef ORIGIN_H
#define ORIGIN_H

#include <stdbool.h>
#include <stdint.h>

/* Coordinates as the caller gave them; one of the two pointers is not NULL. */
typedef struct coordinate_array {
    const float *f32;
    const double *f64;
} coordinate_array;

static inline double coordinate_get(coordinate_array from, uint64_t n) {
    return from.f64 ? from.f64[n] : (double)from.f32[n];
}

/* Where cells lie and how small the smallest is; low above high: no cell. */
typedef struct extent {
    double low[3], high[3];
    double cell[3]; /* least size of a cell along each axis that is not 0; infinite where all are */
} extent;

extern const extent extent_empty;

/* Adds a cell, given its corners. */
void extent_add(extent *e, const double corners[][3], int count);

/* The rule above. */
void origin_choose(const extent *e, double origin[3]);

/* Writes the corners of a cell, 8 at most; returns how many, 0 where the cell does not count. Called by several threads
 * at once. */
typedef int cell_corners(const void *source, uint64_t cell, double corners[][3]);

/* The origin of a grid of cell_count cells. Reads some cells first, and all cells only where the grid may lie far from
 * 0. */
void origin_find(cell_corners *corners, const void *source, uint64_t cell_count, double origin[3]);

/* Writes tuples of coordinates minus those of the origin, rounded to float32: three components of points, one of an
 * axis. */
void coordinates_move(coordinate_array from, uint64_t tuple_count, int components, const double *origin, float *to);

#endif
