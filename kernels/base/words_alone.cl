/*
 * words_alone.cl - sign words where a work-item is alone: 16 samples at a time
 */
#ifndef WORDS_ALONE_CL
#define WORDS_ALONE_CL

#include "words.cl"

/* 0xFF or 0 per sample. */
inline_always char16 inside_mask(BITS16 bits, const isovalue_test *test) {
    return convert_char16((bits - (BITS)test->inside_low) <= (BITS16)(BITS)test->inside_span);
}

inline_always char16 missing_mask(BITS16 bits, const isovalue_test *test) {
    char16 missing = 0;
#if FLOATING
    missing = convert_char16((bits & EXPONENT) == EXPONENT);
#endif
    if (test->has_nodata)
        missing |=
            convert_char16(bits == (BITS)test->nodata_bits[0]) | convert_char16(bits == (BITS)test->nodata_bits[1]);
    return missing;
}

/* Bit n of the result for byte n of the mask: each byte keeps one bit, and the product sums the bytes of a half into
 * its highest one. Where the processor has an instruction for that, extensions.cl defines it. */
#ifndef mask_pack
inline_always uint mask_pack(char16 mask) {
    ulong2 kept = as_ulong2(mask) & 0x8040201008040201ul;
    ulong2 bytes = (kept * 0x0101010101010101ul) >> 56;
    return (uint)(bytes.x | bytes.y << 8);
}
#endif

/* 16 samples from index n on; past the end of the buffer, 0. */
inline_always BITS16 samples_load(global const BITS *samples, const slab *s, ulong n) {
    ulong end = s->arrays.sample_offset + s->arrays.sample_count;
    if (n + 16 <= end) return vload16(0, samples + n);
    BITS last[16];
    for (uint m = 0; m < 16; m++) last[m] = n + m < end ? samples[n + m] : (BITS)0;
    return vload16(0, last);
}

/* 16 bits of a word. */
inline_always uint word_part(global const BITS *samples, const slab *s, uint y, uint z, uint part) {
    if (16 * part >= s->nx) return 0;
    BITS16 bits = samples_load(samples, s, row_start(s, y, z) + 16 * part);
    uint left = s->nx - 16 * part;
    return mask_pack(inside_mask(bits, &s->test)) & (left >= 16 ? 0xffffu : (1u << left) - 1);
}

inline_always ulong word_inside(global const BITS *samples, const slab *s, uint y, uint z, uint w) {
    ulong word = 0;
    for (uint n = 0; n < 4; n++) word |= (ulong)word_part(samples, s, y, z, 4 * w + n) << (16 * n);
    return word;
}

/* Bit n: byte `first` + n is not 0. Bytes from `end` on are not read. */
inline_always ulong bytes_word(global const uchar *bytes, ulong first, ulong end) {
    ulong word = 0;
    for (uint part = 0; part < 4 && first + 16 * part < end; part++) {
        uchar16 loaded = 0;
        ulong n = first + 16 * part;
        if (n + 16 <= end) {
            loaded = vload16(0, bytes + n);
        } else {
            uchar last[16];
            for (uint m = 0; m < 16; m++) last[m] = n + m < end ? bytes[n + m] : (uchar)0;
            loaded = vload16(0, last);
        }
        word |= (ulong)mask_pack(loaded != (uchar16)0) << (16 * part);
    }
    return word;
}

inline_always ulong word_present(global const BITS *samples, global const uchar *blanked, const slab *s, uint y, uint z,
                                 uint w) {
    ulong word = 0, start = row_start(s, y, z);
    for (uint part = 4 * w; part < 4 * w + 4 && 16 * part < s->nx; part++) {
        BITS16 bits = samples_load(samples, s, start + 16 * part);
        word |= (ulong)(~mask_pack(missing_mask(bits, &s->test)) & 0xffff) << (16 * (part & 3));
    }
    if (s->arrays.has_blanked_samples)
        word &= ~bytes_word(blanked, start + 64 * w + s->arrays.blanked_offset,
                            s->arrays.sample_offset + s->arrays.sample_count + s->arrays.blanked_offset);
    return word & word_valid(s, w);
}

#endif
