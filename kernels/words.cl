/*
 * words.cl - sign words: one bit per sample, 64 samples along x in one 64-bit word, bit n for x = 64 w + n
 *
 * A sample is inside when it is >= the isovalue. For every type the samples that are inside are one run of bit patterns
 * (floats order like integers within a sign), so the test is (bits - low) <= span in unsigned integers: exact whatever
 * the device does with subnormals, and the same text for all types. Bits past the end of a row are 0.
 */
/* 0xFF or 0 per sample. */
inline_always char16 inside_mask(BITS16 bits, const slab *s) {
    return convert_char16((bits - (BITS)s->inside_low) <= (BITS16)(BITS)s->inside_span);
}

inline_always char16 missing_mask(BITS16 bits, const slab *s) {
    char16 missing = 0;
#if FLOATING
    missing = convert_char16((bits & EXPONENT) == EXPONENT);
#endif
    if (s->has_nodata)
        missing |= convert_char16(bits == (BITS)s->nodata_bits[0]) | convert_char16(bits == (BITS)s->nodata_bits[1]);
    return missing;
}

/* Bit n of the result for byte n of the mask: each byte keeps one bit, and the product sums the bytes of a half into its
 * highest one. Where the processor has an instruction for that, extensions.cl defines it. */
#ifndef mask_pack
inline_always uint mask_pack(char16 mask) {
    ulong2 kept = as_ulong2(mask) & 0x8040201008040201ul;
    ulong2 bytes = (kept * 0x0101010101010101ul) >> 56;
    return (uint)(bytes.x | bytes.y << 8);
}
#endif

inline_always uint lowest_bit(ulong word) { return (uint)popcount(~word & (word - 1)); } /* 64 for 0 */

inline_always ulong row_start(const slab *s, uint y, uint z) {
    return s->sample_offset + ((ulong)(z - s->sample_z) * s->ny + y) * s->nx;
}

/* 16 samples from n on, of which those from index `end` of the buffer on are read as 0. */
inline_always BITS16 samples_load(global const BITS *samples, const slab *s, ulong n) {
    ulong end = s->sample_offset + s->sample_count;
    if (n + 16 <= end) return vload16(0, samples + n);
    BITS last[16];
    for (uint m = 0; m < 16; m++) last[m] = n + m < end ? samples[n + m] : (BITS)0;
    return vload16(0, last);
}

inline_always ulong word_valid(const slab *s, uint w) {
    uint left = s->nx - 64 * w;
    return left >= 64 ? ~0ul : (1ul << left) - 1;
}

/* 16 bits of a word. */
inline_always uint word_part(global const BITS *samples, const slab *s, uint y, uint z, uint part) {
    if (16 * part >= s->nx) return 0;
    BITS16 bits = samples_load(samples, s, row_start(s, y, z) + 16 * part);
    uint left = s->nx - 16 * part;
    return mask_pack(inside_mask(bits, s)) & (left >= 16 ? 0xffffu : (1u << left) - 1);
}

inline_always ulong word_inside(global const BITS *samples, const slab *s, uint y, uint z, uint w) {
    ulong word = 0;
    for (uint n = 0; n < 4; n++) word |= (ulong)word_part(samples, s, y, z, 4 * w + n) << (16 * n);
    return word;
}

inline_always uint brick_index(const slab *s, uint y, uint z, uint w) {
    return ((z - s->word_z) / BRICK_PLANES * s->bricks_y + y / BRICK_ROWS) * s->words_x + w;
}

/* Where in its brick a row is. */
inline_always uint row_place(const slab *s, uint y, uint z) {
    return (z - s->word_z) % BRICK_PLANES * BRICK_ROWS + y % BRICK_ROWS;
}

inline_always uint word_index(const slab *s, uint y, uint z, uint w) {
    return BRICK_WORDS * brick_index(s, y, z, w) + row_place(s, y, z);
}

/* The 32 words of brick `number`. Where they are constant, they are set past the ends of rows and of the grid too. */
inline_always global const ulong *brick_words(uint number, uint sign, global const ulong *words) {
    return words + BRICK_WORDS * (sign == SIGN_MIXED ? (long)number : (long)sign - UNIFORM_BRICKS);
}
