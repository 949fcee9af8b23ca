/*
 * vtk_legacy_array.c - arrays of VTK legacy files: read, converted or passed over; see vtk_legacy_array.h
 *
 * Types and their sizes are those of VTK's own reader: long has 8 bytes, vtkIdType 4; bits are packed, the first in the
 * highest bit. As there, what follows the name of a type does not matter: "int1" and "int32" are int, "float32" is
 * float. Beyond VTK, names that tell of 8 bytes are taken at their word, and so are unsigned types that VTK does not
 * know.
 */
#include "vtk_legacy/vtk_legacy_array.h"

#include "exit_status.h"
#include "file/mapping.h"
#include "vtk_legacy/vtk_legacy_values.h"

#include <inttypes.h>
#include <string.h>
#include <strings.h>

enum { BLOCK = 1024, IN_PLACE_FROM = 1 << 16 };

typedef union block {
    uint8_t bytes[BLOCK * 8];
    double aligned;
} block;

/* The length of the longest of the names between bars that the word begins with, in any case; 0 where there is none. */
static size_t longest_beginning(const char *names, const char *word) {
    size_t longest = 0;
    for (const char *name = names + 1; *name; name += strcspn(name, "|") + 1) {
        size_t length = strcspn(name, "|");
        if (length > longest && !strncasecmp(word, name, length)) longest = length;
    }
    return longest;
}

static const struct {
    const char *names;
    int type;
} other_types[] = {{"|bit|", LEGACY_BIT}, {"|string|utf8_string|", LEGACY_STRING}, {"|variant|", LEGACY_VARIANT}};

int legacy_type(legacy *r, int *type) {
    char word[LEGACY_WORD];
    size_t longest = 0;
    int status = legacy_need(r, "a type of values", word);
    if (status) return status;
    for (int n = 0; n < ELEMENT_COUNT + (int)(sizeof other_types / sizeof *other_types); n++) {
        const int is_other = n >= ELEMENT_COUNT;
        size_t length =
            longest_beginning(is_other ? other_types[n - ELEMENT_COUNT].names : stored_types[n].vtk_legacy, word);
        if (length <= longest) continue; /* "int64" begins with "int", too */
        longest = length;
        *type = is_other ? other_types[n - ELEMENT_COUNT].type : n;
    }
    if (longest) return 0;
    return legacy_fail(r,
                       "has values of type '%.40s', which is unknown; bit, unsigned_char to double, vtktypeint64, "
                       "vtkIdType, string and variant are known",
                       word);
}

/* Fails where the rest of the file is too short for so many values, at the fewest bytes that they can take. */
static int check_size(const legacy *r, const char *what, int type, uint64_t count) {
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
            status = legacy_skip_number(r, what);
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
        int status = dataset_map(r->out, r->path, &m);
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

static int read_converted(legacy *r, const char *what, int type, uint64_t count, int wanted, uint8_t *to,
                          uint64_t *unfit) {
    block values;
    for (uint64_t done = 0, n; done < count; done += n) {
        n = count - done < BLOCK ? count - done : BLOCK;
        int status = legacy_decode(r, what, type, n, values.bytes);
        if (status) return status;
        /* The caller gives unfit where it converts. NOLINTNEXTLINE(clang-analyzer-core.NullDereference) */
        *unfit += legacy_convert(type, values.bytes, n, wanted, to + done * element_bytes(wanted));
    }
    return 0;
}

int legacy_array(legacy *r, const char *what, int type, int64_t tuples, int64_t components, int wanted, void **out,
                 uint64_t *unfit) {
    uint64_t count;
    int status;
    if (unfit) *unfit = 0;
    if (__builtin_mul_overflow((uint64_t)tuples, (uint64_t)components, &count)) count = UINT64_MAX;
    if (r->is_binary && count && type < LEGACY_STRING) legacy_skip_line(r);
    if ((status = check_size(r, what, type, count))) return status;
    if (!out) {
        status = skip_values(r, what, type, count);
    } else if (r->is_binary && type == wanted && type <= TC_I8 && count >= IN_PLACE_FROM) {
        status = map_in_place(r, count, out);
    } else {
        if (!(*out = dataset_allocate(r->out, count * element_bytes(wanted)))) return STATUS_FAILED;
        int is_native = type == wanted || (type == LEGACY_BIT && wanted == TC_U8);
        if (is_native && !(unfit && wanted >= TC_F32)) /* else all are looked at: coordinates */
            status = legacy_decode(r, what, type, count, *out);
        else
            status = read_converted(r, what, type, count, wanted, *out, unfit);
    }
    if (!status) skip_metadata(r, components);
    return status;
}
