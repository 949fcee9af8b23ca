/*
 * complex_interval.cl - the program of interval volumes of complexes: what lies between two isovalues, as tetrahedra
 *
 * complex_interval_count classifies by both bounds and sums up; complex_interval_list lists the edges that they cross,
 * complex_interval_join and complex_interval_number join and number these; complex_interval_crossings makes the
 * vertices, complex_interval_emit the tetrahedra.
 */
#ifndef COMPLEX_INTERVAL_CL
#define COMPLEX_INTERVAL_CL

#include "complex_interval_emit.cl"

#endif
