/*
 * ranges.cl - least and greatest sample of a brick or cluster, as keys: unsigned integers of 32 bits that order like
 * the samples
 *
 * Of a 64-bit key only the upper half is kept; where that cannot decide, the brick counts as mixed. From the build:
 * BITS, FLOATING.
 */
#ifndef RANGES_CL
#define RANGES_CL

#include "common.cl"

#if FLOATING
#define KEY_SIGN ((BITS)1 << (FLOATING - 1))
/* Keys from here on are of +infinity and NaN; keys up to its complement are of -infinity and NaN. */
#define KEY_INFINITY (FLOATING == 32 ? 0xff800000u : 0xfff00000u)
#endif

inline_always uint key_upper(BITS key) {
#if FLOATING == 64
    return (uint)(key >> 32);
#else
    return (uint)key;
#endif
}

/* Whether all samples are finite; else the range decides nothing. */
inline_always bool range_finite(brick_range range) {
#if FLOATING
    return range.high < KEY_INFINITY && range.low > ~KEY_INFINITY;
#else
    return true;
#endif
}

inline_always uint range_sign(const isovalue_test *test, brick_range range) {
    if (!range_finite(range)) return SIGN_MIXED;
    return range.low >= test->key_inside ? SIGN_INSIDE : range.high < test->key_outside ? SIGN_OUTSIDE : SIGN_MIXED;
}

inline_always BITS key_of(BITS bits, const isovalue_test *test) {
#if FLOATING
    return bits ^ ((BITS)((signed_bits)bits >> (FLOATING - 1)) | KEY_SIGN);
#else
    return bits ^ (BITS)test->key_flip;
#endif
}

#if WORK_ITEMS == 1
#include "ranges_alone.cl"
#endif

#endif
