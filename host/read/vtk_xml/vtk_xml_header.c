/*
 * vtk_xml_header.c - the XML of a VTK file, through expat: pieces, and where each array lies; see vtk_xml_header.h
 *
 * Expat sees the file up to the start tag of its appended data, which need not be XML, and never a document type:
 * without one the file cannot define entities. The text of arrays is not copied: the tags around it tell where in the
 * file it lies.
 */
#include "vtk_xml/vtk_xml_header.h"

#include "control.h"
#include "exit_status.h"
#include "failure.h"
#include "file/header_text.h"
#include "stored_types.h"

#include <expat.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Expat has had functions for files of any size since 2.8, which deprecate the older ones; on Linux both do. */
#ifdef HAVE_EXPAT_64
#define byte_index(parser)  XML_GetCurrentByteIndex64(parser)
#define byte_count(parser)  XML_GetCurrentByteCount64(parser)
#define line_number(parser) XML_GetCurrentLineNumber64(parser)
#else
#define byte_index(parser)  XML_GetCurrentByteIndex(parser)
#define byte_count(parser)  XML_GetCurrentByteCount(parser)
#define line_number(parser) XML_GetCurrentLineNumber(parser)
#endif

enum { DEEPEST = 64, ARRAYS_MOST = 4096, FIRST_CHUNK = 64 << 10, LARGEST_CHUNK = 1 << 30 };

/* Levels of elements: VTKFile, grid, Piece, section, DataArray. */
enum { LEVEL_FILE = 1, LEVEL_GRID, LEVEL_PIECE, LEVEL_SECTION, LEVEL_ARRAY };

typedef struct header_parser {
    XML_Parser expat;
    xml_document *doc;
    const char *grid_name; /* of the element that holds the pieces */
    int depth, in_grid, in_piece, in_array;
    enum xml_section section;
    char scalars[256];         /* the name of its active scalars; "": none */
    char numbers[256];         /* likewise of its global numbers */
    const unsigned char *text; /* where the text of the array begins that is being parsed */
    int status, has_ended;
} header_parser;

static const char *attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (strcmp(attributes[0], name) == 0) return attributes[1];
    return NULL;
}

static int wrong_attribute(const xml_document *doc, const char *element, const char *name, const char *is,
                           const char *should) {
    return fail(STATUS_INPUT, "%s: its element %s has the attribute %s=\"%.60s\"; it must be %s", doc->path, element,
                name, is, should);
}

/* Indices have 32 bits, so that a size is at most 2^32. */
static int parse_extent(const xml_document *doc, const char *text, xml_piece *piece) {
    int64_t extent[6];
    piece->point_count = piece->cell_count = 1;
    if (!text) return fail(STATUS_INPUT, "%s: one of its pieces has no Extent; add \"x0 x1 y0 y1 z0 z1\"", doc->path);
    if (parse_integers(text, extent, 6) != 6) return wrong_attribute(doc, "Piece", "Extent", text, "six integers");
    for (int a = 0; a < 3; a++) {
        int64_t low = extent[2 * a], high = extent[2 * a + 1];
        if (low < INT32_MIN || low > INT32_MAX || high > INT32_MAX || high < low - 1)
            return wrong_attribute(doc, "Piece", "Extent", text,
                                   "three pairs of indices, each first to last, of 32 bits");
        piece->first[a] = low;
        piece->dims[a] = high - low + 1;
        uint64_t cells = piece->dims[a] > 1 ? (uint64_t)piece->dims[a] - 1 : 1;
        if (__builtin_mul_overflow(piece->point_count, (uint64_t)piece->dims[a], &piece->point_count) ||
            __builtin_mul_overflow(piece->cell_count, cells, &piece->cell_count) ||
            piece->point_count > INT64_MAX / 64 || piece->cell_count > INT64_MAX / 64)
            return fail(STATUS_INPUT, "%s: its piece of extent %.100s has too many points; the file is damaged",
                        doc->path, text);
    }
    if (!piece->point_count) piece->cell_count = 0;
    return 0;
}

static int parse_count(const xml_document *doc, const char **attributes, const char *name, uint64_t *count) {
    int64_t value;
    const char *text = attribute(attributes, name);
    if (!text) return fail(STATUS_INPUT, "%s: one of its pieces has no %s; add it", doc->path, name);
    if (parse_integers(text, &value, 1) != 1 || value < 0 || value > INT64_MAX / 64)
        return wrong_attribute(doc, "Piece", name, text, "a number of 0 or more");
    *count = (uint64_t)value;
    return 0;
}

/* Room for one more element. Returns NULL where there is no memory. */
static void *grow(void *items, size_t count, size_t bytes) {
    int is_full = (count & (count - 1)) == 0; /* sizes are powers of two */
    return is_full ? realloc(items, (count ? 2 * count : 1) * bytes) : items;
}

static int no_memory(const xml_document *doc) {
    return fail(STATUS_FAILED, "%s: no memory for the description of its arrays", doc->path);
}

/* Control characters as %XX, as VTK's legacy files have them: names are printed, and chosen on a command line. */
static int add_name(xml_document *doc, const char *name, size_t *at) {
    *at = doc->name_bytes;
    for (int is_end = 0; !is_end;) {
        char code[8];
        is_end = !*name;
        for (size_t i = 0, bytes = control_encode(&name, code); i < bytes; i++) {
            char *names = grow(doc->names, doc->name_bytes, 1);
            if (!names) return no_memory(doc);
            doc->names = names;
            doc->names[doc->name_bytes++] = code[i];
        }
    }
    return 0;
}

/* -------------------------------------------------------------------------------------------------------- elements */

static int refuse_type(const xml_document *doc, const char *type) {
    const char *read = "ImageData, RectilinearGrid, StructuredGrid and UnstructuredGrid (.vti, .vtr, .vts, .vtu)";
    if (strcmp(type, "PolyData") == 0)
        return fail(STATUS_INPUT, "%s: holds PolyData, a surface, which has no isosurfaces; of VTK XML, %s are read",
                    doc->path, read);
    if (type[0] == 'P' || strstr(type, "Collection") || strstr(type, "MultiBlock") || strstr(type, "Partitioned"))
        return fail(STATUS_INPUT,
                    "%s: is a list of other files (%.40s); name one of those: of VTK XML, %s are read, of lists those "
                    "of their pieces (.pvti, .pvtr, .pvts, .pvtu) and of blocks (.vtm)",
                    doc->path, type, read);
    return fail(STATUS_INPUT, "%s: holds %.40s, which cannot be read; of VTK XML, %s are", doc->path, type, read);
}

static int begin_file(header_parser *p, const char *name, const char **attributes) {
    static const struct {
        const char *name;
        enum block_kind kind;
    } types[] = {{"ImageData", BLOCK_UNIFORM},
                 {"RectilinearGrid", BLOCK_RECTILINEAR},
                 {"StructuredGrid", BLOCK_CURVILINEAR},
                 {"UnstructuredGrid", BLOCK_UNSTRUCTURED}};
    xml_document *doc = p->doc;
    const char *type = attribute(attributes, "type"), *order = attribute(attributes, "byte_order"),
               *header = attribute(attributes, "header_type"), *compressor = attribute(attributes, "compressor");
    if (strcmp(name, "VTKFile"))
        return fail(STATUS_INPUT, "%s: is XML, but its first element is %.40s, not VTKFile", doc->path, name);
    for (size_t i = 0; type && i < sizeof types / sizeof *types; i++)
        if (strcmp(type, types[i].name) == 0) {
            p->grid_name = types[i].name;
            doc->kind = types[i].kind;
        }
    if (!p->grid_name) return refuse_type(doc, type ? type : "no named type of data");
    if (order && strcmp(order, "LittleEndian") && strcmp(order, "BigEndian"))
        return wrong_attribute(doc, name, "byte_order", order, "LittleEndian or BigEndian");
    if (header && strcmp(header, "UInt32") && strcmp(header, "UInt64"))
        return wrong_attribute(doc, name, "header_type", header, "UInt32 or UInt64");
    doc->swapped = order && (strcmp(order, "BigEndian") == 0) != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    doc->header_bytes = header && strcmp(header, "UInt64") == 0 ? 8 : 4;
    snprintf(doc->compressor, sizeof doc->compressor, "%s", compressor ? compressor : "");
    doc->packed = packing_of(doc->compressor);
    return 0;
}

static int parse_vector(const xml_document *doc, const char **attributes, const char *name, double *values, int count) {
    const char *text = attribute(attributes, name);
    if (!text || parse_numbers(text, values, count) == count) return 0;
    return wrong_attribute(doc, "ImageData", name, text, count == 3 ? "three numbers" : "nine numbers");
}

static int begin_grid(header_parser *p, const char **attributes) {
    xml_document *doc = p->doc;
    int status = 0;
    p->in_grid = 1;
    if (doc->kind != BLOCK_UNIFORM) return 0;
    if ((status = parse_vector(doc, attributes, "Origin", doc->origin, 3)) ||
        (status = parse_vector(doc, attributes, "Spacing", doc->spacing, 3)))
        return status;
    return parse_vector(doc, attributes, "Direction", doc->direction, 9);
}

static int begin_piece(header_parser *p, const char **attributes) {
    xml_document *doc = p->doc;
    xml_piece *pieces = grow(doc->pieces, doc->piece_count, sizeof *pieces);
    if (!pieces) return no_memory(doc);
    doc->pieces = pieces;
    xml_piece *piece = &pieces[doc->piece_count++];
    *piece = (xml_piece){.first_array = doc->array_count};
    p->in_piece = 1;
    if (doc->kind != BLOCK_UNSTRUCTURED) return parse_extent(doc, attribute(attributes, "Extent"), piece);
    int status = parse_count(doc, attributes, "NumberOfPoints", &piece->point_count);
    return status ? status : parse_count(doc, attributes, "NumberOfCells", &piece->cell_count);
}

static enum xml_section find_section(const char *name) {
    static const char *const names[] = {"", "PointData", "CellData", "Points", "Cells", "Coordinates"};
    for (int i = 1; i < (int)(sizeof names / sizeof *names); i++)
        if (strcmp(name, names[i]) == 0) return (enum xml_section)i;
    return SECTION_NONE;
}

/* A name that is longer than any sensible one is taken for none. */
static void note_name(char noted[256], const char *name) {
    snprintf(noted, 256, "%s", name && strlen(name) < 256 ? name : "");
}

static int find_element_type(const char *type) {
    for (int element = 0; type && element < ELEMENT_COUNT; element++)
        if (strcmp(type, stored_types[element].vtk_xml) == 0) return element;
    return type && strcmp(type, "Bit") == 0 ? TC_U8 : -1;
}

static int parse_offset(const xml_document *doc, const char *text, uint64_t *offset) {
    int64_t value;
    if (text && parse_integers(text, &value, 1) == 1 && value >= 0) {
        *offset = (uint64_t)value;
        return 0;
    }
    return wrong_attribute(doc, "DataArray", "offset", text ? text : "",
                           "a number of 0 or more, as its data is appended");
}

static int begin_array(header_parser *p, const char **attributes) {
    xml_document *doc = p->doc;
    const char *name = attribute(attributes, "Name"), *type = attribute(attributes, "type"),
               *components = attribute(attributes, "NumberOfComponents"), *format = attribute(attributes, "format"),
               *offset = attribute(attributes, "offset");
    if (doc->pieces[doc->piece_count - 1].array_count == ARRAYS_MOST)
        return fail(STATUS_INPUT, "%s: has a piece of more than %d arrays; split it", doc->path, ARRAYS_MOST);
    xml_array *arrays = grow(doc->arrays, doc->array_count, sizeof *arrays);
    if (!arrays) return no_memory(doc);
    doc->arrays = arrays;
    xml_array *array = &arrays[doc->array_count++];
    *array = (xml_array){.section = p->section, .element = find_element_type(type), .components = 1};
    array->is_active = *p->scalars && name && strcmp(name, p->scalars) == 0;
    array->is_number = *p->numbers && name && strcmp(name, p->numbers) == 0;
    array->is_bits = type && strcmp(type, "Bit") == 0;
    snprintf(array->type, sizeof array->type, "%s", type ? type : "");
    doc->pieces[doc->piece_count - 1].array_count++;
    p->in_array = 1;
    if (components && (parse_integers(components, &array->components, 1) != 1 || array->components < 1 ||
                       array->components > INT32_MAX))
        return wrong_attribute(doc, "DataArray", "NumberOfComponents", components, "a number of 1 or more");
    if (format && strcmp(format, "ascii") && strcmp(format, "binary") && strcmp(format, "appended"))
        return wrong_attribute(doc, "DataArray", "format", format, "ascii, binary or appended");
    array->format = format && strcmp(format, "binary") == 0 ? FORMAT_BINARY
                    : format ? strcmp(format, "ascii") == 0 ? FORMAT_TEXT : FORMAT_APPENDED
                    : offset ? FORMAT_APPENDED
                             : FORMAT_TEXT;
    int status = add_name(doc, name ? name : "", &array->name);
    return status || array->format != FORMAT_APPENDED ? status : parse_offset(doc, offset, &array->offset);
}

/* The address in the file behind the tag that expat is at. */
static const unsigned char *behind_tag(const header_parser *p) {
    return p->doc->bytes + byte_index(p->expat) + byte_count(p->expat);
}

static int is_space(unsigned char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

static int begin_appended(header_parser *p, const char **attributes) {
    xml_document *doc = p->doc;
    const char *encoding = attribute(attributes, "encoding");
    if (encoding && strcmp(encoding, "raw") && strcmp(encoding, "base64"))
        return wrong_attribute(doc, "AppendedData", "encoding", encoding, "raw or base64");
    const unsigned char *at = behind_tag(p);
    while (at < doc->end && is_space(*at)) at++;
    if (at == doc->end || *at != '_')
        return fail(STATUS_INPUT, "%s: its appended data does not begin with '_'; the file is damaged", doc->path);
    doc->appended = at + 1;
    doc->appended_is_raw = encoding && strcmp(encoding, "raw") == 0;
    p->has_ended = 1;
    XML_StopParser(p->expat, XML_FALSE);
    return 0;
}

/* -------------------------------------------------------------------------------------------------------- handlers */

/* Text of an array ends where expat is at: at its end tag or at the tag of an element within. */
static int end_text(header_parser *p) {
    const unsigned char *at = p->text, *end = p->doc->bytes + byte_index(p->expat);
    xml_array *array = &p->doc->arrays[p->doc->array_count - 1];
    while (at < end && is_space(*at)) at++;
    while (end > at && is_space(end[-1])) end--;
    if (at >= end) return 0;
    if (array->text)
        return fail(STATUS_INPUT, "%s: the text of its array '%.60s' is in several parts; the file is damaged",
                    p->doc->path, p->doc->names + array->name);
    array->text = at;
    array->text_end = end;
    return 0;
}

static void stop_at_failure(header_parser *p) {
    if (p->status) XML_StopParser(p->expat, XML_FALSE);
}

static void start_element(void *user, const char *name, const char **attributes) {
    header_parser *p = user;
    if (p->status || p->has_ended) return;
    if (p->in_array && p->depth == LEVEL_ARRAY) p->status = end_text(p);
    p->depth++;
    if (p->status) {
    } else if (p->depth > DEEPEST) {
        p->status = fail(STATUS_INPUT, "%s: its elements are nested more than %d deep; this is no VTK file",
                         p->doc->path, DEEPEST);
    } else if (p->depth == LEVEL_FILE) {
        p->status = begin_file(p, name, attributes);
    } else if (p->depth == LEVEL_GRID && strcmp(name, p->grid_name) == 0) {
        p->status = begin_grid(p, attributes);
    } else if (p->depth == LEVEL_GRID && strcmp(name, "AppendedData") == 0) {
        p->status = begin_appended(p, attributes);
    } else if (p->depth == LEVEL_PIECE && p->in_grid && strcmp(name, "Piece") == 0) {
        p->status = begin_piece(p, attributes);
    } else if (p->depth == LEVEL_SECTION && p->in_piece) {
        p->section = find_section(name);
        note_name(p->scalars, attribute(attributes, "Scalars"));
        note_name(p->numbers, attribute(attributes, "GlobalIds"));
    } else if (p->depth == LEVEL_ARRAY && p->section &&
               (strcmp(name, "DataArray") == 0 || strcmp(name, "Array") == 0)) {
        p->status = begin_array(p, attributes);
        p->text = behind_tag(p);
    }
    stop_at_failure(p);
}

static void end_element(void *user, const char *name) {
    header_parser *p = user;
    (void)name;
    if (p->status || p->has_ended) return;
    if (p->in_array && p->depth == LEVEL_ARRAY) p->status = end_text(p);
    p->depth--;
    if (p->depth < LEVEL_ARRAY) p->in_array = 0;
    if (p->depth < LEVEL_SECTION) p->section = SECTION_NONE;
    if (p->depth < LEVEL_PIECE) p->in_piece = 0;
    if (p->depth < LEVEL_GRID) p->in_grid = 0;
    if (p->in_array && p->depth == LEVEL_ARRAY) p->text = behind_tag(p);
    stop_at_failure(p);
}

static void start_document_type(void *user, const char *name, const char *system, const char *public, int has_subset) {
    header_parser *p = user;
    (void)name;
    (void)system;
    (void)public;
    (void)has_subset;
    if (p->status || p->has_ended) return;
    p->status =
        fail(STATUS_INPUT, "%s: declares a document type, which no VTK file has; remove <!DOCTYPE ...>", p->doc->path);
    stop_at_failure(p);
}

int vtk_xml_parse(const char *path, const mapping *file, xml_document *doc) {
    *doc = (xml_document){0};
    if (!file->size) return fail(STATUS_INPUT, "%s: is empty", path);
    *doc = (xml_document){.path = path,
                          .bytes = file->bytes,
                          .end = file->bytes + file->size,
                          .spacing = {1, 1, 1},
                          .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    header_parser p = {.expat = XML_ParserCreate(NULL), .doc = doc};
    if (!p.expat) return no_memory(doc);
    XML_SetUserData(p.expat, &p);
    XML_SetElementHandler(p.expat, start_element, end_element);
    XML_SetStartDoctypeDeclHandler(p.expat, start_document_type);
    enum XML_Status code = XML_STATUS_OK;
    size_t chunk = FIRST_CHUNK; /* grows, as expat begins anew with each where a tag does not end in it */
    for (size_t at = 0, bytes; at < file->size && code == XML_STATUS_OK; at += bytes) {
        bytes = file->size - at < chunk ? file->size - at : chunk;
        code = XML_Parse(p.expat, (const char *)file->bytes + at, (int)bytes, at + bytes == file->size);
        if (chunk < LARGEST_CHUNK) chunk *= 2;
    }
    if (!p.status && !p.has_ended && code != XML_STATUS_OK && XML_GetErrorCode(p.expat) == XML_ERROR_NO_MEMORY)
        p.status = no_memory(doc);
    else if (!p.status && !p.has_ended && code != XML_STATUS_OK)
        p.status = fail(STATUS_INPUT, "%s: line %" PRIu64 " is not XML: %s; the file is damaged or cut", path,
                        (uint64_t)line_number(p.expat), XML_ErrorString(XML_GetErrorCode(p.expat)));
    XML_ParserFree(p.expat);
    return p.status;
}

void vtk_xml_release(xml_document *doc) {
    free(doc->pieces);
    free(doc->arrays);
    free(doc->names);
    *doc = (xml_document){0};
}
