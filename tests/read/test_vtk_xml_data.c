/*
 * test_vtk_xml_data.c - the reader of VTK XML on published files: sizes, fields and ranges as they are known
 *
 * The files are those of the folder that TETRACUBES_DATA names; without it the test is skipped.
 */
#include "exit_status.h"
#include "expect.h"
#include "failure.h"
#include "read_formats.h"
#include "vtk_xml_files.h"

/* ------------------------------------------------------------------------------------------------- published files */

static const dataset_field *find_field(const dataset_block *b, const char *name) {
    for (int n = 0; n < b->field_count; n++)
        if (strcmp(b->fields[n].name, name) == 0) return &b->fields[n];
    return NULL;
}

typedef struct published {
    const char *path;
    enum block_kind kind;
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

static const published files[] = {
    {"uniform/hydrogen.vti",
     BLOCK_UNIFORM,
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
    {"uniform/vase.vti", BLOCK_UNIFORM, 871125, 843600, {115, 101, 75}, {0}, "SLCImage", 0, TC_U8, 0, 239, 0},
    {"uniform/heart.vti", BLOCK_UNIFORM, 12288, 10571, {32, 32, 12}, {0}, "scalars", 0, TC_F32, 0, 255, 0},
    {"uniform/cth.vtr",
     BLOCK_RECTILINEAR,
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
    {"curvilinear/multicomb_0.vts", BLOCK_CURVILINEAR, 648, 440, {6, 12, 9}, {0}, "Density", 0, TC_F32, 0.2, 0.71, 0.2},
    {"curvilinear/multicomb_1.vts",
     BLOCK_CURVILINEAR,
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
     BLOCK_CURVILINEAR,
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
    {"unstructured/fire_ug.vtu", BLOCK_UNSTRUCTURED, 12323, 10462, {0}, {0}, "t", 0, TC_F32, 298, 692, 1},
    {"unstructured/fichera-mixed.vtu",
     BLOCK_UNSTRUCTURED,
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
     BLOCK_UNSTRUCTURED,
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
     BLOCK_UNSTRUCTURED,
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
    {"unstructured/Wedge.vtu", BLOCK_UNSTRUCTURED, 27, 16, {0}, {0}, "Polynomial", 0, TC_F32, 1, 7, 0},
    {"unstructured/Hexahedron.vtu", BLOCK_UNSTRUCTURED, 26, 7, {0}, {0}, "material", 1, TC_I32, 1, 1, 0},
    {"unstructured/QuadraticPyramid.vtu", BLOCK_UNSTRUCTURED, 153, 48, {0}, {0}, "Polynomial", 0, TC_F32, 1, 7, 0}};

static void test_published(const char *data) {
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
                int same = 1;
                for (size_t a = 0; a < 3; a++)
                    same = same && (float)coordinate_at(b->points, 3 * i + (int64_t)a) == points[a * POINTS + k];
                if (!same) continue;
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
    static const char *const refused[][2] = {{"point.vtp", "PolyData"},
                                             {"hexahedron_parallel.pvtu", "list of other files"},
                                             {"cube.pvtp", "list of other files"},
                                             {"tet.vtk", "not XML"}};
    static const char *const packed[][2] = {{"hexahedron_lz4.vtu", "LZ4"},
                                            {"hexahedron_lz4_inline_binary.vtu", "LZ4"},
                                            {"hexahedron_lzma_inline_binary.vtu", "LZMA"},
                                            {"lzma.vtu", "LZMA"}};
    char path[4096], formats[FORMATS_TEXT];
    dataset d;
    for (size_t i = 0; i < sizeof packed / sizeof *packed; i++) {
        snprintf(path, sizeof path, "%s/malformed/vtkio/%s", data, packed[i][0]);
        const int status = read_path(path, &d), has_library = strstr(read_formats_text(formats), packed[i][1]) != NULL;
        EXPECT(has_library ? status == 0 && d.blocks->cell_count > 0
                           : status == STATUS_INPUT && strstr(failure_text(), packed[i][1]),
               "%s: status %d: %s", path, status, failure_text());
        dataset_release(&d);
    }
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

int main(void) {
    const char *data = getenv("TETRACUBES_DATA");
    if (!data || !*data) {
        printf("skipped: TETRACUBES_DATA is not set\n");
        return 77;
    }
    test_published(data);
    test_combustor(data);
    test_foreign(data);
    return EXPECT_DONE();
}
