/*
 * test_inside.c - the test on bit patterns against (double)sample >= isovalue
 *
 * 8 and 16 bits: every pattern. 32 and 64 bits: patterns around every value that could matter (limits, zeros,
 * subnormals, infinities, the isovalue itself, powers of two) and random ones. Missing floats (NaN, infinities) may
 * fall anywhere.
 */
#include "expect.h"
#include "grid/inside.h"
#include "random.h"
#include "samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VALUES_MAX = 4096 };

static double values[VALUES_MAX];
static unsigned value_count;

static uint64_t patterns[1 << 16];
static unsigned pattern_count;

static unsigned type_bits(tc_type type) {
    static const unsigned bits[] = {8, 8, 16, 16, 32, 32, 32, 64};
    return bits[type];
}

static uint64_t type_mask(tc_type type) { return UINT64_MAX >> (64 - type_bits(type)); }

static double value_of(tc_type type, uint64_t pattern) {
    unsigned char bytes[8];
    memcpy(bytes, &pattern, sizeof bytes); /* little-endian hosts only, as the library is */
    switch (type) {
    case TC_F64: {
        double value;
        memcpy(&value, bytes, sizeof value);
        return value;
    }
    case TC_F32: {
        float value;
        memcpy(&value, bytes, sizeof value);
        return (double)value;
    }
    case TC_I8:
        return (int8_t)pattern;
    case TC_I16:
        return (int16_t)pattern;
    case TC_I32:
        return (int32_t)pattern;
    default:
        return (double)pattern;
    }
}

/* As the kernels do it, in unsigned arithmetic as wide as the sample. */
static bool pattern_is_inside(tc_type type, inside_range range, uint64_t pattern) {
    return ((pattern - range.low) & type_mask(type)) <= (range.span & type_mask(type));
}

/* The upper 32 bits of a key, likewise. */
static uint32_t key_of(tc_type type, inside_range range, uint64_t pattern) {
    uint64_t sign = UINT64_C(1) << (type_bits(type) - 1);
    uint64_t key = type < TC_F32 ? pattern ^ range.key_flip : pattern & sign ? ~pattern : pattern | sign;
    return (uint32_t)((key & type_mask(type)) >> (type_bits(type) == 64 ? 32 : 0));
}

/* ----------------------------------------------------------------------------------------------------- what to try */

static void value_add(double value) {
    if (value_count < VALUES_MAX && isfinite(value)) values[value_count++] = value;
}

static void values_add_around(double value) {
    const double steps[] = {0, 0.5, 1, 0x1p-149, 0x1p-1074, 1e-40};
    for (unsigned n = 0; n < sizeof steps / sizeof *steps; n++) {
        value_add(value + steps[n]);
        value_add(value - steps[n]);
    }
    value_add(nextafter(value, INFINITY));
    value_add(nextafter(value, -INFINITY));
    if (fabs(value) <= FLT_MAX) {
        value_add((double)nextafterf((float)value, INFINITY));
        value_add((double)nextafterf((float)value, -INFINITY));
    }
}

/* Isovalues for a type; those of narrow types within reach of its range, and beyond. */
static void values_choose(tc_type type) {
    const double landmarks[] = {0,          1,       -1,       127,      128,      -128,      255,
                                256,        32767,   -32768,   65535,    -0x1p31,  0x1p31,    0x1p32,
                                0.1,        -0.3,    3.14159,  0x1p24,   0x1p-126, -0x1p-126, 0x1p53,
                                -0x1p53,    FLT_MAX, -FLT_MAX, 1e30,     1e-30,    FLT_MIN,   -0x1p-149,
                                0x1.8p-149, 1e300,   DBL_MAX,  -DBL_MAX, DBL_MIN,  0x1p-1074, 65504.7};
    value_count = 0;
    value_add(-0.0);
    for (unsigned n = 0; n < sizeof landmarks / sizeof *landmarks; n++) values_add_around(landmarks[n]);
    for (unsigned n = 0; n < 40; n++) values_add_around(random_between(-300, 300));
    for (unsigned n = 0; n < 40; n++) value_add(value_of(type, random_u64() & type_mask(type)));
}

static void patterns_add_around(tc_type type, uint64_t pattern) {
    for (uint64_t n = 0; n < 7 && pattern_count < sizeof patterns / sizeof *patterns; n++)
        patterns[pattern_count++] = (pattern + n - 3) & type_mask(type);
}

static void patterns_choose(tc_type type) {
    pattern_count = 0;
    if (type_bits(type) <= 16) {
        while (pattern_count < 1u << type_bits(type)) patterns[pattern_count] = pattern_count, pattern_count++;
        return;
    }
    for (unsigned bit = 0; bit < type_bits(type); bit++) {
        patterns_add_around(type, UINT64_C(1) << bit);
        patterns_add_around(type, ~(UINT64_C(1) << bit));
        patterns_add_around(type, UINT64_MAX << bit);
    }
    for (unsigned n = 0; n < 200; n++) patterns_add_around(type, random_u64());
}

/* The pattern of the isovalue itself, as the type has it, and its neighbours. */
static unsigned patterns_add_isovalue(tc_type type, double isovalue) {
    unsigned count = pattern_count;
    uint64_t pattern = 0;
    float rounded = fabs(isovalue) <= FLT_MAX ? (float)isovalue : 0;
    if (type == TC_F64) memcpy(&pattern, &isovalue, sizeof isovalue);
    if (type == TC_F32) memcpy(&pattern, &rounded, sizeof rounded);
    if (type < TC_F32 && fabs(isovalue) < 0x1p40) pattern = (uint64_t)(int64_t)floor(isovalue);
    if (type_bits(type) > 16) patterns_add_around(type, pattern);
    return count;
}

/* ----------------------------------------------------------------------------------------------------------- tests */

static void expect_isovalue(tc_type type, double isovalue) {
    inside_range range = inside_range_of(type, isovalue);
    unsigned wrong = 0, keys_wrong = 0, in = 0, out = 0, kept = patterns_add_isovalue(type, isovalue);
    uint64_t culprit = 0;
    for (unsigned n = 0; n < pattern_count; n++) {
        double value = value_of(type, patterns[n]);
        if (!isfinite(value)) continue;
        bool inside = value >= isovalue;
        in += inside;
        out += !inside;
        if (!range.uniform && pattern_is_inside(type, range, patterns[n]) != inside && wrong++ == 0)
            culprit = patterns[n];
        uint32_t key = key_of(type, range, patterns[n]);
        keys_wrong += !range.uniform && (inside ? key < range.key_outside : key >= range.key_inside);
    }
    pattern_count = kept;
    EXPECT(range.key_inside - range.key_outside <= (type == TC_F64), "%s, isovalue %.17g: keys from %x to %x in doubt",
           tc_type_name(type), isovalue, range.key_outside, range.key_inside);
    EXPECT(keys_wrong == 0, "%s, isovalue %.17g: %u keys are on the wrong side", tc_type_name(type), isovalue,
           keys_wrong);
    EXPECT(wrong == 0, "%s, isovalue %.17g: %u patterns are on the wrong side, the first %llx", tc_type_name(type),
           isovalue, wrong, (unsigned long long)culprit);
    EXPECT(!range.uniform || in == 0 || out == 0,
           "%s, isovalue %.17g: %u samples are inside, %u are not, though all are "
           "said to be on one side",
           tc_type_name(type), isovalue, in, out);
}

static void expect_value(tc_type type, double value) {
    uint64_t equal[2];
    bool any = value_bits(type, value, equal);
    unsigned wrong = 0, found = 0, kept = patterns_add_isovalue(type, value);
    for (unsigned n = 0; n < pattern_count; n++) {
        bool listed =
            any && (patterns[n] == (equal[0] & type_mask(type)) || patterns[n] == (equal[1] & type_mask(type)));
        found += listed;
        wrong += listed != (value_of(type, patterns[n]) == value);
    }
    pattern_count = kept;
    EXPECT(wrong == 0, "%s: %u patterns are wrongly taken for the value %.17g, or not", tc_type_name(type), wrong,
           value);
    EXPECT(!any || found, "%s: the patterns of %.17g are none that was tried", tc_type_name(type), value);
}

int main(void) {
    random_state = 1996;
    for (tc_type type = TC_U8; type <= TC_F64; type++) {
        uint64_t equal[2];
        patterns_choose(type);
        values_choose(type);
        for (unsigned n = 0; n < value_count; n++) {
            expect_isovalue(type, values[n]);
            expect_value(type, values[n]);
        }
        EXPECT(!value_bits(type, NAN, equal) && !value_bits(type, INFINITY, equal),
               "%s: a sample that is not finite is missing whether or not it is asked for", tc_type_name(type));
    }
    return EXPECT_DONE();
}
