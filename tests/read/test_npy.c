/* test_npy.c - arrays of numpy: every type, byte order, order of axes and version; axes; headers that are wrong */
#include "read_files.h"

enum { COUNT = 60 };

static const char *const kinds[] = {"u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8", "i8", "u8"};

/* Magic, version, length and header, without samples. */
static bytes header_of(int version, const char *dictionary) {
    bytes file = {0};
    const unsigned char numbers[2] = {(unsigned char)version, 0};
    bytes_text(&file, "\x93NUMPY");
    bytes_add(&file, numbers, 2);
    bytes_put(&file, strlen(dictionary), version == 1 ? 2 : 4, 0);
    bytes_text(&file, "%s", dictionary);
    return file;
}

static read_request write_npy(int version, const char *dictionary, const bytes *samples) {
    bytes file = header_of(version, dictionary);
    bytes_add(&file, samples->data, samples->size);
    read_request r = request_for(file_write("a.npy", file.data, file.size));
    bytes_free(&file);
    return r;
}

/* Padded as numpy does, so that samples begin at a multiple of 64 bytes; or not. */
static void dictionary_of(char text[256], int type, int big, int is_fortran, const char *shape, int is_padded) {
    const char order = stored_bytes(type) == 1 ? '|' : big ? '>' : '<';
    const int length = snprintf(text, 256, "{'descr': '%c%s', 'fortran_order': %s, 'shape': (%s), }", order,
                                kinds[type], is_fortran ? "True" : "False", shape);
    snprintf(text + length, 256 - (size_t)length, "%*s\n", is_padded ? 117 - length : 3, "");
}

static void test_types(void) {
    for (int type = 0; type <= STORED_U64; type++)
        for (int big = 0; big < 2; big++)
            for (int version = 1; version <= 3; version++)
                for (int is_padded = 0; is_padded < 2; is_padded++) {
                    char dictionary[256];
                    bytes samples = test_samples(type, COUNT, big);
                    dictionary_of(dictionary, type, big, 0, "3, 4, 5", is_padded);
                    read_request r = write_npy(version, dictionary, &samples);
                    expected e = {.stored = type, .dims = {5, 4, 3}, .format = "numpy"};
                    expect_volume(dictionary, &r, &e);
                    read_image v;
                    const int is_plain = type <= TC_F64 && (stored_bytes(type) == 1 || (is_padded && !big));
                    if (image_read(&r, &v) == 0 && (is_padded || stored_bytes(type) == 1) && version == 1)
                        EXPECT(!!v.d.mapping == is_plain, "%s: %s", dictionary, v.d.mapping ? "mapped" : "copied");
                    image_release(&v);
                    bytes_free(&samples);
                }
}

/* In Fortran order sample x, y, z of a 5 x 4 x 3 volume lies at z + 3 (y + 4 x). */
static void test_fortran_order(void) {
    for (int big = 0; big < 2; big++) {
        char dictionary[256];
        bytes samples = test_samples(TC_I16, COUNT, big);
        read_image v;
        dictionary_of(dictionary, TC_I16, big, 1, "3, 4, 5", 1);
        read_request r = write_npy(1, dictionary, &samples);
        int status = image_read(&r, &v);
        EXPECT(!status, "Fortran order: %s", failure_text());
        if (!status) {
            EXPECT(v.dims[0] == 5 && v.dims[1] == 4 && v.dims[2] == 3, "Fortran order: %d", (int)v.dims[0]);
            for (uint64_t n = 0; n < COUNT; n++)
                EXPECT(image_value(&v, n) == test_value(TC_I16, n / 20 + 3 * (n / 5 % 4 + 4 * (n % 5))),
                       "Fortran order: sample %d", (int)n);
            EXPECT(strstr(v.d.notice, "Fortran order"), "Fortran order: notice '%s'", v.d.notice);
        }
        image_release(&v);
        bytes_free(&samples);
    }
}

static void test_axes(void) {
    static const struct {
        const char *shape;
        int is_fortran, component, frame;
        int64_t dims[3];
        uint64_t offset, stride;
    } cases[] = {
        {"12, 5", 0, -1, -1, {5, 12, 1}, 0, 1},        {"60,", 0, -1, -1, {60, 1, 1}, 0, 1},
        {"3, 4, 5, 2", 0, 1, -1, {5, 4, 3}, 1, 2},     {"2, 3, 4, 5", 0, -1, 1, {5, 4, 3}, 60, 1},
        {"2, 2, 3, 5, 1", 0, -1, 1, {5, 3, 2}, 30, 1}, {"2, 1, 2, 5, 3", 0, 2, 1, {5, 2, 1}, 32, 3},
        {"3L, 4L, 5L", 0, -1, -1, {5, 4, 3}, 0, 1},    {"1, 1, 20, 3", 1, 2, -1, {20, 1, 1}, 40, 1},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        char dictionary[256];
        bytes samples = test_samples(TC_F32, 2 * COUNT, 0);
        dictionary_of(dictionary, TC_F32, 0, cases[n].is_fortran, cases[n].shape, 1);
        read_request r = write_npy(2, dictionary, &samples);
        r.component = cases[n].component;
        r.frame = cases[n].frame;
        expected e = {.stored = TC_F32, .offset = cases[n].offset, .stride = cases[n].stride};
        memcpy(e.dims, cases[n].dims, sizeof e.dims);
        expect_volume(dictionary, &r, &e);
        bytes_free(&samples);
    }
}

static void test_placement(void) {
    static const double matrix[12] = {0.5, 0, 0, 10, 0, 0.25, 0, 20, 0, 0, 2, 30};
    char dictionary[256];
    bytes samples = test_samples(TC_U16, COUNT, 0);
    dictionary_of(dictionary, TC_U16, 0, 0, "3, 4, 5", 1);
    read_request r = write_npy(1, dictionary, &samples);
    r.has_spacing = r.has_origin = 1;
    for (int a = 0; a < 3; a++) {
        r.spacing[a] = matrix[5 * a];
        r.origin[a] = matrix[4 * a + 3];
    }
    expected e = {.stored = TC_U16, .dims = {5, 4, 3}, .matrix = matrix};
    expect_volume("with spacing and origin", &r, &e);
    bytes_free(&samples);
}

/* As other programs write dictionaries: any order, quotes, blanks; and booleans. */
static void test_loose(void) {
    static const char *const dictionaries[] = {
        "{\"shape\":(3,4,5),\"descr\":\"|u1\",\"fortran_order\":False}",
        "{ 'fortran_order' : False , 'shape' : ( 3 , 4 , 5 , ) , 'descr' : '<u1' , } \n\n",
        "{'descr': '|b1', 'fortran_order': False, 'shape': (3, 4, 5)}\n",
        "{'descr': '=u1', 'fortran_order': False, 'shape': (3, 4, 5)}\n",
    };
    bytes samples = test_samples(TC_U8, COUNT, 0);
    for (size_t n = 0; n < sizeof dictionaries / sizeof *dictionaries; n++) {
        read_request r = write_npy(1, dictionaries[n], &samples);
        expected e = {.stored = TC_U8, .dims = {5, 4, 3}};
        expect_volume(dictionaries[n], &r, &e);
    }
    bytes_free(&samples);
}

#define U8_OF(shape) "{'descr': '|u1', 'fortran_order': False, 'shape': " shape ", }"

static void test_failures(void) {
    static const struct {
        const char *dictionary, *part;
        int status;
    } cases[] = {
        {U8_OF("(3, 4, 6)"), "cut", STATUS_INPUT},
        {U8_OF("(3, 0, 5)"), "at least 1", STATUS_INPUT},
        {U8_OF("(4294967296, 4294967296, 4294967296)"), "2^64", STATUS_INPUT},
        {U8_OF("(99999999999999999999, 1, 1)"), "whole numbers", STATUS_INPUT},
        {U8_OF("(-1, 4, 5)"), "whole numbers", STATUS_INPUT},
        {U8_OF("()"), "single number", STATUS_INPUT},
        {U8_OF("(1, 1, 1, 1, 1, 1)"), "more than 5 axes", STATUS_INPUT},
        {U8_OF("(3 4 5)"), "no end", STATUS_INPUT},
        {U8_OF("[3, 4, 5]"), "no tuple", STATUS_INPUT},
        {U8_OF("(3, 4, 5"), "no", STATUS_INPUT},
        {U8_OF("(2, 2, 3, 5)"), "--frame", STATUS_USAGE},
        {U8_OF("(5, 4, 1, 3)"), "--component", STATUS_USAGE},
        {"{'descr': '<f2', 'fortran_order': False, 'shape': (3, 4, 5)}", "astype", STATUS_INPUT},
        {"{'descr': '<c8', 'fortran_order': False, 'shape': (3, 4, 5)}", "'<c8'", STATUS_INPUT},
        {"{'descr': '|O', 'fortran_order': False, 'shape': (3, 4, 5)}", "'|O'", STATUS_INPUT},
        {"{'descr': 'u1', 'fortran_order': False, 'shape': (3, 4, 5)}", "'u1'", STATUS_INPUT},
        {"{'descr': '', 'fortran_order': False, 'shape': (3, 4, 5)}", "''", STATUS_INPUT},
        {"{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3, 4, 5)}", "records", STATUS_INPUT},
        {"{'descr': 5, 'fortran_order': False, 'shape': (3, 4, 5)}", "no type", STATUS_INPUT},
        {"{'descr': '|u1', 'fortran_order': 1, 'shape': (3, 4, 5)}", "neither", STATUS_INPUT},
        {"{'descr': '|u1', 'shape': (3, 4, 5)}", "no 'fortran_order'", STATUS_INPUT},
        {"{'fortran_order': False, 'shape': (3, 4, 5)}", "no 'descr'", STATUS_INPUT},
        {"{'descr': '|u1', 'fortran_order': False}", "no 'shape'", STATUS_INPUT},
        {"{'colour': '|u1'}", "does not have", STATUS_INPUT},
        {"{'descr': '|u1' 'shape': (3, 4, 5)}", "no end", STATUS_INPUT},
        {"{'descr': '|u1", "no type", STATUS_INPUT},
        {"{'descr", "no key", STATUS_INPUT},
        {"", "no dictionary", STATUS_INPUT},
    };
    bytes samples = test_samples(TC_U8, COUNT, 0), file;
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        read_request r = write_npy(1, cases[n].dictionary, &samples);
        expect_failure(cases[n].dictionary, &r, cases[n].status, cases[n].part);
    }
    file = header_of(4, U8_OF("(3, 4, 5)"));
    read_request r = request_for(file_write("a.npy", file.data, file.size));
    expect_failure("version 4", &r, STATUS_INPUT, "version 4");
    bytes_free(&file);
    file = header_of(2, U8_OF("(3, 4, 5)"));
    for (size_t size = 0; size < file.size; size++) {
        r = request_for(file_write("a.npy", file.data, size));
        expect_failure("a cut header", &r, STATUS_INPUT, "");
    }
    memset(file.data + 8, 0xff, 4);
    r = request_for(file_write("a.npy", file.data, file.size));
    expect_failure("a header of 4 GiB", &r, STATUS_INPUT, "longer");
    bytes_free(&file);
    bytes_free(&samples);
}

int main(void) {
    folder_make("npy");
    test_types();
    test_fortran_order();
    test_axes();
    test_placement();
    test_loose();
    test_failures();
    folder_remove();
    return EXPECT_DONE();
}
