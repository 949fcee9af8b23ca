/*
 * link_alone.cl - the links of eight rows of samples at once, for a work-item alone
 */
#ifndef LINK_ALONE_CL
#define LINK_ALONE_CL

#include "link.h"
#include "../structured/tetrahedra.cl"

/* Signs of a link, by index. Samples outside the grid are in none of the three. */
typedef struct link_signs {
    lanes plus[LINK_EVEN], minus[LINK_EVEN], zero[LINK_EVEN];
} link_signs;

#define LINK_AXIS(axis, up) (2 * (axis) + (up))

/* Of two different axes. */
inline_always uint link_across(uint a, uint up_a, uint b, uint up_b) {
    return a < b ? 4 * (a + b) + 2 + up_a + 2 * up_b : 4 * (a + b) + 2 + up_b + 2 * up_a;
}

#endif
