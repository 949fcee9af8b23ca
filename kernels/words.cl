/*
 * words.cl - sign words: one bit per sample, 64 samples along x in one 64-bit word, bit n for x = 64 w + n
 *
 * A sample is inside when it is >= the isovalue. For every type the samples that are inside are one run of bit patterns
 * (floats order like integers within a sign), so the test is (bits - low) <= span in unsigned integers: exact whatever
 * the device does with subnormals, and the same text for all types. Bits past the end of a row are 0.
 *
 * From the build: BITS, the unsigned type as wide as a sample; FLOATING; WORK_ITEMS; MISSING.
 */
#pragma OPENCL FP_CONTRACT OFF
#ifdef FP64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif

#define PASTE2(a, b) a##b
#define PASTE(a, b)  PASTE2(a, b)
#define BITS16       PASTE(BITS, 16)

#ifndef inline_always /* tools that run kernels unoptimised define it empty */
#define inline_always static inline __attribute__((always_inline))
#endif

#if WORK_ITEMS == 1
#define group_barrier()
#else
#define group_barrier() barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#endif

#if FLOATING == 32
#define EXPONENT 0x7f800000u
#elif FLOATING == 64
#define EXPONENT 0x7ff0000000000000ul
#endif

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

/* Bit n of the result for byte n of the mask: each byte keeps one bit, the product sums the bytes of a half into its
 * highest one. */
inline_always uint mask_pack(char16 mask) {
    ulong2 kept = as_ulong2(mask) & 0x8040201008040201ul;
    ulong2 bytes = (kept * 0x0101010101010101ul) >> 56;
    return (uint)(bytes.x | bytes.y << 8);
}

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

/* 16 bits of a word. *nonfinite becomes not 0 where a sample is NaN or infinite; those read past the end of a row are
 * samples of the same grid. */
inline_always uint word_part(global const BITS *samples, const slab *s, uint y, uint z, uint part, uint *nonfinite) {
    if (16 * part >= s->nx) return 0;
    BITS16 bits = samples_load(samples, s, row_start(s, y, z) + 16 * part);
#if FLOATING && !MISSING
    *nonfinite |= any(convert_char16((bits & EXPONENT) == EXPONENT));
#endif
    uint left = s->nx - 16 * part;
    return mask_pack(inside_mask(bits, s)) & (left >= 16 ? 0xffffu : (1u << left) - 1);
}

/* 64 samples at once, all of which the buffer has. Stays in registers: a detour through memory costs as much again. */
inline_always ulong word_full(global const BITS *samples, const slab *s, uint *nonfinite) {
    BITS16 b0 = vload16(0, samples), b1 = vload16(1, samples), b2 = vload16(2, samples), b3 = vload16(3, samples);
#if FLOATING && !MISSING
    *nonfinite |= any(convert_char16((b0 & EXPONENT) == EXPONENT) | convert_char16((b1 & EXPONENT) == EXPONENT) |
                      convert_char16((b2 & EXPONENT) == EXPONENT) | convert_char16((b3 & EXPONENT) == EXPONENT));
#endif
    ulong8 mask = (ulong8)(as_ulong2(inside_mask(b0, s)), as_ulong2(inside_mask(b1, s)), as_ulong2(inside_mask(b2, s)),
                           as_ulong2(inside_mask(b3, s)));
    ulong8 bytes = ((mask & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56;
    return as_ulong(convert_uchar8(bytes));
}

inline_always ulong word_inside(global const BITS *samples, const slab *s, uint y, uint z, uint w, uint *nonfinite) {
    ulong start = row_start(s, y, z) + 64ul * w;
    if (start + 64 <= s->sample_offset + s->sample_count)
        return word_full(samples + start, s, nonfinite) & word_valid(s, w);
    ulong word = 0;
    for (uint n = 0; n < 4; n++) word |= (ulong)word_part(samples, s, y, z, 4 * w + n, nonfinite) << (16 * n);
    return word;
}

#if WORK_ITEMS == 1
/* All words of a row. */
inline_always void row_sign(global const BITS *samples, const slab *s, uint y, uint z, global ulong *row,
                            uint *nonfinite) {
    ulong start = row_start(s, y, z);
    if (start + 64ul * s->words_x <= s->sample_offset + s->sample_count) {
        for (uint w = 0; w < s->words_x; w++) row[w] = word_full(samples + start + 64ul * w, s, nonfinite);
        row[s->words_x - 1] &= word_valid(s, s->words_x - 1);
    } else {
        for (uint w = 0; w < s->words_x; w++) row[w] = word_inside(samples, s, y, z, w, nonfinite);
    }
}
#endif

inline_always uint word_index(const slab *s, uint y, uint z, uint w) {
    return ((z - s->word_z) * s->ny + y) * s->words_x + w;
}

inline_always uint brick_index(const slab *s, uint y, uint z, uint w) {
    return ((z - s->word_z) / BRICK_PLANES * s->bricks_y + y / BRICK_ROWS) * s->words_x + w;
}
