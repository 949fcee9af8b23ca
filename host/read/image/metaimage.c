/*
 * metaimage.c - MetaImage, attached (.mha) and detached (.mhd)
 *
 * Source: the MetaIO documentation and ITK's use of it: row i of TransformMatrix is the direction of axis i in the
 * world, Offset (Position, Origin) is the first sample, ElementSpacing goes before ElementSize, and a negative one
 * turns the axis. HeaderSize counts from the file's begin, that of attached data too. Keys come in any case, with "="
 * or ":" behind them; lists may go on in the next line and have more values than there are axes. The declared
 * CompressedDataSize is not relied on: writers get it wrong, and the stream knows its own end.
 */
#include "image/image.h"

#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "image/source.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { SPATIAL_AXES = 3, MAX_DIMENSION = 10, LIST_VALUES = MAX_DIMENSION * MAX_DIMENSION, HEADER_BYTES = 1 << 24 };

typedef struct number_list {
    int count;           /* 0: not given */
    int is_first_choice; /* given by the key that has precedence over its synonyms */
    double values[LIST_VALUES];
} number_list;

typedef struct meta_header {
    const char *path;
    const read_request *request;
    int dimension;
    int element; /* -1: not given */
    int is_big_endian, element_order_given, is_compressed, is_text, has_data_file;
    int64_t sizes[MAX_DIMENSION];
    int64_t channels, header_size;
    number_list size, spacing, element_size, offset, direction;
    char orientation[16], units[16];
    source from;
    uint32_t seen;     /* a bit per key that was met */
    char repeated[32]; /* a key that was met twice, or "" */
} meta_header;

static int parse_type(meta_header *h, const char *text) {
    char name[64];
    size_t length = strlen(text);
    if (length > 6 && strcasecmp(text + length - 6, "_ARRAY") == 0) length -= 6;
    snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : 0), text);
    for (int element = 0; element < ELEMENT_COUNT; element++)
        if (names_have(stored_types[element].metaimage, name)) {
            h->element = element;
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

/* Of synonymous keys, the first choice has precedence wherever it stands. */
static int parse_list(meta_header *h, const char *key, const char *first_choice, const char *text, number_list *list) {
    if (list->is_first_choice && strcasecmp(key, first_choice)) return 0;
    list->is_first_choice = !strcasecmp(key, first_choice);
    list->count = parse_numbers(text, list->values, LIST_VALUES);
    if (list->count > 0) return 0;
    return fail(STATUS_INPUT, "%s: %s is '%.60s'; 1 to %d numbers are needed", h->path, key, text, LIST_VALUES);
}

/* Whether the name has a conversion for a number, as "slice%03d.raw". */
static int has_number(const char *name) {
    const char *at = strchr(name, '%');
    if (!at) return 0;
    at += 1 + strspn(at + 1, "0123456789");
    return *at && strchr("diu", *at);
}

/* A pattern whose numbers may be left out: from 1 on, as many as the last axis has samples. */
static int parse_pattern(meta_header *h, const char *value) {
    char whole[HEADER_LINE_BYTES + 64];
    int name = (int)strcspn(value, " \t");
    int64_t given[4] = {1};
    int count = parse_integers(value + name, given, 4);
    if (count < 0 || count > 1 || h->size.count < h->dimension)
        return data_names_pattern(&h->from.files, h->path, value, &h->from.axes_per_file);
    snprintf(whole, sizeof whole, "%.*s %" PRId64 " %.0f 1", name, value, given[0],
             (double)given[0] + h->size.values[h->dimension - 1] - 1);
    return data_names_pattern(&h->from.files, h->path, whole, &h->from.axes_per_file);
}

static int parse_data_file(meta_header *h, header_text *text, const char *value) {
    int64_t axes_per_file = h->dimension - 1;
    h->has_data_file = 1;
    h->from.axes_per_file = axes_per_file;
    if (!strcasecmp(value, "LOCAL")) return 0;
    if (!strncasecmp(value, "LIST", 4) && (!value[4] || value[4] == ' ')) {
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
    if (data_names_is_pattern(value) || has_number(value)) return parse_pattern(h, value);
    return data_names_add(&h->from.files, h->path, value);
}

static int is_one_of(const char *key, const char *a, const char *b, const char *c) {
    return !strcasecmp(key, a) || !strcasecmp(key, b) || !strcasecmp(key, c);
}

static int parse_geometry(meta_header *h, const char *key, const char *value) {
    if (!strcasecmp(key, "ElementSpacing")) return parse_list(h, key, key, value, &h->spacing);
    if (!strcasecmp(key, "ElementSize")) return parse_list(h, key, key, value, &h->element_size);
    if (is_one_of(key, "Offset", "Position", "Origin")) return parse_list(h, key, "Offset", value, &h->offset);
    if (is_one_of(key, "TransformMatrix", "Rotation", "Orientation"))
        return parse_list(h, key, "TransformMatrix", value, &h->direction);
    if (!strcasecmp(key, "AnatomicalOrientation") && strcmp(value, "???"))
        snprintf(h->orientation, sizeof h->orientation, "%s", value);
    if (!strcasecmp(key, "DistanceUnits") && strcmp(value, "?")) snprintf(h->units, sizeof h->units, "%s", value);
    return 0;
}

static void note_key(meta_header *h, const char *key) {
    static const char *const keys[] = {"NDims",
                                       "DimSize",
                                       "ElementType",
                                       "ElementNumberOfChannels",
                                       "HeaderSize",
                                       "ElementByteOrderMSB",
                                       "CompressedData",
                                       "BinaryData",
                                       "ElementSpacing",
                                       "ElementSize",
                                       "Offset",
                                       "Position",
                                       "Origin",
                                       "TransformMatrix",
                                       "Rotation",
                                       "Orientation",
                                       "AnatomicalOrientation",
                                       "BinaryDataByteOrderMSB"};
    for (size_t n = 0; n < sizeof keys / sizeof *keys; n++) {
        if (strcasecmp(key, keys[n])) continue;
        if (h->seen >> n & 1 && !*h->repeated) snprintf(h->repeated, sizeof h->repeated, "%s", keys[n]);
        h->seen |= 1u << n;
    }
}

static int parse_field(meta_header *h, header_text *text, const char *key, const char *value) {
    int64_t number;
    note_key(h, key);
    if (!strcasecmp(key, "NDims")) {
        int status = parse_integer(h, key, value, 1, MAX_DIMENSION, &number);
        if (!status) h->dimension = (int)number;
        return status;
    }
    if (!strcasecmp(key, "DimSize")) return parse_list(h, key, key, value, &h->size);
    if (!strcasecmp(key, "ElementType")) return parse_type(h, value);
    if (!strcasecmp(key, "ElementNumberOfChannels")) return parse_integer(h, key, value, 1, INT32_MAX, &h->channels);
    if (!strcasecmp(key, "HeaderSize")) return parse_integer(h, key, value, SKIP_FROM_END, INT64_MAX, &h->header_size);
    if (!strcasecmp(key, "ElementDataFile")) return parse_data_file(h, text, value);
    if (!strcasecmp(key, "ElementByteOrderMSB")) {
        h->is_big_endian = parse_flag(value);
        h->element_order_given = 1;
    } else if (!strcasecmp(key, "BinaryDataByteOrderMSB") && !h->element_order_given)
        h->is_big_endian = parse_flag(value);
    else if (!strcasecmp(key, "CompressedData"))
        h->is_compressed = parse_flag(value);
    else if (!strcasecmp(key, "BinaryData"))
        h->is_text = !parse_flag(value);
    else
        return parse_geometry(h, key, value);
    return 0;
}

/* Joins the lines that a list of numbers goes on in to the line where it begins. */
static void join_lines(header_text *text, char *line) {
    for (;;) {
        char further[HEADER_LINE_BYTES];
        header_text ahead = *text;
        int more, status = header_line(&ahead, further, &more);
        size_t used = strlen(line);
        int goes_on = !status && more && *further && strspn(further, "0123456789+-.eE \t") == strlen(further);
        if (!goes_on || used + strlen(further) + 2 > HEADER_LINE_BYTES) return; /* it is looked at later */
        stpcpy(stpcpy(line + used, " "), further);
        *text = ahead;
    }
}

/* Reads fields up to ElementDataFile, which ends the header. */
static int parse_header(meta_header *h, header_text *text) {
    char line[HEADER_LINE_BYTES];
    while (!h->has_data_file) {
        int more, status = header_line(text, line, &more);
        if (status) return status;
        if (!more) return fail(STATUS_INPUT, "%s: its header ends without ElementDataFile; add it", h->path);
        if (!*line) continue;
        int is_last = !strncasecmp(line, "ElementDataFile", 15);
        if (is_last && !h->dimension)
            return fail(STATUS_INPUT, "%s: its header has no NDims before ElementDataFile; add it", h->path);
        if (!is_last) join_lines(text, line);
        size_t key = strcspn(line, "=:");
        if (!line[key])
            return fail(STATUS_INPUT, "%s: line %" PRId64 " of its header, '%.60s', is not KEY = VALUE", h->path,
                        text->line, line);
        line[key] = 0;
        if ((status = parse_field(h, text, trim(line), trim(line + key + 1)))) return status;
    }
    return 0;
}

/* Values beyond those needed are dropped, with a notice. Too few are an error, unless the request replaces them. */
static int check_list(const meta_header *h, const char *key, number_list *list, int needed, int is_replaced,
                      dataset *out) {
    if (!list->count) return 0;
    if (list->count < needed && is_replaced) {
        list->count = 0;
        return 0;
    }
    if (list->count < needed)
        return fail(STATUS_INPUT, "%s: %s has %d values, but NDims = %d asks for %d", h->path, key, list->count,
                    h->dimension, needed);
    if (list->count > needed)
        dataset_notice(out, "%s has %d values, of which its %d axes need %d: those are used", key, list->count,
                       h->dimension, needed);
    return 0;
}

/* Takes the upper left part of a matrix for more axes. */
static void cut_matrix(number_list *matrix, int n) {
    int rows = n;
    while (rows < MAX_DIMENSION && rows * rows < matrix->count) rows++;
    if (rows * rows != matrix->count) return;
    for (int r = 0; r < n; r++)
        for (int c = 0; c < n; c++) matrix->values[r * n + c] = matrix->values[r * rows + c];
}

/* Where more files are named than the sizes ask for, keeps the first. */
static void cut_names(meta_header *h, dataset *out) {
    int64_t expected = 1;
    if (h->from.axes_per_file < 1 || h->from.axes_per_file >= h->dimension) return;
    for (int64_t i = h->from.axes_per_file; i < h->dimension; i++)
        if (h->sizes[i] < 1 || __builtin_mul_overflow(expected, h->sizes[i], &expected)) return;
    if (h->from.files.count <= expected) return;
    dataset_notice(out, "it names %" PRId64 " data files, of which its sizes ask for %" PRId64 ": the first are used",
                   h->from.files.count, expected);
    data_names_cut(&h->from.files, expected);
}

static int take_sizes(meta_header *h) {
    if (h->size.count < 1) return fail(STATUS_INPUT, "%s: its header has no DimSize; add it", h->path);
    for (int i = 0; i < h->dimension; i++) {
        double size = h->size.values[i];
        if (!(fabs(size) <= 0x1p53) || size != floor(size))
            return fail(STATUS_INPUT, "%s: DimSize has a size of %g; whole numbers up to 2^53 are possible", h->path,
                        size);
        h->sizes[i] = (int64_t)size;
    }
    return 0;
}

static int check_header(meta_header *h, dataset *out) {
    int n = h->dimension, status;
    if (h->element < 0) return fail(STATUS_INPUT, "%s: its header has no ElementType; add it", h->path);
    if (h->spacing.count) h->element_size.count = 0;
    if ((status = check_list(h, "DimSize", &h->size, n, 0, out)) || (status = take_sizes(h)) ||
        (status = check_list(h, "ElementSpacing", &h->spacing, n, h->request->has_spacing, out)) ||
        (status = check_list(h, "ElementSize", &h->element_size, n, h->request->has_spacing, out)) ||
        (status = check_list(h, "Offset", &h->offset, n, h->request->has_origin, out)) ||
        (status = check_list(h, "TransformMatrix", &h->direction, n * n, 0, out)))
        return status;
    cut_matrix(&h->direction, n);
    cut_names(h, out);
    if (h->is_text) h->is_compressed = 0; /* as ITK has it */
    if (h->is_compressed && h->header_size < 0)
        return fail(STATUS_INPUT, "%s: HeaderSize = -1 is for uncompressed data only; say how many bytes", h->path);
    return 0;
}

/* Attached data begins behind the header, or where HeaderSize says, which counts from the file's begin. */
static int locate_data(meta_header *h, uint64_t header_end) {
    h->from.start = header_end;
    h->from.byte_skip = h->header_size;
    if (h->from.files.count || h->header_size <= 0) return 0;
    if ((uint64_t)h->header_size < header_end)
        return fail(STATUS_INPUT, "%s: HeaderSize = %" PRId64 " ends within the header, which has %" PRIu64 " bytes",
                    h->path, h->header_size, header_end);
    h->from.byte_skip = h->header_size - (int64_t)header_end;
    return 0;
}

/* An axis whose row of TransformMatrix is zeros, from 1; 0 where there is none. */
static int find_axis_without_direction(const meta_header *h, int count) {
    for (int axis = 0; axis < count && h->direction.count; axis++) {
        int is_zero = 1;
        for (int r = 0; r < count; r++) is_zero &= h->direction.values[axis * h->dimension + r] == 0;
        if (is_zero) return axis + 1;
    }
    return 0;
}

static int fill_matrix(const meta_header *h, double matrix[3][4]) {
    int n = h->dimension < SPATIAL_AXES ? h->dimension : SPATIAL_AXES;
    const number_list *distance = h->spacing.count ? &h->spacing : &h->element_size;
    const int lost = h->request->has_spacing ? 0 : find_axis_without_direction(h, n);
    if (lost) return world_no_direction(h->path, "TransformMatrix", lost);
    for (int r = 0; r < SPATIAL_AXES; r++) matrix[r][r] = 1;
    for (int axis = 0; axis < n; axis++) {
        double spacing = distance->count ? distance->values[axis] : 1;
        for (int r = 0; r < n && h->direction.count; r++)
            matrix[r][axis] = h->direction.values[axis * h->dimension + r] * spacing;
        if (!h->direction.count) matrix[axis][axis] = spacing;
        if (h->offset.count) matrix[axis][3] = h->offset.values[axis];
    }
    return world_complete(h->request, h->path, matrix);
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

int metaimage_read(const read_request *request, const mapping *file, dataset *out) {
    size_t limit = file->size < HEADER_BYTES ? file->size : HEADER_BYTES;
    header_text text = {.path = request->path, .bytes = file->bytes, .size = limit};
    meta_header h = {.path = request->path,
                     .request = request,
                     .element = -1,
                     .channels = 1,
                     .from = {.header_path = request->path}};
    axes stored;
    layout l;
    int status;
    if ((status = dataset_image_begin(out)) || (status = parse_header(&h, &text)) || (status = check_header(&h, out)) ||
        (status = fill_matrix(&h, out->blocks->matrix)) || (status = locate_data(&h, text.position)))
        goto cleanup;
    if (*h.repeated) dataset_notice(out, "its header has '%s' twice: the last is taken", h.repeated);
    list_axes(&h, &stored);
    if ((status = layout_make(h.path, &stored, h.element, request, &l))) goto cleanup;
    h.from.axes = &stored;
    if (__builtin_add_overflow(h.from.axes_per_file, stored.count - h.dimension, &h.from.axes_per_file))
        h.from.axes_per_file = INT64_MAX; /* refused like any that is too many */
    h.from.encoding = h.is_compressed ? ENCODING_DEFLATE : h.is_text ? ENCODING_TEXT : ENCODING_RAW;
    l.swapped = !h.is_text && h.is_big_endian == (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
    snprintf(out->format, sizeof out->format, "MetaImage");
    if (*h.orientation) snprintf(out->space, sizeof out->space, "anatomical orientation %s", h.orientation);
    if (*h.orientation) snprintf(out->world, sizeof out->world, "LPS"); /* ITK's, whatever way the image lies in it */
    if (!request->has_spacing) dataset_set_units(out, h.units);
    status = source_load(request, &h.from, &l, out);
cleanup:
    data_names_release(&h.from.files);
    return status;
}
