/*
 * test_vtk_legacy_odd.c - VTK legacy files as programs write them: sections that are passed over, forms of keywords,
 * types and numbers, blanking, names, polyhedra
 */
#include "vtk_legacy_files.h"

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

/* Characters of a name that would steer a terminal stay encoded as the file has them, or are encoded. */
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

int main(void) {
    test_passed_over();
    test_forms();
    test_blanking();
    test_polyhedra();
    test_names();
    test_types();
    test_columns();
    return EXPECT_DONE();
}
