/*
 * vtk_xml.c - serial VTK XML files: ImageData (.vti), RectilinearGrid (.vtr), StructuredGrid (.vts) and
 * UnstructuredGrid (.vtu); see vtk_xml_header.h
 *
 * Every piece that holds points becomes a block. Aligned raw appended data in this machine's byte order is used in the
 * mapped file; all other values are copied. Arrays of no use here (FieldData, strings) are skipped.
 */
#include "vtk_xml/vtk_xml.h"

#include "dataset/array_memory.h"
#include "dataset/cell_faces.h"
#include "dataset/layout.h"
#include "dataset/part.h"
#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "vtk_xml/vtk_xml_data.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bits of vtkGhostType (vtkDataSetAttributes.h). */
enum { HIDDEN_POINT = 2, DUPLICATE_CELL = 1, HIDDEN_CELL = 32 };

#ifndef SMALL_BYTES /* larger arrays have memory of their own */
#define SMALL_BYTES (16 << 10)
#endif
enum { CHUNK_BYTES = 128 << 10, ALIGNMENT = 64 };

typedef struct xml_reader {
    const read_request *request;
    xml_document doc;
    dataset *out;
    int uses_file;        /* whether any values are used in the mapped file */
    unsigned char *chunk; /* for small arrays, which would waste a page each */
    size_t chunk_left;
} xml_reader;

static void *reader_memory(xml_reader *r, uint64_t bytes) {
    if (bytes > SMALL_BYTES) return dataset_allocate(r->out, bytes);
    size_t rounded = ((size_t)(bytes ? bytes : 1) + ALIGNMENT - 1) & ~(size_t)(ALIGNMENT - 1);
    if (rounded > r->chunk_left) {
        r->chunk = dataset_allocate(r->out, CHUNK_BYTES);
        r->chunk_left = r->chunk ? CHUNK_BYTES : 0;
        if (!r->chunk) return NULL;
    }
    r->chunk_left -= rounded;
    return r->chunk + CHUNK_BYTES - r->chunk_left - rounded;
}

static void note_more(xml_reader *r, const xml_values *v) {
    if (v->more)
        dataset_notice(r->out, "%s holds more values than are needed; the rest is not used", v->label + v->label_array);
}

/* ---------------------------------------------------------------------------------------------------------- values */

/* *values: those of the array, in the stored type, in the mapped file or in memory of the dataset. */
static int load_opened(xml_reader *r, xml_values *v, const void **values) {
    int status = 0;
    *values = v->in_place;
    if (v->in_place) {
        r->uses_file = 1;
    } else {
        void *memory = reader_memory(r, v->bytes);
        if (!memory) return STATUS_FAILED;
        *values = memory;
        status = vtk_xml_take(v, memory);
    }
    note_more(r, v);
    return status;
}

static int load_stored(xml_reader *r, const xml_array *array, uint64_t count, const void **values) {
    xml_values v;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    return status ? status : load_opened(r, &v, values);
}

/* Doubles as they are stored. Later float32 coordinates are made of them, half their size: so sharing them is bounded
 * as copying is. */
static int load_doubles(xml_reader *r, const xml_array *array, uint64_t count, const double **values) {
    xml_values v;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (!status && v.in_place) status = vtk_xml_note_taken(&r->doc, &v, v.bytes);
    return status ? status : load_opened(r, &v, (const void **)values);
}

/* The same for a short while: *owned is to be freed; NULL where the values are in the mapped file. */
static int load_briefly(xml_reader *r, const xml_array *array, uint64_t count, const unsigned char **values,
                        void **owned) {
    xml_values v;
    *owned = NULL;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (status) return status;
    if (v.in_place) {
        *values = v.in_place;
        status = vtk_xml_note_taken(&r->doc, &v, v.bytes);
    } else {
        if (!(*owned = samples_allocate(v.bytes)))
            return fail(STATUS_FAILED, "%s: no memory for %" PRIu64 " bytes", v.label, v.bytes);
        *values = *owned;
        status = vtk_xml_take(&v, *owned);
    }
    note_more(r, &v);
    return status;
}

#define CONVERT_CASE(converted, type, stored)                                                                          \
    case type:                                                                                                         \
        for (uint64_t i = 0; i < count; i++) {                                                                         \
            stored value;                                                                                              \
            memcpy(&value, from + i * sizeof value, sizeof value);                                                     \
            to[i] = (converted)value;                                                                                  \
        }                                                                                                              \
        break;
#define TO_DOUBLE(type, name, c_type, ...)  CONVERT_CASE(double, type, c_type)
#define TO_INTEGER(type, name, c_type, ...) CONVERT_CASE(int64_t, type, c_type)

static void convert_to_doubles(double *to, const unsigned char *from, uint64_t count, int element) {
    switch (element) { STORED_INTEGERS(TO_DOUBLE) }
}

/* Unsigned ones of 64 bits that int64 cannot hold become negative. */
static void convert_to_integers(int64_t *to, const unsigned char *from, uint64_t count, int element) {
    switch (element) { STORED_INTEGERS(TO_INTEGER) }
}

/* Coordinates, from any type of number: integers become doubles. */
static int load_coordinates(xml_reader *r, const xml_array *array, uint64_t count, coordinates *values) {
    const unsigned char *stored = NULL;
    void *owned, *memory;
    if (array->element == TC_F32) return load_stored(r, array, count, (const void **)&values->f32);
    if (array->element == TC_F64) return load_doubles(r, array, count, &values->f64);
    int status = load_briefly(r, array, count, &stored, &owned);
    if (!status && !(memory = reader_memory(r, count * sizeof(double)))) status = STATUS_FAILED;
    if (!status) {
        convert_to_doubles(memory, stored, count, array->element);
        values->f64 = memory;
    }
    free(owned);
    return status;
}

/* Writes `count` integers, stored in any type of integer. */
static int load_integers(xml_reader *r, const xml_array *array, uint64_t count, int64_t *to) {
    const unsigned char *stored = NULL;
    void *owned;
    if (element_is_real(array->element))
        return fail(STATUS_INPUT, "%s: its array '%.60s' is of floating point; it must be of integers", r->doc.path,
                    r->doc.names + array->name);
    int status = load_briefly(r, array, count, &stored, &owned);
    if (!status) convert_to_integers(to, stored, count, array->element);
    free(owned);
    return status;
}

/* --------------------------------------------------------------------------------------------------------- geometry */

/* The array of that index among those of a section and, unless it is NULL, of a name. NULL: there are fewer. */
static const xml_array *find_array(const xml_reader *r, const xml_piece *piece, enum xml_section section,
                                   const char *name, int index) {
    for (size_t i = 0; i < piece->array_count; i++) {
        const xml_array *array = &r->doc.arrays[piece->first_array + i];
        if (array->section == section && (!name || strcmp(name, r->doc.names + array->name) == 0) && !index--)
            return array;
    }
    return NULL;
}

static int set_matrix(const xml_reader *r, dataset_block *block) {
    const xml_document *doc = &r->doc;
    const double *d = doc->direction;
    double matrix[3][4];
    for (int a = 0; a < 3 && !r->request->has_spacing; a++)
        if (d[a] == 0 && d[3 + a] == 0 && d[6 + a] == 0) return world_no_direction(doc->path, "Direction", a + 1);
    for (int row = 0; row < 3; row++) {
        for (int a = 0; a < 3; a++) matrix[row][a] = d[3 * row + a] * doc->spacing[a];
        matrix[row][3] = doc->origin[row];
    }
    int status = world_place(r->request, doc->path, matrix);
    memcpy(block->matrix, matrix, sizeof matrix);
    return status;
}

static int load_axes(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    int status = 0;
    for (int a = 0; a < 3 && !status; a++) {
        const xml_array *array = find_array(r, piece, SECTION_AXES, NULL, a);
        if (!array || array->components != 1)
            return fail(
                STATUS_INPUT,
                "%s: its Coordinates are not three arrays of single numbers, for x, y and z; the file is damaged",
                r->doc.path);
        status = load_coordinates(r, array, (uint64_t)piece->dims[a], &block->axes[a]);
    }
    return status;
}

static int load_points(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    const xml_array *array = find_array(r, piece, SECTION_POINTS, NULL, 0);
    if (!array || array->components != 3)
        return fail(STATUS_INPUT, "%s: its Points are not an array of three numbers each; the file is damaged",
                    r->doc.path);
    return load_coordinates(r, array, 3 * piece->point_count, &block->points);
}

static int load_cell_types(xml_reader *r, const xml_array *array, uint64_t count, dataset_block *block) {
    if (array->element == TC_U8) return load_stored(r, array, count, (const void **)&block->cell_types);
    const unsigned char *stored = NULL;
    void *owned;
    uint8_t *types = NULL;
    int status = load_briefly(r, array, count, &stored, &owned);
    if (!status && !(types = reader_memory(r, count))) status = STATUS_FAILED;
    for (uint64_t i = 0; i < count && !status; i++) {
        int64_t type;
        convert_to_integers(&type, stored + i * element_bytes(array->element), 1, array->element);
        types[i] = (uint8_t)type;
        if (type < 0 || type > UINT8_MAX)
            status = fail(STATUS_INPUT, "%s: its cell %" PRIu64 " is of type %" PRId64 ", which there is not",
                          r->doc.path, i, type);
    }
    block->cell_types = types;
    free(owned);
    return status;
}

/* The file tells where each cell ends; the first begins at 0. */
static int load_cell_offsets(xml_reader *r, const xml_array *array, uint64_t count, dataset_block *block) {
    xml_values v;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (status) return status;
    int64_t *offsets = reader_memory(r, (count + 1) * sizeof *offsets);
    if (!offsets) return STATUS_FAILED;
    offsets[0] = 0;
    if ((status = load_integers(r, array, count, offsets + 1))) return status;
    for (uint64_t i = 0; i < count; i++)
        if (offsets[i + 1] < offsets[i])
            return fail(STATUS_INPUT,
                        "%s: its cell %" PRIu64 " ends at %" PRId64 ", before it begins (%" PRId64
                        "): offsets must ascend; the file is damaged",
                        r->doc.path, i, offsets[i + 1], offsets[i]);
    block->cell_offsets = offsets;
    return 0;
}

static int load_connectivity(xml_reader *r, const xml_array *array, uint64_t count, dataset_block *block) {
    int status;
    if (array->element == ELEMENT_I64) {
        status = load_stored(r, array, count, (const void **)&block->cell_points);
    } else {
        xml_values v;
        if ((status = vtk_xml_open(&r->doc, array, count, &v))) return status;
        int64_t *points = reader_memory(r, count * sizeof *points);
        if (!points) return STATUS_FAILED;
        status = load_integers(r, array, count, points);
        block->cell_points = points;
    }
    for (uint64_t i = 0; i < count && !status; i++)
        if (block->cell_points[i] < 0 || block->cell_points[i] >= block->point_count)
            status = fail(STATUS_INPUT,
                          "%s: its cells name the point %" PRId64 ", but the points are 0 to %" PRId64
                          "; the file is damaged",
                          r->doc.path, block->cell_points[i], block->point_count - 1);
    return status;
}

static const xml_array *find_cells_array(const xml_reader *r, const xml_piece *piece, const char *name) {
    return find_array(r, piece, SECTION_CELLS, name, 0);
}

/* The first `count` integers of an array of the cells, as int64. */
static int load_indices(xml_reader *r, const xml_piece *piece, const char *name, uint64_t count,
                        const int64_t **values) {
    const xml_array *array = find_cells_array(r, piece, name);
    xml_values v;
    if (!array)
        return fail(STATUS_INPUT,
                    "%s: its Cells have no array '%s', which goes with others of polyhedra; the file is "
                    "damaged",
                    r->doc.path, name);
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (status) return status;
    int64_t *memory = reader_memory(r, count * sizeof *memory);
    *values = memory;
    return memory ? load_integers(r, array, count, memory) : STATUS_FAILED;
}

/* Faces as VTK had them up to version 9.3: a stream, and where each cell's ends, -1 where there is none. */
static int load_face_stream(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    const int64_t *ends, *stream;
    int64_t length = 0;
    int status = load_indices(r, piece, "faceoffsets", piece->cell_count, &ends);
    for (uint64_t cell = 0; cell < piece->cell_count && !status; cell++)
        if (block->cell_types[cell] == CELL_POLYHEDRON && ends[cell] > length) length = ends[cell];
    if (!status) status = load_indices(r, piece, "faces", (uint64_t)length, &stream);
    return status ? status : cell_faces_take(r->out, block, r->doc.path, stream, (uint64_t)length, ends, 0);
}

/* Faces from version 9.4 on: each cell has a list of them, and they are stored once. A count that makes no sense is
 * larger than the next array, whose loading fails then. */
static int load_face_lists(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    face_lists l = {0};
    int status = load_indices(r, piece, "polyhedron_offsets", piece->cell_count, &l.cell_ends);
    uint64_t used = status || !piece->cell_count ? 0 : (uint64_t)l.cell_ends[piece->cell_count - 1];
    if (!status) status = load_indices(r, piece, "polyhedron_to_faces", used, &l.faces);
    for (uint64_t n = 0; n < used && !status; n++)
        if (l.faces[n] >= l.face_count) l.face_count = l.faces[n] < INT64_MAX ? l.faces[n] + 1 : INT64_MAX;
    if (!status) status = load_indices(r, piece, "face_offsets", (uint64_t)l.face_count, &l.face_ends);
    used = status || !l.face_count ? 0 : (uint64_t)l.face_ends[l.face_count - 1];
    if (!status) status = load_indices(r, piece, "face_connectivity", used, &l.points);
    return status ? status : cell_faces_gather(r->out, block, r->doc.path, &l);
}

static int load_faces(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    int has_polyhedra = 0;
    for (uint64_t cell = 0; cell < piece->cell_count && !has_polyhedra; cell++)
        has_polyhedra = block->cell_types[cell] == CELL_POLYHEDRON;
    if (!has_polyhedra) return 0;
    if (find_cells_array(r, piece, "faceoffsets")) return load_face_stream(r, piece, block);
    return find_cells_array(r, piece, "polyhedron_offsets") ? load_face_lists(r, piece, block) : 0;
}

static int load_cells(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    static const xml_array nothing = {.section = SECTION_CELLS, .element = TC_U8};
    static const char *const names[] = {"types", "offsets", "connectivity"};
    const xml_array *arrays[3];
    for (int i = 0; i < 3; i++) {
        arrays[i] = find_array(r, piece, SECTION_CELLS, names[i], 0);
        if (!arrays[i] && piece->cell_count)
            return fail(STATUS_INPUT, "%s: its Cells have no array '%s'; the file is damaged", r->doc.path, names[i]);
        if (!arrays[i]) arrays[i] = &nothing;
    }
    int status = load_cell_types(r, arrays[0], piece->cell_count, block);
    if (!status) status = load_cell_offsets(r, arrays[1], piece->cell_count, block);
    if (!status) status = load_connectivity(r, arrays[2], (uint64_t)block->cell_offsets[piece->cell_count], block);
    return status ? status : load_faces(r, piece, block);
}

/* ----------------------------------------------------------------------------------------------------------- fields */

static int is_integral(const xml_array *array) {
    return array->element >= 0 && !element_is_real(array->element) && !array->is_bits;
}

/* Whether the array tells what is missing: vtkGhostType, or vtkGhostLevels of older files' cells. */
static int is_ghost_array(const xml_reader *r, const xml_array *array) {
    const char *name = r->doc.names + array->name;
    return (strcmp(name, "vtkGhostType") == 0 || strcmp(name, "vtkGhostLevels") == 0) && array->components == 1 &&
           is_integral(array);
}

static int load_blanked(xml_reader *r, const xml_array *array, uint64_t count, dataset_block *block) {
    int on_cells = array->section == SECTION_CELL_DATA, any = 0;
    int64_t bits = on_cells ? DUPLICATE_CELL | HIDDEN_CELL : HIDDEN_POINT;
    if (strcmp(r->doc.names + array->name, "vtkGhostLevels") == 0) bits = on_cells ? UINT8_MAX : 0;
    const unsigned char *stored = NULL;
    void *owned;
    uint8_t *blanked = NULL;
    int status = load_briefly(r, array, count, &stored, &owned);
    if (!status && !(blanked = reader_memory(r, count))) status = STATUS_FAILED;
    for (uint64_t i = 0; i < count && !status; i++) {
        int64_t flags;
        convert_to_integers(&flags, stored + i * element_bytes(array->element), 1, array->element);
        blanked[i] = (flags & bits) != 0;
        any |= blanked[i];
    }
    free(owned);
    if (status || !any) return status;
    *(on_cells ? &block->blanked_cells : &block->blanked_points) = blanked;
    return 0;
}

/* A byte for every bit, 0 or 1. */
static int load_bits(xml_reader *r, const xml_array *array, uint64_t count, const void **values) {
    const int is_text = array->format == FORMAT_TEXT;
    const unsigned char *stored = NULL;
    unsigned char *bits = NULL;
    void *owned;
    int status = load_briefly(r, array, is_text ? count : count / 8 + (count % 8 > 0), &stored, &owned);
    if (!status && !(bits = reader_memory(r, count))) status = STATUS_FAILED;
    for (uint64_t n = 0; n < count && !status; n++)
        bits[n] = is_text ? stored[n] != 0 : stored[n / 8] >> (7 - n % 8) & 1;
    *values = bits;
    free(owned);
    return status;
}

/* Of a part the values are left where they lie, whatever their order of bytes: part_field takes what is wanted. */
static int load_values(xml_reader *r, const xml_array *array, uint64_t count, dataset_field *field) {
    const int is_cut = part_is_asked(r->request) && r->doc.kind != BLOCK_UNSTRUCTURED;
    xml_values v;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (status || !is_cut || !v.stored) return status ? status : load_opened(r, &v, &field->values);
    field->is_swapped = r->doc.swapped && element_bytes(array->element) > 1;
    field->values = v.stored;
    r->uses_file = 1;
    note_more(r, &v);
    return 0;
}

/* 64-bit integers become doubles, in the same memory; the nearest where no double is equal. */
static int load_field(xml_reader *r, const xml_array *array, uint64_t tuples, const char *names, dataset_block *block) {
    uint64_t count;
    int wide = array->element >= SAMPLE_TYPE_COUNT;
    dataset_field *added, field = {.name = names + array->name,
                                   .on_cells = array->section == SECTION_CELL_DATA,
                                   .components = (int)array->components,
                                   .type = element_sample_type(array->element)};
    if (__builtin_mul_overflow(tuples, (uint64_t)array->components, &count)) count = UINT64_MAX;
    if (wide) {
        xml_values v;
        int status = vtk_xml_open(&r->doc, array, count, &v);
        void *memory = status ? NULL : reader_memory(r, v.bytes);
        if (status || !memory) return status ? status : STATUS_FAILED;
        const unsigned char *from = v.in_place ? v.in_place : memory;
        if (!v.in_place && (status = vtk_xml_take(&v, memory))) return status;
        note_more(r, &v);
        layout convert = {.element = array->element, .dims = {(int64_t)count, 1, 1}, .stride = {1, 0, 0}};
        field.is_rounded = layout_gather(v.label, &convert, from, memory) != 0; /* one row, filled in any case */
        field.values = memory;
    } else {
        int status = array->is_bits ? load_bits(r, array, count, &field.values) : load_values(r, array, count, &field);
        if (status) return status;
    }
    if (dataset_field_add(block, &added)) return STATUS_FAILED;
    *added = field;
    return 0;
}

static int load_fields(xml_reader *r, const xml_piece *piece, const char *names, dataset_block *block) {
    int status = 0;
    for (size_t i = 0; i < piece->array_count && !status; i++) {
        const xml_array *array = &r->doc.arrays[piece->first_array + i];
        uint64_t tuples = array->section == SECTION_CELL_DATA ? piece->cell_count : piece->point_count;
        if (array->section != SECTION_POINT_DATA && array->section != SECTION_CELL_DATA) continue;
        if (array->element < 0)
            status = dataset_leave_out(r->out, names + array->name,
                                       *array->type ? "its type %s cannot be read" : "it has no type%s", array->type);
        else if (is_ghost_array(r, array))
            status = load_blanked(r, array, tuples, block);
        else
            status = load_field(r, array, tuples, names, block);
    }
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- blocks */

static int load_block(xml_reader *r, const xml_piece *piece, const char *names) {
    dataset_block *block;
    if (dataset_block_add(r->out, &block)) return STATUS_FAILED;
    block->kind = r->doc.kind;
    block->point_count = (int64_t)piece->point_count;
    block->cell_count = (int64_t)piece->cell_count;
    memcpy(block->dims, piece->dims, sizeof block->dims);
    memcpy(block->first, piece->first, sizeof block->first);
    int status = 0;
    if (block->kind == BLOCK_UNIFORM) status = set_matrix(r, block);
    if (block->kind == BLOCK_RECTILINEAR) status = load_axes(r, piece, block);
    if (block->kind == BLOCK_CURVILINEAR || block->kind == BLOCK_UNSTRUCTURED) status = load_points(r, piece, block);
    if (block->kind == BLOCK_UNSTRUCTURED && !status) status = load_cells(r, piece, block);
    return status ? status : load_fields(r, piece, names, block);
}

static int load_blocks(xml_reader *r) {
    const xml_document *doc = &r->doc;
    int status = 0;
    char *names = dataset_allocate(r->out, doc->name_bytes);
    if (!names) return STATUS_FAILED;
    if (doc->name_bytes) memcpy(names, doc->names, doc->name_bytes);
    for (size_t i = 0; i < doc->piece_count && !status; i++)
        if (doc->pieces[i].point_count) status = load_block(r, &doc->pieces[i], names);
    if (!status && !r->out->block_count)
        status = fail(STATUS_INPUT, "%s: holds no points: none of its %zu pieces has any", doc->path, doc->piece_count);
    return status;
}

int vtk_xml_read(const read_request *request, const mapping *file, dataset *out) {
    xml_reader r = {.request = request, .out = out};
    mapping own; /* the caller closes its own; this one lives as long as values in it are used */
    (void)file;
    int status = dataset_map(out, request->path, &own);
    if (!status) status = vtk_xml_parse(request->path, &own, &r.doc);
    if (!status) status = load_blocks(&r);
    vtk_xml_release(&r.doc);
    if (!status && r.uses_file) {
        out->mapping = (void *)(uintptr_t)own.bytes;
        out->mapping_bytes = own.size;
    } else {
        mapping_close(&own);
    }
    if (!status) snprintf(out->format, sizeof out->format, "VTK XML");
    return status;
}
