/* seeds_vtk.c - VTK legacy and VTK XML files of every kind of grid and in every encoding; see seeds.h */
#include "seeds.h"

#include "vtk_xml_files.h"

static const char plain[4] = {-1, -1, 0, 0};
static const double cube_links[] = {0, 1, 3, 2, 4, 5, 7, 6, 8, 9, 10, 11}, ends[] = {8, 12}, types[] = {12, 10};

/* -------------------------------------------------------------------------------------------------------------- XML */

static void xml_section(vtk_writer *w, const char *element, int type, const char *name, int components, int count) {
    double values[64];
    for (int i = 0; i < count; i++) values[i] = test_value(type, (uint64_t)i);
    bytes_text(&w->text, "<%s>\n", element);
    array_add(w, type, name, components, values, (uint64_t)count);
    bytes_text(&w->text, "</%s>\n", element);
}

static void xml_coordinates(vtk_writer *w, enum block_kind kind) {
    static const double axis[] = {0, 1, 3, 4.5};
    double points[36];
    for (int i = 0; i < 36; i++) points[i] = i * 29 % 97;
    if (kind == BLOCK_RECTILINEAR) {
        bytes_text(&w->text, "<Coordinates>\n");
        array_add(w, TC_F32, "x", 1, axis, 3);
        array_add(w, TC_F64, "y", 1, axis, 2);
        array_add(w, TC_I16, "z", 1, axis, 2);
        bytes_text(&w->text, "</Coordinates>\n");
    } else if (kind != BLOCK_UNIFORM) {
        bytes_text(&w->text, "<Points>\n");
        array_add(w, TC_F32, "Points", 3, points, 36);
        bytes_text(&w->text, "</Points>\n");
    }
    if (kind != BLOCK_UNSTRUCTURED) return;
    bytes_text(&w->text, "<Cells>\n");
    array_add(w, STORED_I64, "connectivity", 1, cube_links, 12);
    array_add(w, TC_I32, "offsets", 1, ends, 2);
    array_add(w, TC_U8, "types", 1, types, 2);
    bytes_text(&w->text, "</Cells>\n");
}

/* 3 x 2 x 2 points, or 12 of two cells. */
static void add_xml(enum block_kind kind, const vtk_shape *shape) {
    static const char *const names[] = {"ImageData", "RectilinearGrid", "StructuredGrid", "UnstructuredGrid"};
    char name[64];
    vtk_writer w;
    vtk_xml_begin(&w, shape, names[kind]);
    bytes_text(&w.text, "<%s WholeExtent=\"-1 1 0 1 0 1\" Origin=\"1 2 3\" Spacing=\"1 0.5 2\">\n", names[kind]);
    if (kind == BLOCK_UNSTRUCTURED)
        bytes_text(&w.text, "<Piece NumberOfPoints=\"12\" NumberOfCells=\"2\">\n");
    else
        bytes_text(&w.text, "<Piece Extent=\"-1 1 0 1 0 1\">\n");
    xml_section(&w, "PointData", kind == BLOCK_UNIFORM ? TC_U8 : TC_F32, "a", 1, 12);
    xml_section(&w, "PointData", TC_U8, "vtkGhostType", 1, 12);
    xml_section(&w, "CellData", TC_F64, "b", 3, 6);
    xml_coordinates(&w, kind);
    bytes_text(&w.text, "</Piece></%s>\n", names[kind]);
    bytes file = vtk_xml_finish(&w);
    snprintf(name, sizeof name, "kind-%d-encoding-%d-header-%d-big-%d-packed-%d", (int)kind, shape->encoding,
             shape->header_bytes, shape->big, shape->is_compressed);
    seed_file("vtk_xml", name, file.data, file.size, NULL, 0, plain);
    bytes_free(&file);
}

/* ----------------------------------------------------------------------------------------------------------- legacy */

static void legacy_values(bytes *b, int binary, int stored, uint64_t count) {
    for (uint64_t i = 0; i < count; i++)
        if (binary)
            bytes_value(b, stored, test_value(stored, i), 1);
        else
            bytes_text(b, "%.9g ", test_value(stored, i));
    bytes_text(b, "\n");
}

static void legacy_integers(bytes *b, int binary, size_t size, const double *values, int count) {
    for (int i = 0; i < count; i++)
        if (binary)
            bytes_put(b, (uint64_t)values[i], size, 1);
        else
            bytes_text(b, "%.0f ", values[i]);
    bytes_text(b, "\n");
}

static void legacy_cells(bytes *b, int binary, int version) {
    static const double offsets[] = {0, 8, 12}, lists[] = {8, 0, 1, 3, 2, 4, 5, 7, 6, 4, 8, 9, 10, 11};
    if (version == 5) {
        bytes_text(b, "CELLS 3 12\nOFFSETS vtktypeint64\n");
        legacy_integers(b, binary, 8, offsets, 3);
        bytes_text(b, "CONNECTIVITY vtktypeint64\n");
        legacy_integers(b, binary, 8, cube_links, 12);
    } else {
        bytes_text(b, "CELLS 2 14\n");
        legacy_integers(b, binary, 4, lists, 14);
    }
    bytes_text(b, "CELL_TYPES 2\n");
    legacy_integers(b, binary, 4, types, 2);
}

static void legacy_geometry(bytes *b, enum block_kind kind, int binary, int version) {
    static const char *const names[] = {"STRUCTURED_POINTS", "RECTILINEAR_GRID", "STRUCTURED_GRID",
                                        "UNSTRUCTURED_GRID"};
    bytes_text(b, "# vtk DataFile Version %d.%d\na title\n%s\nDATASET %s\n", version, version == 5,
               binary ? "BINARY" : "ASCII", names[kind]);
    if (kind != BLOCK_UNSTRUCTURED) bytes_text(b, "DIMENSIONS 3 2 2\n");
    if (kind == BLOCK_UNIFORM)
        bytes_text(b, "ORIGIN 10 20 -30\n%s 0.5 2 3\n", version == 5 ? "SPACING" : "ASPECT_RATIO");
    for (int a = 0; a < 3 && kind == BLOCK_RECTILINEAR; a++) {
        bytes_text(b, "%c_COORDINATES %d float\n", 'X' + a, a ? 2 : 3);
        legacy_values(b, binary, TC_F32, a ? 2 : 3);
    }
    if (kind >= BLOCK_CURVILINEAR) {
        bytes_text(b, "POINTS 12 double\n");
        legacy_values(b, binary, TC_F64, 36);
    }
    if (kind == BLOCK_UNSTRUCTURED) legacy_cells(b, binary, version);
}

static void legacy_attributes(bytes *b, int binary) {
    bytes_text(b, "CELL_DATA 2\nSCALARS c bit 1\nLOOKUP_TABLE default\n");
    bytes_text(b, binary ? "\200\n" : "1 0\n");
    bytes_text(b, "POINT_DATA 12\nSCALARS a short\nLOOKUP_TABLE t\n");
    legacy_values(b, binary, TC_I16, 12);
    bytes_text(b, "METADATA\nINFORMATION 0\n\n");
    bytes_text(b, "LOOKUP_TABLE t 2\n");
    bytes_text(b, binary ? "12345678\n" : "0 0 0 1 1 1 1 1\n");
    bytes_text(b, "VECTORS v float\n");
    legacy_values(b, binary, TC_F32, 36);
    bytes_text(b, "FIELD FieldData 2\nf%%20g 2 12 double\n");
    legacy_values(b, binary, TC_F64, 24);
    bytes_text(b, "h 1 12 vtkIdType\n");
    legacy_values(b, binary, TC_I32, 12);
}

static void add_legacy(enum block_kind kind, int binary, int version) {
    char name[64];
    bytes file = {0};
    legacy_geometry(&file, kind, binary, version);
    legacy_attributes(&file, binary);
    snprintf(name, sizeof name, "kind-%d-binary-%d-version-%d", (int)kind, binary, version);
    seed_file("vtk_legacy", name, file.data, file.size, NULL, 0, plain);
    bytes_free(&file);
}

/* A tetrahedron as a polyhedron beside one that is none, in both layouts of each format; columns without blanks. */
static void add_polyhedra(void) {
    static const double links[] = {0, 1, 2, 3, 0, 1, 2, 3}, cell_ends[] = {4, 8}, kinds[] = {10, 42},
                        stream[] = {4, 3, 0, 1, 2, 3, 0, 1, 3, 3, 3, 1, 2, 3, 0, 2, 3}, stream_ends[] = {-1, 17},
                        face_ends[] = {3, 6, 9, 12}, faces[] = {0, 1, 2, 3}, first_faces[] = {0, 4},
                        face_links[] = {0, 1, 2, 0, 1, 3, 3, 1, 2, 0, 2, 3},
                        points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int n = 0; n < 4; n++) {
        const vtk_shape shape = {.encoding = n & 1 ? AS_INLINE : AS_TEXT, .header_bytes = 4};
        char name[32];
        vtk_writer w;
        vtk_xml_begin(&w, &shape, "UnstructuredGrid");
        bytes_text(&w.text, "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"2\"><Points>");
        array_add(&w, TC_F32, "Points", 3, points, 12);
        bytes_text(&w.text, "</Points><Cells>");
        array_add(&w, STORED_I64, "connectivity", 1, links, 8);
        array_add(&w, STORED_I64, "offsets", 1, cell_ends, 2);
        array_add(&w, TC_U8, "types", 1, kinds, 2);
        if (n & 2) {
            array_add(&w, STORED_I64, "faces", 1, stream, 17);
            array_add(&w, STORED_I64, "faceoffsets", 1, stream_ends, 2);
        } else {
            array_add(&w, TC_I32, "face_connectivity", 1, face_links, 12);
            array_add(&w, TC_I32, "face_offsets", 1, face_ends, 4);
            array_add(&w, TC_I32, "polyhedron_to_faces", 1, faces, 4);
            array_add(&w, TC_I32, "polyhedron_offsets", 1, first_faces, 2);
        }
        bytes_text(&w.text, "</Cells></Piece></UnstructuredGrid>");
        bytes file = vtk_xml_finish(&w);
        snprintf(name, sizeof name, "polyhedra-%d", n);
        seed_file("vtk_xml", name, file.data, file.size, NULL, 0, plain);
        bytes_free(&file);
    }
    for (int n = 0; n < 2; n++) {
        bytes file = {0};
        bytes_text(&file,
                   "# vtk DataFile Version %s\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
                   "0-0 0 1.E+00-0.D+00-.0E+00 0 1+0 0 0 1\n",
                   n ? "5.1" : "3.0");
        bytes_text(&file,
                   n ? "CELLS 3 21\nOFFSETS int\n0 4 21\nCONNECTIVITY int\n0 1 2 3\n" : "CELLS 2 23\n4 0 1 2 3\n17 ");
        bytes_text(&file, "4 3 0 1 2 3 0 1 3 3 3 1 2 3 0 2 3\nCELL_TYPES 2\n10 42\nCELL_DATA 2\nSCALARS a int1\n1-2\n");
        seed_file("vtk_legacy", n ? "polyhedra-5" : "polyhedra-3", file.data, file.size, NULL, 0, plain);
        bytes_free(&file);
    }
}

/* ----------------------------------------------------------------------------------------------------------- pieces */

/* Half of 5 x 2 x 2 points, with or without a layer of ghosts; a tetrahedron of two that share a face. */
static bytes piece_file(enum block_kind kind, int piece, int ghosts, int numbered) {
    static const char *const names[] = {"ImageData", "RectilinearGrid", "StructuredGrid", "UnstructuredGrid"};
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1}, all[] = {0, 1, 2, 3, 4};
    static const double marks[2][3] = {{0, 0, 1}, {1, 0, 0}}, numbers[2][4] = {{5, 6, 7, 8}, {5, 6, 7, 9}};
    const vtk_shape shape = {.encoding = AS_TEXT, .header_bytes = 4};
    vtk_writer w;
    const int first = piece ? 2 - ghosts : 0, last = piece ? 4 : 2 + ghosts, count = 4 * (last - first + 1);
    double values[60];
    for (int i = 0; i < 60; i++) values[i] = i * 29 % 97 * 0.5;
    vtk_xml_begin(&w, &shape, names[kind]);
    bytes_text(&w.text, "<%s>", names[kind]);
    if (kind == BLOCK_UNSTRUCTURED)
        bytes_text(&w.text, "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">");
    else
        bytes_text(&w.text, "<Piece Extent=\"%d %d 0 1 0 1\">", first, last);
    bytes_text(&w.text, numbered ? "<PointData GlobalIds=\"n\">" : "<PointData>");
    array_add(&w, TC_F32, "a", 1, all, kind == BLOCK_UNSTRUCTURED ? 4 : 0);
    if (kind != BLOCK_UNSTRUCTURED) array_add(&w, TC_F32, "b", 1, values, (uint64_t)count);
    if (numbered) array_add(&w, TC_I32, "n", 1, numbers[piece], 4);
    bytes_text(&w.text, "</PointData><CellData>");
    if (ghosts) array_add(&w, TC_U8, "vtkGhostType", 1, marks[piece], kind == BLOCK_UNSTRUCTURED ? 1 : 3);
    bytes_text(&w.text, "</CellData>");
    if (kind == BLOCK_RECTILINEAR) {
        bytes_text(&w.text, "<Coordinates>");
        array_add(&w, TC_F32, "x", 1, all + first, (uint64_t)(last - first + 1));
        array_add(&w, TC_F32, "y", 1, all, 2);
        array_add(&w, TC_F32, "z", 1, all, 2);
        bytes_text(&w.text, "</Coordinates>");
    } else if (kind != BLOCK_UNIFORM) {
        double own[12];
        memcpy(own, points, sizeof own);
        if (piece) memcpy(own + 9, points + 12, 3 * sizeof *own);
        bytes_text(&w.text, "<Points>");
        array_add(&w, TC_F32, "Points", 3, kind == BLOCK_UNSTRUCTURED ? own : values,
                  kind == BLOCK_UNSTRUCTURED ? 12 : 3 * (uint64_t)count);
        bytes_text(&w.text, "</Points>");
    }
    if (kind == BLOCK_UNSTRUCTURED) {
        bytes_text(&w.text, "<Cells>");
        array_add(&w, TC_I32, "connectivity", 1, all, 4);
        array_add(&w, TC_I32, "offsets", 1, all + 4, 1);
        array_add(&w, TC_U8, "types", 1, types + 1, 1);
        bytes_text(&w.text, "</Cells>");
    }
    bytes_text(&w.text, "</Piece></%s>", names[kind]);
    return vtk_xml_finish(&w);
}

static void add_pieces(enum block_kind kind, int ghosts, int numbered, int as_blocks) {
    static const char *const names[] = {"PImageData", "PRectilinearGrid", "PStructuredGrid", "PUnstructuredGrid"};
    const char *type = as_blocks ? "vtkMultiBlockDataSet" : names[kind];
    char name[64];
    bytes index = {0}, second = piece_file(kind, 0, ghosts, numbered), third = piece_file(kind, 1, ghosts, numbered);
    bytes_text(&index, "<VTKFile type=\"%s\"><%s WholeExtent=\"0 4 0 1 0 1\" GhostLevel=\"%d\">", type, type, ghosts);
    for (int n = 1; n <= 2; n++)
        bytes_text(&index,
                   as_blocks ? "<Block><DataSet index=\"%d\" file=\"%d\"/></Block>"
                             : "<Piece Extent=\"%d %d 0 1 0 1\" Source=\"%d\"/>",
                   n == 1 ? (as_blocks ? 1 : 0) : 2 - !as_blocks * ghosts,
                   as_blocks ? n
                   : n == 1  ? 2 + ghosts
                             : 4,
                   n);
    bytes_text(&index, "</%s></VTKFile>", type);
    bytes_text(&second, "\n=FILE=\n");
    bytes_add(&second, third.data, third.size);
    snprintf(name, sizeof name, "kind-%d-ghosts-%d-numbered-%d-blocks-%d", (int)kind, ghosts, numbered, as_blocks);
    seed_file("vtk_parallel", name, index.data, index.size, second.data, second.size, plain);
    bytes_free(&index);
    bytes_free(&second);
    bytes_free(&third);
}

void seeds_vtk(void) {
    for (int n = 0; n < 16; n++) add_pieces((enum block_kind)(n & 3), n >> 2 & 1, 0, n >> 3);
    for (int n = 0; n < 2; n++) add_pieces(BLOCK_UNSTRUCTURED, n, 1, 0);
    add_polyhedra();
    for (int kind = BLOCK_UNIFORM; kind <= BLOCK_UNSTRUCTURED; kind++) {
        for (int n = 0; n < 64; n++) {
            const vtk_shape shape = {.encoding = n & 3,
                                     .header_bytes = n & 4 ? 8 : 4,
                                     .big = n >> 3 & 1,
                                     .is_compressed = n >> 4,
                                     .block_bytes = 32};
            if (shape.encoding != AS_TEXT || n < 4) add_xml((enum block_kind)kind, &shape);
        }
        for (int n = 0; n < 4; n++) add_legacy((enum block_kind)kind, n & 1, n & 2 ? 5 : 3);
    }
}
