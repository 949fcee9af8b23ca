/*
 * nrrd.c - NRRD, versions 1 to 5, attached (.nrrd) and detached (.nhdr)
 *
 * Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html. Read here rather than through teem,
 * so that sizes are checked against the file before memory is taken, and data files stay in the header's folder.
 * Encodings raw, ascii, gzip and bzip2. Fields that do not bear on samples or space are ignored.
 */
#include "nrrd.h"

#include "exit_status.h"
#include "failure.h"
#include "readers.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { HEADER_BYTES = 1 << 24 };

static int parse_type(nrrd_header *h, const char *text) {
    static const struct {
        const char *names;
        int element;
    } types[] = {
        {"|signed char|int8|int8_t|", TC_I8},
        {"|uchar|unsigned char|uint8|uint8_t|", TC_U8},
        {"|short|short int|signed short|signed short int|int16|int16_t|", TC_I16},
        {"|ushort|unsigned short|unsigned short int|uint16|uint16_t|", TC_U16},
        {"|int|signed int|int32|int32_t|", TC_I32},
        {"|uint|unsigned int|uint32|uint32_t|", TC_U32},
        {"|longlong|long long|long long int|signed long long|signed long long int|int64|int64_t|", ELEMENT_I64},
        {"|ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t|", ELEMENT_U64},
        {"|float|", TC_F32},
        {"|double|", TC_F64},
    };
    char wanted[64];
    snprintf(wanted, sizeof wanted, "|%.60s|", text);
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (!strchr(text, '|') && strcasestr(types[i].names, wanted)) {
            h->element = types[i].element;
            return 0;
        }
    return fail(STATUS_INPUT, "%s: its type '%.40s' cannot be read; integers of 8 to 64 bits, float and double can",
                h->path, text);
}

static int parse_encoding(nrrd_header *h, const char *text) {
    static const struct {
        const char *name;
        encoding encoding;
    } encodings[] = {{"raw", ENCODING_RAW},    {"txt", ENCODING_TEXT},   {"text", ENCODING_TEXT},
                     {"ascii", ENCODING_TEXT}, {"gz", ENCODING_DEFLATE}, {"gzip", ENCODING_DEFLATE},
                     {"bz2", ENCODING_BZIP2},  {"bzip2", ENCODING_BZIP2}};
    for (size_t i = 0; i < sizeof encodings / sizeof *encodings; i++)
        if (strcasecmp(text, encodings[i].name) == 0) {
            h->from.encoding = encodings[i].encoding;
            h->has_encoding = 1;
            return 0;
        }
    return fail(STATUS_INPUT, "%s: its encoding '%.40s' cannot be read; raw, ascii, gzip and bzip2 can", h->path, text);
}

static int parse_endian(nrrd_header *h, const char *text) {
    if (strcasecmp(text, "little") == 0) h->endian = __ORDER_LITTLE_ENDIAN__;
    if (strcasecmp(text, "big") == 0) h->endian = __ORDER_BIG_ENDIAN__;
    return h->endian ? 0 : fail(STATUS_INPUT, "%s: its endian '%.40s' is neither little nor big", h->path, text);
}

static int wrong_count(const nrrd_header *h, const char *field) {
    return fail(STATUS_INPUT, "%s: '%s' is not %d values, one for each axis", h->path, field, h->dimension);
}

static int parse_kinds(nrrd_header *h, char *text) {
    for (int a = 0; a < h->dimension; a++) {
        const char *word = next_word(&text);
        if (!word) return wrong_count(h, "kinds");
        if (!strcasecmp(word, "domain") || !strcasecmp(word, "space"))
            h->kinds[a] = KIND_SPACE;
        else if (!strcasecmp(word, "time"))
            h->kinds[a] = KIND_TIME;
        else if (strcmp(word, "???") && strcasecmp(word, "none"))
            h->kinds[a] = KIND_COMPONENT;
    }
    return next_word(&text) ? wrong_count(h, "kinds") : 0;
}

static int parse_centers(nrrd_header *h, char *text) {
    for (int a = 0; a < h->dimension; a++) {
        const char *word = next_word(&text);
        if (!word) return wrong_count(h, "centers");
        h->centers[a] = !strcasecmp(word, "cell")   ? CENTER_CELL
                        : !strcasecmp(word, "node") ? CENTER_NODE
                                                    : CENTER_UNKNOWN;
    }
    return next_word(&text) ? wrong_count(h, "centers") : 0;
}

static int parse_dimension(nrrd_header *h, const char *text) {
    int64_t value;
    if (parse_integers(text, &value, 1) != 1 || value < 1 || value > MAX_AXES)
        return fail(STATUS_INPUT, "%s: its dimension '%.40s' is not a number from 1 to %d", h->path, text, MAX_AXES);
    h->dimension = (int)value;
    return 0;
}

static int parse_skip(nrrd_header *h, const char *text, const char *field, int64_t low, int64_t *skip) {
    if (parse_integers(text, skip, 1) == 1 && *skip >= low) return 0;
    return fail(STATUS_INPUT, "%s: '%s: %.40s' is no number that can be skipped; write 0 or more%s", h->path, field,
                text, low < 0 ? ", or -1 for raw data at the end of its file" : "");
}

static int parse_per_axis(nrrd_header *h, const char *text, const char *field, double *values, int *has) {
    *has = 1;
    return parse_numbers(text, values, MAX_AXES) == h->dimension ? 0 : wrong_count(h, field);
}

static int parse_data_file(nrrd_header *h, header_text *text, char *value) {
    int64_t axes_per_file;
    h->is_detached = 1;
    h->from.axes_per_file = h->dimension - 1;
    if (strncmp(value, "LIST", 4) == 0 && (!value[4] || value[4] == ' ' || value[4] == '\t')) {
        int given = parse_integers(value + 4, &axes_per_file, 1);
        if (given < 0) return fail(STATUS_INPUT, "%s: 'data file: %.60s' is no list", h->path, value);
        if (given) h->from.axes_per_file = axes_per_file;
        return data_names_list(&h->from.files, text);
    }
    if (data_names_is_pattern(value)) return data_names_pattern(&h->from.files, h->path, value, &h->from.axes_per_file);
    return data_names_add(&h->from.files, h->path, value);
}

/* Lists have one value per axis, so the format wants the dimension before them. */
static int parse_axis_field(nrrd_header *h, header_text *text, const char *name, char *value) {
    int is_data_file = !strcasecmp(name, "data file") || !strcasecmp(name, "datafile");
    static const char *const known[] = {"sizes",    "spacings", "axis mins",  "axismins", "axis maxs",
                                        "axismaxs", "centers",  "centerings", "kinds",    "space directions"};
    int is_known = is_data_file;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) is_known |= !strcasecmp(name, known[i]);
    if (!is_known) return 0;
    if (!h->dimension)
        return fail(STATUS_INPUT, "%s: '%s' comes before 'dimension'; put the dimension first", h->path, name);
    if (is_data_file) return parse_data_file(h, text, value);
    if (!strcasecmp(name, "sizes")) {
        h->has_sizes = 1;
        return parse_integers(value, h->sizes, MAX_AXES) == h->dimension ? 0 : wrong_count(h, name);
    }
    if (!strcasecmp(name, "spacings")) return parse_per_axis(h, value, name, h->spacings, &h->has_spacings);
    if (!strncasecmp(name, "axis mi", 7) || !strncasecmp(name, "axismi", 6))
        return parse_per_axis(h, value, name, h->mins, &h->has_mins);
    if (!strncasecmp(name, "axis ma", 7) || !strncasecmp(name, "axisma", 6))
        return parse_per_axis(h, value, name, h->maxs, &h->has_maxs);
    if (!strncasecmp(name, "center", 6)) return parse_centers(h, value);
    if (!strcasecmp(name, "kinds")) return parse_kinds(h, value);
    h->has_directions = 1;
    return nrrd_vectors(h, value, name, h->directions, h->dimension);
}

static int parse_field(nrrd_header *h, header_text *text, const char *name, char *value) {
    if (!strcasecmp(name, "dimension")) return parse_dimension(h, value);
    if (!strcasecmp(name, "type")) return parse_type(h, value);
    if (!strcasecmp(name, "encoding")) return parse_encoding(h, value);
    if (!strcasecmp(name, "endian")) return parse_endian(h, value);
    if (!strcasecmp(name, "line skip") || !strcasecmp(name, "lineskip"))
        return parse_skip(h, value, name, 0, &h->from.line_skip);
    if (!strcasecmp(name, "byte skip") || !strcasecmp(name, "byteskip"))
        return parse_skip(h, value, name, SKIP_FROM_END, &h->from.byte_skip);
    if (!strcasecmp(name, "space")) {
        snprintf(h->space, sizeof h->space, "%s", value);
        return 0;
    }
    if (!strcasecmp(name, "space origin")) {
        h->has_origin = 1;
        return nrrd_vectors(h, value, name, &h->origin, 1);
    }
    return parse_axis_field(h, text, name, value);
}

/* Reads fields up to the empty line, or the end of the file; text->position is then where attached data begins. */
static int parse_header(nrrd_header *h, header_text *text) {
    char line[HEADER_LINE_BYTES];
    int more, status = header_line(text, line, &more);
    if (status) return status;
    if (strncmp(line, "NRRD000", 7) || line[7] < '1' || line[7] > '5' || line[8])
        return fail(STATUS_INPUT, "%s: its first line '%.16s' is none of NRRD0001 to NRRD0005", h->path, line);
    for (;;) {
        status = header_line(text, line, &more);
        if (status) return status;
        if (!more && !h->is_detached)
            return fail(STATUS_INPUT, "%s: its header has no end (an empty line) and names no data file", h->path);
        if (!more || !*line) return 0;
        char *colon = strstr(line, ": "), *key = strstr(line, ":=");
        if (line[0] == '#' || (key && (!colon || key < colon))) continue;
        if (!colon) colon = line[strlen(line) - 1] == ':' ? line + strlen(line) - 1 : NULL;
        if (!colon)
            return fail(STATUS_INPUT, "%s: line %" PRId64 " of its header, '%.60s', is no field", h->path, text->line,
                        line);
        *colon = 0;
        if ((status = parse_field(h, text, line, trim(colon + 1)))) return status;
    }
}

static int check_header(nrrd_header *h) {
    const char *missing = !h->dimension      ? "dimension"
                          : h->element < 0   ? "type"
                          : !h->has_sizes    ? "sizes"
                          : !h->has_encoding ? "encoding"
                                             : NULL;
    if (!missing && !h->endian && element_bytes(h->element) > 1 && h->from.encoding != ENCODING_TEXT)
        missing = "endian";
    if (missing) return fail(STATUS_INPUT, "%s: its header has no '%s' field; add it", h->path, missing);
    if (h->from.byte_skip == SKIP_FROM_END && h->from.encoding != ENCODING_RAW)
        return fail(STATUS_INPUT, "%s: 'byte skip: -1' is for raw data only; unpack the data, or say how many bytes",
                    h->path);
    if (h->from.encoding == ENCODING_DEFLATE || h->from.encoding == ENCODING_BZIP2) {
        h->from.stream_skip = (uint64_t)h->from.byte_skip; /* the format counts these bytes in the unpacked stream */
        h->from.byte_skip = 0;
    }
    return 0;
}

int nrrd_read(const read_request *request, const mapping *file, volume *out) {
    size_t limit = file->size < HEADER_BYTES ? file->size : HEADER_BYTES;
    header_text text = {.path = request->path, .bytes = file->bytes, .size = limit};
    nrrd_header h = {.path = request->path, .element = -1, .from = {.header_path = request->path}};
    axes stored;
    layout l;
    int status;
    if ((status = parse_header(&h, &text)) || (status = check_header(&h))) goto cleanup;
    nrrd_axes(&h, &stored);
    h.from.axes = &stored;
    h.from.start = text.position;
    if ((status = layout_make(h.path, &stored, h.element, request, &l)) ||
        (status = nrrd_matrix(&h, &stored, out->matrix)))
        goto cleanup;
    l.swapped = h.from.encoding != ENCODING_TEXT && h.endian && h.endian != __BYTE_ORDER__;
    snprintf(out->format, sizeof out->format, "NRRD");
    snprintf(out->space, sizeof out->space, "%s", h.space);
    status = source_load(&h.from, &l, out);
cleanup:
    data_names_release(&h.from.files);
    return status;
}
