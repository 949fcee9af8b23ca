/*
 * ranges_alone.cl - keys where a work-item is alone: 16 at a time
 */
#ifndef RANGES_ALONE_CL
#define RANGES_ALONE_CL

#include "ranges.cl"

inline_always BITS16 keys16(BITS16 bits, const isovalue_test *test) {
#if FLOATING
    return bits ^ (PASTE(as_, BITS16)((PASTE(as_, SIGNED16)(bits)) >> (FLOATING - 1)) | KEY_SIGN);
#else
    return bits ^ (BITS)test->key_flip;
#endif
}

inline_always uint keys_least(BITS16 keys) {
    PASTE(BITS, 8) m8 = min(keys.lo, keys.hi);
    PASTE(BITS, 4) m4 = min(m8.lo, m8.hi);
    return key_upper(min(min(m4.x, m4.y), min(m4.z, m4.w)));
}

/* The greatest key is the complement of the least complement. */
inline_always uint keys_most(BITS16 keys) { return key_upper((BITS) ~(BITS)0) - keys_least(~keys); }

/* The least and the greatest key. Both are reduced in one vector: the greatest is the complement of the complements'
 * least. */
inline_always brick_range keys_range(BITS16 low, BITS16 high) {
    PASTE(BITS, 8) low8 = min(low.lo, low.hi), high8 = ~max(high.lo, high.hi);
    PASTE(BITS, 8) m8 = (PASTE(BITS, 8))(min(low8.lo, low8.hi), min(high8.lo, high8.hi));
    PASTE(BITS, 4) m4 = min(m8.even, m8.odd);
    PASTE(BITS, 2) m2 = min(m4.even, m4.odd);
    brick_range range = {key_upper(m2.x), key_upper((BITS)~m2.y)};
    return range;
}

#endif
