/* vtk_legacy_values.c - values of VTK legacy files, from words or big-endian bytes, and their conversion; see
 * vtk_legacy_values.h */
#include "vtk_legacy/vtk_legacy_values.h"

#include "file/number_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_NUMBER = 400 };

/* ---------------------------------------------------------------------------------------------------- decoding */

/* The absolute value of an integer of text. 0 where it is none. */
static int parse_integer(const char *word, const char *end, int *is_negative, uint64_t *value) {
    const char *p = word;
    *is_negative = *p == '-';
    *value = 0;
    if (*p == '-' || *p == '+') p++;
    if (p == end) return 0;
    for (; p < end && *p >= '0' && *p <= '9'; p++)
        if (__builtin_mul_overflow(*value, 10, value) || __builtin_add_overflow(*value, (uint64_t)(*p - '0'), value))
            return 0;
    if (p < end) { /* an integer written as 3.0 or 1e2 */
        char *stop;
        double number = strtod(word, &stop);
        if (stop != end || number != floor(number) || fabs(number) > 0x1p53) return 0;
        *value = (uint64_t)fabs(number);
    }
    return 1;
}

static int parse_value(const char *word, const char *end, int type, uint8_t *to) {
    char *stop;
    uint64_t absolute;
    int is_negative;
    if (type == TC_F32) {
        float value = strtof(word, &stop);
        memcpy(to, &value, sizeof value);
        return stop == end;
    }
    if (type == TC_F64) {
        double value = strtod(word, &stop);
        memcpy(to, &value, sizeof value);
        return stop == end;
    }
    if (!parse_integer(word, end, &is_negative, &absolute)) return 0;
    if (type != LEGACY_BIT) return element_put_integer(type, absolute, is_negative, to);
    *to = absolute != 0;
    return absolute <= UINT8_MAX && (!is_negative || !absolute);
}

/* The next word where it lies, or, at the very end of the file, in `last`, since parsing goes on to a character that
 * belongs to no number. Of a longer one the first LONGEST_NUMBER + 1 characters. */
static int number_word(legacy *r, const char *what, char last[LONGEST_NUMBER + 1], const char **word,
                       const char **end) {
    size_t at = r->at;
    while (at < r->size && legacy_is_space(r->bytes[at])) at++;
    size_t start = at;
    while (at < r->size && at - start <= LONGEST_NUMBER && !legacy_is_space(r->bytes[at])) at++;
    r->at = at;
    if (at == start) return legacy_fail(r, "ends within the values of %s; the file is cut", what);
    *word = (const char *)r->bytes + start;
    if (at == r->size && at - start <= LONGEST_NUMBER) {
        memcpy(last, *word, at - start);
        last[at - start] = 0;
        *word = last;
    }
    *end = *word + (at - start);
    return 0;
}

/* Parses a word, or the first of several numbers in it, and leaves r->at behind that. Returns 0 where it is none. */
static int take_value(legacy *r, const char *word, const char *end, int type, uint8_t *to) {
    char number[LONGEST_NUMBER + 1];
    size_t length = (size_t)(end - word);
    if (length <= LONGEST_NUMBER && parse_value(word, end, type, to)) return 1;
    size_t used = number_copy(word, length, number, sizeof number);
    if (!used || !parse_value(number, number + strlen(number), type, to)) return 0;
    r->at -= length - used;
    return 1;
}

static int refuse_word(const legacy *r, const char *what, const char *word, const char *end) {
    char shown[40];
    size_t length = 0;
    if (end - word > LONGEST_NUMBER)
        return legacy_fail(r, "has a word of more than %d characters among the values of %s; it is damaged",
                           LONGEST_NUMBER, what);
    for (; word < end && length < sizeof shown - 1; word++)
        shown[length++] = (char)(*word > ' ' && *word < 127 ? *word : '?');
    shown[length] = 0;
    return legacy_fail(r, "has '%s' among the values of %s, which is no number of its type", shown, what);
}

static int decode_words(legacy *r, const char *what, int type, uint64_t count, uint8_t *to) {
    char last[LONGEST_NUMBER + 1];
    size_t step = type == LEGACY_BIT ? 1 : element_bytes(type);
    for (uint64_t i = 0; i < count; i++, to += step) {
        const char *word, *end;
        int status = number_word(r, what, last, &word, &end);
        if (status) return status;
        /* Set where there is no status. NOLINTNEXTLINE(clang-analyzer-core.CallAndMessage) */
        if (!take_value(r, word, end, type, to)) return refuse_word(r, what, word, end);
    }
    return 0;
}

int legacy_skip_number(legacy *r, const char *what) {
    char last[LONGEST_NUMBER + 1], number[LONGEST_NUMBER + 1];
    const char *word, *end;
    int status = number_word(r, what, last, &word, &end);
    if (status) return status;
    /* Set where there is no status. NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult) */
    size_t length = (size_t)(end - word), used = number_copy(word, length, number, sizeof number);
    if (!used && length > LONGEST_NUMBER) return refuse_word(r, what, word, end);
    if (used) r->at -= length - used;
    return 0;
}

#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define FROM_BIG(bits, value) __builtin_bswap##bits(value)
#else
#define FROM_BIG(bits, value) (value)
#endif

#define DECODE_BYTES(bits)                                                                                             \
    for (uint64_t i = 0; i < count; i++) {                                                                             \
        uint##bits##_t value;                                                                                          \
        memcpy(&value, from + i * sizeof value, sizeof value);                                                         \
        value = FROM_BIG(bits, value);                                                                                 \
        memcpy(to + i * sizeof value, &value, sizeof value);                                                           \
    }                                                                                                                  \
    break

static void decode_bytes(legacy *r, int type, uint64_t count, uint8_t *to) {
    const unsigned char *from = r->bytes + r->at;
    if (type == LEGACY_BIT) {
        for (uint64_t i = 0; i < count; i++) to[i] = from[i / 8] >> (7 - i % 8) & 1;
        r->at += (size_t)(count + 7) / 8;
        return;
    }
    r->at += (size_t)count * element_bytes(type);
    switch (element_bytes(type)) {
    case 1:
        memcpy(to, from, (size_t)count);
        break;
    case 2:
        DECODE_BYTES(16);
    case 4:
        DECODE_BYTES(32);
    default:
        DECODE_BYTES(64);
    }
}

int legacy_decode(legacy *r, const char *what, int type, uint64_t count, uint8_t *to) {
    if (!r->is_binary) return decode_words(r, what, type, count, to);
    decode_bytes(r, type, count, to);
    return 0;
}

/* -------------------------------------------------------------------------------------------------- conversion */

/* Converts `count` values; those that do not fit are counted. */
#define CONVERT(stored_type, wanted_type, fits)                                                                        \
    do {                                                                                                               \
        for (uint64_t i = 0; i < count; i++) {                                                                         \
            stored_type value;                                                                                         \
            memcpy(&value, from + i * sizeof value, sizeof value);                                                     \
            wanted_type result = (wanted_type)value;                                                                   \
            unfit += (fits) ? 0 : 1;                                                                                   \
            ((wanted_type *)to)[i] = result;                                                                           \
        }                                                                                                              \
        return unfit;                                                                                                  \
    } while (0)

/* A case of a switch over stored types, for integers that the wanted type holds all of. */
#define CONVERT_CASE(wanted_type, type, c_type)                                                                        \
    case type:                                                                                                         \
        CONVERT(c_type, wanted_type, 1);

static uint64_t to_f32(int type, const uint8_t *from, uint64_t count, void *to) {
    uint64_t unfit = 0;
    switch (type) {
    case LEGACY_BIT:
        CONVERT(uint8_t, float, 1);
#define TO_F32(type, name, c_type, ...) CONVERT_CASE(float, type, c_type)
        INTEGER_TYPES(TO_F32)
#undef TO_F32
    default:
        CONVERT(float, float, isfinite(result));
    }
}

static uint64_t to_i64(int type, const uint8_t *from, uint64_t count, void *to) {
    uint64_t unfit = 0;
    switch (type) {
    case LEGACY_BIT:
        CONVERT(uint8_t, int64_t, 1);
    case ELEMENT_I64:
        CONVERT(int64_t, int64_t, 1);
#define TO_I64(type, name, c_type, ...) CONVERT_CASE(int64_t, type, c_type)
        INTEGER_TYPES(TO_I64)
#undef TO_I64
    default:
        CONVERT(uint64_t, int64_t, result >= 0);
    }
}

/* Coordinates and 64-bit integers. An integer is converted back to see whether a double holds it; the range is checked
 * first, as one that rounds up to the power of two would overflow on the way back. */
static uint64_t to_f64(int type, const uint8_t *from, uint64_t count, void *to) {
    uint64_t unfit = 0;
    switch (type) {
    case TC_F64:
        CONVERT(double, double, isfinite(result));
    case ELEMENT_I64:
        CONVERT(int64_t, double, result < 0x1p63 && (int64_t)result == value);
#define TO_F64(type, name, c_type, ...) CONVERT_CASE(double, type, c_type)
        INTEGER_TYPES(TO_F64)
#undef TO_F64
    default:
        CONVERT(uint64_t, double, result < 0x1p64 && (uint64_t)result == value);
    }
}

static uint64_t to_u8(const uint8_t *from, uint64_t count, void *to) {
    uint64_t unfit = 0;
    CONVERT(int32_t, uint8_t, value == result);
}

uint64_t legacy_convert(int type, const uint8_t *from, uint64_t count, int wanted, void *to) {
    switch (wanted) {
    case TC_F32:
        return to_f32(type, from, count, to);
    case TC_F64:
        return to_f64(type, from, count, to);
    case ELEMENT_I64:
        return to_i64(type, from, count, to);
    default:
        return to_u8(from, count, to);
    }
}
