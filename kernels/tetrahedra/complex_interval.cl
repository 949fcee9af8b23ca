/*
 * complex_interval.cl - the program of interval volumes of complexes: what lies between two isovalues, as tetrahedra
 *
 * The kernels of complexes have classified by each bound, listed the active tetrahedra, and numbered the vertices on
 * their crossed edges. complex_interval_count classifies by both bounds and sums up; complex_interval_crossings makes
 * the vertices on edges, complex_interval_emit those at points, and the tetrahedra.
 *
 * One text for both variants: plain OpenCL C.
 */
#ifndef COMPLEX_INTERVAL_CL
#define COMPLEX_INTERVAL_CL

#include "complex_interval_count.cl"
#include "complex_interval_emit.cl"

#endif
