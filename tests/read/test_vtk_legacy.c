/*
 * test_vtk_legacy.c - the reader of VTK legacy files: every kind of grid, type and layout, ASCII and binary, made here
 * byte by byte and compared value by value; published files
 */
#include "vtk_legacy_files.h"

enum { POINTS = 12, CUBES = 2 };

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
    test_in_place();
    folder_remove();
    if (data && *data) {
        test_published(data);
        nftw(data, test_any, 8, FTW_PHYS);
    } else {
        printf("published files skipped: TETRACUBES_DATA is unset\n");
    }
    return EXPECT_DONE();
}
