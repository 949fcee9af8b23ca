/*
 * test_hdf5.c - datasets of HDF5: every type and byte order, in one piece and in chunks, found by their names; others
 * that cannot be read; files that are cut, or in which bytes are wrong
 */
#include "read_files.h"

#include <hdf5.h>
#include <sys/wait.h>

enum { COUNT = 60, CHUNKED = 1, FILTERED = 2, SUMMED = 4 };

static const hsize_t sizes[3] = {3, 4, 5};

static hid_t type_of(int type, int big) {
    const hid_t little_types[] = {H5T_STD_U8LE,  H5T_STD_I8LE,   H5T_STD_U16LE,  H5T_STD_I16LE, H5T_STD_U32LE,
                                  H5T_STD_I32LE, H5T_IEEE_F32LE, H5T_IEEE_F64LE, H5T_STD_I64LE, H5T_STD_U64LE};
    const hid_t big_types[] = {H5T_STD_U8BE,  H5T_STD_I8BE,   H5T_STD_U16BE,  H5T_STD_I16BE, H5T_STD_U32BE,
                               H5T_STD_I32BE, H5T_IEEE_F32BE, H5T_IEEE_F64BE, H5T_STD_I64BE, H5T_STD_U64BE};
    return (big ? big_types : little_types)[type];
}

/* Adds a dataset of the samples first, first + 1, ... */
static void add(hid_t file, const char *name, int type, int big, int how, uint64_t first, int dimension,
                const hsize_t *shape) {
    static const hsize_t chunk[5] = {2, 3, 2, 2, 2};
    hsize_t count = 1;
    for (int a = 0; a < dimension; a++) count *= shape[a];
    double *values = malloc(count * sizeof *values);
    int64_t *whole = malloc(count * sizeof *whole);
    for (uint64_t n = 0; n < count; n++) {
        values[n] = test_value(type, first + n);
        whole[n] = (int64_t)values[n];
    }
    const hid_t space = H5Screate_simple(dimension, shape, NULL), plan = H5Pcreate(H5P_DATASET_CREATE),
                links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    if (how & CHUNKED) H5Pset_chunk(plan, dimension, chunk);
    if (how & FILTERED) H5Pset_shuffle(plan);
    if (how & FILTERED) H5Pset_deflate(plan, 6);
    if (how & (FILTERED | SUMMED)) H5Pset_fletcher32(plan);
    const hid_t made = H5Dcreate2(file, name, type_of(type, big), space, links, plan, H5P_DEFAULT);
    const int is_real = type == TC_F32 || type == TC_F64;
    EXPECT(H5Dwrite(made, is_real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                    is_real ? (void *)values : (void *)whole) >= 0,
           "%s cannot be written", name);
    H5Dclose(made);
    H5Pclose(links);
    H5Pclose(plan);
    H5Sclose(space);
    free(values);
    free(whole);
}

static hid_t begin(const char *name, unsigned user_block) {
    const hid_t plan = H5Pcreate(H5P_FILE_CREATE);
    if (user_block) H5Pset_userblock(plan, user_block);
    const hid_t file = H5Fcreate(file_path(name), H5F_ACC_TRUNC, plan, H5P_DEFAULT);
    H5Pclose(plan);
    return file;
}

static void test_types(void) {
    for (int type = 0; type <= STORED_U64; type++)
        for (int n = 0; n < 14; n++) {
            static const int ways[7] = {
                0, CHUNKED, CHUNKED | FILTERED, 0, CHUNKED, CHUNKED | FILTERED, CHUNKED | SUMMED};
            const int big = n & 1, how = ways[n / 2];
            char what[60];
            snprintf(what, sizeof what, "type %d, big %d, chunks and filters %d, block %d", type, big, how, n / 6);
            const hid_t file = begin("a.h5", n / 6 ? 1024 : 0);
            add(file, "volume", type, big, how, 0, 3, sizes);
            H5Fclose(file);
            read_request r = request_for(file_path("a.h5"));
            expected e = {.stored = type, .dims = {5, 4, 3}, .format = "HDF5"};
            expect_volume(what, &r, &e);
            read_image v;
            if (image_read(&r, &v) == 0) EXPECT(!*v.d.notice, "%s: notice '%s'", what, v.d.notice);
            image_release(&v);
        }
}

static void test_names(void) {
    const hid_t file = begin("names.h5", 0);
    add(file, "first", TC_U8, 0, 0, 0, 3, sizes);
    add(file, "group/b:/second", TC_F32, 0, FILTERED | CHUNKED, 60, 3, sizes);
    add(file, "flat", TC_U8, 0, 0, 0, 2, (hsize_t[2]){6, 10});
    add(file, "four", TC_U8, 0, 0, 0, 4, (hsize_t[4]){3, 4, 5, 2});
    H5Lcreate_soft("/group/b:/second", file, "soft", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_external("a.h5", "/volume", file, "elsewhere", H5P_DEFAULT, H5P_DEFAULT);
    const hid_t space = H5Screate_simple(3, sizes, NULL), plan = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(plan, "/etc/hostname", 0, COUNT);
    H5Dclose(H5Dcreate2(file, "outside", H5T_STD_U8LE, space, H5P_DEFAULT, plan, H5P_DEFAULT));
    H5Pclose(plan);
    const hid_t chunks = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_chunk(chunks, 3, (hsize_t[3]){1, 1, 1});
    H5Dclose(H5Dcreate2(file, "empty", H5T_STD_U8LE, space, H5P_DEFAULT, chunks, H5P_DEFAULT));
    H5Pclose(chunks);
    H5Dclose(H5Dcreate2(file, "text", H5T_C_S1, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
    H5Fclose(file);
    char path[600];
    static const struct {
        const char *name, *part; /* part: of the failure's text; NULL: it is read */
        int status;
        expected e;
    } cases[] = {
        {":/first", NULL, 0, {.stored = TC_U8, .dims = {5, 4, 3}}},
        {":/group/b:/second", NULL, 0, {.stored = TC_F32, .dims = {5, 4, 3}, .offset = 60}},
        {":/soft", NULL, 0, {.stored = TC_F32, .dims = {5, 4, 3}, .offset = 60}},
        {":/flat", NULL, 0, {.stored = TC_U8, .dims = {10, 6, 1}}},
        {":/four", "--component", STATUS_USAGE, {.stored = 0}},
        {"", "of: /", STATUS_USAGE, {.stored = 0}},
        {":/none", "'/none'", STATUS_INPUT, {.stored = 0}},
        {":/group", "'/group'", STATUS_INPUT, {.stored = 0}},
        {":/", "'/'", STATUS_INPUT, {.stored = 0}},
        {":/elsewhere", "link to another file", STATUS_INPUT, {.stored = 0}},
        {":/outside", "lie in other files", STATUS_INPUT, {.stored = 0}},
        {":/empty", "no samples were written", STATUS_INPUT, {.stored = 0}},
        {":/text", "type of its dataset", STATUS_INPUT, {.stored = 0}},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        snprintf(path, sizeof path, "%s%s", file_path("names.h5"), cases[n].name);
        read_request r = request_for(path);
        if (cases[n].part)
            expect_failure(cases[n].name, &r, cases[n].status, cases[n].part);
        else
            expect_volume(cases[n].name, &r, &cases[n].e);
    }
}

/* An enumeration over int8 of two values: booleans are u8, others the numbers that they name. */
static void test_booleans(void) {
    static const struct { int values[2], type; } cases[] = {{{0, 1}, TC_U8}, {{1, 0}, TC_U8}, {{0, 2}, TC_I8}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const hid_t file = begin("b.h5", 0), type = H5Tenum_create(H5T_NATIVE_INT8),
                    space = H5Screate_simple(3, sizes, NULL);
        int8_t values[COUNT];
        for (int m = 0; m < 2; m++) {
            const int8_t value = (int8_t)cases[n].values[m];
            H5Tenum_insert(type, m ? "TRUE" : "FALSE", &value);
        }
        for (int k = 0; k < COUNT; k++) values[k] = (int8_t)cases[n].values[k % 3 == 0];
        const hid_t made = H5Dcreate2(file, "mask", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        EXPECT(H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0, "case %zu cannot be written", n);
        H5Dclose(made);
        H5Sclose(space);
        H5Tclose(type);
        H5Fclose(file);
        read_request r = request_for(file_path("b.h5"));
        read_image v;
        const int status = image_read(&r, &v);
        EXPECT(status == 0, "case %zu: %s", n, failure_text());
        if (!status)
            EXPECT((int)v.type == cases[n].type && memcmp(v.samples, values, COUNT) == 0, "case %zu: type %d", n,
                   (int)v.type);
        image_release(&v);
    }
}

/* Chunks of a file, whose samples lie in it and do not lie in it, and spacing as Fiji writes it. */
static void test_spacing(void) {
    static const double matrix[12] = {0.5, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0};
    const float spacing[3] = {3, 2, 0.5f};
    const hsize_t three = 3;
    const hid_t file = begin("a.h5", 0);
    add(file, "volume", TC_I16, 0, 0, 0, 3, sizes);
    const hid_t set = H5Dopen2(file, "volume", H5P_DEFAULT), space = H5Screate_simple(1, &three, NULL),
                attribute = H5Acreate2(set, "element_size_um", H5T_IEEE_F32BE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_FLOAT, spacing);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Dclose(set);
    H5Fclose(file);
    read_request r = request_for(file_path("a.h5"));
    expected e = {.stored = TC_I16, .dims = {5, 4, 3}, .matrix = matrix};
    expect_volume("element_size_um", &r, &e);
}

/* Reads in a process of its own; whether it ended by a signal. */
static int crashes(const char *path) {
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        read_request r = request_for(path);
        read_image v;
        alarm(20);
        if (image_read(&r, &v) == 0) image_release(&v);
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status);
}

static void test_damaged(void) {
    for (int how = 0; how < 4; how += 3) {
        const hid_t file = begin("whole.h5", 0);
        add(file, "volume", TC_I16, 0, how, 0, 3, sizes);
        H5Fclose(file);
        FILE *whole = fopen(file_path("whole.h5"), "rb");
        static unsigned char content[1 << 16];
        const size_t size = whole ? fread(content, 1, sizeof content, whole) : 0;
        if (whole) fclose(whole);
        EXPECT(size > 1000 && size < sizeof content, "a file of %zu bytes", size);
        for (size_t cut = 0; cut < size; cut += 1 + size / 200) {
            read_request r = request_for(file_write("cut.h5", content, cut));
            expect_failure("cut", &r, STATUS_INPUT, "cut.h5");
        }
        int crash_count = 0;
        for (size_t n = 0; n < size; n += 1 + size / 400) {
            content[n] ^= 0xff;
            crash_count += crashes(file_write("wrong.h5", content, size));
            content[n] ^= 0xff;
        }
        EXPECT(!crash_count, "%d files with a wrong byte end in a crash", crash_count);
    }
    read_request r = request_for(file_text("text.h5", "no HDF5"));
    expect_failure("text", &r, STATUS_INPUT, "HDF5");
    const hid_t none = begin("none.h5", 0);
    H5Fclose(none);
    r = request_for(file_path("none.h5"));
    expect_failure("nothing", &r, STATUS_INPUT, "holds no dataset");
}

int main(void) {
    folder_make("hdf5");
    test_types();
    test_names();
    test_booleans();
    test_spacing();
    test_damaged();
    folder_remove();
    return EXPECT_DONE();
}
