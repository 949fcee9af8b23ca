/*
 * crossing.cl - where the isovalue lies on an edge; host/lib/reference/reference_crossing.inc is its twin
 *
 * One formula, one direction (from the lower to the higher sample index), one order of operations, no contraction, and
 * division rounded correctly: the same bits on every device.
 *
 * From the build: DIVISION (1: built in; 2: through double; 3: in integers).
 */
#ifndef CROSSING_CL
#define CROSSING_CL

#include "values.cl"

#ifdef REAL

#if DIVISION == 1
inline_always float divide(float a, float b) { return a / b; }
inline_always float root(float a) { return sqrt(a); }
#elif DIVISION == 2
/* Rounding to double first changes nothing: 53 >= 2 * 24 + 2 bits. */
inline_always float divide(float a, float b) { return (float)((double)a / (double)b); }
inline_always float root(float a) { return (float)sqrt((double)a); }
#else
/* value = *mantissa 2^*exponent with bit 23 of the mantissa set; a is finite and not 0. */
inline_always void float_split(float a, uint *mantissa, int *exponent) {
    uint bits = as_uint(a) & 0x7fffffff;
    uint field = bits >> 23;
    *mantissa = field ? (bits & 0x7fffff) | 0x800000 : bits;
    *exponent = (field ? (int)field : 1) - 150;
    int shift = (int)clz(*mantissa) - 8;
    *mantissa <<= shift;
    *exponent -= shift;
}

/* Round to nearest even, by hand; a and b are finite, b is not 0, the quotient does not overflow. */
inline_always float divide(float a, float b) {
    uint sign = (as_uint(a) ^ as_uint(b)) & 0x80000000u;
    if ((as_uint(a) & 0x7fffffff) == 0) return as_float(sign);
    uint ma, mb;
    int ea, eb;
    float_split(a, &ma, &ea);
    float_split(b, &mb, &eb);
    ulong quotient = ((ulong)ma << 32) / mb; /* 32 or 33 bits */
    bool inexact = quotient * mb != (ulong)ma << 32;
    int exponent = ea - eb - 32;
    int drop = 64 - (int)clz(quotient) - 24; /* bits below a full mantissa, and below the least subnormal */
    drop = max(drop, -149 - exponent);
    if (drop > 40) return as_float(sign);
    ulong kept = quotient >> drop, rest = quotient - (kept << drop), half_way = 1ul << (drop - 1);
    kept += rest > half_way || (rest == half_way && (inexact || (kept & 1)));
    int field = exponent + drop + 150;
    uint magnitude = (uint)kept; /* at most 24 bits: no quotient lies so close below 2^n that it is rounded to it */
    magnitude = magnitude >> 23 ? ((uint)field << 23) | (magnitude & 0x7fffff) : magnitude;
    return as_float(sign | magnitude);
}

/* For 1 <= a <= 4: makes 25 bits of the root; the last bit decides the rounding, as no root lies half way. */
inline_always float root(float a) {
    uint mantissa;
    int exponent;
    float_split(a, &mantissa, &exponent);
    ulong square = (ulong)mantissa << (exponent + 23 + 25), r = 0;
    for (ulong bit = 1ul << 26; bit; bit >>= 1)
        if ((r | bit) * (r | bit) <= square) r |= bit;
    return (float)((r + 1) >> 1) * 0x1p-23f;
}
#endif

#if WIDE
#define DIVIDE(a, b) ((a) / (b))
#define ROOT(a)      sqrt(a)
#else
#define DIVIDE(a, b) divide(a, b)
#define ROOT(a)      root(a)
#endif

/* Where the isovalue lies between the samples at the two ends. All three are halved where the difference overflows. */
inline_always float crossing(REAL a, REAL b, REAL iso) {
#if FLOATING
    REAL scale = isinf(b - a) ? (REAL)0.5f : (REAL)1;
    a *= scale, b *= scale, iso *= scale;
#endif
    return (float)DIVIDE(iso - a, b - a);
}

#endif

#endif
