/*
 * interval.cl - the program of interval volumes: what lies between two isovalues, as tetrahedra
 *
 * Kernel 1 has classified the window by each bound. interval_count counts what bricks have within; the host sums that
 * up, brick by brick, as it cuts the volume into windows by these sums. interval_emit makes vertices and tetrahedra.
 *
 * One text for both variants: plain OpenCL C, a row of 64 cubes at a time.
 */
#ifndef INTERVAL_CL
#define INTERVAL_CL

#include "interval_count.cl"
#include "interval_emit.cl"

#endif
