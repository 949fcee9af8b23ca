/*
 * test_vtk_xml.c - the reader of VTK XML: every kind of grid in every encoding, cut at every byte, bytes changed
 *
 * Usage: test_vtk_xml [ROUNDS], of changed bytes for each kind and encoding
 */
#include "exit_status.h"
#include "expect.h"
#include "failure.h"
#include "vtk_xml_files.h"
#include "random.h"

#include <fcntl.h>
#include <unistd.h>

/* ---------------------------------------------------------------------------------------------------- what is made */

enum { FIELD_COUNT = 10 };

/* Two pieces of a structured grid, the first with odd and negative indices; cells of an unstructured one. */
static const int64_t extents[2][6] = {{-1, 1, 3, 6, 7, 11}, {1, 2, 3, 6, 7, 8}};
static const int cell_points[] = {0, 1, 3, 2, 4, 5, 7, 6, 8, 9, 10, 11, 0, 2, 4, 6, 8, 10};
static const int cell_ends[] = {8, 12, 18};
static const int cell_types[] = {12, 10, 13};
static const char *const grid_names[] = {"ImageData", "RectilinearGrid", "StructuredGrid", "UnstructuredGrid"};

static void piece_sizes(enum block_kind kind, int piece, int64_t dims[3], uint64_t *points, uint64_t *cells) {
    const int64_t *e = extents[piece];
    for (int a = 0; a < 3; a++) dims[a] = kind == BLOCK_UNSTRUCTURED ? 0 : e[2 * a + 1] - e[2 * a] + 1;
    *points = kind == BLOCK_UNSTRUCTURED ? 12 : (uint64_t)(dims[0] * dims[1] * dims[2]);
    *cells = kind == BLOCK_UNSTRUCTURED ? 3 : (uint64_t)((dims[0] - 1) * (dims[1] - 1) * (dims[2] - 1));
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

static void add_piece(vtk_writer *w, enum block_kind kind, int piece) {
    const int64_t *e = extents[piece];
    int64_t dims[3];
    uint64_t points, cells;
    piece_sizes(kind, piece, dims, &points, &cells);
    if (kind == BLOCK_UNSTRUCTURED)
        bytes_text(&w->text, "<Piece NumberOfPoints=\"%" PRIu64 "\" NumberOfCells=\"%" PRIu64 "\">\n", points, cells);
    else
        bytes_text(&w->text,
                   "<Piece Extent=\"%" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 " %" PRId64 "\">\n", e[0],
                   e[1], e[2], e[3], e[4], e[5]);
    add_fields(w, points, cells);
    if (kind == BLOCK_RECTILINEAR) {
        bytes_text(&w->text, "<Coordinates>\n");
        add_coordinates(w, TC_F32, "x", 1, (uint64_t)dims[0]);
        add_coordinates(w, TC_F64, "y", 1, (uint64_t)dims[1]);
        add_coordinates(w, TC_I16, "z", 1, (uint64_t)dims[2]);
        bytes_text(&w->text, "</Coordinates>\n");
    }
    if (kind == BLOCK_CURVILINEAR || kind == BLOCK_UNSTRUCTURED) {
        bytes_text(&w->text, "<Points>\n");
        add_coordinates(w, kind == BLOCK_CURVILINEAR ? TC_F32 : TC_F64, "Points", 3, 3 * points);
        bytes_text(&w->text, "</Points>\n");
    }
    if (kind == BLOCK_UNSTRUCTURED) {
        bytes_text(&w->text, "<Cells>\n");
        add_integers(w, piece ? TC_I32 : STORED_I64, "connectivity", cell_points, 18);
        add_integers(w, piece ? STORED_U64 : STORED_I64, "offsets", cell_ends, 3);
        add_integers(w, piece ? TC_I16 : TC_U8, "types", cell_types, 3);
        bytes_text(&w->text, "</Cells>\n");
    }
    bytes_text(&w->text, "</Piece>\n");
}

static bytes make_file(enum block_kind kind, const vtk_shape *shape, int pieces) {
    vtk_writer w;
    vtk_xml_begin(&w, shape, grid_names[kind]);
    bytes_text(&w.text,
               "<%s%s>\n<FieldData><DataArray type=\"Float64\" Name=\"time\" NumberOfTuples=\"1\" "
               "format=\"ascii\">0.5</DataArray></FieldData>\n",
               grid_names[kind],
               kind == BLOCK_UNIFORM ? " WholeExtent=\"-1 2 3 6 7 11\" Origin=\"1 -2 3.5\" Spacing=\"0.5 2 4\" "
                                       "Direction=\"0 -1 0 1 0 0 0 0 1\""
                                     : "");
    for (int i = 0; i < pieces; i++) add_piece(&w, kind, i);
    bytes_text(&w.text, "</%s>\n", grid_names[kind]);
    return vtk_xml_finish(&w);
}

/* ------------------------------------------------------------------------------------------------------- comparison */

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
        EXPECT(!b->blanked_points[i] == (i != 5), "%s: point %" PRIu64 " blanked %d", what, i, b->blanked_points[i]);
    for (uint64_t i = 0; i < cells && b->blanked_cells; i++)
        EXPECT(!b->blanked_cells[i] == (i != 0 && i != 2), "%s: cell %" PRIu64 " blanked %d", what, i,
               b->blanked_cells[i]);
}

static uint64_t wrong_coordinates(coordinates is, char name, uint64_t count) {
    uint64_t wrong = 0;
    for (uint64_t i = 0; i < count; i++) wrong += coordinate_at(is, (int64_t)i) != coordinate(i + (uint64_t)name);
    return wrong;
}

static void expect_geometry(const char *what, const dataset_block *b, uint64_t points) {
    static const double matrix[12] = {0, -2, 0, 1, 0.5, 0, 0, -2, 0, 0, 4, 3.5};
    uint64_t wrong = 0;
    if (b->kind == BLOCK_UNIFORM)
        for (int i = 0; i < 12; i++)
            EXPECT(b->matrix[i / 4][i % 4] == matrix[i], "%s: matrix[%d] is %g", what, i, b->matrix[i / 4][i % 4]);
    if (b->kind == BLOCK_RECTILINEAR)
        for (int a = 0; a < 3; a++) wrong += wrong_coordinates(b->axes[a], "xyz"[a], (uint64_t)b -> dims[a]);
    if (b->kind == BLOCK_CURVILINEAR || b->kind == BLOCK_UNSTRUCTURED)
        wrong += wrong_coordinates(b->points, 'P', 3 * points);
    EXPECT(wrong == 0, "%s: %" PRIu64 " coordinates are wrong", what, wrong);
    if (b->kind != BLOCK_UNSTRUCTURED) return;
    for (int i = 0; i < 3; i++)
        EXPECT(b->cell_types[i] == cell_types[i] && b->cell_offsets[i + 1] == cell_ends[i], "%s: cell %d: %d, ends %d",
               what, i, b->cell_types[i], (int)b->cell_offsets[i + 1]);
    for (int i = 0; i < 18; i++) wrong += b->cell_points[i] != cell_points[i];
    EXPECT(b->cell_offsets[0] == 0 && wrong == 0, "%s: %" PRIu64 " points of cells are wrong", what, wrong);
}

static void expect_dataset(const char *what, const dataset *d, enum block_kind kind, int pieces) {
    static const char left_out[] = "the array 's' is left out: its type String cannot be read"; /* once */
    EXPECT(d->block_count == pieces && !strcmp(d->format, "VTK XML") && !strcmp(d->notice, left_out),
           "%s: %d blocks, '%s', notice '%s'", what, d->block_count, d->format, d->notice);
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
            EXPECT(b->first[a] == (kind == BLOCK_UNSTRUCTURED ? 0 : extents[n][2 * a]), "%s: first[%d] is %" PRId64,
                   what, a, b->first[a]);
        expect_geometry(what, b, points);
        expect_fields(what, b, points, cells);
    }
}

/* Values that are native, aligned and raw are used where they lie in the file, unless their type has to change. */
static void expect_in_place(const char *what, const dataset *d) {
    const unsigned char *begin = d->mapping, *end = begin + d->mapping_bytes;
    int inside = 0;
    for (int n = 0; n < d->blocks[0].field_count; n++) {
        const unsigned char *values = d->blocks[0].fields[n].values;
        inside += values >= begin && values < end;
    }
    EXPECT(d->mapping && inside == FIELD_COUNT - 2 + 1, "%s: %d fields in place", what, inside);
}

static void test_shape(enum block_kind kind, const vtk_shape *s, int pieces) {
    static const char *const names[] = {"text", "inline", "raw", "base64"};
    char what[128];
    snprintf(what, sizeof what, "%s, %s, UInt%d, big %d, packed by %d, breaks %d", grid_names[kind], names[s->encoding],
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
                test_shape((enum block_kind)kind, &s, 1 + (bits & 1));
                for (int by = BY_LZ4; by <= BY_LZMA && s.is_compressed && can_pack(by); by++) {
                    s.is_compressed = by;
                    test_shape((enum block_kind)kind, &s, 1 + (bits & 1));
                }
            }
}

/* ----------------------------------------------------------------------------------------------------------- damage */

/* Every shorter file: an error with a text, or, where only the end of the XML is gone, all values. */
static void test_truncation(enum block_kind kind, const vtk_shape *s) {
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
static void test_changes(enum block_kind kind, const vtk_shape *s, int rounds) {
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
                                       {AS_APPENDED_BASE64, 4, 0, 1, 50, 0},
                                       {AS_APPENDED_RAW, 4, 0, BY_LZ4, 64, 0},
                                       {AS_APPENDED_RAW, 8, 0, BY_LZMA, 64, 0},
                                       {AS_APPENDED_BASE64, 4, 1, BY_LZ4, 100, 0}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (shapes[i].is_compressed && !can_pack(shapes[i].is_compressed)) continue;
        test_truncation(BLOCK_UNSTRUCTURED, &shapes[i]);
        for (int kind = 0; kind < 4; kind++) test_changes((enum block_kind)kind, &shapes[i], rounds);
    }
}

/* So many blocks that threads share them; then one that is damaged. */
static void test_many_blocks(int by) {
    enum { SIDE = 100, VALUES = SIDE * SIDE * SIDE };
    vtk_shape shape = {AS_APPENDED_RAW, 8, 0, by, 10000, 0};
    vtk_writer w;
    bytes data = {malloc(VALUES), VALUES};
    for (size_t i = 0; i < VALUES; i++) data.data[i] = (unsigned char)(i * i / 1000 + i % 3);
    vtk_xml_begin(&w, &shape, "ImageData");
    bytes_text(&w.text, "<ImageData><Piece Extent=\"1 100 1 100 1 100\">"
                        "<PointData><DataArray type=\"UInt8\" offset=\"0\"/></PointData></Piece></ImageData>");
    add_binary(&shape, &data, 0, &w.appended);
    bytes file = vtk_xml_finish(&w);
    dataset d;
    EXPECT(read_bytes("blocks.vtk", &file, &d) == 0 && d.blocks[0].field_count == 1, "%s", failure_text());
    EXPECT(d.block_count && !memcmp(d.blocks[0].fields[0].values, data.data, VALUES),
           "values of many blocks are wrong");
    dataset_release(&d);
    memset(file.data + file.size / 2, 0x55, 100);
    EXPECT(read_bytes("blocks.vtk", &file, &d) == STATUS_INPUT && strstr(failure_text(), "damaged"), "%s",
           failure_text());
    dataset_release(&d);
    bytes_free(&data);
    bytes_free(&file);
}

/* Bits as VTK writes them: text, or eight to a byte, the first in the highest. */
static void test_bits(void) {
    for (int encoding = AS_TEXT; encoding <= AS_APPENDED_BASE64; encoding++)
        for (int components = 1; components <= 3; components += 2) {
            const vtk_shape shape = {.encoding = encoding, .header_bytes = 8, .block_bytes = 64};
            const int count = 27 * components;
            double values[81] = {0};
            vtk_writer w;
            vtk_xml_begin(&w, &shape, "ImageData");
            bytes_text(&w.text, "<ImageData><Piece Extent=\"0 2 0 2 0 2\"><PointData>\n");
            for (int n = 0; n < count; n++)
                values[encoding == AS_TEXT ? n : n / 8] += n * n % 7 < 3 ? encoding == AS_TEXT ? 1 : 128 >> n % 8 : 0;
            array_add(&w, TC_U8, "b", components, values, (uint64_t)(encoding == AS_TEXT ? count : (count + 7) / 8));
            bytes_text(&w.text, "</PointData></Piece></ImageData>\n");
            char *type = memmem(w.text.data, w.text.size, "UInt8", 5);
            memcpy(type, "Bit\" ", 5);
            type[5] = ' ';
            bytes file = vtk_xml_finish(&w);
            dataset d;
            int status = read_bytes("bits.vti", &file, &d);
            EXPECT(!status && d.blocks->field_count == 1, "bits, encoding %d: %s", encoding, failure_text());
            for (int n = 0; n < count && !status; n++)
                EXPECT(field_value(d.blocks->fields, (uint64_t)n) == (n * n % 7 < 3), "bit %d, encoding %d", n,
                       encoding);
            if (!status) dataset_release(&d);
            bytes_free(&file);
        }
}

int main(int argc, char **argv) {
    random_state = 1996;
    folder_make("vtk-xml");
    test_shapes();
    test_bits();
    for (int by = BY_ZLIB; by <= BY_LZMA; by++)
        if (can_pack(by)) test_many_blocks(by);
    test_damage(argc > 1 ? atoi(argv[1]) : 200);
    folder_remove();
    return EXPECT_DONE();
}
