/*
 * lanes.cl - bit-sliced code: how many rows of 64 cubes it processes at once, one word per row
 */
#ifndef LANES_CL
#define LANES_CL

#if WORK_ITEMS == 1
#include "lanes_alone.cl"
#else
#include "lanes_groups.cl"
#endif

#endif
