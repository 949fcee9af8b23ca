/*
 * vtk_xml.c - serial VTK XML files: ImageData (.vti), RectilinearGrid (.vtr), StructuredGrid (.vts) and
 * UnstructuredGrid (.vtu); see vtk_xml_header.h
 *
 * Every piece that holds points becomes a block. Aligned raw appended data in this machine's byte order is used in the
 * mapped file; all other values are copied. Arrays of no use here (FieldData, strings) are skipped.
 */
#include "vtk_xml/vtk_xml.h"

#include "dataset/array_memory.h"
#include "dataset/layout.h"
#include "dataset/region.h"
#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "vtk_xml/vtk_xml_cells.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --------------------------------------------------------------------------------------------------------- geometry */

int vtk_xml_matrix(const read_request *request, const double origin[3], const double spacing[3],
                   const double direction[9], double matrix[3][4]) {
    const double *d = direction;
    for (int a = 0; a < 3 && !request->has_spacing; a++)
        if (d[a] == 0 && d[3 + a] == 0 && d[6 + a] == 0) return world_no_direction(request->path, "Direction", a + 1);
    for (int row = 0; row < 3; row++) {
        for (int a = 0; a < 3; a++) matrix[row][a] = d[3 * row + a] * spacing[a];
        matrix[row][3] = origin[row];
    }
    return world_complete(request, request->path, matrix);
}

static int load_axes(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    int status = 0;
    for (int a = 0; a < 3 && !status; a++) {
        const xml_array *array = vtk_xml_array_find(r, piece, SECTION_AXES, NULL, a);
        if (!array || array->components != 1)
            return fail(
                STATUS_INPUT,
                "%s: its Coordinates are not three arrays of single numbers, for x, y and z; the file is damaged",
                r->doc.path);
        status = vtk_xml_load_coordinates(r, array, (uint64_t)piece->dims[a], &block->axes[a]);
    }
    return status;
}

static int load_points(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    const xml_array *array = vtk_xml_array_find(r, piece, SECTION_POINTS, NULL, 0);
    if (!array || array->components != 3)
        return fail(STATUS_INPUT, "%s: its Points are not an array of three numbers each; the file is damaged",
                    r->doc.path);
    return vtk_xml_load_coordinates(r, array, 3 * piece->point_count, &block->points);
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
    const int is_level = strcmp(r->doc.names + array->name, "vtkGhostLevels") == 0;
    const int64_t bits = is_level ? on_cells ? UINT8_MAX : 0 : on_cells ? GHOST_CELL : POINT_IS_HIDDEN;
    const unsigned char *stored = NULL;
    void *owned;
    uint8_t *blanked = NULL;
    int status = vtk_xml_load_briefly(r, array, count, &stored, &owned);
    if (!status && !(blanked = vtk_xml_memory(r, count))) status = STATUS_FAILED;
    for (uint64_t i = 0; i < count && !status; i++) {
        int64_t flags;
        vtk_xml_to_integers(&flags, stored + i * element_bytes(array->element), 1, array->element);
        blanked[i] = is_level ? (flags & bits) != 0 : (uint8_t)(flags & bits); /* any level: a duplicate */
        any |= blanked[i];
    }
    samples_free(owned);
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
    int status = vtk_xml_load_briefly(r, array, is_text ? count : count / 8 + (count % 8 > 0), &stored, &owned);
    if (!status && !(bits = vtk_xml_memory(r, count))) status = STATUS_FAILED;
    for (uint64_t n = 0; n < count && !status; n++)
        bits[n] = is_text ? stored[n] != 0 : stored[n / 8] >> (7 - n % 8) & 1;
    *values = bits;
    samples_free(owned);
    return status;
}

/* Of a part the values are left where they lie, whatever their order of bytes: region_field takes what is wanted. */
static int load_values(xml_reader *r, const xml_array *array, uint64_t count, dataset_field *field) {
    const int is_cut = region_is_asked(r->request) && r->doc.kind != BLOCK_UNSTRUCTURED;
    xml_values v;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (status || !is_cut || !v.stored) return status ? status : vtk_xml_load_opened(r, &v, &field->values);
    field->is_swapped = r->doc.swapped && element_bytes(array->element) > 1;
    field->values = v.stored;
    r->uses_file = 1;
    vtk_xml_note_more(r, &v);
    return 0;
}

/* 64-bit integers become doubles, in the same memory; the nearest where no double is equal. */
static int load_field(xml_reader *r, const xml_array *array, uint64_t tuples, const char *names, dataset_block *block) {
    uint64_t count;
    int wide = array->element >= SAMPLE_TYPE_COUNT;
    dataset_field *added, field = {.name = names + array->name,
                                   .on_cells = array->section == SECTION_CELL_DATA,
                                   .components = (int)array->components,
                                   .is_active = array->is_active,
                                   .is_number = array->is_number,
                                   .type = element_sample_type(array->element)};
    if (__builtin_mul_overflow(tuples, (uint64_t)array->components, &count)) count = UINT64_MAX;
    if (wide) {
        xml_values v;
        int status = vtk_xml_open(&r->doc, array, count, &v);
        void *memory = status ? NULL : vtk_xml_memory(r, v.bytes);
        if (status || !memory) return status ? status : STATUS_FAILED;
        const unsigned char *from = v.in_place ? v.in_place : memory;
        if (!v.in_place && (status = vtk_xml_take(&v, memory))) return status;
        vtk_xml_note_more(r, &v);
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
    if (block->kind == BLOCK_UNIFORM)
        status = vtk_xml_matrix(r->request, r->doc.origin, r->doc.spacing, r->doc.direction, block->matrix);
    if (block->kind == BLOCK_RECTILINEAR) status = load_axes(r, piece, block);
    if (block->kind == BLOCK_CURVILINEAR || block->kind == BLOCK_UNSTRUCTURED) status = load_points(r, piece, block);
    if (block->kind == BLOCK_UNSTRUCTURED && !status) status = vtk_xml_load_cells(r, piece, block);
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
    return status;
}

int vtk_xml_read_piece(const read_request *request, mapping *own, dataset *out) {
    xml_reader r = {.request = request, .out = out};
    int status = vtk_xml_parse(request->path, own, &r.doc);
    if (!status) status = load_blocks(&r);
    vtk_xml_release(&r.doc);
    if (!status && r.uses_file) {
        out->mapping = (void *)(uintptr_t)own->bytes;
        out->mapping_bytes = own->size;
    } else {
        mapping_close(own);
    }
    if (!status) snprintf(out->format, sizeof out->format, "VTK XML");
    return status;
}

int vtk_xml_read(const read_request *request, const mapping *file, dataset *out) {
    mapping own; /* the caller closes its own; this one lives as long as values in it are used */
    (void)file;
    int status = dataset_map(out, request->path, &own);
    if (!status) status = vtk_xml_read_piece(request, &own, out);
    if (!status && !out->block_count)
        status = fail(STATUS_INPUT, "%s: holds no points: none of its pieces has any", request->path);
    return status;
}
