/*
 * lanes.cl - bit-sliced code: how many rows of 64 cubes it has at a time, in words side by side
 */
#ifndef LANES_CL
#define LANES_CL

#if WORK_ITEMS == 1
#include "lanes_alone.cl"
#else
#include "lanes_groups.cl"
#endif

#endif
