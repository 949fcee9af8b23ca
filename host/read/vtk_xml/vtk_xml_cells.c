#include "vtk_xml/vtk_xml_cells.h"

#include "dataset/array_memory.h"
#include "dataset/cell_faces.h"
#include "exit_status.h"
#include "failure.h"
#include "stored_types.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static int load_cell_types(xml_reader *r, const xml_array *array, uint64_t count, dataset_block *block) {
    if (array->element == TC_U8) return vtk_xml_load_stored(r, array, count, (const void **)&block->cell_types);
    const unsigned char *stored = NULL;
    void *owned;
    uint8_t *types = NULL;
    int status = vtk_xml_load_briefly(r, array, count, &stored, &owned);
    if (!status && !(types = vtk_xml_memory(r, count))) status = STATUS_FAILED;
    for (uint64_t i = 0; i < count && !status; i++) {
        int64_t type;
        vtk_xml_to_integers(&type, stored + i * element_bytes(array->element), 1, array->element);
        types[i] = (uint8_t)type;
        if (type < 0 || type > UINT8_MAX)
            status = fail(STATUS_INPUT, "%s: its cell %" PRIu64 " is of type %" PRId64 ", which there is not",
                          r->doc.path, i, type);
    }
    block->cell_types = types;
    samples_free(owned);
    return status;
}

/* The file tells where each cell ends; the first begins at 0. */
static int load_cell_offsets(xml_reader *r, const xml_array *array, uint64_t count, dataset_block *block) {
    xml_values v;
    int status = vtk_xml_open(&r->doc, array, count, &v);
    if (status) return status;
    int64_t *offsets = vtk_xml_memory(r, (count + 1) * sizeof *offsets);
    if (!offsets) return STATUS_FAILED;
    offsets[0] = 0;
    if ((status = vtk_xml_load_integers(r, array, count, offsets + 1))) return status;
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
        status = vtk_xml_load_stored(r, array, count, (const void **)&block->cell_points);
    } else {
        xml_values v;
        if ((status = vtk_xml_open(&r->doc, array, count, &v))) return status;
        int64_t *points = vtk_xml_memory(r, count * sizeof *points);
        if (!points) return STATUS_FAILED;
        status = vtk_xml_load_integers(r, array, count, points);
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
    return vtk_xml_array_find(r, piece, SECTION_CELLS, name, 0);
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
    int64_t *memory = vtk_xml_memory(r, count * sizeof *memory);
    *values = memory;
    return memory ? vtk_xml_load_integers(r, array, count, memory) : STATUS_FAILED;
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

int vtk_xml_load_cells(xml_reader *r, const xml_piece *piece, dataset_block *block) {
    static const xml_array nothing = {.section = SECTION_CELLS, .element = TC_U8};
    static const char *const names[] = {"types", "offsets", "connectivity"};
    const xml_array *arrays[3];
    for (int i = 0; i < 3; i++) {
        arrays[i] = vtk_xml_array_find(r, piece, SECTION_CELLS, names[i], 0);
        if (!arrays[i] && piece->cell_count)
            return fail(STATUS_INPUT, "%s: its Cells have no array '%s'; the file is damaged", r->doc.path, names[i]);
        if (!arrays[i]) arrays[i] = &nothing;
    }
    int status = load_cell_types(r, arrays[0], piece->cell_count, block);
    if (!status) status = load_cell_offsets(r, arrays[1], piece->cell_count, block);
    if (!status) status = load_connectivity(r, arrays[2], (uint64_t)block->cell_offsets[piece->cell_count], block);
    return status ? status : load_faces(r, piece, block);
}
