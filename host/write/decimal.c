/*
 * decimal.c - numbers as text
 *
 * A float that is a whole number below 10^9 is written as one. Others are scaled by a power of ten, in double, to nine
 * digits before the point, and rounded.
 *
 * Nine digits tell all floats apart. Relative to their size, decimals of nine digits lie at most 1e-8 apart and floats
 * at least 5.9e-8, subnormal ones more. So the nearest decimal is less than 0.6e-8 from the float, and no other float
 * is as near to it. The scaling rounds by some 1e-16, which does not matter here; only where two decimals are about
 * equally near may the ninth digit differ from printf's.
 */
#include "decimal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DIGITS = 9, LEAST_POWER = -30, MOST_POWER = 53, LEAST_FIXED = -5 };

/* 10^LEAST_POWER to 10^MOST_POWER: what brings any float, 1e-45 to 3.5e38, to nine digits. */
static const double powers[MOST_POWER - LEAST_POWER + 1] = {
    1e-30, 1e-29, 1e-28, 1e-27, 1e-26, 1e-25, 1e-24, 1e-23, 1e-22, 1e-21, 1e-20, 1e-19, 1e-18, 1e-17,
    1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9,  1e-8,  1e-7,  1e-6,  1e-5,  1e-4,  1e-3,
    1e-2,  1e-1,  1e0,   1e1,   1e2,   1e3,   1e4,   1e5,   1e6,   1e7,   1e8,   1e9,   1e10,  1e11,
    1e12,  1e13,  1e14,  1e15,  1e16,  1e17,  1e18,  1e19,  1e20,  1e21,  1e22,  1e23,  1e24,  1e25,
    1e26,  1e27,  1e28,  1e29,  1e30,  1e31,  1e32,  1e33,  1e34,  1e35,  1e36,  1e37,  1e38,  1e39,
    1e40,  1e41,  1e42,  1e43,  1e44,  1e45,  1e46,  1e47,  1e48,  1e49,  1e50,  1e51,  1e52,  1e53,
};

/* floor(log10(value)), or one too low; of a positive finite value. */
static int estimate_exponent(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    int binary = bits >> 23 ? (int)(bits >> 23) - 127 : ilogbf(value);
    return binary * 315653 >> 20; /* log10(2): right for every exponent of a float */
}

/* value (positive, finite) as digits * 10^(exponent - 8) with nine digits; returns the digits. */
static uint32_t split_decimal(float value, int *exponent) {
    *exponent = estimate_exponent(value);
    uint64_t digits = (uint64_t)((double)value * powers[DIGITS - 1 - *exponent - LEAST_POWER] + 0.5);
    if (digits >= 1000000000) {
        ++*exponent;
        digits = (uint64_t)((double)value * powers[DIGITS - 1 - *exponent - LEAST_POWER] + 0.5);
    }
    return (uint32_t)digits;
}

/* Two digits at a time halve the divisions, each of which waits for the one before. */
static const char pairs[] =
    "0001020304050607080910111213141516171819202122232425262728293031323334353637383940414243444546474849"
    "5051525354555657585960616263646566676869707172737475767778798081828384858687888990919293949596979899";

/* The last count digits of value. */
static void put_digits(char *to, uint32_t value, int count) {
    for (; count >= 2; count -= 2, value /= 100) memcpy(to + count - 2, pairs + 2 * (value % 100), 2);
    if (count) *to = (char)('0' + value % 10);
}

static int digit_count(uint32_t value) {
    static const uint32_t least[] = {0, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000, 1000000000};
    int binary = 32 - __builtin_clz(value | 1), count = binary * 1233 >> 12; /* log10(2) */
    return count + (value >= least[count]);
}

static char *put_bytes(char *to, const char *text, int length) {
    memcpy(to, text, (size_t)length);
    return to + length;
}

/* Writes count digits, the point after the first exponent + 1 of them; zeros fill up to the point. */
static char *put_fixed(char *to, const char *digits, int count, int exponent) {
    int whole = exponent + 1;
    if (whole <= 0) {
        to = put_bytes(to, "0.0000", 2 - whole);
        return put_bytes(to, digits, count);
    }
    if (count <= whole) {
        to = put_bytes(to, digits, count);
        return put_bytes(to, "00000000", whole - count);
    }
    to = put_bytes(to, digits, whole);
    *to++ = '.';
    return put_bytes(to, digits + whole, count - whole);
}

static char *put_scientific(char *to, const char *digits, int count, int exponent) {
    to = put_fixed(to, digits, count, 0);
    *to++ = 'e';
    *to++ = exponent < 0 ? '-' : '+';
    return put_u32_text(to, (uint32_t)(exponent < 0 ? -exponent : exponent));
}

char *put_float_text(char *to, float value) {
    if (isnan(value)) return put_bytes(to, "nan", 3);
    if (signbit(value)) *to++ = '-';
    value = fabsf(value);
    if (isinf(value)) return put_bytes(to, "inf", 3);
    if (value < 1e9f && value == (float)(uint32_t)value) return put_u32_text(to, (uint32_t)value);

    int exponent, count = DIGITS;
    char text[DIGITS];
    uint32_t digits = split_decimal(value, &exponent);
    put_digits(text, digits, DIGITS);
    while (text[count - 1] == '0') count--;
    if (exponent < LEAST_FIXED || exponent >= DIGITS) return put_scientific(to, text, count, exponent);
    return put_fixed(to, text, count, exponent);
}

char *put_u32_text(char *to, uint32_t value) {
    int count = digit_count(value);
    put_digits(to, value, count);
    return to + count;
}

char *put_double_text(char *to, double value) {
    char text[40];
    int length = 0;
    for (int digits = 15; digits <= 17; digits++) {
        length = snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    for (int n = 0; n < length; n++) to[n] = (char)(text[n] == ',' ? '.' : text[n]); /* the point of some locales */
    return to + length;
}
