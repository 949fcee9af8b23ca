/*
 * words_groups.cl - sign words where the work-items of a group share bricks: sample by sample
 *
 * Every work-item loads samples of its own, so a group has many loads in flight; for that a work-item has to need few
 * registers. Loops are not unrolled for the same reason: masks and addresses would need registers side by side.
 */
#ifndef WORDS_GROUPS_CL
#define WORDS_GROUPS_CL

#include "words.cl"

/* Signs of samples, bit n for row[n]. */
inline_always ulong signs_make(global const BITS *row, uint count, const slab *s) {
    ulong word = 0;
#pragma unroll 1
    for (uint n = 0; n < count; n++) word |= (ulong)bits_inside(row[n], &s->test) << n;
    return word;
}

/* 16 bits of a word. */
inline_always uint word_part(global const BITS *samples, const slab *s, uint y, uint z, uint part) {
    if (16 * part >= s->nx) return 0;
    return (uint)signs_make(samples + row_start(s, y, z) + 16 * part, min(s->nx - 16 * part, 16u), s);
}

inline_always ulong word_inside(global const BITS *samples, const slab *s, uint y, uint z, uint w) {
    return signs_make(samples + row_start(s, y, z) + 64 * w, min(s->nx - 64 * w, 64u), s);
}

/* Bit n: byte `first` + n is not 0. Bytes from `end` on are not read. */
inline_always ulong bytes_word(global const uchar *bytes, ulong first, ulong end) {
    const uint count = first < end ? (uint)min(end - first, 64ul) : 0;
    ulong word = 0;
#pragma unroll 1
    for (uint n = 0; n < count; n++) word |= (ulong)(bytes[first + n] != 0) << n;
    return word;
}

inline_always ulong word_present(global const BITS *samples, global const uchar *blanked, const slab *s, uint y, uint z,
                                 uint w) {
    const ulong start = row_start(s, y, z) + 64ul * w;
    const uint count = min(s->nx - 64 * w, 64u);
    ulong word = 0;
#pragma unroll 1
    for (uint n = 0; n < count; n++) word |= (ulong)!bits_missing(samples[start + n], &s->test) << n;
    if (s->arrays.has_blanked_samples)
        word &= ~bytes_word(blanked, start + s->arrays.blanked_offset, start + s->arrays.blanked_offset + count);
    return word;
}

#endif
