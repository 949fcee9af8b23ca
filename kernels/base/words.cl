/*
 * words.cl - sign words: one bit per sample, 64 samples along x in one 64-bit word, bit n for x = 64 w + n
 *
 * A sample is inside when it is >= the isovalue. For every type the samples that are inside are one run of bit patterns
 * (floats order like integers within a sign), so the test is (bits - low) <= span in unsigned integers: exact whatever
 * the device does with subnormals, and the same text for all types. Bits past the end of a row are 0.
 * words_alone.cl and words_groups.cl make words of samples.
 */
#ifndef WORDS_CL
#define WORDS_CL

#include "lanes.cl"

inline_always ulong row_start(const slab *s, uint y, uint z) {
    return s->arrays.sample_offset + ((ulong)(z - s->arrays.sample_z) * s->ny + y) * s->nx;
}

inline_always ulong word_valid(const slab *s, uint w) {
    uint left = s->nx - 64 * w;
    return left >= 64 ? ~0ul : (1ul << left) - 1;
}

/* Samples of a row that have one before them and one after them in x. */
inline_always ulong has_before(uint w) { return w ? ~0ul : ~1ul; }
inline_always ulong has_after(const slab *s, uint w) { return w + 1 < s->words_x ? ~0ul : word_valid(s, w) >> 1; }

/* Samples of a row that are on no border of the grid. */
inline_always ulong samples_inner(const slab *s, uint y, uint z, uint w) {
    return y > 0 && y + 1 < s->ny && z > 0 && z + 1 < s->nz ? has_before(w) & has_after(s, w) : 0;
}

inline_always uint brick_index(const slab *s, uint y, uint z, uint w) {
    return ((z - s->results.word_z) / BRICK_PLANES * s->bricks_y + y / BRICK_ROWS) * s->words_x + w;
}

typedef struct grid_index {
    uint x, y, z;
} grid_index;

/* Which word of its rows a brick has. */
inline_always uint brick_word(const slab *s, uint brick) { return brick % s->words_x; }

/* The first sample of a brick. */
inline_always grid_index brick_origin(const slab *s, uint brick) {
    grid_index origin = {brick % s->words_x * 64, brick / s->words_x % s->bricks_y * BRICK_ROWS,
                         s->results.word_z + brick / s->words_x / s->bricks_y * BRICK_PLANES};
    return origin;
}

/* The index of a row in its brick. */
inline_always uint row_in_brick(const slab *s, uint y, uint z) {
    return (z - s->results.word_z) % BRICK_PLANES * BRICK_ROWS + y % BRICK_ROWS;
}

inline_always uint word_index(const slab *s, uint y, uint z, uint w) {
    return BRICK_WORDS * brick_index(s, y, z, w) + row_in_brick(s, y, z);
}

/* The 32 words of a brick. `words` points behind the two bricks of constant words, which have the indices -2 (outside)
 * and -1 (inside). Those of an inside brick have bits set outside the grid too. */
inline_always global const ulong *brick_words(uint brick, uint sign, global const ulong *words) {
    return words + BRICK_WORDS * (sign == SIGN_MIXED ? (long)brick : (long)sign - UNIFORM_BRICKS);
}

/* Words of the samples that are vertices themselves (method snap), for words of a brick. */
inline_always global const ulong *zeros_of(const slab *s, global const ulong *words) {
    return words + BRICK_WORDS * (ulong)s->snapping.zero_bricks;
}

inline_always bool bits_inside(BITS bits, const isovalue_test *test) {
    return (BITS)(bits - (BITS)test->inside_low) <= (BITS)test->inside_span;
}

/* Whether a sample's bits make it missing; without branches. */
inline_always bool bits_missing(BITS bits, const isovalue_test *test) {
    bool missing =
        (test->has_nodata != 0) & ((bits == (BITS)test->nodata_bits[0]) | (bits == (BITS)test->nodata_bits[1]));
#if FLOATING
    missing |= (bits & EXPONENT) == EXPONENT;
#endif
    return missing;
}

/* At index n of the sample buffer. */
inline_always bool sample_missing(global const BITS *samples, global const uchar *blanked, const slab *s, ulong n) {
    return bits_missing(samples[n], &s->test) ||
           (s->arrays.has_blanked_samples && blanked[n + s->arrays.blanked_offset]);
}

#if WORK_ITEMS == 1
#include "words_alone.cl"
#else
#include "words_groups.cl"
#endif

#endif
