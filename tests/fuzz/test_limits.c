/*
 * test_limits.c - what every reader does with sizes that overflow, streams that unpack to far more than they should,
 * arrays that share what they unpack or copy, headers and names without end, numbers of hundreds of digits, links out
 * of a header's folder, and spacings that are no distances
 *
 * Memory is measured: nothing is taken for what a header only says.
 */
#include "limit_cases.h"
#include "tiff_files.h"

#include "dataset/dataset.h"

#include <sys/resource.h>

enum { MEMORY_MOST = 32 << 10 }; /* KiB */

/* The most memory that this process has had since the last call; proc(5), clear_refs. */
static long memory_peak(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    FILE *file = fopen("/proc/self/clear_refs", "w");
    EXPECT(file && fputs("5", file) >= 0 && fclose(file) == 0, "the peak of memory cannot be set back");
    return usage.ru_maxrss;
}

/* Reads a file that was written; part as in limit_case. */
static void check_file(const char *what, const char *path, const char *part) {
    dataset d;
    read_request request = request_for(path);
    fail(0, "(no text)");
    (void)memory_peak();
    long before = memory_peak();
    int status = dataset_read(&request, &d);
    long taken = memory_peak() - before;
    if (part)
        EXPECT(status == STATUS_INPUT && strstr(failure_text(), part) && strstr(failure_text(), folder),
               "%s: status %d, no '%s': %s", what, status, part, failure_text());
    else
        EXPECT(status == 0, "%s: status %d: %s", what, status, failure_text());
    EXPECT(taken < MEMORY_MOST, "%s: took %ld KiB", what, taken);
    if (!status) dataset_release(&d);
}

static void check_cases(const limit_case *cases, size_t count) {
    for (size_t n = 0; n < count; n++)
        check_file(cases[n].text, file_text(cases[n].name, cases[n].text), cases[n].part);
}

/* -------------------------------------------------------------------------------------------------- size arithmetic */

static void test_sizes(void) {
    file_text("whole.vti", XML8("")); /* the piece of lists of pieces */
    check_cases(size_cases, sizeof size_cases / sizeof *size_cases);
}

/* ------------------------------------------------------------------------------------------------------ compression */

/* A header, then `count` zeros packed. */
static const char *bomb_write(const char *name, const bytes *header, int bzip2, size_t count) {
    unsigned char *zeros = calloc(count, 1);
    bytes packed = bzip2 ? bzipped(zeros, count) : gzipped(zeros, count, AS_GZIP), file = {0};
    bytes_add(&file, header->data, header->size);
    bytes_add(&file, packed.data, packed.size);
    const char *path = file_write(name, file.data, file.size);
    free(zeros);
    bytes_free(&packed);
    bytes_free(&file);
    return path;
}

/* What unpacks to 64 MiB, of which the header asks for eight bytes, or for more than can be. */
static void test_bombs(void) {
    enum { UNPACKED = 64 << 20 };
    static const char *const encodings[] = {"gzip", "bzip2"};
    for (int n = 0; n < 2; n++)
        for (int huge = 0; huge < 2; huge++) {
            bytes header = {0};
            bytes_text(&header, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: %s\nencoding: %s\n\n",
                       huge ? "1000000 1000000 10" : "2 2 2", encodings[n]);
            const char *path = bomb_write("bomb.nrrd", &header, n, UNPACKED);
            check_file("an NRRD bomb", path, huge ? "cannot hold" : NULL);
            bytes_free(&header);
        }
    for (int huge = 0; huge < 2; huge++) {
        bytes header = {0};
        bytes_text(&header,
                   "NDims = 3\nDimSize = 2 2 %s\nElementType = MET_UCHAR\nCompressedData = True\n"
                   "ElementDataFile = LOCAL\n",
                   huge ? "1000000000000" : "2");
        check_file("a MetaImage bomb", bomb_write("bomb.mha", &header, 0, UNPACKED), huge ? "cannot hold" : NULL);
        bytes_free(&header);
    }
    for (int version = 1; version <= 2; version++) {
        nifti_fields f = nifti_plain(version, 2, 8, 32767, 32767, 32767);
        bytes plain = nifti_header_bytes(&f), packed = gzipped(plain.data, plain.size, AS_GZIP);
        check_file("a NIfTI bomb", file_write("bomb.nii.gz", packed.data, packed.size), "cannot hold");
        bytes_free(&plain);
        bytes_free(&packed);
    }
}

/* Pages and tiles of sizes that their few bytes cannot hold. */
static void test_pages(void) {
    static const unsigned char tags[3][8] = {
        {0, 1, 4, 0, 1, 0, 0, 0}, {0x42, 1, 4, 0, 1, 0, 0, 0}, {0x43, 1, 4, 0, 1, 0, 0, 0}}; /* width, sides of tiles */
    for (int n = 0; n < 6; n++) {
        const int compression = n & 1 ? TIFF_DEFLATE : TIFF_NONE, is_tiled = n / 2 > 0;
        const tiff_form f = {.type = TC_U8,
                             .compression = compression,
                             .width = 16,
                             .height = 16,
                             .samples = 1,
                             .rows = 16,
                             .tile = is_tiled ? 16 : 0};
        bytes file = tiff_file(&f, 1, 0);
        unsigned char *at = memmem(file.data, file.size, tags[n / 2], 8);
        EXPECT(at != NULL, "no such tag");
        if (at) memcpy(at + 8, &(uint32_t){1u << 28}, 4);
        check_file("a large page", file_write("large.tif", file.data, file.size),
                   is_tiled ? "large.tif" : "cannot hold the pages");
        bytes_free(&file);
    }
}

/* ---------------------------------------------------------------------------------------------- headers without end */

static void check_repeated(const char *name, const char *start, const char *line, size_t count, const char *part) {
    bytes file = {0};
    size_t length = strlen(line);
    bytes_text(&file, "%s", start);
    file.data = realloc(file.data, file.size + count * length);
    for (size_t n = 0; n < count; n++) memcpy(file.data + file.size + n * length, line, length);
    file.size += count * length;
    check_file(start, file_write(name, file.data, file.size), part);
    bytes_free(&file);
}

static void test_headers(void) {
    char wide[16001] = "";
    memset(wide, 'a', sizeof wide - 1);
    memcpy(wide, "Comment = ", 10);
    wide[sizeof wide - 2] = '\n';
    check_repeated("long.nrrd", "NRRD0004\n", "#\n", 1000001, "lines");
    check_repeated("long.mha", "NDims = 3\n", "\n", 1000001, "lines");
    check_repeated("long.mha", "NDims = 3\n", wide, 1100, "ends without ElementDataFile");
    check_repeated("long.nhdr", "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: LIST\n",
                   "\n", 1000001, "lines");
    check_repeated("long.vtk", "# vtk DataFile Version 3.0\ntitle\nASCII\n", "a", 100000, "longer than 255");
    check_repeated("long.vtk", "# vtk DataFile Version 3.0\n", "a", 1000000, "ASCII");
    check_repeated("many.vti",
                   "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"0 1 0 1 0 1\">"
                   "<Piece Extent=\"0 1 0 1 0 1\"><PointData>",
                   "<DataArray type=\"UInt8\" format=\"ascii\"/>", 5000, "more than 4096 arrays");
    check_repeated("deep.vtu", "<VTKFile type=\"UnstructuredGrid\">", "<a>", 100000, "nested");
    check_repeated("deep.vtm", "<VTKFile type=\"vtkMultiBlockDataSet\">", "<a>", 100000, "nested");
    check_repeated("many.vtm", "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet>",
                   "<DataSet file=\"a.vti\"/>", 20000, "more than 16384 files");
    check_repeated("many.pvtu", "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>", "<Piece Source=\"a.vtu\"/>",
                   20000, "more than 16384 files");
}

/* ------------------------------------------------------------------------------------------------------------ names */

/* A million names of 4,000 characters; files of more axes than numbers can say. */
static void test_names(void) {
    char long_name[4001] = "";
    bytes header = {0};
    memset(long_name, 'a', sizeof long_name - 1);
    bytes_text(&header, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 1000000\nencoding: raw\n");
    bytes_text(&header, "data file: %s%%d 0 999999 1\n", long_name);
    check_file("names by the million", file_write("names.nhdr", header.data, header.size), "in all");
    bytes_free(&header);

    read_request r = request_for(
        file_text("axes.mhd", "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementNumberOfChannels = 3\n"
                              "ElementDataFile = a%d.raw 0 1 1 9223372036854775807\n"));
    r.component = 0;
    expect_failure("2^63 - 1 axes per file", &r, STATUS_INPUT, "axes");
    check_file("what would steer a terminal",
               file_text("type.nrrd", "NRRD0004\ntype: \033]0;a\007\ndimension: 3\nsizes: 2 2 2\n"), "'?]0;a?'");
}

/* ---------------------------------------------------------------------------------------------------------- numbers */

static double first_value(const char *path) {
    dataset d;
    read_request r = request_for(path);
    int status = dataset_read(&r, &d);
    EXPECT(status == 0 && d.blocks[0].field_count == 1, "%s: status %d: %s", path, status, failure_text());
    if (status) return 0;
    double value;
    memcpy(&value, d.blocks[0].fields[0].values, sizeof value);
    dataset_release(&d);
    return value;
}

/* Words of so many digits are one number, or refused; never two. */
static void test_numbers(void) {
    static const struct {
        int digits;
        double value;
    } cases[] = {{62, 1e62}, {63, 1e63}, {64, 1e64}, {126, 1e126}, {127, 1e127}, {308, 1e308}, {2000, 0}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        bytes number = {0}, nrrd = {0}, vti = {0};
        bytes_text(&number, "1");
        for (int digit = 0; digit < cases[n].digits; digit++) bytes_text(&number, "0");
        bytes_text(&number, " 2 3 4 5 6 7 8");
        bytes_add(&number, "", 1);
        bytes_text(&nrrd, "NRRD0004\ntype: double\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n%s\n", number.data);
        bytes_text(&vti,
                   XML("ImageData") "<ImageData WholeExtent=\"0 1 0 1 0 1\"><Piece Extent=\"0 1 0 1 0 1\"><PointData>"
                                    "<DataArray type=\"Float64\" Name=\"a\" format=\"ascii\">%s</DataArray>"
                                    "</PointData></Piece></ImageData></VTKFile>",
                   number.data);
        const bytes *const files[] = {&nrrd, &vti};
        for (int f = 0; f < 2; f++) {
            const char *path = file_write(f ? "digits.vti" : "digits.nrrd", files[f]->data, files[f]->size);
            if (cases[n].value == 0)
                check_file("a number of 2,001 digits", path, "is no number");
            else
                EXPECT(first_value(path) == cases[n].value, "1e%d: read as %g", cases[n].digits, first_value(path));
        }
        bytes_free(&number);
        bytes_free(&nrrd);
        bytes_free(&vti);
    }
    static const char zero[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n"
                               "1\0002 2 3 4 5 6 7 8\n";
    check_file("a number with a zero byte in it", file_write("zero.nrrd", zero, sizeof zero - 1), "is no number");
}

/* ---------------------------------------------------------------------------------------------------------- sharing */

/* So many pieces of points with one array in common. */
static void write_shared(bytes *file, int pieces, int points, const bytes *data, const char *type, int is_packed) {
    bytes_text(file,
               "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" header_type=\"UInt64\"%s>"
               "<UnstructuredGrid>",
               is_packed ? " compressor=\"vtkZLibDataCompressor\"" : "");
    for (int n = 0; n < pieces; n++)
        bytes_text(file,
                   "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"0\"><Points><DataArray type=\"%s\" "
                   "NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points></Piece>",
                   points, type);
    bytes_text(file, "</UnstructuredGrid><AppendedData encoding=\"raw\">");
    while ((file->size + 1) % 8) bytes_text(file, " ");
    bytes_text(file, "_");
    bytes_add(file, data->data, data->size);
    bytes_text(file, "</AppendedData></VTKFile>");
}

static void test_sharing(void) {
    enum { DOUBLES = 3 * 4000, FLOATS = 3 * 300000 };
    unsigned char *zeros = calloc(FLOATS, sizeof(float));
    bytes plain = {0}, packed = {0}, stream = gzipped(zeros, FLOATS * sizeof(float), AS_ZLIB), file = {0};
    bytes_put(&plain, DOUBLES * sizeof(double), 8, 0);
    bytes_add(&plain, zeros, DOUBLES * sizeof(double));
    write_shared(&file, 3, DOUBLES / 3, &plain, "Float64", 0);
    check_file("doubles shared by three pieces", file_write("shared.vtu", file.data, file.size), NULL);
    file.size = 0;
    write_shared(&file, 400, DOUBLES / 3, &plain, "Float64", 0);
    check_file("doubles shared by 400 pieces", file_write("shared.vtu", file.data, file.size), "share the same data");
    file.size = 0;
    write_shared(&file, 400, DOUBLES / 3, &plain, "Int64", 0);
    check_file("integers shared by 400 pieces", file_write("shared.vtu", file.data, file.size), "share the same data");
    file.size = 0;
    bytes_put(&packed, 1, 8, 0); /* blocks, bytes of each, of the last, packed */
    bytes_put(&packed, FLOATS * sizeof(float), 8, 0);
    bytes_put(&packed, 0, 8, 0);
    bytes_put(&packed, stream.size, 8, 0);
    bytes_add(&packed, stream.data, stream.size);
    write_shared(&file, 40, FLOATS / 3, &packed, "Float32", 1);
    check_file("a packed array shared by 40 pieces", file_write("shared.vtu", file.data, file.size),
               "share the same data");
    free(zeros);
    bytes_free(&plain);
    bytes_free(&packed);
    bytes_free(&stream);
    bytes_free(&file);
}

/* ------------------------------------------------------------------------------------------------------------ links */

static const char *link_to(const char *target, const char *name) {
    const char *path = file_path(name);
    unlink(path);
    EXPECT(symlink(target, path) == 0, "cannot make the link %s", path);
    return path;
}

/* store/ holds data and a header; own/ is where headers under test lie. */
static void test_links(void) {
    static const char nrrd[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: d.raw\n",
                      below[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
                                "data file: sub/d.raw\n",
                      list[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 2 2\nencoding: raw\n"
                               "data file: LIST\nd.raw\nsub/d.raw\n",
                      meta[] = "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = d.raw\n";
    mkdir(file_path("store"), 0700);
    mkdir(file_path("own"), 0700);
    mkdir(file_path("own-too"), 0700);
    file_text("own-too/d.raw", "12345678");
    file_text("store/d.raw", "12345678");
    file_text("store/a.nhdr", nrrd);
    file_text("own/e.raw", "12345678");
    file_text("own/a.nhdr", nrrd);
    file_text("own/a.mhd", meta);
    file_text("own/b.nhdr", below);
    file_text("own/c.nhdr", list);

    link_to("../store/d.raw", "own/d.raw");
    check_file("a link out of the folder", file_path("own/a.nhdr"), "symbolic link");
    check_file("a link out of the folder", file_path("own/a.mhd"), "symbolic link");
    link_to("../own-too/d.raw", "own/d.raw");
    check_file("a link to a folder whose name begins alike", file_path("own/a.nhdr"), "symbolic link");
    link_to("e.raw", "own/d.raw");
    check_file("a link within the folder", file_path("own/a.nhdr"), NULL);
    check_file("a link within the folder", file_path("own/a.mhd"), NULL);
    link_to("../store", "own/sub");
    check_file("a folder that is a link", file_path("own/b.nhdr"), "symbolic link");
    check_file("the second of a list in a folder that is a link", file_path("own/c.nhdr"), "symbolic link");
    unlink(file_path("own/sub"));
    mkdir(file_path("own/sub"), 0700);
    file_text("own/sub/d.raw", "12345678");
    check_file("a folder below", file_path("own/b.nhdr"), NULL);

    link_to("../store/d.raw", "own/d.raw");
    check_file("header and data, both links to one folder", link_to("../store/a.nhdr", "own/a.nhdr"), NULL);
    link_to("own", "alias");
    check_file("a folder named through a link", file_path("alias/b.nhdr"), NULL);
    link_to("missing", "own/d.raw");
    check_file("a link to nothing", file_path("own/a.mhd"), "cannot be opened");
}

/* -------------------------------------------------------------------------------------------------------- distances */

static void test_distances(void) {
    check_cases(distance_cases, sizeof distance_cases / sizeof *distance_cases);
    for (int n = 0; n < 5; n++) {
        static const double odd[] = {0, (double)NAN, (double)INFINITY, -(double)INFINITY, -1};
        read_request r = request_for(file_text("a.raw", "12345678"));
        dataset d;
        for (int a = 0; a < 3; a++) r.dims[a] = 2;
        r.type = TC_U8;
        r.spacing[n % 3] = odd[n];
        int status = dataset_read(&r, &d);
        EXPECT(status == (odd[n] == -1 ? 0 : STATUS_USAGE), "raw spacing %g: status %d", odd[n], status);
        if (!status) dataset_release(&d);
    }
}

int main(void) {
    folder_make("limits");
    test_sizes();
    test_bombs();
    test_pages();
    test_headers();
    test_names();
    test_numbers();
    test_sharing();
    test_links();
    test_distances();
    folder_remove();
    return EXPECT_DONE();
}
