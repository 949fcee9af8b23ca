/*
 * lanes_alone.cl - bit-sliced code where a work-item has bricks to itself: the eight rows of a plane of a brick at once
 */
#ifndef LANES_ALONE_CL
#define LANES_ALONE_CL

#include "common.cl"

#define LANES 8
typedef ulong8 lanes;

#define group_barrier()

#define LANE_NUMBERS            ((ulong8)(0, 1, 2, 3, 4, 5, 6, 7))
#define lanes_select(condition) as_ulong8(condition) /* all bits or none */

/* popcount of a vector, in a form that compilers vectorise: some built-in ones go element by element. */
inline_always lanes lanes_popcount(lanes x) {
    x -= (x >> 1) & 0x5555555555555555ul;
    x = (x & 0x3333333333333333ul) + ((x >> 2) & 0x3333333333333333ul);
    x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0ful;
    return (x * 0x0101010101010101ul) >> 56;
}

inline_always ulong lanes_any(lanes x) {
    ulong4 four = x.lo | x.hi;
    ulong2 two = four.lo | four.hi;
    return two.x | two.y;
}

inline_always ulong lanes_sum(lanes x) {
    ulong4 four = x.lo + x.hi;
    ulong2 two = four.lo + four.hi;
    return two.x + two.y;
}

/* Bit n for a lane n that is not 0. */
#ifndef lanes_nonzero
inline_always uint lanes_nonzero(lanes x) {
    char8 mask = convert_char8(x != 0ul);
    return (uint)(((as_ulong(mask) & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56);
}
#endif

/* Lane n of the result is lane n + 1 of x; the highest lane is `last`. */
inline_always lanes lanes_next_row(lanes x, ulong last) { return ulongs_joined(x, last); }

/* For normals: axes that are computed at once. */
#define AXES_AT_ONCE 3

#endif
