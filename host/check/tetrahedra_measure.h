/*
 * tetrahedra_measure.h - volume, integrals and shapes of tetrahedra, from points and tetrahedra alone
 *
 * Tetrahedra with a point out of range, or one that is not finite, are left out of every figure. Sums do not depend on
 * the number of threads.
 */
#ifndef TETRAHEDRA_MEASURE_H
#define TETRAHEDRA_MEASURE_H

#include <stdint.h>

/* Points x, y, z each, and 4 of them for each tetrahedron. */
typedef struct tetrahedra_view {
    const float *points;
    uint64_t point_count;
    const uint32_t *tetrahedra;
    uint64_t tetrahedron_count;
} tetrahedra_view;

/* *volume: the sum, of positive and of negative ones. integrals: NULL, or room for one per component: the integrals of
 * what is linear in each tetrahedron, with `components` values at each point. Returns 0, or STATUS_FAILED with its
 * message (failure.h) where memory runs out. */
int tetrahedra_integrate(const tetrahedra_view *t, const float *values, int components, double *volume,
                         double *integrals);

/* The smallest dihedral angle is 70.6 degrees at most. */
enum { DIHEDRAL_TENTHS = 707 };

/* Tetrahedra by their smallest dihedral angle. Flat ones, of which the least height is below 2^-20 of the longest edge,
 * as rounding makes, are counted alone. */
typedef struct tetrahedra_shapes {
    uint64_t flat, inverted; /* inverted: of negative volume, and not flat */
    uint64_t count;          /* of all that are not flat, as the next */
    uint64_t below_5, below_10;
    uint64_t by_tenth[DIHEDRAL_TENTHS]; /* rounded down to tenths of a degree */
    double least;                       /* degrees; 0 where count is */
} tetrahedra_shapes;

/* Adds these tetrahedra to those of others. */
void tetrahedra_shapes_add(const tetrahedra_view *t, tetrahedra_shapes *sum);

/* In degrees, to a tenth; 0 where there are none. */
double tetrahedra_shapes_median(const tetrahedra_shapes *shapes);

#endif
