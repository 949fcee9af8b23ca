/*
 * metaimage.c - MetaImage, attached (.mha) and detached (.mhd)
 *
 * Source: the MetaIO documentation and ITK's use of it: row i of TransformMatrix is the direction of axis i in the
 * world, Offset (Position, Origin) is the first sample, ElementSpacing goes before ElementSize. The declared
 * CompressedDataSize is not relied on: writers get it wrong, and the stream knows its own end.
 */
#include "readers.h"

#include "exit_status.h"
#include "failure.h"
#include "source.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { SPATIAL_AXES = 3, MAX_DIMENSION = 4, HEADER_BYTES = 1 << 24 };

typedef struct meta_header {
    const char *path;
    int dimension;
    int element; /* -1: not given */
    int is_big_endian, is_compressed, is_text, has_data_file;
    int64_t sizes[MAX_DIMENSION];
    int64_t channels;
    int size_count, spacing_count, element_size_count, offset_count, direction_count;
    double spacing[MAX_DIMENSION], element_size[MAX_DIMENSION], offset[MAX_DIMENSION];
    double direction[MAX_DIMENSION * MAX_DIMENSION];
    char orientation[16];
    source from;
} meta_header;

static int parse_type(meta_header *h, const char *text) {
    static const struct {
        const char *name;
        int element;
    } types[] = {{"MET_CHAR", TC_I8},
                 {"MET_UCHAR", TC_U8},
                 {"MET_SHORT", TC_I16},
                 {"MET_USHORT", TC_U16},
                 {"MET_INT", TC_I32},
                 {"MET_UINT", TC_U32},
                 {"MET_LONG", TC_I32},
                 {"MET_ULONG", TC_U32},
                 {"MET_LONG_LONG", ELEMENT_I64},
                 {"MET_ULONG_LONG", ELEMENT_U64},
                 {"MET_FLOAT", TC_F32},
                 {"MET_DOUBLE", TC_F64}};
    size_t length = strlen(text);
    if (length > 6 && strcmp(text + length - 6, "_ARRAY") == 0) length -= 6;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strlen(types[i].name) == length && strncmp(text, types[i].name, length) == 0) {
            h->element = types[i].element;
            return 0;
        }
    return fail(STATUS_INPUT, "%s: its ElementType '%.40s' cannot be read; MET_UCHAR to MET_DOUBLE can", h->path, text);
}

static int parse_flag(const char *text) { return text[0] == 'T' || text[0] == 't' || text[0] == '1'; }

static int parse_integer(meta_header *h, const char *key, const char *text, int64_t low, int64_t high, int64_t *value) {
    if (parse_integers(text, value, 1) == 1 && *value >= low && *value <= high) return 0;
    return fail(STATUS_INPUT, "%s: %s is '%.40s'; a number from %" PRId64 " to %" PRId64 " is needed", h->path, key,
                text, low, high);
}

static int parse_list(meta_header *h, const char *key, const char *text, double *values, int max, int *count) {
    *count = parse_numbers(text, values, max);
    if (*count > 0) return 0;
    return fail(STATUS_INPUT, "%s: %s is '%.60s'; 1 to %d numbers are needed", h->path, key, text, max);
}

static int parse_data_file(meta_header *h, header_text *text, const char *value) {
    int64_t axes_per_file = h->dimension - 1;
    h->has_data_file = 1;
    h->from.axes_per_file = axes_per_file;
    if (!strcasecmp(value, "LOCAL")) return 0;
    if (!strncmp(value, "LIST", 4) && (!value[4] || value[4] == ' ')) {
        char word[16];
        snprintf(word, sizeof word, "%s", value + 4);
        char *last = trim(word);
        size_t length = strlen(last);
        if (length && (last[length - 1] == 'D' || last[length - 1] == 'd')) last[length - 1] = 0;
        if (*last && parse_integers(last, &axes_per_file, 1) != 1)
            return fail(STATUS_INPUT, "%s: ElementDataFile = %.40s is no list", h->path, value);
        h->from.axes_per_file = axes_per_file;
        return data_names_list(&h->from.files, text);
    }
    if (data_names_is_pattern(value)) return data_names_pattern(&h->from.files, h->path, value, &h->from.axes_per_file);
    return data_names_add(&h->from.files, h->path, value);
}

static int is_one_of(const char *key, const char *a, const char *b, const char *c) {
    return !strcasecmp(key, a) || !strcasecmp(key, b) || !strcasecmp(key, c);
}

static int parse_geometry(meta_header *h, const char *key, const char *value) {
    if (!strcasecmp(key, "ElementSpacing"))
        return parse_list(h, key, value, h->spacing, MAX_DIMENSION, &h->spacing_count);
    if (!strcasecmp(key, "ElementSize"))
        return parse_list(h, key, value, h->element_size, MAX_DIMENSION, &h->element_size_count);
    if (is_one_of(key, "Offset", "Position", "Origin"))
        return parse_list(h, key, value, h->offset, MAX_DIMENSION, &h->offset_count);
    if (is_one_of(key, "TransformMatrix", "Rotation", "Orientation"))
        return parse_list(h, key, value, h->direction, MAX_DIMENSION * MAX_DIMENSION, &h->direction_count);
    if (!strcasecmp(key, "AnatomicalOrientation") && strcmp(value, "???"))
        snprintf(h->orientation, sizeof h->orientation, "%s", value);
    return 0;
}

static int parse_field(meta_header *h, header_text *text, const char *key, const char *value) {
    int64_t number;
    if (!strcasecmp(key, "NDims")) {
        int status = parse_integer(h, key, value, 1, MAX_DIMENSION, &number);
        if (!status) h->dimension = (int)number;
        return status;
    }
    if (!strcasecmp(key, "DimSize")) {
        h->size_count = parse_integers(value, h->sizes, MAX_DIMENSION);
        return h->size_count > 0 ? 0
                                 : fail(STATUS_INPUT, "%s: DimSize is '%.60s'; up to %d sizes are needed", h->path,
                                        value, MAX_DIMENSION);
    }
    if (!strcasecmp(key, "ElementType")) return parse_type(h, value);
    if (!strcasecmp(key, "ElementNumberOfChannels")) return parse_integer(h, key, value, 1, INT32_MAX, &h->channels);
    if (!strcasecmp(key, "HeaderSize"))
        return parse_integer(h, key, value, SKIP_FROM_END, INT64_MAX, &h->from.byte_skip);
    if (!strcasecmp(key, "ElementDataFile")) return parse_data_file(h, text, value);
    if (!strcasecmp(key, "BinaryDataByteOrderMSB") || !strcasecmp(key, "ElementByteOrderMSB"))
        h->is_big_endian = parse_flag(value);
    else if (!strcasecmp(key, "CompressedData"))
        h->is_compressed = parse_flag(value);
    else if (!strcasecmp(key, "BinaryData"))
        h->is_text = !parse_flag(value);
    else
        return parse_geometry(h, key, value);
    return 0;
}

/* Reads fields up to ElementDataFile, which ends the header. */
static int parse_header(meta_header *h, header_text *text) {
    char line[HEADER_LINE_BYTES];
    while (!h->has_data_file) {
        int more, status = header_line(text, line, &more);
        if (status) return status;
        if (!more) return fail(STATUS_INPUT, "%s: its header ends without ElementDataFile; add it", h->path);
        if (!*line) continue;
        char *equals = strchr(line, '=');
        if (!equals)
            return fail(STATUS_INPUT, "%s: line %" PRId64 " of its header, '%.60s', is not KEY = VALUE", h->path,
                        text->line, line);
        *equals = 0;
        if (!strcasecmp(trim(line), "ElementDataFile") && !h->dimension)
            return fail(STATUS_INPUT, "%s: its header has no NDims before ElementDataFile; add it", h->path);
        if ((status = parse_field(h, text, trim(line), trim(equals + 1)))) return status;
    }
    return 0;
}

static int check_header(const meta_header *h) {
    int n = h->dimension;
    if (h->element < 0) return fail(STATUS_INPUT, "%s: its header has no ElementType; add it", h->path);
    if (h->size_count != n)
        return fail(STATUS_INPUT, "%s: DimSize has %d sizes, but NDims is %d", h->path, h->size_count, n);
    if ((h->spacing_count && h->spacing_count != n) || (h->offset_count && h->offset_count != n) ||
        (h->direction_count && h->direction_count != n * n) ||
        (!h->spacing_count && h->element_size_count && h->element_size_count != n))
        return fail(STATUS_INPUT,
                    "%s: its spacing, offset or matrix has not one value, or row, for each of NDims = %d axes", h->path,
                    n);
    if (h->is_compressed && h->is_text)
        return fail(STATUS_INPUT, "%s: says that its data is both compressed and text; correct the header", h->path);
    if (h->is_compressed && h->from.byte_skip == SKIP_FROM_END)
        return fail(STATUS_INPUT, "%s: HeaderSize = -1 is for uncompressed data only; say how many bytes", h->path);
    return 0;
}

static int fill_matrix(const meta_header *h, double matrix[3][4]) {
    int n = h->dimension < SPATIAL_AXES ? h->dimension : SPATIAL_AXES;
    for (int r = 0; r < SPATIAL_AXES; r++) matrix[r][r] = 1;
    for (int axis = 0; axis < n; axis++) {
        double spacing = h->spacing_count ? h->spacing[axis] : h->element_size_count ? h->element_size[axis] : 1;
        if (!isfinite(spacing) || spacing <= 0)
            return fail(STATUS_INPUT,
                        "%s: its spacing along axis %d is %g; give a finite number above 0 (directions "
                        "belong into TransformMatrix)",
                        h->path, axis + 1, spacing);
        for (int r = 0; r < n && h->direction_count; r++)
            matrix[r][axis] = h->direction[axis * h->dimension + r] * spacing;
        if (!h->direction_count) matrix[axis][axis] = spacing;
        if (h->offset_count) matrix[axis][3] = h->offset[axis];
    }
    return matrix_check(h->path, matrix);
}

static void list_axes(const meta_header *h, axes *out) {
    *out = (axes){0};
    if (h->channels > 1) {
        out->size[0] = h->channels;
        out->role[0] = AXIS_COMPONENT;
        out->count = 1;
    }
    for (int i = 0; i < h->dimension; i++, out->count++) {
        out->size[out->count] = h->sizes[i];
        out->role[out->count] = i < SPATIAL_AXES ? AXIS_SPACE : AXIS_FRAME;
    }
}

int metaimage_read(const read_request *request, const mapping *file, volume *out) {
    size_t limit = file->size < HEADER_BYTES ? file->size : HEADER_BYTES;
    header_text text = {.path = request->path, .bytes = file->bytes, .size = limit};
    meta_header h = {.path = request->path, .element = -1, .channels = 1, .from = {.header_path = request->path}};
    axes stored;
    layout l;
    int status;
    if ((status = parse_header(&h, &text)) || (status = check_header(&h)) || (status = fill_matrix(&h, out->matrix)))
        goto cleanup;
    list_axes(&h, &stored);
    if ((status = layout_make(h.path, &stored, h.element, request, &l))) goto cleanup;
    h.from.axes = &stored;
    if (__builtin_add_overflow(h.from.axes_per_file, stored.count - h.dimension, &h.from.axes_per_file))
        h.from.axes_per_file = INT64_MAX; /* refused like any that is too many */
    h.from.start = text.position;
    h.from.encoding = h.is_compressed ? ENCODING_DEFLATE : h.is_text ? ENCODING_TEXT : ENCODING_RAW;
    l.swapped = !h.is_text && h.is_big_endian == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
    snprintf(out->format, sizeof out->format, "MetaImage");
    if (*h.orientation) snprintf(out->space, sizeof out->space, "anatomical orientation %s", h.orientation);
    status = source_load(&h.from, &l, out);
cleanup:
    data_names_release(&h.from.files);
    return status;
}
