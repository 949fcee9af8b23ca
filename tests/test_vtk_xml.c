/*
 * test_vtk_xml.c - the reader of VTK XML: every kind of grid in every encoding, damage of each kind, published files
 *
 * Published files are those of the folder that TETRACUBES_DATA names; without it those checks are skipped.
 */
#include "exit_status.h"
#include "expect.h"
#include "failure.h"
#include "readers.h"
#include "vtk_xml_files.h"
#include "random.h"

#include <fcntl.h>
#include <unistd.h>

static int read_path(const char *path, dataset *out) {
    read_request request;
    mapping file;
    *out = (dataset){0};
    read_request_init(&request, path);
    fail(0, "(no text)");
    int status = mapping_open(path, &file);
    if (!status) status = vtk_xml_read(&request, &file, out);
    mapping_close(&file);
    return status;
}

static int read_bytes(const char *name, const bytes *file, dataset *out) {
    return read_path(file_write(name, file->data, file->size), out);
}

/* ---------------------------------------------------------------------------------------------------- what is made */

enum { FIELD_COUNT = 10 };

/* Two pieces of a structured grid, the first with odd and negative indices; cells of an unstructured one. */
static const int64_t extents[2][6] = {{-1, 1, 3, 6, 7, 11}, {1, 2, 3, 6, 7, 8}};
static const int cell_points[] = {0, 1, 3, 2, 4, 5, 7, 6, 8, 9, 10, 11, 0, 2, 4, 6, 8, 10};
static const int cell_ends[] = {8, 12, 18};
static const int cell_types[] = {12, 10, 13};
static const char *const grid_names[] = {"ImageData", "RectilinearGrid", "StructuredGrid", "UnstructuredGrid"};

static void piece_sizes(enum grid_kind kind, int piece, int64_t dims[3], uint64_t *points, uint64_t *cells) {
    const int64_t *e = extents[piece];
    for (int a = 0; a < 3; a++) dims[a] = kind == GRID_UNSTRUCTURED ? 0 : e[2 * a + 1] - e[2 * a] + 1;
    *points = kind == GRID_UNSTRUCTURED ? 12 : (uint64_t)(dims[0] * dims[1] * dims[2]);
    *cells = kind == GRID_UNSTRUCTURED ? 3 : (uint64_t)((dims[0] - 1) * (dims[1] - 1) * (dims[2] - 1));
}

/* A small value for coordinates, exact in every type. */
static double coordinate(uint64_t i) { return (double)(i * 29 % 97); }

static void add_coordinates(vtk_writer *w, int type, const char *name, int components, uint64_t count) {
    double values[1024];
    for (uint64_t i = 0; i < count; i++) values[i] = coordinate(i + (uint64_t)*name);
    array_add(w, type, name, components, values, count);
}

static void add_integers(vtk_writer *w, int type, const char *name, const int *from, uint64_t count) {
    double values[64];
    for (uint64_t i = 0; i < count; i++) values[i] = from[i];
    array_add(w, type, name, 1, values, count);
}

/* A field of every type on the points, two on the cells, and arrays that tell what is missing. */
static void add_fields(vtk_writer *w, uint64_t points, uint64_t cells) {
    double values[1024];
    bytes_text(&w->text, "<PointData Scalars=\"Float32\">\n");
    for (int type = 0; type < FIELD_COUNT; type++) {
        uint64_t components = type == TC_F32 ? 3 : 1;
        for (uint64_t i = 0; i < points * components; i++) values[i] = test_value(type, i);
        array_add(w, type, vtk_types[type], (int)components, values, points * components);
    }
    for (uint64_t i = 0; i < points; i++) values[i] = i == 5 ? 2 : i == 6 ? 1 : 0;
    array_add(w, TC_U8, "vtkGhostType", 1, values, points);
    bytes_text(&w->text, "<Array type=\"String\" Name=\"s\" format=\"ascii\">1 2 3</Array></PointData>\n<CellData>\n");
    for (uint64_t i = 0; i < cells; i++) values[i] = test_value(TC_I16, i);
    array_add(w, TC_I16, "on cells", 1, values, cells);
    for (uint64_t i = 0; i < cells; i++) values[i] = i == 0 ? 1 : i == 1 ? 8 : i == 2 ? 32 : 0;
    array_add(w, TC_U8, "vtkGhostType", 1, values, cells);
    bytes_text(&w->text, "</CellData>\n");
}

static void add_piece(vtk_writer *w, enum grid_kind kind, int piece) {
    const int64_t *e = extents[piece];
    int64_t dims[3];
    uint64_t points, cells;
    piece_sizes(kind, piece, dims, &points, &cells);
    if (kind == GRID_UNSTRUCTURED)
        bytes_text(&w->text, "<Piece NumberOfPoints=\"%" PRIu64 "\" NumberOfCells=\"%" PRIu64 "\">\n", points, cells);
    else
        bytes_text(&w->text,
                   "<Piece Extent=\"%" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 "\">\n", e[0],
                   e[1], e[2], e[3], e[4], e[5]);
    add_fields(w, points, cells);
    if (kind == GRID_RECTILINEAR) {
        bytes_text(&w->text, "<Coordinates>\n");
        add_coordinates(w, TC_F32, "x", 1, (uint64_t)dims[0]);
        add_coordinates(w, TC_F64, "y", 1, (uint64_t)dims[1]);
        add_coordinates(w, TC_I16, "z", 1, (uint64_t)dims[2]);
        bytes_text(&w->text, "</Coordinates>\n");
    }
    if (kind == GRID_CURVILINEAR || kind == GRID_UNSTRUCTURED) {
        bytes_text(&w->text, "<Points>\n");
        add_coordinates(w, kind == GRID_CURVILINEAR ? TC_F32 : TC_F64, "Points", 3, 3 * points);
        bytes_text(&w->text, "</Points>\n");
    }
    if (kind == GRID_UNSTRUCTURED) {
        bytes_text(&w->text, "<Cells>\n");
        add_integers(w, piece ? TC_I32 : STORED_I64, "connectivity", cell_points, 18);
        add_integers(w, piece ? STORED_U64 : STORED_I64, "offsets", cell_ends, 3);
        add_integers(w, piece ? TC_I16 : TC_U8, "types", cell_types, 3);
        bytes_text(&w->text, "</Cells>\n");
    }
    bytes_text(&w->text, "</Piece>\n");
}

static bytes make_file(enum grid_kind kind, const vtk_shape *shape, int pieces) {
    vtk_writer w;
    vtk_xml_begin(&w, shape, grid_names[kind]);
    bytes_text(&w.text,
               "<%s%s>\n<FieldData><DataArray type=\"Float64\" Name=\"time\" NumberOfTuples=\"1\" "
               "format=\"ascii\">0.5</DataArray></FieldData>\n",
               grid_names[kind],
               kind == GRID_UNIFORM ? " WholeExtent=\"-1 2 3 6 7 11\" Origin=\"1 -2 3.5\" Spacing=\"0.5 2 4\" "
                                      "Direction=\"0 -1 0 1 0 0 0 0 1\""
                                    : "");
    for (int i = 0; i < pieces; i++) add_piece(&w, kind, i);
    bytes_text(&w.text, "</%s>\n", grid_names[kind]);
    return vtk_xml_finish(&w);
}

/* ------------------------------------------------------------------------------------------------------- comparison */

static double field_value(const dataset_field *f, uint64_t i) {
    volume v = {.type = f->type, .samples = f->values};
    return volume_value(&v, i);
}

static void expect_fields(const char *what, const dataset_block *b, uint64_t points, uint64_t cells) {
    EXPECT(b->field_count == FIELD_COUNT + 1, "%s: %d fields", what, b->field_count);
    for (int n = 0; n < b->field_count && n <= FIELD_COUNT; n++) {
        const dataset_field *f = &b->fields[n];
        int type = n < FIELD_COUNT ? n : TC_I16, components = n == TC_F32 ? 3 : 1;
        uint64_t count = (n < FIELD_COUNT ? points : cells) * (uint64_t)components, wrong = 0;
        EXPECT(f->type == (type > TC_F64 ? TC_F64 : (tc_type)type) && f->components == components &&
                   f->on_cells == (n == FIELD_COUNT) && !strcmp(f->name, n < FIELD_COUNT ? vtk_types[n] : "on cells"),
               "%s: field %d is '%s', type %d, %d components, on cells %d", what, n, f->name, f->type, f->components,
               f->on_cells);
        if (f->components != components) continue;
        EXPECT((uintptr_t)f->values % stored_bytes((int)f->type) == 0, "%s: field %d is not aligned", what, n);
        for (uint64_t i = 0; i < count; i++) wrong += field_value(f, i) != test_value(type, i);
        EXPECT(wrong == 0, "%s: %" PRIu64 " values of field '%s' are wrong", what, wrong, f->name);
    }
    EXPECT(b->blanked_points && b->blanked_cells, "%s: nothing is blanked", what);
    for (uint64_t i = 0; i < points && b->blanked_points; i++)
        EXPECT(b->blanked_points[i] == (i == 5), "%s: point %" PRIu64 " blanked %d", what, i, b->blanked_points[i]);
    for (uint64_t i = 0; i < cells && b->blanked_cells; i++)
        EXPECT(b->blanked_cells[i] == (i == 0 || i == 2), "%s: cell %" PRIu64 " blanked %d", what, i,
               b->blanked_cells[i]);
}

static uint64_t wrong_coordinates(const float *is, char name, uint64_t count) {
    uint64_t wrong = 0;
    for (uint64_t i = 0; i < count; i++) wrong += (double)is[i] != coordinate(i + (uint64_t)name);
    return wrong;
}

static void expect_geometry(const char *what, const dataset_block *b, uint64_t points) {
    static const double matrix[12] = {0, -2, 0, 1, 0.5, 0, 0, -2, 0, 0, 4, 3.5};
    uint64_t wrong = 0;
    if (b->kind == GRID_UNIFORM)
        for (int i = 0; i < 12; i++)
            EXPECT(b->matrix[i / 4][i % 4] == matrix[i], "%s: matrix[%d] is %g", what, i, b->matrix[i / 4][i % 4]);
    if (b->kind == GRID_RECTILINEAR)
        for (int a = 0; a < 3; a++) wrong += wrong_coordinates(b->axes[a], "xyz"[a], (uint64_t)b -> dims[a]);
    if (b->kind == GRID_CURVILINEAR || b->kind == GRID_UNSTRUCTURED)
        wrong += wrong_coordinates(b->points, 'P', 3 * points);
    EXPECT(wrong == 0, "%s: %" PRIu64 " coordinates are wrong", what, wrong);
    if (b->kind != GRID_UNSTRUCTURED) return;
    for (int i = 0; i < 3; i++)
        EXPECT(b->cell_types[i] == cell_types[i] && b->cell_offsets[i + 1] == cell_ends[i], "%s: cell %d: %d, ends %d",
               what, i, b->cell_types[i], (int)b->cell_offsets[i + 1]);
    for (int i = 0; i < 18; i++) wrong += b->cell_points[i] != cell_points[i];
    EXPECT(b->cell_offsets[0] == 0 && wrong == 0, "%s: %" PRIu64 " points of cells are wrong", what, wrong);
}

static void expect_dataset(const char *what, const dataset *d, enum grid_kind kind, int pieces) {
    EXPECT(d->block_count == pieces && !strcmp(d->format, "VTK XML") && !*d->notice, "%s: %d blocks, '%s', notice '%s'",
           what, d->block_count, d->format, d->notice);
    for (int n = 0; n < pieces && n < d->block_count; n++) {
        const dataset_block *b = &d->blocks[n];
        int64_t dims[3];
        uint64_t points, cells;
        piece_sizes(kind, n, dims, &points, &cells);
        EXPECT(b->kind == kind && b->point_count == (int64_t)points && b->cell_count == (int64_t)cells &&
                   !memcmp(b->dims, dims, sizeof dims),
               "%s: block %d of kind %d, %" PRId64 " points, %" PRId64 " cells", what, n, b->kind, b->point_count,
               b->cell_count);
        for (int a = 0; a < 3; a++)
            EXPECT(b->first[a] == (kind == GRID_UNSTRUCTURED ? 0 : extents[n][2 * a]), "%s: first[%d] is %" PRId64,
                   what, a, b->first[a]);
        expect_geometry(what, b, points);
        expect_fields(what, b, points, cells);
    }
}

/* Native, aligned, raw: used where it lies, but what has another type than is needed. */
static void expect_in_place(const char *what, const dataset *d) {
    const unsigned char *begin = d->mapping, *end = begin + d->mapping_bytes;
    int inside = 0;
    for (int n = 0; n < d->blocks[0].field_count; n++) {
        const unsigned char *values = d->blocks[0].fields[n].values;
        inside += values >= begin && values < end;
    }
    EXPECT(d->mapping && inside == FIELD_COUNT - 2 + 1, "%s: %d fields in place", what, inside);
}

static void test_shape(enum grid_kind kind, const vtk_shape *s, int pieces) {
    static const char *const names[] = {"text", "inline", "raw", "base64"};
    char what[128];
    snprintf(what, sizeof what, "%s, %s, UInt%d, big %d, zlib %d, breaks %d", grid_names[kind], names[s->encoding],
             8 * s->header_bytes, s->big, s->is_compressed, s->line_breaks);
    bytes file = make_file(kind, s, pieces);
    dataset d;
    int status = read_bytes("shape.vtk", &file, &d);
    EXPECT(status == 0, "%s: status %d: %s", what, status, failure_text());
    if (!status) {
        expect_dataset(what, &d, kind, pieces);
        int is_raw = s->encoding == AS_APPENDED_RAW && !s->is_compressed && !s->big;
        if (is_raw)
            expect_in_place(what, &d);
        else
            EXPECT(!d.mapping || (s->encoding == AS_APPENDED_RAW && !s->is_compressed), "%s: keeps the file", what);
    }
    dataset_release(&d);
    bytes_free(&file);
}

static void test_shapes(void) {
    for (int kind = 0; kind < 4; kind++)
        for (int encoding = 0; encoding < 4; encoding++)
            for (int bits = 0; bits < 16; bits++) {
                vtk_shape s = {encoding,      bits & 1 ? 8 : 4,     bits >> 1 & 1,
                               bits >> 2 & 1, bits & 1 ? 48 : 1000, bits >> 3 & 1};
                if (encoding == AS_TEXT && bits) continue;
                test_shape((enum grid_kind)kind, &s, 1 + (bits & 1));
            }
}

/* ------------------------------------------------------------------------------------------------------------ damage
 */

/* Every shorter file: an error with a text, or, where only the end of the XML is gone, all values. */
static void test_truncation(enum grid_kind kind, const vtk_shape *s) {
    bytes file = make_file(kind, s, 1);
    char path[256];
    snprintf(path, sizeof path, "%s", file_write("cut.vtk", file.data, file.size));
    uint64_t wrong = 0, read = 0;
    for (size_t size = file.size; size-- > 0;) {
        dataset d;
        if (truncate(path, (off_t)size)) break;
        int status = read_path(path, &d);
        wrong += status && (status != STATUS_INPUT || !strstr(failure_text(), path));
        read += !status;
        if (!status) expect_dataset("cut", &d, kind, 1);
        dataset_release(&d);
    }
    int is_appended = s->encoding >= AS_APPENDED_RAW;
    EXPECT(wrong == 0, "%" PRIu64 " shorter files fail otherwise", wrong);
    EXPECT(is_appended ? read > 0 && read < 64 : read == 1, "%" PRIu64 " shorter files of encoding %d can be read",
           read, s->encoding);
    bytes_free(&file);
}

/* Some bytes changed: an error with a text, or other values. */
static void test_changes(enum grid_kind kind, const vtk_shape *s, int rounds) {
    bytes file = make_file(kind, s, 2);
    char path[256];
    uint64_t wrong = 0;
    snprintf(path, sizeof path, "%s", file_write("changed.vtk", file.data, file.size));
    int fd = open(path, O_WRONLY);
    for (int round = 0; round < rounds; round++) {
        off_t places[4];
        int count = 1 + (int)random_below(4);
        for (int i = 0; i < count; i++) {
            unsigned char byte = (unsigned char)(random_below(3) ? '0' + random_below(10) : random_below(256));
            places[i] = random_below((uint32_t)file.size);
            wrong += pwrite(fd, &byte, 1, places[i]) != 1;
        }
        dataset d;
        int status = read_path(path, &d);
        wrong += status && (status != STATUS_INPUT || !strstr(failure_text(), path));
        dataset_release(&d);
        for (int i = 0; i < count; i++) wrong += pwrite(fd, file.data + places[i], 1, places[i]) != 1;
    }
    close(fd);
    EXPECT(wrong == 0, "%" PRIu64 " changed files fail otherwise", wrong);
    bytes_free(&file);
}

static void test_damage(int rounds) {
    static const vtk_shape shapes[] = {{AS_TEXT, 4, 0, 0, 0, 0},
                                       {AS_INLINE, 4, 0, 0, 0, 0},
                                       {AS_INLINE, 8, 1, 1, 100, 0},
                                       {AS_APPENDED_RAW, 8, 0, 0, 0, 0},
                                       {AS_APPENDED_RAW, 4, 0, 1, 64, 0},
                                       {AS_APPENDED_BASE64, 8, 1, 0, 0, 1},
                                       {AS_APPENDED_BASE64, 4, 0, 1, 50, 0}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        test_truncation(GRID_UNSTRUCTURED, &shapes[i]);
        for (int kind = 0; kind < 4; kind++) test_changes((enum grid_kind)kind, &shapes[i], rounds);
    }
}

/* ------------------------------------------------------------------------------------------------------- small files
 */

static void expect_refused(const char *words, const char *text) {
    dataset d;
    int status = read_path(file_text("bad.vtk", text), &d);
    EXPECT(status == STATUS_INPUT && strstr(failure_text(), words) && strstr(failure_text(), "bad.vtk"),
           "status %d, text lacks '%s': %s\n%.300s", status, words, failure_text(), text);
    dataset_release(&d);
}

#define FILE_OF(type, attributes, content) "<VTKFile type=\"" type "\"" attributes ">" content "</VTKFile>"
#define IMAGE(extent, content)                                                                                         \
    FILE_OF("ImageData", "", "<ImageData><Piece Extent=\"" extent "\">" content "</Piece></ImageData>")
#define POINTS(attributes, content)                                                                                    \
    "<PointData><DataArray Name=\"a\" " attributes ">" content "</DataArray></PointData>"
#define CELLS(points, cells, connectivity, offsets, types)                                                             \
    FILE_OF("UnstructuredGrid", "",                                                                                    \
            "<UnstructuredGrid><Piece NumberOfPoints=\"" points "\" NumberOfCells=\"" cells "\"><Points><DataArray "   \
            "type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>"  \
            "<Cells><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">" connectivity                    \
            "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">" offsets                         \
            "</DataArray><DataArray type=\"Int16\" Name=\"types\" format=\"ascii\">" types                             \
            "</DataArray></Cells></Piece></UnstructuredGrid>")
#define CUBE "0 1 0 1 0 1"

static void test_kinds_refused(void) {
    expect_refused("PolyData", FILE_OF("PolyData", "", "<PolyData/>"));
    expect_refused("list of other files", FILE_OF("PImageData", "", ""));
    expect_refused("list of other files", FILE_OF("PUnstructuredGrid", "", ""));
    expect_refused("list of other files", FILE_OF("vtkMultiBlockDataSet", "", ""));
    expect_refused("HyperTreeGrid", FILE_OF("HyperTreeGrid", "", ""));
    expect_refused(".vtu", "<VTKFile version=\"0.1\"/>");
    expect_refused("not VTKFile", "<svg/>");
    expect_refused("is not XML", "# vtk DataFile Version 3.0\n");
    expect_refused("is not XML", "<VTKFile type=\"ImageData\"><ImageData></VTKFile>");
    expect_refused("is empty", "");
    expect_refused("no points", FILE_OF("ImageData", "", "<ImageData/>"));
    expect_refused("no points", FILE_OF("ImageData", "", ""));
    expect_refused("no points", IMAGE("0 -1 0 -1 0 -1", ""));
    expect_refused("byte_order", FILE_OF("ImageData", " byte_order=\"Middle\"", ""));
    expect_refused("header_type", FILE_OF("ImageData", " header_type=\"UInt16\"", ""));
}

/* Expat must not even see entities; deep elements and long texts must not matter. */
static void test_xml(void) {
    expect_refused("document type", "<!DOCTYPE a [<!ENTITY b \"bbbbbbbb\"><!ENTITY c \"&b;&b;&b;&b;\">]><a>&c;</a>");
    expect_refused("document type", "<!DOCTYPE VTKFile SYSTEM \"file:///etc/passwd\"><VTKFile type=\"ImageData\"/>");
    bytes deep = {0};
    bytes_text(&deep, "<VTKFile type=\"ImageData\"><ImageData>");
    for (int i = 0; i < 100000; i++) bytes_text(&deep, "<Piece>");
    bytes_add(&deep, "", 1);
    expect_refused("Extent", (char *)deep.data);
    deep.size = 0;
    bytes_text(&deep, "<VTKFile type=\"ImageData\">");
    for (int i = 0; i < 100000; i++) bytes_text(&deep, "<a>");
    bytes_add(&deep, "", 1);
    expect_refused("nested", (char *)deep.data);
    bytes_free(&deep);
}

static void test_extents(void) {
    expect_refused("Extent", FILE_OF("ImageData", "", "<ImageData><Piece/></ImageData>"));
    expect_refused("Extent", IMAGE("0 1 0 1", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 0 1 0", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 5 0", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 0 x", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 0 99999999999999999999", ""));
    expect_refused("Extent", IMAGE("0 1 0 1 -9223372036854775808 1", ""));
    expect_refused("too many points", IMAGE("0 2147483646 0 2147483646 0 2147483646", ""));
    expect_refused("too many points", IMAGE("-2147483648 2147483647 -2147483648 2147483647 0 1", ""));
    expect_refused("numbers of text",
                   IMAGE("0 2000000 0 2000000 0 100", POINTS("type=\"UInt8\" format=\"ascii\"", "1 2 3")));
    expect_refused("Spacing", FILE_OF("ImageData", "", "<ImageData Spacing=\"1 1\"/>"));
    expect_refused("Direction", FILE_OF("ImageData", "", "<ImageData Direction=\"1 0 0 0 1 0 0 0\"/>"));
    expect_refused("do not span",
                   FILE_OF("ImageData", "", "<ImageData Spacing=\"1 0 1\"><Piece Extent=\"" CUBE "\"/></ImageData>"));
    expect_refused("not finite",
                   FILE_OF("ImageData", "", "<ImageData Origin=\"1 nan 1\"><Piece Extent=\"" CUBE "\"/></ImageData>"));
}

static void test_arrays(void) {
    expect_refused("format", IMAGE(CUBE, POINTS("type=\"UInt8\" format=\"hex\"", "")));
    expect_refused("NumberOfComponents", IMAGE(CUBE, POINTS("type=\"UInt8\" NumberOfComponents=\"0\"", "")));
    expect_refused("NumberOfComponents", IMAGE(CUBE, POINTS("type=\"UInt8\" NumberOfComponents=\"9999999999\"", "")));
    expect_refused("offset", IMAGE(CUBE, POINTS("type=\"UInt8\" format=\"appended\"", "")));
    expect_refused("offset", IMAGE(CUBE, POINTS("type=\"UInt8\" format=\"appended\" offset=\"-1\"", "")));
    expect_refused("of which the file has none", IMAGE(CUBE, POINTS("type=\"UInt8\" offset=\"0\"", "")));
    expect_refused("'300'", IMAGE(CUBE, POINTS("type=\"UInt8\"", "1 2 3 4 5 6 7 300")));
    expect_refused("'-129'", IMAGE(CUBE, POINTS("type=\"Int8\"", "1 2 3 4 5 6 -128 -129")));
    expect_refused("'-1'", IMAGE(CUBE, POINTS("type=\"UInt32\"", "1 2 3 4 5 6 7 -1")));
    expect_refused("'1.5'", IMAGE(CUBE, POINTS("type=\"Int32\"", "1 2 3 4 5 6 7 1.5")));
    expect_refused("'1.5x'", IMAGE(CUBE, POINTS("type=\"Float32\"", "1 2 3 4 5 6 7 1.5x")));
    expect_refused("'9223372036854775808'", IMAGE(CUBE, POINTS("type=\"Int64\"", "1 2 3 4 5 6 7 9223372036854775808")));
    expect_refused("has 7 numbers", IMAGE(CUBE, POINTS("type=\"Int32\"", "10 20 3 4 5 6 7")));
    expect_refused("has at most", IMAGE(CUBE, POINTS("type=\"Int32\"", "1 2 3 4")));
    expect_refused("has at most", IMAGE(CUBE, POINTS("type=\"Int32\"", "")));
    expect_refused("several parts", IMAGE(CUBE, POINTS("type=\"Int32\"", "1 2 3 4 <a/> 5 6 7 8")));
    expect_refused("'a' ends", IMAGE(CUBE, POINTS("type=\"Int32\" format=\"binary\"", "IAA")));
    expect_refused("'a' ends", IMAGE(CUBE, POINTS("type=\"Int32\" format=\"binary\"", "*AAA")));
    expect_refused("has 32 bytes", IMAGE(CUBE, POINTS("type=\"Int64\" format=\"binary\"", "IAAAAAAAAAAA")));
    expect_refused("vtkLZ4DataCompressor",
                   FILE_OF("ImageData", " compressor=\"vtkLZ4DataCompressor\"",
                           "<ImageData><Piece Extent=\"" CUBE
                           "\">" POINTS("type=\"UInt8\" format=\"binary\"", "AAAA") "</Piece></ImageData>"));
    expect_refused("begin with '_'",
                   FILE_OF("ImageData", "",
                           "<ImageData><Piece Extent=\"" CUBE
                           "\">" POINTS("type=\"UInt8\" offset=\"0\"",
                                        "") "</Piece></ImageData><AppendedData encoding=\"raw\">AAAA</AppendedData>"));
    expect_refused("only", FILE_OF("ImageData", "",
                                   "<ImageData><Piece Extent=\"" CUBE "\">" POINTS(
                                       "type=\"UInt8\" offset=\"1000\"",
                                       "") "</Piece></ImageData><AppendedData encoding=\"raw\">_AAAA</AppendedData>"));
}

/* Headers of compressed data: blocks, bytes of one, bytes of the last, then packed bytes; 32 bits each. */
static void expect_blocks_refused(const char *words, const uint32_t *header, size_t count) {
    bytes raw = {0}, file = {0};
    for (size_t i = 0; i < count; i++) bytes_put(&raw, header[i], 4, 0);
    bytes_add(&raw, "some bytes that are nothing that was packed", 43);
    bytes_text(&file, "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\">"
                      "<ImageData><Piece Extent=\"0 99 0 99 0 99\">" POINTS("type=\"UInt8\" format=\"binary\"", ""));
    file.size -= strlen("</DataArray></PointData>");
    add_base64(&file, &raw, 0);
    bytes_text(&file, "</DataArray></PointData></Piece></ImageData></VTKFile>");
    bytes_add(&file, "", 1);
    expect_refused(words, (char *)file.data);
    bytes_free(&raw);
    bytes_free(&file);
}

static void test_blocks(void) {
    expect_blocks_refused("ends", (uint32_t[]){0xffffffff, 1000000, 0, 10}, 4);
    expect_blocks_refused("ends", (uint32_t[]){1, 1000000, 0, 0xffffffff}, 4);
    expect_blocks_refused("ends", (uint32_t[]){2, 500000, 0, 40, 40}, 5);
    expect_blocks_refused("has 0 bytes", (uint32_t[]){0, 1000000, 0}, 3);
    expect_blocks_refused("has 0 bytes", (uint32_t[]){1, 0, 0, 10}, 4);
    expect_blocks_refused("has 999999 bytes", (uint32_t[]){1, 1000000, 999999, 10}, 4);
    expect_blocks_refused("make no sense", (uint32_t[]){1, 1000000, 1000001, 10}, 4);
    expect_blocks_refused("cannot hold more", (uint32_t[]){1, 1000000, 0, 40}, 4);
    expect_blocks_refused("cannot hold more", (uint32_t[]){1, 0xffffffff, 0, 40}, 4);
}

static void test_cells(void) {
    dataset d;
    EXPECT(read_path(file_text("cells.vtk", CELLS("4", "1", "0 1 2 3", "4", "10")), &d) == 0, "%s", failure_text());
    dataset_release(&d);
    expect_refused("point 4", CELLS("4", "1", "0 1 2 4", "4", "10"));
    expect_refused("point -1", CELLS("4", "1", "0 1 2 -1", "4", "10"));
    expect_refused("ascend", CELLS("4", "2", "0 1 2 3", "4 3", "10 10"));
    expect_refused("ascend", CELLS("4", "1", "0 1 2 3", "-4", "10"));
    expect_refused("'connectivity' has at most", CELLS("4", "1", "0 1 2 3", "5", "10"));
    expect_refused("'connectivity'", CELLS("4", "1", "0 1 2 3", "9223372036854775807", "10"));
    expect_refused("type 300", CELLS("4", "1", "0 1 2 3", "4", "300"));
    expect_refused("'types' has at most", CELLS("4", "1", "0 1 2 3", "4", ""));
    expect_refused("has at most", CELLS("4", "99999999999", "0 1 2 3", "4", "10"));
    expect_refused("of Points", CELLS("5", "1", "0 1 2 3", "4", "10"));
    expect_refused("of Points", CELLS("99999999999999999", "1", "0 1 2 3", "4", "10"));
    expect_refused("NumberOfPoints", CELLS("-1", "1", "0 1 2 3", "4", "10"));
    expect_refused("NumberOfCells", CELLS("4", "9223372036854775807", "0 1 2 3", "4", "10"));
    expect_refused("Points", FILE_OF("UnstructuredGrid", "",
                                     "<UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"0\"/>"
                                     "</UnstructuredGrid>"));
    expect_refused("floating", FILE_OF("UnstructuredGrid", "",
                                       "<UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\"><Points>"
                                       "<DataArray type=\"UInt8\" NumberOfComponents=\"3\">1 2 3</DataArray></Points>"
                                       "<Cells><DataArray type=\"UInt8\" Name=\"types\">1</DataArray><DataArray "
                                       "type=\"Float32\" Name=\"offsets\">1</DataArray><DataArray type=\"UInt8\" "
                                       "Name=\"connectivity\">0</DataArray></Cells></Piece></UnstructuredGrid>"));
    expect_refused("no array 'types'",
                   FILE_OF("UnstructuredGrid", "",
                           "<UnstructuredGrid><Piece NumberOfPoints=\"1\" NumberOfCells=\"1\"><Points><DataArray "
                           "type=\"UInt8\" NumberOfComponents=\"3\">1 2 3</DataArray></Points></Piece>"
                           "</UnstructuredGrid>"));
    expect_refused("Coordinates", FILE_OF("RectilinearGrid", "",
                                          "<RectilinearGrid><Piece Extent=\"" CUBE "\"><Coordinates><DataArray "
                                          "type=\"UInt8\">1 2</DataArray></Coordinates></Piece></RectilinearGrid>"));
}

/* Many arrays that share one, each of which would be unpacked. */
static void test_sharing(void) {
    bytes file = {0};
    bytes_text(&file,
               "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"><ImageData><Piece Extent=\"0 99 0 99 0 99\">"
               "<PointData>");
    for (int i = 0; i < 1000; i++) bytes_text(&file, "<DataArray type=\"Int8\" Name=\"%d\" offset=\"0\"/>", i);
    bytes_text(&file, "</PointData></Piece></ImageData><AppendedData encoding=\"base64\">_");
    bytes data = {0};
    unsigned char *values = calloc(1000000, 1);
    bytes_put(&data, 1000000, 4, 0);
    bytes_add(&data, values, 1000000);
    free(values);
    add_base64(&file, &data, 0);
    dataset d;
    EXPECT(read_bytes("shared.vtk", &file, &d) == STATUS_INPUT && strstr(failure_text(), "share"), "%s",
           failure_text());
    dataset_release(&d);
    bytes_free(&data);
    bytes_free(&file);
}

/* ----------------------------------------------------------------------------------------------------------- notices
 */

static void test_notices(void) {
    dataset d;
    const char *wide =
        IMAGE(CUBE, POINTS("type=\"Int64\"", "1 2 3 4 5 6 7 9007199254740993") "<CellData><DataArray type=\"UInt8\" "
                                                                               "Name=\"c\">7</DataArray></CellData>");
    EXPECT(read_path(file_text("wide.vtk", wide), &d) == 0 && strstr(d.notice, "'a' is left out"), "%s, notice '%s'",
           failure_text(), d.notice);
    EXPECT(d.block_count == 1 && d.blocks[0].field_count == 1 && d.blocks[0].fields[0].on_cells, "fields");
    dataset_release(&d);

    const char *more = IMAGE(CUBE, POINTS("type=\"Int16\"", "1 2 3 4 5 6 7 8 9"));
    EXPECT(read_path(file_text("more.vtk", more), &d) == 0 && strstr(d.notice, "more values"), "%s, notice '%s'",
           failure_text(), d.notice);
    dataset_release(&d);

    const char *levels = IMAGE("0 2 0 1 0 1", "<CellData><DataArray type=\"UInt8\" Name=\"vtkGhostLevels\">0 "
                                              "1</DataArray></CellData>");
    EXPECT(read_path(file_text("levels.vtk", levels), &d) == 0 && d.blocks[0].blanked_cells &&
               !d.blocks[0].blanked_cells[0] && d.blocks[0].blanked_cells[1] && !d.blocks[0].field_count,
           "%s", failure_text());
    dataset_release(&d);

    const char *empty = FILE_OF(
        "ImageData", "", "<ImageData><Piece Extent=\"0 -1 0 -1 0 -1\"/><Piece Extent=\"3 4 0 1 0 1\"/></ImageData>");
    EXPECT(read_path(file_text("empty.vtk", empty), &d) == 0 && d.block_count == 1 && d.blocks[0].first[0] == 3, "%s",
           failure_text());
    dataset_release(&d);
}

/* Text that strtod reads, and the short decimals that it does not see. */
static void test_numbers(void) {
    static const char *const words[] = {"0.1",
                                        "-1e-3",
                                        "123456789012345678",
                                        "1e22",
                                        "1.7976931348623157e308",
                                        "4.9e-324",
                                        "+7.",
                                        ".5e1",
                                        "1e23",
                                        "0.30000000000000004",
                                        "-0",
                                        "inf",
                                        "-1E+05",
                                        "1e400",
                                        "9007199254740993",
                                        "5e-22"};
    enum { COUNT = sizeof words / sizeof *words };
    bytes file = {0};
    bytes_text(&file, "<VTKFile type=\"ImageData\"><ImageData><Piece Extent=\"0 3 0 1 0 1\"><PointData><DataArray "
                      "type=\"Float64\">");
    for (int i = 0; i < COUNT; i++) bytes_text(&file, "%s\t\r\n", words[i]);
    bytes_text(&file, "</DataArray></PointData></Piece></ImageData></VTKFile>");
    dataset d;
    EXPECT(COUNT == 16 && read_bytes("numbers.vtk", &file, &d) == 0 && d.blocks[0].field_count == 1, "%s",
           failure_text());
    for (int i = 0; i < COUNT && d.block_count; i++) {
        double is = field_value(&d.blocks[0].fields[0], (uint64_t)i), should = strtod(words[i], NULL);
        EXPECT(memcmp(&is, &should, 8) == 0, "%s is %.17g", words[i], is);
    }
    dataset_release(&d);
    bytes_free(&file);
}

/* ------------------------------------------------------------------------------------------------- published files */

static const dataset_field *find_field(const dataset_block *b, const char *name) {
    for (int n = 0; n < b->field_count; n++)
        if (strcmp(b->fields[n].name, name) == 0) return &b->fields[n];
    return NULL;
}

typedef struct published {
    const char *path;
    enum grid_kind kind;
    int64_t points, cells, dims[3], first[3];
    const char *field;
    int on_cells;
    tc_type type;
    double low, high, tolerance;
} published;

static void test_published_file(const char *data, const published *p) {
    char path[4096];
    dataset d;
    snprintf(path, sizeof path, "%s/%s", data, p->path);
    int status = read_path(path, &d);
    EXPECT(status == 0 && d.block_count == 1, "%s: status %d: %s", p->path, status, failure_text());
    if (!status && d.block_count == 1) {
        const dataset_block *b = &d.blocks[0];
        const dataset_field *f = find_field(b, p->field);
        EXPECT(b->kind == p->kind && b->point_count == p->points && b->cell_count == p->cells &&
                   !memcmp(b->dims, p->dims, sizeof b->dims) && !memcmp(b->first, p->first, sizeof b->first),
               "%s: kind %d, %" PRId64 " points, %" PRId64 " cells", p->path, b->kind, b->point_count, b->cell_count);
        EXPECT(f && f->type == p->type && f->on_cells == p->on_cells, "%s: field %s", p->path, p->field);
        double low = INFINITY, high = -INFINITY;
        for (int64_t i = 0; f && i < (p->on_cells ? b->cell_count : b->point_count); i++) {
            double value = field_value(f, (uint64_t)i);
            low = fmin(low, value);
            high = fmax(high, value);
        }
        EXPECT(fabs(low - p->low) <= p->tolerance && fabs(high - p->high) <= p->tolerance, "%s: %s is %.9g to %.9g",
               p->path, p->field, low, high);
    }
    dataset_release(&d);
}

static void test_published(const char *data) {
    static const published files[] = {
        {"uniform/hydrogen.vti",
         GRID_UNIFORM,
         262144,
         250047,
         {64, 64, 64},
         {0},
         "probability_density",
         0,
         TC_F32,
         0,
         1,
         0},
        {"uniform/vase.vti", GRID_UNIFORM, 871125, 843600, {115, 101, 75}, {0}, "SLCImage", 0, TC_U8, 0, 239, 0},
        {"uniform/heart.vti", GRID_UNIFORM, 12288, 10571, {32, 32, 12}, {0}, "scalars", 0, TC_F32, 0, 255, 0},
        {"uniform/cth.vtr",
         GRID_RECTILINEAR,
         545025,
         524288,
         {129, 65, 65},
         {0},
         "Volume Fraction for Armor Plate",
         1,
         TC_F32,
         0,
         1,
         0.001},
        {"curvilinear/multicomb_0.vts",
         GRID_CURVILINEAR,
         648,
         440,
         {6, 12, 9},
         {0},
         "Density",
         0,
         TC_F32,
         0.2,
         0.71,
         0.2},
        {"curvilinear/multicomb_1.vts",
         GRID_CURVILINEAR,
         864,
         616,
         {8, 12, 9},
         {4, 0, 0},
         "Density",
         0,
         TC_F32,
         0.2,
         0.71,
         0.2},
        {"curvilinear/multicomb_2.vts",
         GRID_CURVILINEAR,
         972,
         704,
         {9, 12, 9},
         {10, 0, 0},
         "Density",
         0,
         TC_F32,
         0.2,
         0.71,
         0.2},
        {"unstructured/fire_ug.vtu", GRID_UNSTRUCTURED, 12323, 10462, {0}, {0}, "t", 0, TC_F32, 298, 692, 1},
        {"unstructured/fichera-mixed.vtu",
         GRID_UNSTRUCTURED,
         26,
         14,
         {0},
         {0},
         "f",
         0,
         TC_F64,
         -1.4411200080598672,
         1.4411200080598672,
         0},
        {"unstructured/fichera-mixed-16.vtu",
         GRID_UNSTRUCTURED,
         26,
         16,
         {0},
         {0},
         "f",
         0,
         TC_F64,
         -1.4411200080598672,
         1.4411200080598672,
         0},
        {"unstructured/Tetrahedron.vtu",
         GRID_UNSTRUCTURED,
         35,
         96,
         {0},
         {0},
         "DistanceToCenter",
         0,
         TC_F32,
         0,
         1.7320508,
         1e-6},
        {"unstructured/Wedge.vtu", GRID_UNSTRUCTURED, 27, 16, {0}, {0}, "Polynomial", 0, TC_F32, 1, 7, 0},
        {"unstructured/Hexahedron.vtu", GRID_UNSTRUCTURED, 26, 7, {0}, {0}, "material", 1, TC_I32, 1, 1, 0},
        {"unstructured/QuadraticPyramid.vtu", GRID_UNSTRUCTURED, 153, 48, {0}, {0}, "Polynomial", 0, TC_F32, 1, 7, 0}};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) test_published_file(data, &files[i]);
}

/* Big-endian floats of a Plot3D file behind its first `skip` bytes. */
static float *read_floats(const char *data, const char *name, size_t skip, size_t count) {
    char path[4096];
    mapping m;
    snprintf(path, sizeof path, "%s/curvilinear/%s", data, name);
    if (mapping_open(path, &m)) return NULL;
    float *values = m.size >= skip + 4 * count ? malloc(4 * count) : NULL;
    for (size_t i = 0; i < count && values; i++) {
        uint32_t bits;
        memcpy(&bits, m.bytes + skip + 4 * i, 4);
        bits = __builtin_bswap32(bits);
        memcpy(values + i, &bits, 4);
    }
    mapping_close(&m);
    return values;
}

/* The three pieces were taken from the combustor: where a point of theirs is one of its points, densities are the same,
 * and most of them are. */
static void test_combustor(const char *data) {
    enum { POINTS = 57 * 33 * 25 };
    float *points = read_floats(data, "combxyz.bin", 12, 3 * (size_t)POINTS);
    float *density = read_floats(data, "combq.bin", 12 + 16, POINTS);
    EXPECT(points && density, "the combustor cannot be read");
    for (int piece = 0; piece < 3 && points && density; piece++) {
        char path[4096];
        dataset d;
        snprintf(path, sizeof path, "%s/curvilinear/multicomb_%d.vts", data, piece);
        if (read_path(path, &d)) continue;
        const dataset_block *b = &d.blocks[0];
        const dataset_field *f = find_field(b, "Density");
        int64_t found = 0, wrong = 0;
        for (int64_t i = 0; f && i < b->point_count; i++)
            for (size_t k = 0; k < POINTS; k++) {
                const float *p = b->points + 3 * i;
                if (p[0] != points[k] || p[1] != points[POINTS + k] || p[2] != points[2 * POINTS + k]) continue;
                found++;
                wrong += ((const float *)f->values)[i] != density[k];
                break;
            }
        EXPECT(found > b->point_count / 2 && wrong == 0,
               "piece %d: %" PRId64 " of %" PRId64 " points are found, %" PRId64 " densities differ", piece, found,
               b->point_count, wrong);
        dataset_release(&d);
    }
    free(points);
    free(density);
}

/* What another program tests its reader with: each is read, or refused for what this reader does not do. */
static void test_foreign(const char *data) {
    static const char *const read[] = {"ascii.vtu",
                                       "box.vtu",
                                       "box_para.vtu",
                                       "hexahedron.vtu",
                                       "hexahedron_ascii.vtu",
                                       "hexahedron_binary.vtu",
                                       "hexahedron_inline_binary.vtu",
                                       "hexahedron_zlib.vtu",
                                       "hexahedron_zlib_binary.vtu",
                                       "hexahedron_zlib_inline_binary.vtu",
                                       "hexahedron_zlib_para.vtu",
                                       "hexahedron_parallel_0.vtu",
                                       "no-compression.vtu",
                                       "tet.vtu",
                                       "zlib.vtu",
                                       "volume_complex.vti",
                                       "RectilinearGrid_ascii.vtr",
                                       "RectilinearGridAppendedBase64.vtr",
                                       "RectilinearGridCompressed.vtr",
                                       "RectilinearGridInlineBinary.vtr",
                                       "RectilinearGridRawBinary.vtr"};
    static const char *const refused[][2] = {{"hexahedron_lz4.vtu", "LZ4"},
                                             {"hexahedron_lz4_inline_binary.vtu", "LZ4"},
                                             {"hexahedron_lzma_inline_binary.vtu", "LZMA"},
                                             {"lzma.vtu", "LZMA"},
                                             {"point.vtp", "PolyData"},
                                             {"hexahedron_parallel.pvtu", "list of other files"},
                                             {"cube.pvtp", "list of other files"},
                                             {"tet.vtk", "not XML"}};
    char path[4096];
    dataset d;
    for (size_t i = 0; i < sizeof read / sizeof *read; i++) {
        snprintf(path, sizeof path, "%s/malformed/vtkio/%s", data, read[i]);
        EXPECT(read_path(path, &d) == 0 && d.block_count == 1, "%s", failure_text());
        dataset_release(&d);
    }
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        snprintf(path, sizeof path, "%s/malformed/vtkio/%s", data, refused[i][0]);
        EXPECT(read_path(path, &d) == STATUS_INPUT && strstr(failure_text(), refused[i][1]), "%s", failure_text());
        dataset_release(&d);
    }
}

int main(int argc, char **argv) {
    const char *data = getenv("TETRACUBES_DATA");
    random_state = 1996;
    folder_make();
    test_shapes();
    test_damage(argc > 1 ? atoi(argv[1]) : 200);
    test_kinds_refused();
    test_xml();
    test_extents();
    test_arrays();
    test_blocks();
    test_cells();
    test_sharing();
    test_notices();
    test_numbers();
    folder_remove();
    if (data && *data) {
        test_published(data);
        test_combustor(data);
        test_foreign(data);
    } else {
        printf("skipped: published files (TETRACUBES_DATA is not set)\n");
    }
    return EXPECT_DONE();
}
