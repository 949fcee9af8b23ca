/* complexes.h - cases whose samples are the points of an unstructured grid */
#ifndef COMPLEXES_H
#define COMPLEXES_H

#include "samples.h"

/* Makes the tetrahedra of samples that have their points: BENCH_TETRAHEDRA, five of each cube, or BENCH_HEXAHEDRA, the
 * cubes as cells of an unstructured grid. Returns 0 or an exit status with its message (failure.h). */
int complex_make(samples *s);

void complex_release(samples *s);

/* A grid of the samples, structured or not. */
tc_status samples_open(const samples *s, tc_context *context, tc_grid **grid);

#endif
