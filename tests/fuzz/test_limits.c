/*
 * test_limits.c - what every reader does with sizes that overflow, streams that unpack to far more than they should,
 * headers without end, links out of a header's folder, and spacings that are no distances
 *
 * Memory is measured: nothing is taken for what a header only says.
 */
#include "../read_files.h"
#include "limit_cases.h"

#include "dataset.h"

#include <sys/resource.h>

enum { MEMORY_MOST = 24 << 10 }; /* KiB */

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

/* ---------------------------------------------------------------------------------------------------- size arithmetic
 */

static void test_sizes(void) { check_cases(size_cases, sizeof size_cases / sizeof *size_cases); }

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

/* ------------------------------------------------------------------------------------------------ headers without end
 */

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
    check_repeated("deep.vtu", "<VTKFile type=\"UnstructuredGrid\">", "<a>", 100000, "nested");
}

/* ------------------------------------------------------------------------------------------------------------- links
 */

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

/* --------------------------------------------------------------------------------------------------------- distances
 */

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
    test_headers();
    test_links();
    test_distances();
    folder_remove();
    return EXPECT_DONE();
}
