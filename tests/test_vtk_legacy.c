/*
 * test_vtk_legacy.c - the reader of VTK legacy files: every kind of grid, type and layout, ASCII and binary, made here
 * byte by byte and compared value by value; odd sections; damage; published files
 *
 * Run under sanitizers it also shows that no byte behind a file is touched: files lie in memory of their exact size.
 */
#include "read_files.h"

#include "random.h"
#include "readers.h"

enum { POINTS = 12, CUBES = 2, FLIPS = 1000 };

static const int64_t grid_dims[3] = {3, 2, 2};

static const struct {
    const char *name;
    int stored;
} types[] = {{"unsigned_char", TC_U8},
             {"char", TC_I8},
             {"unsigned_short", TC_U16},
             {"short", TC_I16},
             {"unsigned_int", TC_U32},
             {"INT", TC_I32},
             {"float", TC_F32},
             {"double", TC_F64},
             {"vtktypeint64", STORED_I64},
             {"vtktypeuint64", STORED_U64},
             {"long", STORED_I64},
             {"unsigned_long", STORED_U64},
             {"vtkIdType", TC_I32}};

enum { TYPES = sizeof types / sizeof *types };

static double field_value(const dataset_field *f, int64_t i) { return value_at(f->type, f->values, (uint64_t)i); }

static int64_t value_count(const dataset_block *b, const dataset_field *f) {
    return (f->on_cells ? b->cell_count : b->point_count) * f->components;
}

/* Reads the bytes as the file `path`. */
static int read_bytes(const char *path, const unsigned char *data, size_t size, dataset *out) {
    unsigned char *exact = malloc(size + !size);
    memcpy(exact, data, size);
    read_request r = request_for(path);
    mapping m = {exact, size};
    *out = (dataset){0};
    fail(0, "(no text)");
    int status = vtk_legacy_read(&r, &m, out);
    if (status) dataset_release(out);
    free(exact);
    return status;
}

static int read_path(const char *path, dataset *out) {
    read_request r = request_for(path);
    mapping m;
    *out = (dataset){0};
    int status = mapping_open(path, &m);
    if (!status && (status = vtk_legacy_read(&r, &m, out))) dataset_release(out);
    mapping_close(&m);
    return status;
}

static const dataset_field *find_field(const dataset *d, const char *name, int on_cells) {
    const dataset_block *b = d->blocks;
    for (int i = 0; i < b->field_count; i++)
        if (b->fields[i].on_cells == on_cells && !strcmp(b->fields[i].name, name)) return &b->fields[i];
    return NULL;
}

static void expect_field(const char *what, const dataset *d, const char *name, int on_cells, int type, int components,
                         const double *values) {
    const dataset_field *f = find_field(d, name, on_cells);
    EXPECT(f, "%s: no field '%s'", what, name);
    if (!f) return;
    EXPECT((int)f->type == type && f->components == components, "%s: '%s' has type %d and %d components", what, name,
           (int)f->type, f->components);
    if ((int)f->type != type || f->components != components) return;
    for (int64_t i = 0; i < value_count(d->blocks, f); i++)
        EXPECT(field_value(f, i) == values[i], "%s: '%s'[%" PRId64 "] is %g, not %g", what, name, i, field_value(f, i),
               values[i]);
}

/* ---------------------------------------------------------------------------------------- files of every kind */

static void put_values(bytes *b, int binary, int stored, uint64_t first, uint64_t count) {
    for (uint64_t i = first; i < first + count; i++)
        if (binary)
            bytes_value(b, stored, test_value(stored, i), 1);
        else
            bytes_text(b, "%.17g%s", test_value(stored, i), i % 5 == 4 ? "\n" : " ");
    bytes_text(b, "\n");
}

static void put_integers(bytes *b, int binary, size_t size, const int64_t *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (binary)
            bytes_put(b, (uint64_t)values[i], size, 1);
        else
            bytes_text(b, "%" PRId64 " ", values[i]);
    bytes_text(b, "\n");
}

/* A tetrahedron, a wedge, a vertex, a pyramid. */
static const int64_t cell_offsets[] = {0, 4, 10, 11, 16}, cell_types[] = {10, 13, 1, 14};
static const int64_t cell_points[] = {0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 11, 6, 7, 8, 9, 10};

enum { CELLS = 4, LINKS = 16 };

static void put_cells(bytes *b, int binary, int with_offsets) {
    if (with_offsets) {
        bytes_text(b, "CELLS %d %d\nOFFSETS vtktypeint64\n", CELLS + 1, LINKS);
        put_integers(b, binary, 8, cell_offsets, CELLS + 1);
        bytes_text(b, "CONNECTIVITY unsigned_short\n");
        put_integers(b, binary, 2, cell_points, LINKS);
    } else {
        bytes_text(b, "CELLS %d %d\n", CELLS, LINKS + CELLS);
        for (int cell = 0; cell < CELLS; cell++) {
            int64_t count = cell_offsets[cell + 1] - cell_offsets[cell];
            put_integers(b, binary, 4, &count, 1);
            b->size--; /* the line feed */
            put_integers(b, binary, 4, cell_points + cell_offsets[cell], (size_t)count);
            if (binary) b->size--;
        }
    }
    bytes_text(b, "\nCELL_TYPES %d\n", CELLS);
    put_integers(b, binary, 4, cell_types, CELLS);
}

static void put_geometry(bytes *b, enum block_kind kind, int binary, int with_offsets) {
    static const char *const names[] = {"STRUCTURED_POINTS", "RECTILINEAR_GRID", "STRUCTURED_GRID",
                                        "UNSTRUCTURED_GRID"};
    bytes_text(b, "# vtk DataFile Version %s\ntitle\n%s\nDATASET %s\n", with_offsets ? "5.1" : "3.0",
               binary ? "BINARY" : "ASCII", names[kind]);
    if (kind != BLOCK_UNSTRUCTURED) bytes_text(b, "DIMENSIONS 3 2 2\n");
    if (kind == BLOCK_UNIFORM) bytes_text(b, "ORIGIN 10 20 -30\nSPACING 0.5 2 3\n");
    for (int a = 0; a < 3 && kind == BLOCK_RECTILINEAR; a++) {
        int stored = a == 0 ? TC_F32 : a == 1 ? TC_F64 : TC_I16;
        bytes_text(b, "%c_COORDINATES %" PRId64 " %s\n", 'X' + a, grid_dims[a],
                   a == 0   ? "float"
                   : a == 1 ? "double"
                            : "short");
        put_values(b, binary, stored, 0, (uint64_t)grid_dims[a]);
    }
    if (kind >= BLOCK_CURVILINEAR) {
        bytes_text(b, "POINTS %d %s\n", POINTS, with_offsets ? "double" : "float");
        put_values(b, binary, with_offsets ? TC_F64 : TC_F32, 0, 3 * POINTS);
    }
    if (kind == BLOCK_UNSTRUCTURED) put_cells(b, binary, with_offsets);
}

/* Arrays of every type in FIELD, of one and two components, with SCALARS and VECTORS before them. */
static void put_attributes(bytes *b, int binary, const char *section, int64_t count) {
    bytes_text(b, "%s %" PRId64 "\nSCALARS plain float\nLOOKUP_TABLE default\n", section, count);
    put_values(b, binary, TC_F32, 1, (uint64_t)count);
    bytes_text(b, "VECTORS vec double \n");
    put_values(b, binary, TC_F64, 2, 3 * (uint64_t)count);
    bytes_text(b, "FIELD FieldData %d\n", TYPES);
    for (int t = 0; t < TYPES; t++) {
        bytes_text(b, "of%%20type%%2%c%s %d %" PRId64 " %s\n", 'd', types[t].name, 1 + t % 2, count, types[t].name);
        put_values(b, binary, types[t].stored, (uint64_t)t, (uint64_t)(count * (1 + t % 2)));
    }
}

static bytes make_file(enum block_kind kind, int binary, int with_offsets) {
    bytes b = {0};
    put_geometry(&b, kind, binary, with_offsets);
    put_attributes(&b, binary, "CELL_DATA", kind == BLOCK_UNSTRUCTURED ? CELLS : CUBES);
    put_attributes(&b, binary, "POINT_DATA", POINTS);
    return b;
}

static void expect_attributes(const char *what, const dataset *d, int on_cells) {
    double values[3 * POINTS];
    for (uint64_t i = 0; i < 3 * POINTS; i++) values[i] = test_value(TC_F32, i + 1);
    expect_field(what, d, "plain", on_cells, TC_F32, 1, values);
    for (uint64_t i = 0; i < 3 * POINTS; i++) values[i] = test_value(TC_F64, i + 2);
    expect_field(what, d, "vec", on_cells, TC_F64, 3, values);
    for (int t = 0; t < TYPES; t++) {
        char name[64];
        snprintf(name, sizeof name, "of type-%s", types[t].name);
        for (uint64_t i = 0; i < 3 * POINTS; i++) values[i] = test_value(types[t].stored, i + (uint64_t)t);
        expect_field(what, d, name, on_cells, types[t].stored > TC_F64 ? TC_F64 : types[t].stored, 1 + t % 2, values);
    }
}

static void expect_cells(const char *what, const dataset_block *b) {
    EXPECT(b->point_count == POINTS && b->cell_count == CELLS, "%s: %" PRId64 " points, %" PRId64 " cells", what,
           b->point_count, b->cell_count);
    EXPECT(!memcmp(b->cell_offsets, cell_offsets, sizeof cell_offsets), "%s: offsets", what);
    EXPECT(!memcmp(b->cell_points, cell_points, sizeof cell_points), "%s: points of cells", what);
    for (int i = 0; i < CELLS; i++) EXPECT(b->cell_types[i] == cell_types[i], "%s: type of cell %d", what, i);
}

static void expect_geometry(const char *what, const dataset_block *b, enum block_kind kind, int with_offsets) {
    static const double matrix[12] = {0.5, 0, 0, 10, 0, 2, 0, 20, 0, 0, 3, -30};
    EXPECT(b->kind == kind && b->point_count == POINTS, "%s: kind %d, %" PRId64 " points", what, (int)b->kind,
           b->point_count);
    EXPECT(!b->blanked_points && !b->blanked_cells, "%s: blanked", what);
    if (kind != BLOCK_UNSTRUCTURED)
        EXPECT(!memcmp(b->dims, grid_dims, sizeof grid_dims) && b->cell_count == CUBES, "%s: dims", what);
    if (kind == BLOCK_UNIFORM) EXPECT(!memcmp(b->matrix, matrix, sizeof matrix), "%s: matrix", what);
    for (int a = 0; a < 3 && kind == BLOCK_RECTILINEAR; a++)
        for (int64_t i = 0; i < grid_dims[a]; i++)
            EXPECT(coordinate_at(b->axes[a], i) == test_value(a == 0   ? TC_F32
                                                              : a == 1 ? TC_F64
                                                                       : TC_I16,
                                                              (uint64_t)i),
                   "%s: axis %d", what, a);
    for (int64_t i = 0; i < 3 * POINTS && kind >= BLOCK_CURVILINEAR; i++)
        EXPECT(coordinate_at(b->points, i) == test_value(with_offsets ? TC_F64 : TC_F32, (uint64_t)i),
               "%s: coordinate %d", what, (int)i);
    if (kind == BLOCK_UNSTRUCTURED) expect_cells(what, b);
}

/* Whatever was read can be read to its end. */
static void touch(const dataset *d) {
    volatile double sum = 0;
    const dataset_block *b = d->blocks;
    for (int f = 0; f < b->field_count; f++)
        for (int64_t i = 0; i < value_count(b, &b->fields[f]); i++) sum = sum + field_value(&b->fields[f], i);
    for (int64_t i = 0; (b->points.f32 || b->points.f64) && i < 3 * b->point_count; i++)
        sum = sum + coordinate_at(b->points, i);
    for (int a = 0; a < 3; a++)
        for (int64_t i = 0; (b->axes[a].f32 || b->axes[a].f64) && i < b->dims[a]; i++)
            sum = sum + coordinate_at(b->axes[a], i);
    for (int64_t i = 0; b->blanked_points && i < b->point_count; i++) sum = sum + b->blanked_points[i];
    for (int64_t i = 0; b->blanked_cells && i < b->cell_count; i++) sum = sum + b->blanked_cells[i];
    for (int64_t c = 0; b->cell_offsets && c < b->cell_count; c++)
        for (int64_t i = b->cell_offsets[c]; i < b->cell_offsets[c + 1]; i++)
            EXPECT(b->cell_points[i] >= 0 && b->cell_points[i] < b->point_count, "cell %d has point %d", (int)c,
                   (int)b->cell_points[i]);
    for (int64_t i = 0; b->cell_faces && i < b->face_offsets[b->cell_faces[b->cell_count]]; i++)
        EXPECT(b->face_points[i] >= 0 && b->face_points[i] < b->point_count, "a face has point %d",
               (int)b->face_points[i]);
}

static void expect_survives(const char *what, const unsigned char *data, size_t size) {
    dataset d;
    int status = read_bytes("damaged.vtk", data, size, &d);
    if (status) {
        EXPECT(status == STATUS_INPUT && strstr(failure_text(), "damaged.vtk: "), "%s: status %d: %s", what, status,
               failure_text());
        return;
    }
    touch(&d);
    dataset_release(&d);
}

static void test_damage(const char *what, const bytes *b) {
    for (size_t size = 0; size < b->size; size++) expect_survives(what, b->data, size);
    unsigned char *copy = malloc(b->size);
    for (int i = 0; i < FLIPS; i++) {
        memcpy(copy, b->data, b->size);
        for (uint32_t flips = random_below(4) + 1; flips; flips--)
            copy[random_below((uint32_t)b->size)] = (unsigned char)"0197 \n-.e%"[random_below(10)];
        expect_survives(what, copy, b->size);
    }
    free(copy);
}

static void test_kinds(void) {
    for (int kind = BLOCK_UNIFORM; kind <= BLOCK_UNSTRUCTURED; kind++)
        for (int binary = 0; binary < 2; binary++)
            for (int with_offsets = 0; with_offsets < 2; with_offsets++) {
                char what[64];
                snprintf(what, sizeof what, "kind %d, binary %d, offsets %d", kind, binary, with_offsets);
                bytes b = make_file((enum block_kind)kind, binary, with_offsets);
                dataset d;
                int status = read_bytes(what, b.data, b.size, &d);
                EXPECT(!status, "%s: status %d: %s", what, status, failure_text());
                if (!status) {
                    EXPECT(!strcmp(d.format, "VTK legacy") && d.block_count == 1 && !*d.notice, "%s: %s", what,
                           d.notice);
                    expect_geometry(what, d.blocks, (enum block_kind)kind, with_offsets);
                    EXPECT(d.blocks->field_count == 2 * (TYPES + 2), "%s: %d fields", what, d.blocks->field_count);
                    expect_attributes(what, &d, 0);
                    expect_attributes(what, &d, 1);
                    dataset_release(&d);
                }
                if (with_offsets || kind >= BLOCK_CURVILINEAR) test_damage(what, &b); /* else the same bytes again */
                bytes_free(&b);
            }
}

/* ------------------------------------------------------------------------------------------------ odd sections */

#define HEAD    "# vtk DataFile Version 3.0\nt\nASCII\n"
#define BINARY  "# vtk DataFile Version 4.2\nt\nBINARY\n"
#define IMAGE   HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 1\n"
#define IMAGE_B BINARY "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 1\n"
#define LAST    "SCALARS last int\nLOOKUP_TABLE default\n"

/* Reads a file made of a literal, zero bytes included, in which a field `last` of 1 2 3 4 must be found. */
#define READ(d, text) read_odd(d, text, sizeof text - 1, __LINE__)

static int read_odd(dataset *d, const char *text, size_t size, int line) {
    static const double last[] = {1, 2, 3, 4};
    char what[32];
    snprintf(what, sizeof what, "line %d", line);
    bytes b = {0};
    bytes_add(&b, text, size);
    test_damage(what, &b);
    int status = read_bytes(what, b.data, b.size, d);
    bytes_free(&b);
    EXPECT(!status, "%s: status %d: %s", what, status, failure_text());
    if (!status) expect_field(what, d, "last", 0, TC_I32, 1, last);
    return status;
}

static void test_passed_over(void) {
    dataset d;
    if (!READ(&d, HEAD "\n \ndataset Structured_Points\nfield f 2\nTIME 1 1 double\n3.5\nnote 1 2 string\na b\n\n"
                       "Dimensions 2 2 1\nASPECT_RATIO 1 2 3\norigin 0 0 0\n\npoint_data 4\n"
                       "Scalars a unsigned_char 2\nlookup_table mine\n1 2 3 4 5 6 7 8\n"
                       "METADATA\nCOMPONENT_NAMES\n\nsecond\nINFORMATION 1\nNAME K LOCATION L\nDATA 2 0 1\n\n"
                       "LOOKUP_TABLE mine 2\n0 0 0 1 1 1 1 1\nNORMALS n float\n1 0 0 1 0 0 1 0 0 1 0 0\n"
                       "PEDIGREE_IDS p variant\n13 q%20r\n11 3.5\n13 \n6 7\n"
                       "FIELD g 3\ntexts 1 4 string\nSCALARS\n\n1 2\nlast\nNULL_ARRAY\nnone 0 4 int\n"
                       "EDGE_FLAGS e bit\n1 0 0 1\n" LAST "1 2\n3 4")) {
        static const double a[] = {1, 2, 3, 4, 5, 6, 7, 8}, e[] = {1, 0, 0, 1};
        expect_field("passed over", &d, "a", 0, TC_U8, 2, a);
        expect_field("passed over", &d, "e", 0, TC_U8, 1, e);
        EXPECT(d.blocks->field_count == 4 && d.blocks->matrix[2][2] == 3, "%d fields", d.blocks->field_count);
        dataset_release(&d);
    }
    if (!READ(&d, IMAGE_B "POINT_DATA 4\nSCALARS bits bit 3\nLOOKUP_TABLE t\n\xA5\x90\nLOOKUP_TABLE t 2\n\n\n\n\n1234\n"
                          "FIELD f 2\ns 1 4 string\n\xC3"
                          "a\nb\xC0\x80\x01 \x40\0\0\2\n\n\nv 1 4 variant\n13 x\n13 \n13 y\n5 6\n"
                          "COLOR_SCALARS c 2\nABCDEFGH\n" LAST "\0\0\0\1\0\0\0\2\0\0\0\3\0\0\0\4")) {
        static const double bits[] = {1, 0, 1, 0, 0, 1, 0, 1, 1, 0, 0, 1}, colors[] = {65, 66, 67, 68, 69, 70, 71, 72};
        expect_field("binary", &d, "bits", 0, TC_U8, 3, bits);
        expect_field("binary", &d, "c", 0, TC_U8, 2, colors);
        EXPECT(d.blocks->field_count == 3, "%d fields", d.blocks->field_count);
        dataset_release(&d);
    }
}

static void test_forms(void) {
    dataset d;
    if (!READ(&d, "# vtk DataFile Version 5.1\r\nt\r\nASCII\r\nDATASET STRUCTURED_POINTS\r\nEXTENT -1 0 5 6 7 7\r\n"
                  "SPACING 2 2 2\r\nORIGIN 1 1 1\r\nCELL_DATA 1\r\nSCALARS c float LOOKUP_TABLE default\r\nnan\r\n"
                  "TEXTURE_COORDINATES t 2 float\r\n1 -inf\r\nTENSORS six float\r\n1 2 3 4 5 6 7 8 9\r\n"
                  "TENSORS6 t6 char\r\n1 2 3 4 5 6\r\nGLOBAL_IDS g vtkIdType\r\n9\r\n"
                  "POINT_DATA 4\r\nSCALARS bare float\r\n5 6 7 8\r\nCOLOR_SCALARS rgb 1\r\n0 0.5 1 7\r\nSCALARS n "
                  "short\r\n1.0 2e1 -3 +4\r\n" LAST "1 2 3 4\r\n")) {
        static const double rgb[] = {0, 128, 255, 255}, bare[] = {5, 6, 7, 8}, n[] = {1, 20, -3, 4},
                            t6[] = {1, 2, 3, 4, 5, 6};
        const dataset_field *c = find_field(&d, "c", 1), *t = find_field(&d, "t", 1), *six = find_field(&d, "six", 1);
        const int64_t *first = d.blocks->first, *dims = d.blocks->dims;
        EXPECT(first[0] == -1 && first[1] == 5 && first[2] == 7 && dims[0] == 2 && dims[1] == 2 && dims[2] == 1,
               "extent");
        EXPECT(d.blocks->matrix[1][1] == 2 && d.blocks->matrix[1][3] == 1, "matrix of an extent");
        EXPECT(c && isnan(field_value(c, 0)) && t && isinf(field_value(t, 1)) && six && field_value(six, 8) == 9,
               "nan, inf");
        expect_field("forms", &d, "bare", 0, TC_F32, 1, bare);
        expect_field("forms", &d, "rgb", 0, TC_U8, 1, rgb);
        expect_field("forms", &d, "n", 0, TC_I16, 1, n);
        expect_field("forms", &d, "t6", 1, TC_I8, 6, t6);
        dataset_release(&d);
    }
    if (!READ(&d, IMAGE "POINT_DATA 4\nSCALARS big%ZZ%41%1b vtktypeuint64 1\nLOOKUP_TABLE default\n"
                        "18446744073709551615 9007199254740993 9007199254740992 1\n" LAST "1 2 3 4")) {
        static const double big[] = {0x1p64, 0x1p53, 0x1p53, 1};
        expect_field("64 bits", &d, "big%ZZA%1B", 0, TC_F64, 1, big);
        EXPECT(d.blocks->fields[0].is_rounded && !d.blocks->fields[1].is_rounded, "which fields are rounded");
        EXPECT(!d.notice_count, "notice of a field that nobody uses yet: %s", d.notice);
        dataset_release(&d);
    }
}

/* The given flags or, where that is NULL, none. */
static void expect_blanked(const char *what, const uint8_t *blanked, const char *flags) {
    EXPECT(!blanked == !flags, "%s: blanked is %s", what, blanked ? "there" : "missing");
    for (int i = 0; blanked && flags && flags[i]; i++)
        EXPECT(blanked[i] == flags[i] - '0', "%s: blanked[%d] is %d", what, i, blanked[i]);
}

#define CURVED(version, blanking)                                                                                      \
    "# vtk DataFile Version " version "\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 4 1 1\n" blanking               \
    "POINTS 4 float\n0 0 0 1 0 0 2 0 0 3 0 0\n"

static void test_blanking(void) {
    dataset d;
    if (!READ(&d,
              CURVED("2.0", "BLANKING 4 unsigned_char\n1 0 1 1\n") "POINT_DATA 4\n"
                                                                   "SCALARS vtkGhostType unsigned_char\nLOOKUP_TABLE "
                                                                   "default\n1 0 2 0\n" LAST "1 2 3 4\n"
                                                                   "CELL_DATA 3\nFIELD f 1\nvtkGhostLevels 1 3 "
                                                                   "unsigned_char\n0 2 0")) {
        expect_blanked("blanking", d.blocks->blanked_points, "0110");
        expect_blanked("levels", d.blocks->blanked_cells, "010");
        EXPECT(d.blocks->field_count == 1, "flags became fields");
        dataset_release(&d);
    }
    if (!READ(&d, CURVED("4.0", "") "POINT_DATA 4\nFIELD f 1\nvtkGhostType 1 4 unsigned_char\n1 0 32 0\n" LAST
                                    "1 2 3 4\nCELL_DATA 3\nFIELD f 2\nvtkGhostType 1 3 unsigned_char\n32 2 1\n"
                                    "vtkGhostLevels 1 3 unsigned_char\n1 1 1")) {
        expect_blanked("nothing hidden", d.blocks->blanked_points, NULL);
        expect_blanked("cells", d.blocks->blanked_cells, "101");
        EXPECT(d.blocks->field_count == 2, "%d fields", d.blocks->field_count);
        dataset_release(&d);
    }
}

/* What of a name would steer a terminal stays as the file has it, or becomes that. */
static void test_names(void) {
    static const char *const names[][2] = {{"a%20b%25", "a b%"},
                                           {"a%09%0a%1B%7f", "a%09%0A%1B%7F"},
                                           {"%00%4", "%00%4"},
                                           {"%C2%9B%C2%B5", "%C2%9B\xC2\xB5"},
                                           {"\xC2%9B%c2\x85.", "%C2%9B%C2%85."},
                                           {"\x1B[2J\xC2\x9B", "?[2J??"},
                                           {"%C3%A9\xE9", "\xC3\xA9\xE9"}};
    static const double values[] = {1, 2, 3, 4};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        dataset d;
        bytes file = {0};
        bytes_text(&file, IMAGE "POINT_DATA 4\nSCALARS %s int\nLOOKUP_TABLE default\n1 2 3 4\n", names[n][0]);
        int status = read_bytes("names.vtk", file.data, file.size, &d);
        EXPECT(!status, "%s: %s", names[n][0], failure_text());
        if (!status) expect_field(names[n][0], &d, names[n][1], 0, TC_I32, 1, values);
        if (!status) dataset_release(&d);
        bytes_free(&file);
    }
}

/* Types as programs write them; VTK takes them by how they begin. */
static void test_types(void) {
    static const struct {
        const char *name;
        int type;
    } names[] = {{"int1", TC_I32},          {"Int", TC_I32},
                 {"int32", TC_I32},         {"float32", TC_F32},
                 {"Float1", TC_F32},        {"UNSIGNED_CHAR", TC_U8},
                 {"float64", TC_F64},       {"double3", TC_F64},
                 {"vtkidtype", TC_I32},     {"int64", TC_F64},
                 {"uint8", TC_U8},          {"uint16", TC_U16},
                 {"long_long", TC_F64},     {"unsigned_int64", TC_F64},
                 {"short2", TC_I16},        {"unsigned_short", TC_U16},
                 {"signed_char", TC_I8},    {"char8", TC_I8},
                 {"uint32", TC_U32},        {"unsigned_int1", TC_U32},
                 {"vtktypeint64_t", TC_F64}};
    static const double values[] = {1, 2, 3, 4};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        dataset d;
        bytes file = {0};
        bytes_text(&file, IMAGE "POINT_DATA 4\nSCALARS s %s\nLOOKUP_TABLE default\n1 2 3 4\n", names[n].name);
        int status = read_bytes("types.vtk", file.data, file.size, &d);
        EXPECT(!status, "%s: %s", names[n].name, failure_text());
        if (!status) expect_field(names[n].name, &d, "s", 0, names[n].type, 1, values);
        if (!status) dataset_release(&d);
        bytes_free(&file);
    }
}

/* Columns of fixed width, as Fortran writes them. */
static void expect_numbers(const char *type, int read_as, const char *text, double a, double b, double c, double e) {
    const double values[] = {a, b, c, e};
    dataset d;
    bytes file = {0};
    bytes_text(&file, IMAGE "FIELD x 1\na 1 4 %s\n%s\nPOINT_DATA 4\nSCALARS s %s\nLOOKUP_TABLE t\n%s\n" LAST "1 2 3 4",
               type, text, type, text);
    int status = read_bytes("numbers.vtk", file.data, file.size, &d);
    EXPECT(!status, "%s: %s", text, failure_text());
    if (!status) expect_field(text, &d, "s", 0, read_as, 1, values);
    if (!status) expect_field(text, &d, "last", 0, TC_I32, 1, (const double[]){1, 2, 3, 4});
    if (!status) dataset_release(&d);
    bytes_free(&file);
}

static void expect_no_number(const char *type, const char *text) {
    dataset d;
    bytes file = {0};
    bytes_text(&file, IMAGE "POINT_DATA 4\nSCALARS s %s\nLOOKUP_TABLE t\n%s\n", type, text);
    int status = read_bytes("numbers.vtk", file.data, file.size, &d);
    EXPECT(status == STATUS_INPUT && strstr(failure_text(), "no number"), "%s: %s", text, failure_text());
    if (!status) dataset_release(&d);
    bytes_free(&file);
}

static void test_columns(void) {
    expect_numbers("float", TC_F32, "-1.00000E+00-2.00000E+00 3.00000E+00-4.00000E+00", -1, -2, 3, -4);
    expect_numbers("double", TC_F64, "-1.0D+00-2.0d+01-3.5Q-01+4.0D00", -1, -20, -0.35, 4);
    expect_numbers("double", TC_F64, "0.25-101-0.5+102-1.-100-2.0-200", 0.25e-101, -0.5e102, -1e-100, -2e-200);
    expect_numbers("double", TC_F64, "1.00E+002.00E+00.50E+01-.25E+00", 1, 2, 5, -0.25);
    expect_numbers("double", TC_F64, "1.00E+1002.00E-1003.E+004.E+00", 1e100, 2e-100, 3, 4);
    expect_numbers("double", TC_F64, "1.5-3.25-100.5-2", 1.5, -3.25, -100.5, -2);
    expect_numbers("int", TC_I32, "-1-2 3-4", -1, -2, 3, -4);
    expect_numbers("char", TC_I8, "1-128+3-4", 1, -128, 3, -4);
    expect_numbers("double", TC_F64, "1e0 0x1p1 3 4", 1, 2, 3, 4);
    expect_no_number("double", "1.0002.000 3 4 5");
    expect_no_number("double", "1.0E+5.0 3 4 5");
    expect_no_number("double", "1.0E+000005.0 3 4 5");
    expect_no_number("double", "1.0E-2.0 3 4");
    expect_no_number("double", "1.0E 2 3 4");
    expect_no_number("double", "1-- 2 3 4");
    expect_no_number("double", "1.0x-2 2 3 4");
    expect_no_number("double", "-. 2 3 4");
    expect_no_number("int", "1-2.5-3 4");
    expect_no_number("char", "1-129 3 4");
    bytes file = {0}; /* a line of a thousand numbers without a blank */
    dataset d;
    bytes_text(&file, HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 10 10 10\nPOINT_DATA 1000\nSCALARS s float\n");
    for (int n = 0; n < 1000; n++) bytes_text(&file, "-%d.0E+00", n);
    int status = read_bytes("line.vtk", file.data, file.size, &d);
    EXPECT(!status, "%s", failure_text());
    for (int n = 0; n < 1000 && !status; n++) EXPECT(field_value(d.blocks->fields, n) == -n, "number %d of a line", n);
    if (!status) dataset_release(&d);
    bytes_free(&file);
}

#define UNSTRUCTURED(points) "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " points

#define FOUR_POINTS UNSTRUCTURED("5 float\n0 0 0 1 0 0 0 1 0 0 0 1 9 9 9\n")

/* A tetrahedron, the same as a polyhedron of 4 faces, and a line; in both layouts. */
static void expect_polyhedron(const char *what, const char *cells) {
    static const int64_t offsets[] = {0, 4, 8, 10}, points[] = {0, 1, 2, 3, 0, 1, 2, 3, 3, 4};
    static const int64_t starts[] = {0, 0, 4, 4}, face_offsets[] = {0, 3, 6, 9, 12};
    static const int64_t face_points[] = {0, 1, 2, 0, 1, 3, 3, 1, 2, 0, 2, 3};
    dataset d;
    bytes file = {0};
    bytes_text(&file, FOUR_POINTS "%sCELL_TYPES 3\n10 42 3\n", cells);
    int status = read_bytes(what, file.data, file.size, &d);
    EXPECT(!status, "%s: %s", what, failure_text());
    bytes_free(&file);
    if (status) return;
    const dataset_block *b = d.blocks;
    EXPECT(!memcmp(b->cell_offsets, offsets, sizeof offsets) && !memcmp(b->cell_points, points, sizeof points),
           "%s: points of cells", what);
    EXPECT(b->cell_faces && !memcmp(b->cell_faces, starts, sizeof starts) &&
               !memcmp(b->face_offsets, face_offsets, sizeof face_offsets) &&
               !memcmp(b->face_points, face_points, sizeof face_points),
           "%s: faces", what);
    EXPECT(!*d.notice, "%s: notice '%s'", what, d.notice);
    dataset_release(&d);
}

static void expect_no_polyhedron(const char *stream, int length) {
    dataset d;
    bytes file = {0};
    bytes_text(&file, FOUR_POINTS "CELLS 1 %d\n%d %s\nCELL_TYPES 1\n42\n", length + 1, length, stream);
    int status = read_bytes("x.vtk", file.data, file.size, &d);
    EXPECT(status == STATUS_INPUT && strstr(failure_text(), "x.vtk: ") && strstr(failure_text(), "damaged"),
           "%s: status %d: %s", stream, status, failure_text());
    if (!status) dataset_release(&d);
    bytes_free(&file);
}

#define STREAM "4 3 0 1 2 3 0 1 3 3 3 1 2 3 0 2 3"

static void test_polyhedra(void) {
    dataset d;
    expect_polyhedron("counted", "CELLS 3 26\n4 0 1 2 3\n17 " STREAM "\n2 3 4\n");
    expect_polyhedron("with offsets", "CELLS 4 23\nOFFSETS vtktypeint64\n0 4 21 23\nCONNECTIVITY vtktypeint64\n"
                                      "0 1 2 3 " STREAM " 3 4\n");
    expect_no_polyhedron("5 3 0 1 2 3 0 1 3 3 3 1 2 3 0 2 3", 17);
    expect_no_polyhedron("3 3 0 1 2 3 0 1 3 3 3 1 2 3 0 2 3", 17);
    expect_no_polyhedron("4 3 0 1 2 3 0 1 3 3 3 1 2 4 0 2 3", 17);
    expect_no_polyhedron("4 3 0 1 2 3 0 1 3 3 3 1 2 3 0 2 5", 17);
    expect_no_polyhedron("4 3 0 1 2 3 0 1 3 3 3 1 2 3 0 2 -1", 17);
    expect_no_polyhedron("-1 3 0 1 2", 5);
    expect_no_polyhedron("1 -1 0 1 2", 5);
    expect_no_polyhedron("2 -2 0", 3);
    expect_no_polyhedron("2147483647 3 0 1 2", 5);
    expect_no_polyhedron("1 2147483647 0 1 2", 5);
    if (!READ(&d, UNSTRUCTURED("4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n") "POINT_DATA 4\n" LAST "1 2 3 4")) {
        EXPECT(d.blocks->cell_count == 0 && d.blocks->cell_offsets[0] == 0, "no cells");
        dataset_release(&d);
    }
}

/* Bytes of a large array stay in the file. */
static void test_in_place(void) {
    enum { SIDE = 48, COUNT = SIDE * SIDE * SIDE };
    bytes b = {0};
    bytes_text(&b, BINARY "DATASET STRUCTURED_POINTS\nDIMENSIONS %d %d %d\nPOINT_DATA %d\n", SIDE, SIDE, SIDE, COUNT);
    for (int n = 0; n < 2; n++) {
        bytes_text(&b, "SCALARS s%d unsigned_char\nLOOKUP_TABLE default\n", n);
        for (int i = 0; i < COUNT; i++) bytes_put(&b, (uint64_t)(i % 251 + n), 1, 1);
        bytes_text(&b, "\n");
    }
    dataset d;
    int status = read_path(file_write("large.vtk", b.data, b.size), &d);
    EXPECT(!status, "in place: %s", failure_text());
    for (int n = 0; n < 2 && !status; n++) {
        const dataset_field *f = &d.blocks->fields[n];
        int64_t wrong = 0;
        for (int64_t i = 0; i < COUNT; i++) wrong += field_value(f, i) != (double)(i % 251 + n);
        EXPECT(!wrong, "in place: %" PRId64 " values of %s", wrong, f->name);
        EXPECT((const unsigned char *)f->values > (unsigned char *)d.mapping &&
                   (const unsigned char *)f->values < (unsigned char *)d.mapping + d.mapping_bytes,
               "%s was copied", f->name);
    }
    if (!status) dataset_release(&d);
    bytes_free(&b);
}

/* ------------------------------------------------------------------------------------------------------ damage */

static const struct {
    const char *text, *part;
} damaged[] = {
    {"", "does not begin"},
    {"# vtk DataFile Version", "version"},
    {"# vtk DataFile Version x\n", "version"},
    {"# vtk DataFile Version 3.0\nt\nTEXT\n", "'TEXT' where ASCII"},
    {HEAD, "cut"},
    {HEAD "FIELD f 0\n", "no grid"},
    {HEAD "DATASET POLYDATA\n", "a surface, POLYDATA"},
    {HEAD "DATASET TABLE\n", "holds TABLE"},
    {HEAD "DATASET STRUCTURED_POINTS\n", "no DIMENSIONS"},
    {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 0 2\n", "'0' for DIMENSIONS"},
    {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 -2 2\n", "'-2' for DIMENSIONS"},
    {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2\n", "cut"},
    {HEAD "DATASET STRUCTURED_POINTS\nEXTENT 0 1 2 1 0 0\n", "'1' for EXTENT"},
    {HEAD "DATASET STRUCTURED_POINTS\nDIMENSIONS 2147483647 2147483647 2147483647\n", "2^63"},
    {IMAGE "DIMENSIONS 2 2 2\n", "twice"},
    {IMAGE "SPACING 1 1 0\n", "spacing"},
    {IMAGE "SPACING 1 x 1\n", "'x' for SPACING"},
    {IMAGE "POINTS 4 float\n", "'POINTS' where a keyword"},
    {IMAGE "SCALARS s float\n", "before POINT_DATA"},
    {IMAGE "POINT_DATA 5\n", "POINT_DATA of 5, but 4 points"},
    {IMAGE "POINT_DATA 99999999999999999999\n", "integer"},
    {IMAGE "CELL_DATA 2\n", "CELL_DATA of 2, but 1 cells"},
    {IMAGE "POINT_DATA 4\nDIMENSIONS 2 2 2\n", "behind the first POINT_DATA"},
    {IMAGE "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3", "too few"},
    {IMAGE "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3          ",
     "ends within the values of array 's'"},
    {IMAGE "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 x 4", "'x' among the values of array 's'"},
    {IMAGE "POINT_DATA 4\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3 4 5", "'5' where a keyword"},
    {IMAGE "POINT_DATA 4\nSCALARS s char\nLOOKUP_TABLE default\n1 2 3 128", "'128'"},
    {IMAGE "POINT_DATA 4\nSCALARS s unsigned_char\nLOOKUP_TABLE default\n1 2 3 -1", "'-1'"},
    {IMAGE "POINT_DATA 4\nSCALARS s int\nLOOKUP_TABLE default\n1 2 3 1.5", "'1.5'"},
    {IMAGE "POINT_DATA 4\nSCALARS s quad\nLOOKUP_TABLE default\n1 2 3 1.5", "'quad'"},
    {IMAGE "POINT_DATA 4\nSCALARS s float 2147483647\nLOOKUP_TABLE default\n1 2 3 1.5", "too few"},
    {IMAGE "POINT_DATA 4\nSCALARS s float 0\nLOOKUP_TABLE default\n1 2 3 1.5", "components"},
    {IMAGE "POINT_DATA 4\nTEXTURE_COORDINATES t 4 float\n", "'4' for the dimension"},
    {IMAGE "POINT_DATA 4\nFIELD f 1\na 1 5 float\n1 2 3 4 5\n", "5 tuples in array 'a' for 4 points"},
    {IMAGE "POINT_DATA 4\nFIELD f -1\n", "'-1'"},
    {IMAGE "POINT_DATA 4\nFIELD f 9\n", "cut"},
    {IMAGE "FIELD f 1\na 2147483647 576460752303423487 double\n", "too few"},
    {IMAGE "FIELD f 1\na 4 1000000000000 string\nx\n", "too few"},
    {IMAGE "FIELD f 1\na 1 3 string\nx\n   ", "ends within the texts"},
    {IMAGE "POINT_DATA 4\nLOOKUP_TABLE t 2147483647\n", "too few"},
    {IMAGE_B "POINT_DATA 4\nSCALARS s double\nLOOKUP_TABLE default\n12345678123456781234567812345678"
             "SCALARS s double\nLOOKUP_TABLE default\n1234567812345678123456781234567",
     "31 bytes that follow"},
    {IMAGE_B "FIELD f 1\na 1 2 string\n\xC1x\xC5xyz", "ends within the texts"},
    {IMAGE_B "FIELD f 1\na 1 1 string\n\x3F\xFF\xFF\xFF\xFF\xFF\xFF\xFFx", "ends within the texts"},
    {HEAD "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 3 float\n1 2 3\n", "3 coordinates along axis 1"},
    {HEAD "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 2 float\n1 nan\n", "not finite"},
    {HEAD "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 2 double\n1 1e399\n", "not finite"},
    {HEAD "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 2 string\nx\ny\n", "texts for X_COORDINATES"},
    {HEAD "DATASET STRUCTURED_GRID\nDIMENSIONS 2 1 1\n", "0 POINTS, but DIMENSIONS of 2"},
    {HEAD "DATASET STRUCTURED_GRID\nDIMENSIONS 2 1 1\nPOINTS 3 float\n0 0 0 0 0 0 0 0 0\n", "3 POINTS"},
    {CURVED("2.0", "BLANKING 3 unsigned_char\n1 0 1\n"), "BLANKING of 3"},
    {CURVED("2.0", "BLANKING 4 float\n1 0 1 1\n"), "neither"},
    {UNSTRUCTURED("300000000000000000 double\n1 2 3\n"), "'300000000000000000'"},
    {UNSTRUCTURED("100000000000000000 double\n1 2 3\n"), "too few"},
    {HEAD "DATASET UNSTRUCTURED_GRID\n", "no POINTS"},
#define FOUR UNSTRUCTURED("4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n")
    {FOUR "CELLS 1 5\n4 0 1 2 4\nCELL_TYPES 1\n10\n", "cell 0 with point 4, but points 0 to 3"},
    {FOUR "CELLS 1 5\n4 0 1 -1 3\nCELL_TYPES 1\n10\n", "point -1"},
    {FOUR "CELLS 1 5\n4 0 1 2 3\n", "CELL_TYPES for 0"},
    {FOUR "CELL_TYPES 1\n10\n", "0 cells, but CELL_TYPES for 1"},
    {FOUR "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n256\n", "0 to 255"},
    {FOUR "CELLS 1 5\n5 0 1 2 3\nCELL_TYPES 1\n10\n", "more points"},
    {FOUR "CELLS 1 5\n-1 0 1 2 3\nCELL_TYPES 1\n10\n", "fewer than 0"},
    {FOUR "CELLS 1 5\n3 0 1 2 3\nCELL_TYPES 1\n10\n", "take 4 numbers, but says 5"},
    {FOUR "CELLS 2 1\n0\n", "at least one"},
    {FOUR "CELLS 100000000000000000 100000000000000000\n0\n", "too few"},
    {FOUR "CELLS 2 4\nOFFSETS vtktypeint64\n0 5\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\n", "lead out"},
    {FOUR "CELLS 3 4\nOFFSETS int\n0 4 3\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES 2\n10 10\n", "do not rise"},
    {FOUR "CELLS 2 4\nOFFSETS int\n1 4\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES 1\n10\n", "from 1 to 4"},
    {FOUR "CELLS 2 4\nOFFSETS int\n0 3\nCONNECTIVITY int\n0 1 2 3\nCELL_TYPES 1\n10\n", "from 0 to 3"},
    {FOUR "CELLS 2 4\nOFFSETS int\n0 4\nCELL_TYPES 1\n10\n", "no CONNECTIVITY"},
    {FOUR "CELLS 2 4\nOFFSETS float\n0 4\n", "no integers"},
    {FOUR "CELLS 2 4\nOFFSETS vtktypeuint64\n0 9223372036854775808\n", "beyond 2^63"},
};

static void test_damaged(void) {
    for (size_t i = 0; i < sizeof damaged / sizeof *damaged; i++) {
        dataset d;
        const char *path = file_text("damaged.vtk", damaged[i].text);
        int status = read_path(path, &d);
        EXPECT(status == STATUS_INPUT, "%s\nstatus %d: %s", damaged[i].text, status, failure_text());
        if (!status) dataset_release(&d);
        EXPECT(strstr(failure_text(), path) && strstr(failure_text(), damaged[i].part), "no '%s': %s", damaged[i].part,
               failure_text());
    }
    bytes b = {0};
    bytes_text(&b, IMAGE "POINT_DATA 4\n");
    for (int i = 0; i < 300; i++) bytes_text(&b, "x");
    dataset d;
    EXPECT(read_bytes("x", b.data, b.size, &d) == STATUS_INPUT && strstr(failure_text(), "longer than 255"), "%s",
           failure_text());
    b.size -= 300;
    bytes_text(&b, "FIELD f 5000\n");
    for (int i = 0; i < 5000; i++) bytes_text(&b, "a 1 4 char\n1 2 3 4\n");
    EXPECT(read_bytes("x", b.data, b.size, &d) == STATUS_INPUT && strstr(failure_text(), "4096 arrays"), "%s",
           failure_text());
    bytes_free(&b);
}

/* ---------------------------------------------------------------------------------------------- published files */

static const struct {
    const char *file;
    enum block_kind kind;
    int64_t dims[3], points, cells;
    const char *field;
    int on_cells, type;
    double low, high; /* to 6 digits */
} published[] = {
    {"uniform/ironProt.vtk", BLOCK_UNIFORM, {68, 68, 68}, 314432, 300763, "scalars", 0, TC_U8, 0, 255},
    {"uniform/heart.vtk", BLOCK_UNIFORM, {32, 32, 12}, 12288, 10571, "scalars", 0, TC_F32, 0, 255},
    {"uniform/RectGrid2.vtk", BLOCK_RECTILINEAR, {47, 33, 11}, 17061, 14720, "scalars", 0, TC_F32, 0, 10.3964},
    {"curvilinear/SampleStructGrid.vtk",
     BLOCK_CURVILINEAR,
     {20, 30, 40},
     24000,
     21489,
     "scalars",
     0,
     TC_F64,
     0,
     1.30456},
    {"unstructured/CylinderLinear.vtk", BLOCK_UNSTRUCTURED, {0}, 465, 1522, "vel_norm", 0, TC_F64, 0, 1.0044},
    {"unstructured/hexa.vtk", BLOCK_UNSTRUCTURED, {0}, 12167, 10648, "scalars", 0, TC_F32, 0.753065, 17.3205},
    {"unstructured/notch_stress_fixed.vtk",
     BLOCK_UNSTRUCTURED,
     {0},
     3537,
     2192,
     "Nodal Stress-normed",
     0,
     TC_F64,
     3206.61,
     8.1098e6},
    {"unstructured/PentaHexa.vtk", BLOCK_UNSTRUCTURED, {0}, 401, 210, "scalar1", 1, TC_F64, 1, 210},
    {"unstructured/tetraMesh.vtk", BLOCK_UNSTRUCTURED, {0}, 55, 160, "scalars", 0, TC_I32, 0, 4},
    {"unstructured/uGridEx.vtk", BLOCK_UNSTRUCTURED, {0}, 27, 12, "scalars", 0, TC_F32, 0, 26},
    {"unstructured/VTKCellTypes.vtk", BLOCK_UNSTRUCTURED, {0}, 27, 11, "scalars", 1, TC_F32, 0, 10},
    {"unstructured/blow.vtk", BLOCK_UNSTRUCTURED, {0}, 687, 1057, "thickness9", 0, TC_F32, 0.126328, 1.14768},
    {"malformed/visit_issue_20474.vtk", BLOCK_UNSTRUCTURED, {0}, 18, 4, "d", 0, TC_F32, 3.8, 5},
    {"malformed/vtkio/rectilinear_grid_binary.vtk",
     BLOCK_RECTILINEAR,
     {3, 4, 1},
     12,
     6,
     "cellscalar",
     1,
     TC_F32,
     1.1,
     8.1},
    {"malformed/vtkio/structured_grid.vtk", BLOCK_CURVILINEAR, {2, 2, 2}, 8, 1, "ptval", 0, TC_F32, 0, 7},
    {"malformed/vtkio/volume_complex.vtk", BLOCK_UNIFORM, {3, 4, 6}, 72, 30, "volume_scalars", 0, TC_I8, 0, 50},
    {"malformed/vtkio/triangle_vtkidtype.vtk",
     BLOCK_UNSTRUCTURED,
     {0},
     3,
     1,
     "vtkOriginalPointIds",
     0,
     TC_I32,
     95364,
     95691},
    {"malformed/vtkio/para_test.vtk", BLOCK_UNSTRUCTURED, {0}, 12, 3, "MixedInts", 0, TC_I32, -1, 3},
};

static void test_published(const char *data) {
    for (size_t i = 0; i < sizeof published / sizeof *published; i++) {
        char path[1024];
        dataset d;
        snprintf(path, sizeof path, "%s/%s", data, published[i].file);
        int status = read_path(path, &d);
        EXPECT(!status, "status %d: %s", status, failure_text());
        if (status) continue;
        const dataset_block *b = d.blocks;
        EXPECT(b->kind == published[i].kind && !memcmp(b->dims, published[i].dims, sizeof b->dims) &&
                   b->point_count == published[i].points && b->cell_count == published[i].cells,
               "%s: kind %d, %" PRId64 " points, %" PRId64 " cells", path, (int)b->kind, b->point_count, b->cell_count);
        const dataset_field *f = find_field(&d, published[i].field, published[i].on_cells);
        EXPECT(f && (int)f->type == published[i].type && f->components == 1, "%s: field '%s'", path,
               published[i].field);
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int64_t k = 0; f && k < value_count(b, f); k++) {
            low = fmin(low, field_value(f, k));
            high = fmax(high, field_value(f, k));
        }
        EXPECT(fabs(low - published[i].low) <= 1e-5 * fabs(published[i].low) &&
                   fabs(high - published[i].high) <= 1e-5 * fabs(published[i].high),
               "%s: '%s' from %g to %g", path, published[i].field, low, high);
        touch(&d);
        dataset_release(&d);
    }
}

/* Whatever a file holds: grids that can be read to their end, or STATUS_INPUT with its name. */
static int test_any(const char *path, const struct stat *about, int kind, struct FTW *at) {
    (void)about;
    (void)at;
    size_t length = strlen(path);
    if (kind != FTW_F || length < 4 || strcmp(path + length - 4, ".vtk")) return 0;
    dataset d;
    int status = read_path(path, &d);
    EXPECT(!status || (status == STATUS_INPUT && strstr(failure_text(), path)), "%s: status %d: %s", path, status,
           failure_text());
    if (!status) touch(&d);
    if (!status) dataset_release(&d);
    return 0;
}

int main(void) {
    const char *data = getenv("TETRACUBES_DATA");
    folder_make("vtk-legacy");
    test_kinds();
    test_passed_over();
    test_forms();
    test_blanking();
    test_polyhedra();
    test_names();
    test_types();
    test_columns();
    test_in_place();
    test_damaged();
    folder_remove();
    if (data && *data) {
        test_published(data);
        nftw(data, test_any, 8, FTW_PHYS);
    } else {
        printf("published files skipped: TETRACUBES_DATA is unset\n");
    }
    return EXPECT_DONE();
}
