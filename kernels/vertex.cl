/*
 * vertex.cl - crossing, position and normal of one vertex; host/lib/reference_vertex.inc is its twin
 *
 * One formula, one direction (from the lower to the higher sample index), one order of operations, no contraction, and
 * division rounded correctly: the same bits on every device.
 *
 * From the build: REAL (float for u8 i8 u16 i16 f32, double for u32 i32 f64), SAMPLE_VALUE(bits), DIVISION (1: built
 * in; 2: through double; 3: in integers), NORMALS.
 */
/* The first sample of a brick: its position in the grid. */
typedef struct corner {
    uint x, y, z;
} corner;

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
    uint magnitude = (uint)kept;
    if (magnitude >> 24) magnitude >>= 1, field++;
    magnitude = magnitude >> 23 ? ((uint)field << 23) | (magnitude & 0x7fffff) : magnitude;
    return as_float(sign | magnitude);
}

/* For 1 <= a <= 4: a root of 25 bits, the last of which decides the rounding (no root lies half way). */
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
#define ISOVALUE(s)  as_double((s)->isovalue64)
#else
#define DIVIDE(a, b) divide(a, b)
#define ROOT(a)      root(a)
#define ISOVALUE(s)  ((s)->isovalue32)
#endif

/* Where the isovalue lies between the samples at the two ends; halved first where their difference overflows. */
inline_always float crossing(REAL a, REAL b, REAL iso) {
#if FLOATING
    REAL scale = isinf(b - a) ? (REAL)0.5f : (REAL)1;
    a *= scale, b *= scale, iso *= scale;
#endif
    return (float)DIVIDE(iso - a, b - a);
}

/* Where an edge begins and which way it goes, in one word: offsets of its first end from the first sample of the
 * brick's row of bits 0-6 x, 7-10 y, 11-13 z, then a step of -1, 0 or 1 along each axis, plus 1, two bits each. */
#define PLACE(x, y, z, step_x, step_y, step_z)                                                                         \
    ((uint)(x) | (uint)(y) << 7 | (uint)(z) << 11 | (uint)((step_x) + 1) << 14 | (uint)((step_y) + 1) << 16 |          \
     (uint)((step_z) + 1) << 18)

/* The position on the edge at t, in world space. */
inline_always void position_make(const slab *s, corner c, uint place, float t, float out[3]) {
    int step_x = (int)(place >> 14 & 3) - 1, step_y = (int)(place >> 16 & 3) - 1, step_z = (int)(place >> 18 & 3) - 1;
    float x = (float)(s->first[0] + (int)(c.x + (place & 0x7f))) + (float)step_x * t;
    float y = (float)(s->first[1] + (int)(c.y + (place >> 7 & 0xf))) + (float)step_y * t;
    float z = (float)(s->first[2] + (int)(c.z + (place >> 11 & 7))) + (float)step_z * t;
    const float *m = s->matrix;
    out[0] = ((m[0] * x + m[1] * y) + m[2] * z) + m[3];
    out[1] = ((m[4] * x + m[5] * y) + m[6] * z) + m[7];
    out[2] = ((m[8] * x + m[9] * y) + m[10] * z) + m[11];
}

#if NORMALS

inline_always bool sample_missing(global const BITS *samples, const slab *s, ulong n) {
#if MISSING
    BITS bits = samples[n];
    bool missing = s->has_nodata && (bits == (BITS)s->nodata_bits[0] || bits == (BITS)s->nodata_bits[1]);
#if FLOATING
    missing = missing || (bits & EXPONENT) == EXPONENT;
#endif
    return missing;
#else
    return false;
#endif
}

/* Along one axis: central, one-sided at borders and beside missing samples, 0 between two. Scaled by 1/16, so that
 * nothing below overflows. */
inline_always REAL difference(global const BITS *samples, const slab *s, const uint p[3], uint axis) {
    const uint dims[3] = {s->nx, s->ny, s->nz};
    const ulong strides[3] = {1, s->nx, (ulong)s->nx * s->ny};
    ulong here = row_start(s, p[1], p[2]) + p[0];
    bool has_before = p[axis] > 0 && !sample_missing(samples, s, here - strides[axis]);
    bool has_after = p[axis] + 1 < dims[axis] && !sample_missing(samples, s, here + strides[axis]);
    REAL before = SAMPLE_VALUE(samples[has_before ? here - strides[axis] : here]);
    REAL after = SAMPLE_VALUE(samples[has_after ? here + strides[axis] : here]);
    REAL weight = has_before && has_after ? (REAL)0.03125f : (REAL)0.0625f;
    return weight * after - weight * before;
}

/* Unit length, towards lower values; zero where the gradient vanishes. */
inline_always void normal_store(global const BITS *samples, const slab *s, corner c, uint place, float t,
                                global float *out) {
    const float *m = s->normal_matrix;
    const uint a[3] = {c.x + (place & 0x7f), c.y + (place >> 7 & 0xf), c.z + (place >> 11 & 7)};
    const uint b[3] = {a[0] + (place >> 14 & 3) - 1, a[1] + (place >> 16 & 3) - 1, a[2] + (place >> 18 & 3) - 1};
    REAL g[3], n[3];
    for (uint axis = 0; axis < 3; axis++) {
        REAL ga = difference(samples, s, a, axis), gb = difference(samples, s, b, axis);
        g[axis] = ga + (REAL)t * (gb - ga);
    }
    for (uint row = 0; row < 3; row++)
        n[row] = -(((REAL)m[3 * row] * g[0] + (REAL)m[3 * row + 1] * g[1]) + (REAL)m[3 * row + 2] * g[2]);
    REAL x = n[0] < 0 ? -n[0] : n[0], y = n[1] < 0 ? -n[1] : n[1], z = n[2] < 0 ? -n[2] : n[2];
    REAL largest = x > y ? x : y;
    largest = largest > z ? largest : z;
    out[0] = out[1] = out[2] = 0;
    if (!(largest > 0)) return;
    for (uint row = 0; row < 3; row++) n[row] = DIVIDE(n[row], largest);
    REAL length = ROOT((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
    for (uint row = 0; row < 3; row++) out[row] = (float)DIVIDE(n[row], length);
}

#endif

#endif
