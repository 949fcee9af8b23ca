/*
 * lanes.cl - the type `lanes` of bit-sliced code: one 64-bit word for each of LANES rows of 64 cubes, eight rows in the
 * variant for a work-item alone, one in that for groups
 */
#ifndef LANES_CL
#define LANES_CL

#if WORK_ITEMS == 1
#include "lanes_alone.cl"
#else
#include "lanes_groups.cl"
#endif

inline_always uint lowest_bit(ulong word) { return (uint)popcount(~word & (word - 1)); } /* 64 for 0 */

#endif
