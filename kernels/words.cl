/*
 * words.cl - sign words: one bit per sample, 64 samples along x in one 64-bit word, bit n for x = 64 w + n
 *
 * A sample is inside when it is >= the isovalue. For every type the samples that are inside are one run of bit patterns
 * (floats order like integers within a sign), so the test is (bits - low) <= span in unsigned integers: exact whatever
 * the device does with subnormals, and the same text for all types. Bits past the end of a row are 0.
 *
 * From the build: BITS, the unsigned type as wide as a sample; FLOATING; WORK_ITEMS; MISSING; HYBRID.
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

/* AVX-512: masks of comparisons are integers in registers of their own. Tests leave it out, for other processors' text.
 */
#if defined(__AVX512BW__) && defined(__AVX512DQ__) && defined(__AVX512VL__) && !defined(NO_AVX512)
#define MASK_REGISTERS
#endif

/* Bit-sliced code runs over LANES rows of 64 samples at once: the eight of a plane of a brick where a work-item has
 * bricks to itself, one where it shares them. */
#if WORK_ITEMS == 1
#define group_barrier()
#define LANES 8
typedef ulong8 lanes;

/* A work-item alone leaves nothing to vectorise across work-items; Intel's compiler for CPUs tries for minutes. */
#ifdef cl_intel_vec_len_hint
#define kernel __kernel __attribute__((intel_vec_len_hint(1)))
#endif

/* Asks for the cache line at an address, which need not be one of the buffer's. Tools may define it empty, too. */
#ifndef line_prefetch
#define line_prefetch(address) __builtin_prefetch((const void *)(size_t)(address))
#endif

/* Stores a vector as large as a cache line, at its start, without reading the line into the caches. */
#ifndef line_store
#define line_store(value, place) __builtin_nontemporal_store(value, place)
#endif
#else
#define group_barrier() barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#define LANES           1
typedef ulong lanes;
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

/* Bit n of the result for byte n of the mask, as AVX-512 has it; elsewhere each byte keeps one bit, and the product
 * sums the bytes of a half into its highest one. */
#ifdef MASK_REGISTERS
inline_always uint mask_pack(char16 mask) { return __builtin_ia32_cvtb2mask128(mask); }
#else
inline_always uint mask_pack(char16 mask) {
    ulong2 kept = as_ulong2(mask) & 0x8040201008040201ul;
    ulong2 bytes = (kept * 0x0101010101010101ul) >> 56;
    return (uint)(bytes.x | bytes.y << 8);
}
#endif

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
