/* index.c - the XML of a parallel file, through expat; see index.h */
#include "vtk_parallel/index.h"

#include "exit_status.h"
#include "failure.h"
#include "file/header_text.h"

#include <expat.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { DEEPEST = 64, FILES_MOST = 16384, CHUNK = 1 << 20 };

/* Levels of elements: VTKFile, grid, and its pieces; blocks are nested deeper. */
enum { LEVEL_FILE = 1, LEVEL_GRID, LEVEL_PIECE };

typedef struct index_parser {
    XML_Parser expat;
    vtk_index *index;
    const char *grid_name;
    int depth, in_grid, status;
} index_parser;

static const char *attribute(const char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (strcmp(attributes[0], name) == 0) return attributes[1];
    return NULL;
}

static int wrong_attribute(const vtk_index *x, const char *element, const char *name, const char *is,
                           const char *should) {
    return fail(STATUS_INPUT, "%s: its element %s has the attribute %s=\"%.60s\"; it must be %s", x->path, element,
                name, is, should);
}

/* Indices have 32 bits, as in files of pieces. */
static int parse_extent(const vtk_index *x, const char *element, const char *name, const char *text,
                        index_extent *extent) {
    int64_t pairs[6];
    if (!text)
        return fail(STATUS_INPUT, "%s: its element %s has no %s; add \"x0 x1 y0 y1 z0 z1\"", x->path, element, name);
    if (parse_integers(text, pairs, 6) != 6) return wrong_attribute(x, element, name, text, "six integers");
    for (int a = 0; a < 3; a++) {
        const int64_t low = pairs[2 * a], high = pairs[2 * a + 1];
        if (low < INT32_MIN || low > INT32_MAX || high > INT32_MAX || high < low - 1)
            return wrong_attribute(x, element, name, text, "three pairs of indices, each first to last, of 32 bits");
        extent->first[a] = low;
        extent->dims[a] = high - low + 1;
    }
    return 0;
}

static int begin_file(index_parser *p, const char *name, const char **attributes) {
    static const struct {
        const char *name;
        enum block_kind kind;
    } types[] = {{"PImageData", BLOCK_UNIFORM},
                 {"PRectilinearGrid", BLOCK_RECTILINEAR},
                 {"PStructuredGrid", BLOCK_CURVILINEAR},
                 {"PUnstructuredGrid", BLOCK_UNSTRUCTURED},
                 {"vtkMultiBlockDataSet", BLOCK_UNSTRUCTURED}};
    const char *type = attribute(attributes, "type");
    if (strcmp(name, "VTKFile"))
        return fail(STATUS_INPUT, "%s: is XML, but its first element is %.40s, not VTKFile", p->index->path, name);
    for (size_t n = 0; type && n < sizeof types / sizeof *types; n++)
        if (strcmp(type, types[n].name) == 0) {
            p->grid_name = types[n].name;
            p->index->kind = types[n].kind;
        }
    if (!p->grid_name)
        return fail(STATUS_INPUT, "%s: is no index of VTK XML that is read, but %.40s", p->index->path,
                    type ? type : "of no named type");
    p->index->is_list = strcmp(p->grid_name, "vtkMultiBlockDataSet") == 0;
    return 0;
}

static int parse_vector(index_parser *p, const char **attributes, const char *name, double *values, int count) {
    const char *text = attribute(attributes, name);
    if (!text) return 0;
    p->index->has_world = 1;
    if (parse_numbers(text, values, count) == count) return 0;
    return wrong_attribute(p->index, p->grid_name, name, text, count == 3 ? "three numbers" : "nine numbers");
}

static int begin_grid(index_parser *p, const char **attributes) {
    vtk_index *x = p->index;
    const char *levels = attribute(attributes, "GhostLevel");
    int status = 0;
    p->in_grid = 1;
    if (x->is_list) return 0;
    if (levels &&
        (parse_integers(levels, &x->ghost_levels, 1) != 1 || x->ghost_levels < 0 || x->ghost_levels > INT32_MAX))
        return wrong_attribute(x, p->grid_name, "GhostLevel", levels, "a number of 0 or more");
    if (x->kind == BLOCK_UNSTRUCTURED) return 0;
    status = parse_extent(x, p->grid_name, "WholeExtent", attribute(attributes, "WholeExtent"), &x->whole);
    if (!status) status = parse_vector(p, attributes, "Origin", x->origin, 3);
    if (!status) status = parse_vector(p, attributes, "Spacing", x->spacing, 3);
    return status ? status : parse_vector(p, attributes, "Direction", x->direction, 9);
}

static int add_file(vtk_index *x, const char *name, const index_extent *extent) {
    const int64_t count = x->files.count;
    if (count == FILES_MOST)
        return fail(STATUS_INPUT, "%s: names more than %d files; join some of them", x->path, FILES_MOST);
    int status = data_names_add(&x->files, x->path, name);
    if (status || !extent) return status;
    if ((count & (count - 1)) == 0) { /* sizes are powers of two */
        index_extent *grown = realloc(x->extents, (size_t)(count ? 2 * count : 1) * sizeof *grown);
        if (!grown) return fail(STATUS_FAILED, "%s: no memory for the list of its pieces", x->path);
        x->extents = grown;
    }
    x->extents[count] = *extent;
    return 0;
}

/* A piece without points needs no file. */
static int begin_piece(index_parser *p, const char **attributes) {
    const char *source = attribute(attributes, "Source");
    index_extent extent;
    if (p->index->kind == BLOCK_UNSTRUCTURED && source) return add_file(p->index, source, NULL);
    if (p->index->kind != BLOCK_UNSTRUCTURED) {
        int status = parse_extent(p->index, "Piece", "Extent", attribute(attributes, "Extent"), &extent);
        if (status || !extent.dims[0] || !extent.dims[1] || !extent.dims[2]) return status;
        if (source) return add_file(p->index, source, &extent);
    }
    return fail(STATUS_INPUT, "%s: one of its pieces has no Source, which names its file; add it", p->index->path);
}

/* A block that is empty names no file. */
static int begin_block(index_parser *p, const char **attributes) {
    const char *file = attribute(attributes, "file");
    return file ? add_file(p->index, file, NULL) : 0;
}

static void start_element(void *user, const char *name, const char **attributes) {
    index_parser *p = user;
    if (p->status) return;
    p->depth++;
    if (p->depth > DEEPEST)
        p->status = fail(STATUS_INPUT, "%s: its elements are nested more than %d deep; this is no VTK file",
                         p->index->path, DEEPEST);
    else if (p->depth == LEVEL_FILE)
        p->status = begin_file(p, name, attributes);
    else if (p->depth == LEVEL_GRID && strcmp(name, p->grid_name) == 0)
        p->status = begin_grid(p, attributes);
    else if (p->depth == LEVEL_PIECE && p->in_grid && !p->index->is_list && strcmp(name, "Piece") == 0)
        p->status = begin_piece(p, attributes);
    else if (p->depth >= LEVEL_PIECE && p->in_grid && p->index->is_list && strcmp(name, "DataSet") == 0)
        p->status = begin_block(p, attributes);
    if (p->status) XML_StopParser(p->expat, XML_FALSE);
}

static void end_element(void *user, const char *name) {
    index_parser *p = user;
    (void)name;
    p->depth--;
    if (p->depth < LEVEL_GRID) p->in_grid = 0;
}

static void start_document_type(void *user, const char *name, const char *system, const char *public, int has_subset) {
    index_parser *p = user;
    (void)name;
    (void)system;
    (void)public;
    (void)has_subset;
    if (p->status) return;
    p->status = fail(STATUS_INPUT, "%s: declares a document type, which no VTK file has; remove <!DOCTYPE ...>",
                     p->index->path);
    XML_StopParser(p->expat, XML_FALSE);
}

static int parse(index_parser *p, const mapping *file) {
    enum XML_Status code = XML_STATUS_OK;
    for (size_t at = 0, bytes; at < file->size && code == XML_STATUS_OK && !p->status; at += bytes) {
        bytes = file->size - at < CHUNK ? file->size - at : CHUNK;
        code = XML_Parse(p->expat, (const char *)file->bytes + at, (int)bytes, at + bytes == file->size);
    }
    if (p->status || code == XML_STATUS_OK) return p->status;
    const enum XML_Error error = XML_GetErrorCode(p->expat);
    if (error == XML_ERROR_NO_MEMORY) return fail(STATUS_FAILED, "%s: no memory for its list of files", p->index->path);
    return fail(STATUS_INPUT, "%s: is not XML to its end: %s; the file is damaged or cut", p->index->path,
                XML_ErrorString(error));
}

int vtk_index_parse(const char *path, const mapping *file, vtk_index *index) {
    *index = (vtk_index){.path = path, .spacing = {1, 1, 1}, .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    if (!file->size) return fail(STATUS_INPUT, "%s: is empty", path);
    index_parser p = {.expat = XML_ParserCreate(NULL), .index = index};
    if (!p.expat) return fail(STATUS_FAILED, "%s: no memory for its list of files", path);
    XML_SetUserData(p.expat, &p);
    XML_SetElementHandler(p.expat, start_element, end_element);
    XML_SetStartDoctypeDeclHandler(p.expat, start_document_type);
    int status = parse(&p, file);
    XML_ParserFree(p.expat);
    if (!status && !index->files.count)
        status = fail(STATUS_INPUT, "%s: names no file that holds %s", path,
                      index->is_list ? "a block" : "a piece with points");
    return status;
}

void vtk_index_release(vtk_index *index) {
    data_names_release(&index->files);
    free(index->extents);
    *index = (vtk_index){0};
}
