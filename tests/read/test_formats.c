/*
 * test_formats.c - the tables of formats: the pages list what they hold, and what is not built in is told
 *
 *     test_formats PAGE_OF_READERS PAGE_OF_TOOL [absent]
 *
 * absent: the readers were built without the libraries that files need.
 */
#include "expect.h"

#include "exit_status.h"
#include "failure.h"
#include "file/unpack_block.h"
#include "folder.h"
#include "mesh_write.h"
#include "read.h"
#include "read_formats.h"

#include <stdlib.h>
#include <string.h>

static char page[1 << 17];

static void read_page(const char *path) {
    FILE *file = fopen(path, "r");
    size_t length = file ? fread(page, 1, sizeof page - 1, file) : 0;
    EXPECT(length > 1000 && length < sizeof page - 1, "%s: %zu bytes", path, length);
    if (file) fclose(file);
}

/* The first line that begins so; "" where there is none. */
static const char *line_of(const char *beginning, char line[1000]) {
    char wanted[100];
    snprintf(wanted, sizeof wanted, "\n%s", beginning);
    const char *at = strstr(page, wanted);
    snprintf(line, 1000, "%.*s", at ? (int)strcspn(at + 1, "\n") : 0, at ? at + 1 : "");
    return line;
}

static void test_page_of_reading(void) {
    for (const read_format *f = read_formats; f < read_formats + read_format_count; f++) {
        char row[1000], word[40];
        snprintf(word, sizeof word, "| %.*s", (int)strcspn(f->name, " "), f->name);
        if (strncmp(f->name, "VTK", 3) == 0) snprintf(word, sizeof word, "| %s", f->name);
        EXPECT(*line_of(word, row), "the readers' page: no row of %s", f->name);
        for (const char *at = f->endings + 1; *at && f != raw_format && f != plot3d_format;
             at += strcspn(at, "|") + 1) {
            snprintf(word, sizeof word, "`%.*s", (int)strcspn(at + 1, "|.") + 1, at); /* .gz is told by itself */
            EXPECT(strstr(row, word), "the readers' page: no %s in '%s'", word, row);
        }
        for (int n = 0; f->notes[n].text; n++)
            if (f->notes[n].library)
                EXPECT(strstr(row, f->notes[n].text), "the readers' page: no %s in '%s'", f->notes[n].text, row);
    }
}

static void test_page_of_writing(void) {
    char row[1000];
    line_of("| `--format F`", row);
#define FORMAT_IN_PAGE(name, label, ...)                                                                               \
    EXPECT(strstr(page, label), "the tool's page: no %s", label);                                                      \
    EXPECT(strstr(row, #name), "the tool's page: no %s in '%s'", #name, row);
    MESH_FORMATS(FORMAT_IN_PAGE)
}

/* Endings and beginnings lead to the row. */
static void test_rows(void) {
    for (const read_format *f = read_formats; f < read_formats + read_format_count; f++) {
        char path[40];
        for (const char *at = f->endings + 1; *at; at += strcspn(at, "|") + 1) {
            snprintf(path, sizeof path, "A%.*s", (int)strcspn(at, "|"), at);
            EXPECT(read_format_of_ending(path) == f, "%s is not %s", path, f->name);
        }
        EXPECT(!f->library == !f->instead, "%s: what helps without a library", f->name);
    }
    EXPECT(!read_format_of_ending(".nrrd") && !read_format_of_ending("a.stl"), "no format");
}

static void expect_missing(const char *name, const char *text, const char *library, const char *package) {
    char path[600];
    read_request request;
    dataset d;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file || fputs(text, file) < 0 || fclose(file)) abort();
    read_request_init(&request, path);
    int status = dataset_read(&request, &d);
    EXPECT(status == STATUS_INPUT && strstr(failure_text(), "built without") && strstr(failure_text(), library) &&
               strstr(failure_text(), package),
           "%s: status %d, %s", name, status, failure_text());
    if (!status) dataset_release(&d);
}

#define NRRD_222 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: "

static void test_absent(void) {
    char text[FORMATS_TEXT];
    EXPECT(!strcmp(read_formats_text(text), "raw, NRRD, MetaImage, numpy, VTK legacy, Plot3D (grid and solution)"),
           "%s", text);
    expect_missing("a.nii", "x", "libnifti2", "TETRACUBES_NIFTI");
    expect_missing("a.tif", "x", "libtiff", "libtiff-dev");
    expect_missing("a.h5", "x", "libhdf5", "TETRACUBES_HDF5");
    expect_missing("a.vtu", "<VTKFile>", "expat", "libexpat1-dev");
    expect_missing("a.nrrd", NRRD_222 "gzip\n\n12345678", "zlib", "zlib1g-dev");
    expect_missing("b.nrrd", NRRD_222 "bzip2\n\n12345678", "libbz2", "TETRACUBES_BZIP2");
    static const char *const packed[][3] = {{"vtkZLibDataCompressor", "zlib1g-dev", "zlib"},
                                            {"vtkLZ4DataCompressor", "liblz4-dev", "LZ4"},
                                            {"vtkLZMADataCompressor", "liblzma-dev", "LZMA"}};
    for (int n = 0; n < 3; n++)
        EXPECT(unpack_block_check("a.vtu", packing_of(packed[n][0]), 10, 10) == STATUS_INPUT &&
                   strstr(failure_text(), packed[n][1]) && strstr(failure_text(), packed[n][2]),
               "%s: %s", packed[n][0], failure_text());
}

int main(int argc, char **argv) {
    if (argc < 3) return 2;
    folder_make("formats");
    test_rows();
    read_page(argv[1]);
    test_page_of_reading();
    read_page(argv[2]);
    test_page_of_writing();
    if (argc > 3) test_absent();
    folder_remove();
    return EXPECT_DONE();
}
