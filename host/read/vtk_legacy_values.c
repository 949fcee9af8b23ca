/*
 * vtk_legacy_values.c - arrays of VTK legacy files; see vtk_legacy.h
 *
 * Values are decoded in blocks into native ones of the stored type, from words or big-endian bytes, and converted from
 * there where another type is wanted. Sizes as VTK's own reader has them: long is 8 bytes, vtkIdType 4, bits are
 * packed, the first in the highest bit.
 */
#include "vtk_legacy.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { BLOCK = 1024, LONGEST_NUMBER = 400, IN_PLACE_FROM = 1 << 16 };

typedef union block {
    uint8_t bytes[BLOCK * 8];
    double aligned;
} block;

int legacy_type(legacy *r, int *type) {
    static const struct {
        const char *name;
        int type;
    } types[] = {{"unsigned_char", TC_U8},
                 {"char", TC_I8},
                 {"signed_char", TC_I8},
                 {"unsigned_short", TC_U16},
                 {"short", TC_I16},
                 {"unsigned_int", TC_U32},
                 {"int", TC_I32},
                 {"vtkIdType", TC_I32},
                 {"unsigned_long", ELEMENT_U64},
                 {"long", ELEMENT_I64},
                 {"vtktypeint64", ELEMENT_I64},
                 {"vtktypeuint64", ELEMENT_U64},
                 {"float", TC_F32},
                 {"double", TC_F64},
                 {"bit", LEGACY_BIT},
                 {"string", LEGACY_STRING},
                 {"utf8_string", LEGACY_STRING},
                 {"variant", LEGACY_VARIANT}};
    char word[LEGACY_WORD];
    int status = legacy_need(r, "a type of values", word);
    if (status) return status;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strcasecmp(word, types[i].name)) {
            *type = types[i].type;
            return 0;
        }
    return legacy_fail(r,
                       "has values of type '%.40s', which is unknown; bit, unsigned_char to double, vtktypeint64, "
                       "vtkIdType, string and variant are known",
                       word);
}

/* ---------------------------------------------------------------------------------------------------- decoding */

/* An integer of text as 64 bits of two's complement. 0 where it is none or the type cannot hold it. */
static int parse_integer(const char *word, const char *end, int type, uint64_t *bits) {
    static const uint64_t low[] = {0, 1u << 7, 0, 1u << 15, 0, 1u << 31, 0, 0, 1ull << 63, 0},
                          high[] = {UINT8_MAX, INT8_MAX, UINT16_MAX, INT16_MAX, UINT32_MAX,
                                    INT32_MAX, 0,        0,          INT64_MAX, UINT64_MAX};
    const char *p = word;
    int is_negative = *p == '-';
    uint64_t value = 0;
    if (*p == '-' || *p == '+') p++;
    if (p == end) return 0;
    for (; p < end && *p >= '0' && *p <= '9'; p++)
        if (__builtin_mul_overflow(value, 10, &value) || __builtin_add_overflow(value, (uint64_t)(*p - '0'), &value))
            return 0;
    if (p < end) { /* an integer written as 3.0 or 1e2 */
        char *stop;
        double number = strtod(word, &stop);
        if (stop != end || number != floor(number) || fabs(number) > 0x1p53) return 0;
        value = (uint64_t)fabs(number);
    }
    if (value > (is_negative ? low : high)[type]) return 0;
    *bits = is_negative ? 0 - value : value;
    return 1;
}

static int parse_value(const char *word, const char *end, int type, uint8_t *to) {
    char *stop;
    uint64_t bits;
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
    if (!parse_integer(word, end, type == LEGACY_BIT ? TC_U8 : type, &bits)) return 0;
    uint8_t bits8 = type == LEGACY_BIT ? bits != 0 : (uint8_t)bits;
    uint16_t bits16 = (uint16_t)bits;
    uint32_t bits32 = (uint32_t)bits;
    switch (type == LEGACY_BIT ? 1 : element_bytes(type)) {
    case 1:
        *to = bits8;
        break;
    case 2:
        memcpy(to, &bits16, 2);
        break;
    case 4:
        memcpy(to, &bits32, 4);
        break;
    default:
        memcpy(to, &bits, 8);
    }
    return 1;
}

/* The next word where it lies, or, at the very end of the file, in `last`, since parsing goes on to a character that
 * belongs to no number. */
static int number_word(legacy *r, const char *what, char last[LONGEST_NUMBER + 1], const char **word,
                       const char **end) {
    size_t at = r->at;
    while (at < r->size && legacy_is_space(r->bytes[at])) at++;
    size_t start = at;
    while (at < r->size && !legacy_is_space(r->bytes[at])) at++;
    r->at = at;
    if (at == start) return legacy_fail(r, "ends within the values of %s; the file is cut", what);
    if (at - start > LONGEST_NUMBER)
        return legacy_fail(r, "has a word of %zu characters among the values of %s; it is damaged", at - start, what);
    *word = (const char *)r->bytes + start;
    if (at == r->size) {
        memcpy(last, *word, at - start);
        last[at - start] = 0;
        *word = last;
    }
    *end = *word + (at - start);
    return 0;
}

static int decode_words(legacy *r, const char *what, int type, uint64_t count, uint8_t *to) {
    char last[LONGEST_NUMBER + 1];
    size_t step = type == LEGACY_BIT ? 1 : element_bytes(type);
    for (uint64_t i = 0; i < count; i++, to += step) {
        const char *word, *end;
        int status = number_word(r, what, last, &word, &end);
        if (status) return status;
        if (parse_value(word, end, type, to)) continue;
        char shown[40];
        size_t length = 0;
        for (; word < end && length < sizeof shown - 1; word++)
            shown[length++] = *word > ' ' && *word < 127 ? *word : '?';
        shown[length] = 0;
        return legacy_fail(r, "has '%s' among the values of %s, which is no number of its type", shown, what);
    }
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

static int decode(legacy *r, const char *what, int type, uint64_t count, uint8_t *to) {
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

static uint64_t to_f32(int type, const uint8_t *from, uint64_t count, void *to) {
    uint64_t unfit = 0;
    switch (type) {
    case TC_U8:
    case LEGACY_BIT:
        CONVERT(uint8_t, float, 1);
    case TC_I8:
        CONVERT(int8_t, float, 1);
    case TC_U16:
        CONVERT(uint16_t, float, 1);
    case TC_I16:
        CONVERT(int16_t, float, 1);
    case TC_U32:
        CONVERT(uint32_t, float, 1);
    case TC_I32:
        CONVERT(int32_t, float, 1);
    case TC_F32:
        CONVERT(float, float, isfinite(result));
    case TC_F64:
        CONVERT(double, float, isfinite(result));
    case ELEMENT_I64:
        CONVERT(int64_t, float, 1);
    default:
        CONVERT(uint64_t, float, 1);
    }
}

static uint64_t to_i64(int type, const uint8_t *from, uint64_t count, void *to) {
    uint64_t unfit = 0;
    switch (type) {
    case TC_U8:
    case LEGACY_BIT:
        CONVERT(uint8_t, int64_t, 1);
    case TC_I8:
        CONVERT(int8_t, int64_t, 1);
    case TC_U16:
        CONVERT(uint16_t, int64_t, 1);
    case TC_I16:
        CONVERT(int16_t, int64_t, 1);
    case TC_U32:
        CONVERT(uint32_t, int64_t, 1);
    case TC_I32:
        CONVERT(int32_t, int64_t, 1);
    case ELEMENT_I64:
        CONVERT(int64_t, int64_t, 1);
    default:
        CONVERT(uint64_t, int64_t, result >= 0);
    }
}

/* The range is checked before the way back: what rounds to the power of two itself would overflow there. */
static uint64_t to_f64(int type, const uint8_t *from, uint64_t count, void *to) {
    uint64_t unfit = 0;
    if (type == ELEMENT_I64) CONVERT(int64_t, double, result < 0x1p63 && (int64_t)result == value);
    CONVERT(uint64_t, double, result < 0x1p64 && (uint64_t)result == value);
}

static uint64_t to_u8(const uint8_t *from, uint64_t count, void *to) {
    uint64_t unfit = 0;
    CONVERT(int32_t, uint8_t, value == result);
}

static uint64_t convert(int type, const uint8_t *from, uint64_t count, int wanted, void *to) {
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

static int read_converted(legacy *r, const char *what, int type, uint64_t count, int wanted, uint8_t *to,
                          uint64_t *unfit) {
    block values;
    for (uint64_t done = 0, n; done < count; done += n) {
        n = count - done < BLOCK ? count - done : BLOCK;
        int status = decode(r, what, type, n, values.bytes);
        if (status) return status;
        *unfit += convert(type, values.bytes, n, wanted, to + done * element_bytes(wanted));
    }
    return 0;
}

/* ------------------------------------------------------------------------------------------------------ arrays */

/* Bytes that so many values take in the file at least. */
static int check_room(const legacy *r, const char *what, int type, uint64_t count) {
    uint64_t needed, left = r->size - r->at;
    if (type >= LEGACY_STRING || !r->is_binary)
        needed = count > UINT64_MAX / 2 ? UINT64_MAX : count * 2 - (count > 0 && type != LEGACY_STRING);
    else if (type == LEGACY_BIT)
        needed = count / 8 + (count % 8 > 0);
    else if (__builtin_mul_overflow(count, element_bytes(type), &needed))
        needed = UINT64_MAX;
    if (type == LEGACY_STRING) needed /= 2;
    if (needed <= left) return 0;
    return legacy_fail(r,
                       "declares %" PRIu64 " values of %s, for which the %" PRIu64
                       " bytes that follow are too few; the count is wrong or the file is cut",
                       count, what, left);
}

/* A text of a binary file: its length is in the lower bits of 1, 2, 4 or 8 bytes, which the upper two tell. */
static int skip_text(legacy *r, const char *what) {
    size_t left = r->size - r->at;
    if (left) {
        unsigned kind = r->bytes[r->at] >> 6;
        size_t bytes = (size_t)1 << (3 - kind);
        uint64_t length = r->bytes[r->at] & 63;
        for (size_t i = 1; i < bytes && i < left; i++) length = length << 8 | r->bytes[r->at + i];
        if (bytes <= left && length <= left - bytes) {
            r->at += bytes + (size_t)length;
            return 0;
        }
    }
    return legacy_fail(r, "ends within the texts of %s; the file is cut or a length is wrong", what);
}

/* The number of a type and, unless it is empty, an encoded text of any length. */
static int skip_variant(legacy *r, const char *what) {
    char word[LEGACY_WORD];
    int status = legacy_need(r, what, word);
    if (status || !legacy_line_goes_on(r)) return status;
    while (r->at < r->size && legacy_is_space(r->bytes[r->at])) r->at++;
    while (r->at < r->size && !legacy_is_space(r->bytes[r->at])) r->at++;
    return 0;
}

static int skip_values(legacy *r, const char *what, int type, uint64_t count) {
    char last[LONGEST_NUMBER + 1];
    const char *start, *end;
    int status = 0;
    if (type == LEGACY_STRING && count) legacy_skip_line(r);
    if (r->is_binary && type < LEGACY_STRING) {
        r->at += (size_t)(type == LEGACY_BIT ? (count + 7) / 8 : count * element_bytes(type));
        return 0;
    }
    for (uint64_t i = 0; i < count && !status; i++) {
        if (type == LEGACY_STRING && r->is_binary)
            status = skip_text(r, what);
        else if (type == LEGACY_STRING && r->at == r->size)
            status = legacy_fail(r, "ends within the texts of %s; the file is cut", what);
        else if (type == LEGACY_STRING)
            legacy_skip_line(r);
        else if (type == LEGACY_VARIANT)
            status = skip_variant(r, what);
        else
            status = number_word(r, what, last, &start, &end);
    }
    return status;
}

/* METADATA: the names of components, a line each, and other information, up to a blank line. */
static void skip_metadata(legacy *r, int64_t components) {
    if (!legacy_accept(r, "METADATA")) return;
    legacy_skip_line(r);
    for (;;) {
        size_t start = r->at;
        if (legacy_skip_line(r)) return;
        if (r->at - start < 15 || strncasecmp((const char *)r->bytes + start, "COMPONENT_NAMES", 15)) continue;
        for (int64_t i = 0; i < components && r->at < r->size; i++) legacy_skip_line(r); /* they may be empty */
    }
}

/* Bytes of a large binary array are used where they lie, in a mapping that the dataset owns. */
static int map_in_place(legacy *r, uint64_t count, void **out) {
    if (!r->out->mapping) {
        mapping m;
        int status = mapping_open(r->path, &m);
        if (status) return status;
        if (m.size != r->size) {
            mapping_close(&m);
            return legacy_fail(r, "changed while it was read; read it again");
        }
        r->out->mapping = (void *)(uintptr_t)m.bytes;
        r->out->mapping_bytes = m.size;
    }
    *out = (unsigned char *)r->out->mapping + r->at;
    r->at += (size_t)count;
    return 0;
}

int legacy_array(legacy *r, const char *what, int type, int64_t tuples, int64_t components, int wanted, void **out,
                 uint64_t *unfit) {
    uint64_t count;
    int status;
    if (unfit) *unfit = 0;
    if (__builtin_mul_overflow((uint64_t)tuples, (uint64_t)components, &count)) count = UINT64_MAX;
    if (r->is_binary && count && type < LEGACY_STRING) legacy_skip_line(r);
    if ((status = check_room(r, what, type, count))) return status;
    if (!out) {
        status = skip_values(r, what, type, count);
    } else if (r->is_binary && type == wanted && type <= TC_I8 && count >= IN_PLACE_FROM) {
        status = map_in_place(r, count, out);
    } else {
        if (!(*out = dataset_allocate(r->out, count * element_bytes(wanted)))) return STATUS_FAILED;
        if (type == wanted || (type == LEGACY_BIT && wanted == TC_U8))
            status = wanted == TC_F32 && unfit ? read_converted(r, what, type, count, wanted, *out, unfit)
                                               : decode(r, what, type, count, *out);
        else
            status = read_converted(r, what, type, count, wanted, *out, unfit);
    }
    if (!status) skip_metadata(r, components);
    return status;
}
