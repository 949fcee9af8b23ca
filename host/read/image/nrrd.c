/*
 * nrrd.c - NRRD, versions 1 to 5, attached (.nrrd) and detached (.nhdr)
 *
 * Source: "Definition of NRRD File Format", teem.sourceforge.net/nrrd/format.html. Read here rather than through teem,
 * so that sizes are checked against the file before memory is taken, and data files stay in the header's folder.
 * Encodings raw, ascii, hex, gzip and bzip2. Fields that do not bear on samples or space are ignored.
 */
#include "image/image.h"

#include "exit_status.h"
#include "failure.h"
#include "image/nrrd_world.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { HEADER_BYTES = 1 << 24 };

static int parse_type(nrrd_header *h, const char *text) {
    for (int element = 0; element < ELEMENT_COUNT; element++)
        if (names_have(stored_types[element].nrrd, text)) {
            h->element = element;
            return 0;
        }
    return fail(STATUS_INPUT, "%s: its type '%.40s' cannot be read; integers of 8 to 64 bits, float and double can",
                h->path, text);
}

static int parse_encoding(nrrd_header *h, const char *text) {
    static const struct {
        const char *names;
        encoding encoding;
    } encodings[] = {{"|raw|", ENCODING_RAW},
                     {"|txt|text|ascii|", ENCODING_TEXT},
                     {"|hex|", ENCODING_HEX},
                     {"|gz|gzip|", ENCODING_DEFLATE},
                     {"|bz2|bzip2|", ENCODING_BZIP2}};
    for (size_t i = 0; i < sizeof encodings / sizeof *encodings; i++)
        if (names_have(encodings[i].names, text)) {
            h->from.encoding = encodings[i].encoding;
            h->has_encoding = 1;
            return 0;
        }
    return fail(STATUS_INPUT, "%s: its encoding '%.40s' cannot be read; raw, ascii, hex, gzip and bzip2 can", h->path,
                text);
}

static int parse_endian(nrrd_header *h, const char *text) {
    if (strcasecmp(text, "little") == 0) h->endian = __ORDER_LITTLE_ENDIAN__;
    if (strcasecmp(text, "big") == 0) h->endian = __ORDER_BIG_ENDIAN__;
    return h->endian ? 0 : fail(STATUS_INPUT, "%s: its endian '%.40s' is neither little nor big", h->path, text);
}

static int wrong_count(const nrrd_header *h, const char *field) {
    return fail(STATUS_INPUT, "%s: '%s' is not %d values, one for each axis", h->path, field, h->dimension);
}

static enum nrrd_kind kind_of(const char *word) {
    static const char *const of_values[] = {"vector", "normal", "gradient", "color",   "matrix", "quaternion",
                                            "list",   "point",  "scalar",   "complex", "stub"};
    if (names_have("|domain|space|", word)) return KIND_SPACE;
    if (!strcasecmp(word, "time")) return KIND_TIME;
    for (size_t i = 0; i < sizeof of_values / sizeof *of_values; i++)
        if (strcasestr(word, of_values[i])) return KIND_COMPONENT;
    return KIND_UNKNOWN; /* "???", "none" and words that the format does not define */
}

static int parse_kinds(nrrd_header *h, char *text) {
    for (int a = 0; a < h->dimension; a++) {
        const char *word = next_word(&text);
        if (!word) return wrong_count(h, "kinds");
        h->kinds[a] = kind_of(word);
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

static int parse_sizes(nrrd_header *h, const char *text) {
    h->has_sizes = 1;
    return parse_integers(text, h->sizes, MAX_AXES) == h->dimension ? 0 : wrong_count(h, "sizes");
}

static int parse_skip(nrrd_header *h, const char *text, const char *field, int64_t low, int64_t *skip) {
    if (parse_integers(text, skip, 1) == 1 && *skip >= low) return 0;
    return fail(STATUS_INPUT, "%s: '%s: %.40s' is no number that can be skipped; write 0 or more%s", h->path, field,
                text, low < 0 ? ", or -1 for data at the end of its file" : "");
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

enum field {
    FIELD_OTHER,
    FIELD_DIMENSION,
    FIELD_TYPE,
    FIELD_ENCODING,
    FIELD_ENDIAN,
    FIELD_LINE_SKIP,
    FIELD_BYTE_SKIP,
    FIELD_SPACE,
    FIELD_UNITS,
    FIELD_ORIGIN,
    FIELD_PER_AXIS, /* this and the following have values for each axis, or mean some of them */
    FIELD_SIZES,
    FIELD_SPACINGS,
    FIELD_MINS,
    FIELD_MAXS,
    FIELD_CENTERS,
    FIELD_KINDS,
    FIELD_DIRECTIONS,
    FIELD_DATA_FILE
};

static enum field field_of(const char *name) {
    static const char *const names[] = {
        [FIELD_DIMENSION] = "|dimension|",
        [FIELD_TYPE] = "|type|",
        [FIELD_ENCODING] = "|encoding|",
        [FIELD_ENDIAN] = "|endian|",
        [FIELD_LINE_SKIP] = "|line skip|lineskip|",
        [FIELD_BYTE_SKIP] = "|byte skip|byteskip|",
        [FIELD_SPACE] = "|space|",
        [FIELD_UNITS] = "|space units|spaceunits|units|",
        [FIELD_ORIGIN] = "|space origin|spaceorigin|",
        [FIELD_SIZES] = "|sizes|",
        [FIELD_SPACINGS] = "|spacings|",
        [FIELD_MINS] = "|axis mins|axismins|",
        [FIELD_MAXS] = "|axis maxs|axismaxs|",
        [FIELD_CENTERS] = "|centers|centerings|",
        [FIELD_KINDS] = "|kinds|",
        [FIELD_DIRECTIONS] = "|space directions|spacedirections|",
        [FIELD_DATA_FILE] = "|data file|datafile|",
    };
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        if (names[n] && names_have(names[n], name)) return (enum field)n;
    return FIELD_OTHER;
}

static int parse_field(nrrd_header *h, header_text *text, const char *name, char *value) {
    enum field field = field_of(name);
    if (field > FIELD_PER_AXIS && !h->dimension)
        return fail(STATUS_INPUT, "%s: its header has no 'dimension' field; add it", h->path);
    if (field != FIELD_OTHER && h->seen >> field & 1 && !*h->repeated)
        snprintf(h->repeated, sizeof h->repeated, "%.31s", name);
    h->seen |= 1u << field;
    switch (field) {
    case FIELD_TYPE:
        return parse_type(h, value);
    case FIELD_ENCODING:
        return parse_encoding(h, value);
    case FIELD_ENDIAN:
        return parse_endian(h, value);
    case FIELD_LINE_SKIP:
        return parse_skip(h, value, name, 0, &h->from.line_skip);
    case FIELD_BYTE_SKIP:
        return parse_skip(h, value, name, INT64_MIN, &h->from.byte_skip);
    case FIELD_SPACE:
        snprintf(h->space, sizeof h->space, "%s", value);
        return 0;
    case FIELD_UNITS:
        nrrd_units(h, value);
        return 0;
    case FIELD_ORIGIN:
        h->has_origin = 1;
        return nrrd_vectors(h, value, name, &h->origin, 1);
    case FIELD_SIZES:
        return parse_sizes(h, value);
    case FIELD_SPACINGS:
        return parse_per_axis(h, value, name, h->spacings, &h->has_spacings);
    case FIELD_MINS:
        return parse_per_axis(h, value, name, h->mins, &h->has_mins);
    case FIELD_MAXS:
        return parse_per_axis(h, value, name, h->maxs, &h->has_maxs);
    case FIELD_CENTERS:
        return parse_centers(h, value);
    case FIELD_KINDS:
        return parse_kinds(h, value);
    case FIELD_DIRECTIONS:
        h->has_directions = 1;
        return nrrd_vectors(h, value, name, h->directions, h->dimension);
    case FIELD_DATA_FILE:
        return parse_data_file(h, text, value);
    default: /* parse_dimension has seen the dimension */
        return 0;
    }
}

/* The next field, its name at the line's begin and its value; *value is NULL where the header ends. Comments and keys
 * are passed over. */
static int next_field(const nrrd_header *h, header_text *text, char *line, char **value, int *more) {
    for (*value = NULL;;) {
        int status = header_line(text, line, more);
        if (status || !*more || !*line) return status;
        char *colon = strstr(line, ": "), *key = strstr(line, ":=");
        if (line[0] == '#' || (key && (!colon || key < colon))) continue;
        if (!colon) colon = strchr(line, ':'); /* nothing behind it, or no blank */
        if (!colon)
            return fail(STATUS_INPUT, "%s: line %" PRId64 " of its header, '%.60s', is no field", h->path, text->line,
                        line);
        *colon = 0;
        *value = trim(colon + 1);
        (void)trim(line);
        return 0;
    }
}

/* Lists have one value per axis, so the dimension is looked for first, wherever it stands. */
static int find_dimension(nrrd_header *h, header_text text) {
    char line[HEADER_LINE_BYTES], *value = line;
    while (value && !h->dimension) {
        int more, status = next_field(h, &text, line, &value, &more);
        if (status) return status;
        if (value && field_of(line) == FIELD_DIMENSION && (status = parse_dimension(h, value))) return status;
        if (value && field_of(line) == FIELD_DATA_FILE && !strncmp(value, "LIST", 4)) return 0; /* names follow */
    }
    return 0;
}

/* Reads fields up to the empty line, or the end of the file; text->position is then where attached data begins. */
static int parse_header(nrrd_header *h, header_text *text) {
    char line[HEADER_LINE_BYTES], *value = line;
    int more, status = header_line(text, line, &more);
    if (status) return status;
    if (strcmp(line, "NRRD00.01") && (strncmp(line, "NRRD000", 7) || line[7] < '1' || line[7] > '5' || line[8]))
        return fail(STATUS_INPUT, "%s: its first line '%.16s' is none of NRRD0001 to NRRD0005", h->path, line);
    status = find_dimension(h, *text);
    while (value && !status) {
        status = next_field(h, text, line, &value, &more);
        if (!status && value) status = parse_field(h, text, line, value);
    }
    if (!status && !more && !h->is_detached)
        status = fail(STATUS_INPUT, "%s: its header has no end (an empty line) and names no data file", h->path);
    return status;
}

static int check_header(nrrd_header *h) {
    const char *absent = !h->dimension      ? "dimension"
                         : h->element < 0   ? "type"
                         : !h->has_sizes    ? "sizes"
                         : !h->has_encoding ? "encoding"
                                            : NULL;
    if (!absent && !h->endian && element_bytes(h->element) > 1 && h->from.encoding != ENCODING_TEXT) absent = "endian";
    if (absent) return fail(STATUS_INPUT, "%s: its header has no '%s' field; add it", h->path, absent);
    if (h->from.byte_skip < 0 && (h->from.encoding == ENCODING_TEXT || h->from.encoding == ENCODING_HEX))
        return fail(STATUS_INPUT, "%s: 'byte skip: -1' makes no sense with text; say how many bytes", h->path);
    if (h->from.encoding == ENCODING_DEFLATE || h->from.encoding == ENCODING_BZIP2) {
        h->from.stream_skip = h->from.byte_skip; /* the format counts these bytes in the unpacked stream */
        h->from.byte_skip = 0;
    }
    return 0;
}

int nrrd_read(const read_request *request, const mapping *file, dataset *out) {
    size_t limit = file->size < HEADER_BYTES ? file->size : HEADER_BYTES;
    header_text text = {.path = request->path, .bytes = file->bytes, .size = limit};
    nrrd_header h = {.path = request->path, .request = request, .element = -1, .from = {.header_path = request->path}};
    axes stored;
    layout l;
    int status;
    if ((status = dataset_image_begin(out)) || (status = parse_header(&h, &text)) || (status = check_header(&h)))
        goto cleanup;
    if (*h.repeated)
        dataset_notice(out, "its header has '%s' twice: the %s is taken", h.repeated,
                       field_of(h.repeated) == FIELD_DIMENSION ? "first" : "last");
    nrrd_settle_directions(&h, out);
    nrrd_axes(&h, &stored);
    h.from.axes = &stored;
    h.from.start = text.position;
    if ((status = layout_make(h.path, &stored, h.element, request, &l)) || (status = nrrd_matrix(&h, &stored, out)))
        goto cleanup;
    l.swapped = h.from.encoding != ENCODING_TEXT && h.endian && h.endian != __BYTE_ORDER__;
    snprintf(out->format, sizeof out->format, "NRRD");
    nrrd_name_world(&h, out);
    status = source_load(request, &h.from, &l, out);
cleanup:
    data_names_release(&h.from.files);
    return status;
}
