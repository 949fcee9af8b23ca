/*
 * sign.cl - the first stage of kernel 1: on which side the samples of a brick are, and its sign words where on both
 *
 * A first visit reads every sample once and leaves the range of every brick, as keys: unsigned integers of 32 bits that
 * order like the samples (of 64-bit samples the upper half, so that a key in doubt counts as mixed). Later visits with
 * another isovalue read the bricks only whose range holds it. How a layer of bricks is gone through: sign_alone.cl,
 * sign_groups.cl.
 */
#ifndef SIGN_CL
#define SIGN_CL

#include "ranges.cl"
#include "words.cl"

inline_always ulong sign_word(uint sign) { return sign == SIGN_INSIDE ? ~0ul : 0; }

/* Of the brick that a word is in, of any tile; mixed on the first visit. */
inline_always uint sign_known(const slab *s, uint y, uint z, uint w, global const brick_range *ranges) {
    return s->ranges_known ? range_sign(s, ranges[s->range_offset + brick_index(s, y, z, w)]) : SIGN_MIXED;
}

inline_always void brick_sign_store(uint number, uint sign, global brick_state *bricks) {
    brick_state b = {0, 0, 0, sign};
    bricks[number] = b;
}

#if WORK_ITEMS == 1
#include "sign_alone.cl"
#else
#include "sign_groups.cl"
#endif

#endif
