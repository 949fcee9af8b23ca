/*
 * extensions.cl - what the variant for a work-item alone takes from compilers beyond OpenCL C 1.2: vectors of 64
 * elements, built-in functions, hints. Compilers built on Clang know it; see host/lib/opencl/variant.c
 */
#ifndef EXTENSIONS_CL
#define EXTENSIONS_CL

#include "common.cl"

/* With AVX-512 masks of comparisons are integers in registers of their own. Tests define NO_AVX512, to try code for
 * processors without. */
#if defined(__AVX512BW__) && defined(__AVX512DQ__) && defined(__AVX512VL__) && !defined(NO_AVX512)
#define MASK_REGISTERS
#endif

/* Vectors of 8 words can be shuffled by variable indices. Tests define NO_AVX2 as well, for processors without. */
#if defined(MASK_REGISTERS) || (defined(__AVX2__) && !defined(NO_AVX2))
#define WORD_SHUFFLES
#endif

/* A work-item alone leaves nothing to vectorise across work-items; Intel's compiler for CPUs tries for minutes. */
#ifdef cl_intel_vec_len_hint
#define kernel __kernel __attribute__((intel_vec_len_hint(1)))
#endif

/* Prefetches the cache line at an address, which may lie outside the buffer, into the cache of the second level: what
 * is prefetched here is used so late that it would displace what is in use from the first. Tools may define this as
 * empty. */
#ifndef line_prefetch
#define line_prefetch(address) __builtin_prefetch((const void *)(size_t)(address), 0, 2)
#endif

/* Stores a whole cache line without reading it into the caches; `out` is the start of a line. */
#ifndef line_store
#define line_store(value, out) __builtin_nontemporal_store(value, out)
#endif

/* Hints for the loop that follows. */
#define loop_unrolled _Pragma("unroll")
#define loop_copied   _Pragma("clang loop vectorize(disable) unroll(full)")
#define loop_short    _Pragma("clang loop vectorize(disable) unroll(disable)")

/* ---------------------------------------------------------------------------------------------------------- vectors */

/* Sixteen words of 4 bytes, of any type, at any multiple of 4 bytes. */
typedef uint16 __attribute__((aligned(4), may_alias)) words16;

/* Sixteen bytes, anywhere. */
typedef uchar16 __attribute__((aligned(1), may_alias)) bytes16;

/* 64 samples of a row, and a byte for each. */
typedef BITS samples64 __attribute__((ext_vector_type(64)));
typedef BITS samples64_unaligned __attribute__((ext_vector_type(64), aligned(sizeof(BITS))));
typedef char bytes64 __attribute__((ext_vector_type(64)));

/* As many keys as a cache line has samples, at least 16. */
#define LINE_KEYS (sizeof(BITS) < 4 ? 64 / sizeof(BITS) : 16)
typedef BITS line_keys __attribute__((ext_vector_type(LINE_KEYS)));

constant const samples64 lane64 = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
                                   16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31,
                                   32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47,
                                   48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63};

#if FLOATING
/* Every bit of element n is the sign bit of sample n. */
inline_always samples64 signs64(samples64 bits) {
    typedef signed_bits signed64 __attribute__((ext_vector_type(64)));
    return __builtin_astype(__builtin_astype(bits, signed64) >> (FLOATING - 1), samples64);
}
#endif

/* Bit n: byte n of the mask is set. Without instructions for that, each byte keeps one bit, and the product sums eight
 * bytes into its highest one. */
inline_always ulong mask_word(bytes64 is) {
#ifdef MASK_REGISTERS
    return __builtin_ia32_cvtb2mask512(is);
#elif defined(__AVX2__)
    return (uint)__builtin_ia32_pmovmskb256(is.lo) | (ulong)(uint)__builtin_ia32_pmovmskb256(is.hi) << 32;
#else
    ulong8 mask = __builtin_astype(is, ulong8);
    return as_ulong(convert_uchar8(((mask & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56));
#endif
}

/* Bit n: sample n is at most element n of `most`. */
inline_always ulong at_most64(samples64 samples, samples64 most) {
    return mask_word(__builtin_convertvector(samples <= most, bytes64));
}

/* Elements 1 to 7 of x, then `last`. OpenCL C's own form, a vector literal, compiles to slower code. */
inline_always ulong8 ulongs_joined(ulong8 x, ulong last) {
    return __builtin_shufflevector(x, (ulong8)last, 1, 2, 3, 4, 5, 6, 7, 8);
}

/* ----------------------------------------------------------------------------------------------------------- masks */

#ifdef MASK_REGISTERS

#define mask_pack(mask)  ((uint)__builtin_ia32_cvtb2mask128(mask))
#define lanes_nonzero(x) ((uint)__builtin_ia32_cvtq2mask512((x) != 0ul))

/* All bits of byte n are bit n. */
inline_always bytes64 bits_spread(ulong bits) { return __builtin_astype(__builtin_ia32_cvtmask2b512(bits), bytes64); }

/* Stores the items in the mask one after another and returns their number. The rest of the 16 words at `out` is
 * overwritten too. */
inline_always uint items_keep(uint16 items, ulong mask, uint *out) {
    *(words16 *)out =
        __builtin_astype(__builtin_ia32_compresssi512_mask(as_int16(items), (int16)0, (ushort)mask), words16);
    return (uint)popcount((ushort)mask);
}

#endif

/* Bit n: element n of the mask is set. */
inline_always uint mask8(int8 mask) {
#ifdef MASK_REGISTERS
    return (uint)__builtin_ia32_cvtd2mask256(mask);
#elif defined(__AVX2__)
    return (uint)__builtin_ia32_movmskps256(as_float8(mask));
#else
    const int8 bit = mask & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
    const int4 four = bit.lo | bit.hi;
    return (uint)(four.x | four.y | four.z | four.w);
#endif
}

#ifdef WORD_SHUFFLES

/* Bit n: the highest bit of element n. */
inline_always uint signs_packed(ulong8 x) {
#ifdef MASK_REGISTERS
    return (uint)__builtin_ia32_cvtq2mask512(as_long8(x));
#else
    return (uint)__builtin_ia32_movmskpd256(__builtin_astype(x.lo, double4)) |
           (uint)__builtin_ia32_movmskpd256(__builtin_astype(x.hi, double4)) << 4;
#endif
}

#ifndef MASK_REGISTERS
/* Element n is word lane[n] of low.lo, low.hi, high.lo and high.hi, eight words each. all_four: false where no lane[n]
 * names a word of the last one. */
inline_always uint8 words_chosen(uint16 low, uint16 high, uint8 lane, bool all_four) {
    const int8 by_8 = as_int8(lane << 28), by_16 = as_int8(lane << 27);
    const uint8 a = __builtin_astype(__builtin_ia32_permvarsi256(as_int8(low.lo), as_int8(lane)), uint8);
    const uint8 b = __builtin_astype(__builtin_ia32_permvarsi256(as_int8(low.hi), as_int8(lane)), uint8);
    const uint8 c = __builtin_astype(__builtin_ia32_permvarsi256(as_int8(high.lo), as_int8(lane)), uint8);
    const uint8 d = __builtin_astype(__builtin_ia32_permvarsi256(as_int8(high.hi), as_int8(lane)), uint8);
    const uint8 of_low = by_8 < 0 ? b : a, of_high = !all_four ? c : by_8 < 0 ? d : c;
    return by_16 < 0 ? of_high : of_low;
}
#endif

/* Element n: of the 32 words of low and high, the one that lane[n] names. all: false where no lane names one of the
 * last eight. */
inline_always words16 words_shuffled(uint16 low, uint16 high, bytes16 lane, bool all) {
#ifdef MASK_REGISTERS
    return as_uint16(__builtin_ia32_vpermi2vard512(as_int16(low), convert_int16((uchar16)lane), as_int16(high)));
#else
    const uchar16 n = lane;
    return (uint16)(words_chosen(low, high, convert_uint8(n.lo), all),
                    words_chosen(low, high, convert_uint8(n.hi), all));
#endif
}

/* a, with the elements of b whose bits are set in slots. */
inline_always uint16 words_with(uint16 a, uint slots, uint16 b) {
    const int16 bit = (int16)(1 << 0, 1 << 1, 1 << 2, 1 << 3, 1 << 4, 1 << 5, 1 << 6, 1 << 7, 1 << 8, 1 << 9, 1 << 10,
                              1 << 11, 1 << 12, 1 << 13, 1 << 14, 1 << 15);
    return (bit & (int16)(int)slots) != 0 ? b : a;
}

#endif

/* ---------------------------------------------------------------------------------------------------------- stores */

/* Copies words of 4 bytes. Whole cache lines bypass the caches, which saves reading lines that are overwritten. */
inline_always void lines_store(const void *words, uint count, global void *out) {
    const uint *from = (const uint *)words;
    global uint *to = (global uint *)out;
    uint n = 0, ahead = min(count, (uint)(-(size_t)to / 4 % 16));
    loop_short for (; n < ahead; n++) to[n] = from[n];
    for (; n + 16 <= count; n += 16) {
        uint16 line = *(const words16 *)(from + n);
        line_store(line, (global uint16 *)(to + n));
    }
    loop_short for (; n < count; n++) to[n] = from[n];
}

#endif
