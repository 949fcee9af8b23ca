/*
 * sign.cl - the first stage of kernel 1: on which side of the isovalue a brick's samples are; sign words of mixed
 * bricks
 *
 * A first visit reads every sample once and stores the range of every brick, as keys: unsigned integers of 32 bits that
 * order like the samples. Of a 64-bit key only the upper half is kept; where that cannot decide, the brick counts as
 * mixed. Later visits, with another isovalue, read only the bricks whose range holds the isovalue. The loops over a
 * layer of bricks are in sign_alone.cl and sign_groups.cl.
 */
#ifndef SIGN_CL
#define SIGN_CL

#include "../base/ranges.cl"
#include "../base/words.cl"

inline_always ulong sign_word(uint sign) { return sign == SIGN_INSIDE ? ~0ul : 0; }

/* The side of the brick that holds a word, also in another tile. On the first visit ranges are unknown: SIGN_MIXED. */
inline_always uint sign_known(const slab *s, uint y, uint z, uint w, global const brick_range *ranges) {
    return s->results.ranges_known ? range_sign(&s->test, ranges[s->results.range_offset + brick_index(s, y, z, w)])
                                   : SIGN_MIXED;
}

inline_always void brick_sign_store(uint brick, uint sign, global brick_state *bricks) {
    brick_state b = {0, 0, 0, sign};
    bricks[brick] = b;
}

#if WORK_ITEMS == 1
#include "sign_alone.cl"
#else
#include "sign_groups.cl"
#endif

#endif
