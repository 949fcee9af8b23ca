/* test_gzip.c - files of every format packed by gzip as a whole, and such files that are damaged */
#include "read_files.h"

enum { COUNT = 60 };

#define MHA                                                                                                            \
    "NDims = 3\nDimSize = 5 4 3\nElementType = MET_USHORT\nElementByteOrderMSB = True\nElementDataFile = LOCAL\n"
#define NRRD  "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 5 4 3\nendian: big\nencoding: raw\n\n"
#define NUMPY "{'descr': '>u2', 'fortran_order': False, 'shape': (3, 4, 5)}"
#define VTK                                                                                                            \
    "# vtk DataFile Version 3.0\nt\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 5 4 3\nPOINT_DATA 60\n"              \
    "SCALARS a unsigned_short\nLOOKUP_TABLE default\n"

/* A header with 60 samples behind it. */
static bytes file_of(const char *header, size_t length) {
    bytes file = {0}, samples = test_samples(TC_U16, COUNT, 1);
    bytes_add(&file, header, length);
    bytes_add(&file, samples.data, samples.size);
    bytes_free(&samples);
    return file;
}

static const char *write_packed(const char *name, const bytes *file) {
    bytes packed = gzipped(file->data, file->size, AS_GZIP);
    const char *path = file_write(name, packed.data, packed.size);
    bytes_free(&packed);
    return path;
}

static void test_images(void) {
    char npy[80] = "\x93NUMPY\1";
    npy[8] = sizeof NUMPY - 1;
    memcpy(npy + 10, NUMPY, sizeof NUMPY);
    const struct {
        const char *name, *header;
        size_t length;
        const char *format;
    } cases[] = {{"a.mha.gz", MHA, sizeof MHA - 1, "MetaImage"},    {"a.nrrd.gz", NRRD, sizeof NRRD - 1, "NRRD"},
                 {"a.npy.gz", npy, 10 + sizeof NUMPY - 1, "numpy"}, {"a.npy.GZ", npy, 10 + sizeof NUMPY - 1, "numpy"},
                 {"a.mha", MHA, sizeof MHA - 1, "MetaImage"},       {"a.raw.gz", "", 0, "raw"}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        bytes file = file_of(cases[n].header, cases[n].length);
        read_request r = request_for(write_packed(cases[n].name, &file));
        for (int a = 0; a < 3 && !cases[n].length; a++) r.dims[a] = 5 - a;
        if (!cases[n].length) r.type = TC_U16;
        r.big_endian = 1;
        expected e = {.stored = TC_U16, .dims = {5, 4, 3}, .format = cases[n].format};
        expect_volume(cases[n].name, &r, &e);
        bytes_free(&file);
    }
}

/* A raw file that is named .raw may begin like gzip's. */
static void test_raw_like_gzip(void) {
    read_request r = request_for(file_write("a.raw", "\x1f\x8b\x08xxxxx", 8));
    for (int a = 0; a < 3; a++) r.dims[a] = 2;
    r.type = TC_U8;
    read_image v;
    int status = image_read(&r, &v);
    EXPECT(!status && image_value(&v, 0) == 0x1f, "raw that begins as gzip: %s", failure_text());
    image_release(&v);
}

static dataset *read_grid(const char *path, const char *path2) {
    static dataset d;
    read_request r = request_for(path);
    r.path2 = path2;
    int status = dataset_read(&r, &d);
    EXPECT(!status, "%s: status %d: %s", path, status, failure_text());
    return status ? NULL : &d;
}

static void test_grids(void) {
    bytes file = file_of(VTK, sizeof VTK - 1);
    dataset *d = read_grid(write_packed("a.vtk.gz", &file), NULL);
    if (d) {
        const dataset_field *f = d->blocks->fields;
        EXPECT(d->blocks->point_count == COUNT && value_at(f->type, f->values, 59) == test_value(TC_U16, 59), "VTK: %d",
               (int)d->blocks->point_count);
        dataset_release(d);
    }
    bytes_free(&file);
    for (int packed = 1; packed < 4; packed++) { /* the grid, its function file, both */
        bytes grid = {0}, function = {0};
        bytes_text(&grid, "2 2 2\n0 1 0 1 0 1 0 1\n0 0 1 1 0 0 1 1\n0 0 0 0 1 1 1 1\n");
        bytes_text(&function, "2 2 2 1\n1 2 3 4 5 6 7 8\n");
        const char *first = packed & 1 ? write_packed("a.xyz.gz", &grid) : file_write("a.xyz", grid.data, grid.size);
        const char *second =
            packed & 2 ? write_packed("a.f.gz", &function) : file_write("a.f", function.data, function.size);
        if ((d = read_grid(first, second))) {
            EXPECT(d->blocks->point_count == 8 && d->blocks->field_count == 1, "Plot3D: %d", d->blocks->field_count);
            dataset_release(d);
        }
        bytes_free(&grid);
        bytes_free(&function);
    }
}

/* Several streams in one file, of the same length and of others: all of them are one. */
static void test_several_streams(void) {
    bytes file = file_of(MHA, sizeof MHA - 1);
    for (size_t split = 0; split <= file.size; split++) {
        bytes first = gzipped(file.data, split, AS_GZIP),
              second = gzipped(file.data + split, file.size - split, AS_GZIP);
        bytes_add(&first, second.data, second.size);
        read_request r = request_for(file_write("a.mha.gz", first.data, first.size));
        expected e = {.stored = TC_U16, .dims = {5, 4, 3}};
        expect_volume("two streams", &r, &e);
        bytes_free(&first);
        bytes_free(&second);
    }
    bytes_free(&file);
}

/* What stands behind the stream, as tapes leave it, is passed over, whatever size it seems to tell. */
static void test_rest(void) {
    static const unsigned char rests[][4] = {{0, 0, 0, 0}, {0, 16, 0, 0}, {1, 0, 0, 0}, {255, 255, 255, 255}};
    for (size_t n = 0; n < sizeof rests / sizeof *rests; n++) {
        bytes file = file_of(NRRD, sizeof NRRD - 1), packed = gzipped(file.data, file.size, AS_GZIP);
        bytes_add(&packed, rests[n], sizeof rests[n]);
        read_request r = request_for(file_write("a.nrrd.gz", packed.data, packed.size));
        read_image v;
        int status = image_read(&r, &v);
        EXPECT(!status && !*v.d.notice && image_value(&v, 59) == test_value(TC_U16, 59), "rest %d: %s %s", (int)n,
               failure_text(), v.d.notice);
        image_release(&v);
        bytes_free(&packed);
        bytes_free(&file);
    }
}

static void test_damaged(void) {
    bytes file = file_of(MHA, sizeof MHA - 1), packed = gzipped(file.data, file.size, AS_GZIP);
    for (size_t size = 3; size < packed.size; size++) {
        read_request r = request_for(file_write("a.mha.gz", packed.data, size));
        expect_failure("cut", &r, STATUS_INPUT, "a.mha.gz");
    }
    for (size_t n = 10; n < packed.size; n += 3) { /* behind the header, which has times and names */
        packed.data[n] ^= 0x55;
        read_request r = request_for(file_write("a.mha.gz", packed.data, packed.size));
        read_image v;
        int status = image_read(&r, &v);
        const int is_size = n + 4 >= packed.size; /* the size is looked at, but zlib refuses it, too */
        EXPECT(status == STATUS_INPUT, "byte %d: status %d%s", (int)n, status, is_size ? ", of the size" : "");
        image_release(&v);
        packed.data[n] ^= 0x55;
    }
    bytes nothing = {0};
    read_request r = request_for(write_packed("a.mha.gz", &nothing));
    expect_failure("nothing is packed", &r, STATUS_INPUT, "a.mha.gz");
    nothing = gzipped(packed.data, packed.size, AS_GZIP);
    r = request_for(file_write("a.dat.gz", nothing.data, nothing.size));
    expect_failure("packed twice", &r, STATUS_INPUT, "not known");
    bytes_free(&nothing);
    bytes_free(&packed);
    bytes_free(&file);
}

/* Read again and again, each time what the file then holds. */
static void test_again(void) {
    for (int n = 0; n < 20; n++) {
        char text[200];
        bytes file = {0};
        snprintf(text, sizeof text, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 1 %d\nencoding: ascii\n\n", n + 1);
        bytes_text(&file, "%s", text);
        for (int m = 0; m <= n; m++) bytes_text(&file, "%d ", n);
        read_request r = request_for(write_packed("again.nrrd.gz", &file));
        read_image v;
        int status = image_read(&r, &v);
        EXPECT(!status && v.dims[2] == n + 1 && image_value(&v, (uint64_t)n) == n, "time %d: %s", n, failure_text());
        image_release(&v);
        bytes_free(&file);
    }
}

int main(void) {
    folder_make("gzip");
    test_images();
    test_raw_like_gzip();
    test_grids();
    test_several_streams();
    test_rest();
    test_damaged();
    test_again();
    folder_remove();
    return EXPECT_DONE();
}
