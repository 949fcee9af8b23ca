/*
 * test_read_hostile.c - damaged, absurd and malicious volume files: a status, a text that helps, no volume
 *
 * Run under sanitizers or valgrind, this also shows that no byte outside a file is touched.
 */
#include "read_files.h"
#include "read_formats.h"

typedef struct text_case {
    const char *name, *text, *part;
    int status;
} text_case;

static void test_texts(const text_case *cases, size_t count) {
    for (size_t i = 0; i < count; i++) {
        read_request r = request_for(file_text(cases[i].name, cases[i].text));
        expect_failure(cases[i].text, &r, cases[i].status, cases[i].part);
        EXPECT(strstr(failure_text(), folder), "no file name: %s", failure_text());
    }
}

#define NRRD     "NRRD0004\n"
#define NRRD_U8  NRRD "type: uchar\ndimension: 3\nencoding: raw\n"
#define NRRD_222 NRRD_U8 "sizes: 2 2 2\n"
#define EIGHT    "12345678"

/* Fields that are needed, and their values. */
static void test_nrrd_header(void) {
    static const text_case cases[] = {
        {"a.nrrd", "NRRD0009\n\n", "NRRD0005", STATUS_INPUT},
        {"a.nrrd", "something else\n\n", "NRRD0005", STATUS_INPUT},
        {"a.nrrd", "", "NRRD0001", STATUS_INPUT},
        {"a.nrrd", NRRD "type: uchar\ndimension: 3\nsizes: 2 2 2\n\n" EIGHT, "'encoding'", STATUS_INPUT},
        {"a.nrrd", NRRD "dimension: 3\nencoding: raw\nsizes: 2 2 2\n\n" EIGHT, "'type'", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "\n" EIGHT, "'sizes'", STATUS_INPUT},
        {"a.nrrd", NRRD "type: uchar\nencoding: raw\n\n" EIGHT, "'dimension'", STATUS_INPUT},
        {"a.nrrd", NRRD "type: short\ndimension: 3\nencoding: raw\nsizes: 2 2 1\n\n" EIGHT, "'endian'", STATUS_INPUT},
        {"a.nrrd", NRRD "sizes: 2 2 2\n", "'dimension'", STATUS_INPUT},
        {"a.nrrd", NRRD "dimension: 17\n", "1 to 16", STATUS_INPUT},
        {"a.nrrd", NRRD "dimension: -1\n", "1 to 16", STATUS_INPUT},
        {"a.nrrd", NRRD "type: block\n", "'block'", STATUS_INPUT},
        {"a.nrrd", NRRD "type: uchar|short\n", "type", STATUS_INPUT},
        {"a.nrrd", NRRD "encoding: zrl\n", "'zrl'", STATUS_INPUT},
        {"a.nrrd", NRRD "endian: middle\n", "'middle'", STATUS_INPUT},
        {"a.nrrd", NRRD "nonsense\n", "no field", STATUS_INPUT},
        {"a.nrrd", NRRD_222, "no end", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 2 2\n\n", "3 values", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 2 2 2 2\n\n", "3 values", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 2 2 x\n\n", "3 values", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 2 0 2\n\n" EIGHT, "at least 1", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 2 -2 -2\n\n" EIGHT, "at least 1", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 3 3 3\n\n" EIGHT, "asks for 27", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 4294967296 4294967296 2\n\n" EIGHT, "2^64", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 4294967296 2147483648 1\n\n" EIGHT, "2^60", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 99999999999999999999 1 1\n\n" EIGHT, "3 values", STATUS_INPUT},
        {"a.nrrd", NRRD_U8 "sizes: 1000000 1000000 1000\n\n" EIGHT, "asks for", STATUS_INPUT},
    };
    test_texts(cases, sizeof cases / sizeof *cases);
}

/* World space, and what axes are. */
static void test_nrrd_axes(void) {
    static const text_case cases[] = {
        {"a.nrrd", NRRD_222 "spacings: 1 1 0\n\n" EIGHT, "spacing along axis 3", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "spacings: inf 1 1\n\n" EIGHT, "spacing along axis 1", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "spacings: 1 1\n\n" EIGHT, "3 values", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "kinds: space space\n\n" EIGHT, "3 values", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "centers: cell cell cell cell\n\n" EIGHT, "3 values", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "space directions: (1,0,0) (0,1,0) (1,1,0)\n\n" EIGHT, "determinant", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "space directions: (1,0,0) (0,1,0) (0,0,0)\n\n" EIGHT, "axis 3 is 0", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "space directions: (1,0,0) (0,1,0) (0,0,nan)\n\n" EIGHT, "vectors", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "space directions: (1,0,0) (0,1,0)\n\n" EIGHT, "has 2 vectors", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "space directions: (1,0,0) (0,1,0) (0,0,1,\n\n" EIGHT, "vectors", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "space directions: (1,0,0) (0,1,0) (0,0,1,2,3)\n\n" EIGHT, "vectors", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "space origin: (0,0,inf)\n\n" EIGHT, "vectors", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "space origin: (0,0,nan)\n\n" EIGHT, "vectors", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "kinds: vector domain domain\n\n" EIGHT, "--component 0 to 1", STATUS_USAGE},
        {"a.nrrd", NRRD_222 "kinds: time domain domain\n\n" EIGHT, "--frame 0 to 1", STATUS_USAGE},
        {"a.nrrd", NRRD_222 "kinds: time time domain\n\n" EIGHT, "more axes", STATUS_INPUT},
        {"a.nrrd",
         NRRD_222 "kinds: scalar space space\nsizes: 1 4 2\n\n"
                  "1234567",
         "asks for 8", STATUS_INPUT},
    };
    test_texts(cases, sizeof cases / sizeof *cases);
}

/* Where data begin. */
static void test_nrrd_skips(void) {
    static const text_case cases[] = {
        {"a.nrrd", NRRD_222 "byte skip: 1\n\n" EIGHT, "asks for 8", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "byte skip: 9223372036854775807\n\n" EIGHT, "behind", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "byte skip: -2\n\n" EIGHT, "8 and 1 behind", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "byte skip: -9223372036854775808\n\n" EIGHT, "behind", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "line skip: 2\n\n" EIGHT "\n", "only 1", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "line skip: -1\n\n" EIGHT, "skip", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: gzip\nbyte skip: -1\n\n" EIGHT, "damaged", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: gzip\nbyte skip: -9223372036854775808\n\n" EIGHT, "cannot hold", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\nbyte skip: -1\n\n1 2 3 4 5 6 7 8", "no sense", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: hex\nbyte skip: -1\n\n0102030405060708", "no sense", STATUS_INPUT},
    };
    test_texts(cases, sizeof cases / sizeof *cases);
}

/* Data that are too short, damaged, or of other values. */
static void test_nrrd_data(void) {
    static const text_case cases[] = {
        {"a.nrrd", NRRD_222 "encoding: hex\n\n010203040506070", "15 hexadecimal", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: hex\n\n010203040506070 ", "has 15 hexadecimal", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: hex\n\n01020304050607g8", "no hexadecimal digit", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: hex\ntype: short\n\n" EIGHT EIGHT EIGHT EIGHT, "'endian'", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: gzip\nbyte skip: 9223372036854775807\n\n" EIGHT, "cannot hold", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: gzip\n\n" EIGHT, "damaged", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: bzip2\n\n" EIGHT, "damaged", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: gzip\n\n", "cannot hold", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: gzip\nsizes: 1000 1000 1\n\n" EIGHT, "cannot hold", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: bzip2\nsizes: 1000 1000 1\n\n" EIGHT, "damaged", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: bzip2\nsizes: 10000 10000 1\n\n" EIGHT, "cannot hold", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\n\n1 2 3 4 5 6 7\n", "few", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\n\n1 2 3 4 5 6 7        ", "has 7 numbers", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\n\n1 2 3 4 5 6 7 256", "'256'", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\n\n1 2 -3 4 5 6 7 8", "'-3'", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\n\n1 2 3.5 4 5 6 7 8", "'3.5'", STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\ntype: ulonglong\n\n1 2 3 4 5 6 7 9007199254740993", "double",
         STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\ntype: longlong\n\n1 2 3 4 5 6 7 9223372036854775807", "double",
         STATUS_INPUT},
        {"a.nrrd", NRRD_222 "encoding: ascii\ntype: ulonglong\n\n1 2 3 4 5 6 7 18446744073709551615", "double",
         STATUS_INPUT},
    };
    test_texts(cases, sizeof cases / sizeof *cases);
}

static void test_data_files(void) {
    file_text("8.raw", EIGHT);
    static const text_case cases[] = {
        {"d.nhdr", NRRD_222 "data file: /etc/passwd\n", "no absolute path", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: ../8.raw\n", "'..'", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: a/../../8.raw\n", "'..'", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: ..\n", "'..'", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: .\n", "not a regular file", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: none.raw\n", "none.raw", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file:\n", "0 characters", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: LIST\n", "no name follows", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: LIST\n8.raw\n../8.raw\n", "'..'", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: LIST x\n8.raw\n", "list", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: LIST 9\n8.raw\n8.raw\n", "1 to 3", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: LIST 0\n8.raw\n8.raw\n", "1 to 3", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: LIST 3\n8.raw\n8.raw\n8.raw\n", "evenly", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: LIST\n8.raw\n8.raw\n8.raw\n", "sizes ask for 2", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %d%d 1 2 1\n", "one %d", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %s 1 2 1\n", "one %d", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %n%d 1 2 1\n", "one %d", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %999999999d 1 2 1\n", "one %d", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %*d 1 2 1\n", "one %d", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %d 1\n", "one %d", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %d 1 2 0\n", "none or too many", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %d 2 1 1\n", "none or too many", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %d 0 9000000000000000000 1\n", "none or too many", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %d -9223372036854775808 9223372036854775807 -1\n", "none or too many",
         STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: ../%d 1 2 1\n", "'..'", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "data file: %d 5 4 -1\n", "/5", STATUS_INPUT},
        {"d.nhdr", NRRD_222 "sizes: 3 3 3\ndata file: 8.raw\n", "asks for 27", STATUS_INPUT},
        {"d.mhd", "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = ../8.raw\n", "'..'",
         STATUS_INPUT},
        {"d.mhd", "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = LIST 1\n8.raw\n8.raw\n",
         "sizes ask for 4", STATUS_INPUT},
        {"d.mhd", "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementDataFile = LIST 3D x\n8.raw\n", "list",
         STATUS_INPUT},
    };
    test_texts(cases, sizeof cases / sizeof *cases);
}

#define META  "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"
#define LOCAL "ElementDataFile = LOCAL\n"

static void test_metaimage(void) {
    static const text_case cases[] = {
        {"a.mha", "", "ElementDataFile", STATUS_INPUT},
        {"a.mha", META, "ElementDataFile", STATUS_INPUT},
        {"a.mha", "NDims = 3\nnonsense\n", "KEY = VALUE", STATUS_INPUT},
        {"a.mha", "DimSize = 2 2 2\nElementType = MET_UCHAR\n" LOCAL EIGHT, "NDims", STATUS_INPUT},
        {"a.mha", "NDims = 11\n", "1 to 10", STATUS_INPUT},
        {"a.mha", "NDims = 3\nDimSize = 2 2\nElementType = MET_UCHAR\n" LOCAL EIGHT, "DimSize has 2 values",
         STATUS_INPUT},
        {"a.mha", "NDims = 3\nDimSize = 2 2 2.5\nElementType = MET_UCHAR\n" LOCAL EIGHT, "2.5", STATUS_INPUT},
        {"a.mha", "NDims = 3\nDimSize = 2 2 2\n" LOCAL EIGHT, "ElementType", STATUS_INPUT},
        {"a.mha", "NDims = 3\nDimSize = 2 2 2\nElementType = MET_STRING\n" LOCAL EIGHT, "MET_STRING", STATUS_INPUT},
        {"a.mha", "NDims = 3\nDimSize = 2 2 -2\nElementType = MET_UCHAR\n" LOCAL EIGHT, "at least 1", STATUS_INPUT},
        {"a.mha", "NDims = 3\nDimSize = 9 9 9\nElementType = MET_UCHAR\n" LOCAL EIGHT, "asks for 729", STATUS_INPUT},
        {"a.mha", META "ElementNumberOfChannels = 0\n" LOCAL EIGHT, "Channels", STATUS_INPUT},
        {"a.mha", META "ElementNumberOfChannels = 2\n" LOCAL EIGHT EIGHT, "--component 0 to 1", STATUS_USAGE},
        {"a.mha", META "ElementSpacing = 1 0 1\n" LOCAL EIGHT, "axis 2", STATUS_INPUT},
        {"a.mha", META "ElementSpacing = 1 1 x\n" LOCAL EIGHT, "numbers are needed", STATUS_INPUT},
        {"a.mha", META "ElementSpacing = nan 1 1\n" LOCAL EIGHT, "axis 1", STATUS_INPUT},
        {"a.mha", META "ElementSpacing = 1 1\n" LOCAL EIGHT, "NDims", STATUS_INPUT},
        {"a.mha", META "Offset = 1 inf 1\n" LOCAL EIGHT, "finite", STATUS_INPUT},
        {"a.mha", META "TransformMatrix = 1 0 0 0 1 0\n" LOCAL EIGHT, "NDims", STATUS_INPUT},
        {"a.mha", META "TransformMatrix = 1 0 0 0 1 0 0 0 0\n" LOCAL EIGHT, "only zeros for axis 3", STATUS_INPUT},
        {"a.mha", META "TransformMatrix = 1 0 0 0 1 0 1 1 0\n" LOCAL EIGHT, "determinant", STATUS_INPUT},
        {"a.mha", META "HeaderSize = -2\n" LOCAL EIGHT, "HeaderSize", STATUS_INPUT},
        {"a.mha", META "HeaderSize = 1000\n" LOCAL EIGHT, "behind", STATUS_INPUT},
        {"a.mha", META "HeaderSize = 10\n" LOCAL EIGHT, "ends within the header", STATUS_INPUT},
        {"a.mha", META "CompressedData = True\nHeaderSize = -1\n" LOCAL EIGHT, "HeaderSize", STATUS_INPUT},
        {"a.mha", META "CompressedData = True\n" LOCAL EIGHT, "damaged", STATUS_INPUT},
        {"a.mha", META "CompressedData = True\nBinaryData = False\n" LOCAL EIGHT, "characters of text", STATUS_INPUT},
    };
    test_texts(cases, sizeof cases / sizeof *cases);
}

/* The status is that of a bad file, unless the text asks for an option. */
static void expect_nifti_failure(const char *what, const nifti_fields *f, size_t extra, const char *part) {
    bytes file = nifti_header_bytes(f);
    for (size_t i = 0; i < extra; i++) bytes_put(&file, i, 1, 0);
    read_request r = request_for(file_write("a.nii", file.data, file.size));
    expect_failure(what, &r, strstr(part, "--") ? STATUS_USAGE : STATUS_INPUT, part);
    bytes_free(&file);
}

static void test_nifti(void) {
    for (int version = 1; version <= 2; version++) {
        const nifti_fields good = nifti_plain(version, 2, 8, 2, 2, 2);
        nifti_fields f;
        static const int64_t bad_counts[] = {0, -1, 8, 32767};
        for (int i = 0; i < 4; i++) {
            f = good;
            f.dim[0] = bad_counts[i];
            expect_nifti_failure("dim[0]", &f, 8, "dimensions");
        }
        for (int i = 1; i <= 3; i++) {
            f = good;
            f.dim[i] = -1;
            expect_nifti_failure("a negative size", &f, 8, "at least 1");
            f.dim[i] = 32767;
            expect_nifti_failure("an absurd size", &f, 8, "asks for");
        }
        f = good;
        f.dim[0] = 7;
        for (int i = 1; i <= 7; i++) f.dim[i] = 32767;
        expect_nifti_failure("sizes that overflow", &f, 8, "2^64");
        f = good;
        f.dim[0] = 4;
        f.dim[4] = 2;
        expect_nifti_failure("frames", &f, 16, "--frame 0 to 1");
        static const struct {
            int datatype;
            const char *part;
        } types[] = {{0, "type 0"},
                     {1, "type 1"},
                     {1536, "FLOAT128"},
                     {2048, "COMPLEX256"},
                     {77, "type 77"},
                     {128, "red, green, blue); choose one with --component 0 to 2"},
                     {32, "real, imaginary); choose one with --component 0 to 1"}};
        for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
            f = good;
            f.datatype = types[i].datatype;
            expect_nifti_failure("data type", &f, 256, types[i].part);
        }
        static const double offsets[] = {-1, 1e6, 1e18};
        for (int i = 0; i < 3; i++) {
            f = good;
            f.vox_offset = offsets[i];
            expect_nifti_failure("vox_offset", &f, 8, i ? "behind" : "vox_offset");
        }
        f = good;
        f.qform = 1;
        f.quatern[0] = 1e200;
        if (version == 2) expect_nifti_failure("a qform beyond all numbers", &f, 8, "correct");
        f = good;
        f.magic = "xx";
        expect_nifti_failure("magic", &f, 8, "does not begin");
        f.magic = "ni";
        expect_nifti_failure("half of a pair", &f, 0, ".img file is missing");
        f = nifti_plain(version, 1024, 64, 2, 2, 1);
        f.dim[0] = 1;
        f.dim[1] = 1;
        bytes file = nifti_header_bytes(&f);
        bytes_put(&file, (UINT64_C(1) << 53) + 1, 8, 0);
        read_request r = request_for(file_write("a.nii", file.data, file.size));
        expect_failure("2^53 + 1", &r, STATUS_INPUT, "double");
        bytes_free(&file);
    }
    nifti_fields f = nifti_plain(1, 2, 8, 2, 2, 2);
    f.vox_offset = NAN;
    expect_nifti_failure("vox_offset", &f, 8, "vox_offset");
    f = nifti_plain(2, 2, 8, INT64_MAX, INT64_MAX, 2);
    expect_nifti_failure("sizes that overflow", &f, 8, "2^64");
    f.dim[1] = INT64_MIN;
    expect_nifti_failure("a negative size", &f, 8, "at least 1");
}

/* The first one that is not there. */
static void test_choices_beyond(void) {
    read_request r = request_for(file_text("a.nrrd", NRRD_222 "kinds: vector domain domain\n\n" EIGHT));
    r.component = 2;
    expect_failure("component 2 of 2", &r, STATUS_USAGE, "--component 0 to 1");
    r = request_for(file_text("a.nrrd", NRRD_222 "kinds: time domain domain\n\n" EIGHT));
    r.frame = 2;
    expect_failure("frame 2 of 2", &r, STATUS_USAGE, "--frame 0 to 1");
}

static void test_raw(void) {
    const char *path = file_text("a.raw", EIGHT);
    read_request good = request_for(path), r = good;
    expect_failure("nothing given", &r, STATUS_USAGE, "--dims");
    for (int i = 0; i < 3; i++) good.dims[i] = 2;
    good.type = TC_U8;
    read_image v;
    EXPECT(image_read(&good, &v) == 0, "the good one: %s", failure_text());
    image_release(&v);
    r = good;
    r.type = -1;
    expect_failure("no type", &r, STATUS_USAGE, "--type");
    r = good;
    memset(r.dims, 0, sizeof r.dims);
    expect_failure("no dims", &r, STATUS_USAGE, "--dims");
    r = good;
    r.dims[1] = -2;
    expect_failure("negative dims", &r, STATUS_USAGE, "at least 1");
    r = good;
    r.dims[2] = 3;
    expect_failure("too short", &r, STATUS_INPUT, "8 bytes long");
    expect_failure("too short", &r, STATUS_INPUT, "0 + 12");
    r.dims[2] = 1;
    expect_failure("too long", &r, STATUS_INPUT, "0 + 4");
    r = good;
    r.skip = 1;
    expect_failure("skip", &r, STATUS_INPUT, "1 + 8");
    r.skip = UINT64_MAX;
    expect_failure("skip that overflows", &r, STATUS_INPUT, "bytes long");
    r = good;
    r.dims[0] = r.dims[1] = r.dims[2] = INT64_MAX;
    expect_failure("dims that overflow", &r, STATUS_INPUT, "2^64");
    r = good;
    r.spacing[1] = 0;
    expect_failure("spacing", &r, STATUS_USAGE, "--spacing");
    r = good;
    r.origin[1] = NAN;
    expect_failure("origin", &r, STATUS_USAGE, "--origin");
    r = good;
    r.component = 1;
    expect_failure("component", &r, STATUS_USAGE, "--component");
    r = good;
    r.frame = 2;
    expect_failure("frame", &r, STATUS_USAGE, "--frame");
}

static void test_other_files(void) {
    static const text_case cases[] = {
        {"a.vtk", "# vtk DataFile Version 3.0\n", "ends where ASCII or BINARY", STATUS_INPUT},
        {"a.vti", "<?xml version=\"1.0\"?>\n", "no element found", STATUS_INPUT},
        {"noending", "x", "--dims", STATUS_INPUT},
        {"a.nii", "abc", "cut or no NIfTI", STATUS_INPUT},
        {"a.nii.gz", "short and not packed", "cut or no NIfTI", STATUS_INPUT},
    };
    test_texts(cases, sizeof cases / sizeof *cases);
    read_request r = request_for(file_path("missing.nrrd"));
    expect_failure("a missing file", &r, STATUS_INPUT, "No such file");
    r = request_for(folder);
    expect_failure("a folder", &r, STATUS_INPUT, tiff_format->read ? "folder without slices" : "not a regular file");
    mkfifo(file_path("pipe.nrrd"), 0600);
    r = request_for(file_text("pipe.nhdr", NRRD_222 "data file: pipe.nrrd\n"));
    expect_failure("a pipe as a data file", &r, STATUS_INPUT, "not a regular file");

    size_t size = 40000;
    char *text = malloc(size + 1);
    memset(text, 'a', size);
    text[size] = 0;
    memcpy(text, "NRRD0001\n", 9);
    r = request_for(file_text("a.nrrd", text));
    expect_failure("a line without end", &r, STATUS_INPUT, "too long");
    free(text);
    r = request_for(file_write("a.nrrd", "NRRD0001\nty\0pe: x\n\n", 19));
    expect_failure("a zero byte", &r, STATUS_INPUT, "not text");
}

/* UTF-16 with and without its mark, in both byte orders, and marks of UTF-8; samples may begin with any bytes. */
static void test_encodings(void) {
    static const char *const texts[] = {"<?xml version=\"1.0\"?>", "NRRD0004\n", "# vtk DataFile Version 3.0\n",
                                        "ObjectType = Image\n", "2 2 2\n1 2 3"};
    static const char *const names[] = {"a.vti", "a.nrrd", "a.vtk", "a.mha", "a.xyz"};
    for (size_t n = 0; n < sizeof texts / sizeof *texts; n++)
        for (int form = 0; form < 4; form++) {
            const int has_mark = form < 2, big = form % 2;
            bytes b = {0};
            if (!has_mark && *texts[n] != '<') continue;
            if (has_mark) bytes_put(&b, 0xfeff, 2, big);
            for (const char *c = texts[n]; *c; c++) bytes_put(&b, (uint64_t)*c, 2, big);
            read_request r = request_for(file_write(names[n], b.data, b.size));
            expect_failure(names[n], &r, STATUS_INPUT, "UTF-16");
            r.dims[0] = (int64_t)b.size;
            r.dims[1] = r.dims[2] = 1;
            r.type = TC_U8;
            read_image v;
            EXPECT(!image_read(&r, &v), "%s as raw: %s", names[n], failure_text());
            image_release(&v);
            bytes_free(&b);
        }
    read_request r = request_for(file_text("a.nrrd", "\xef\xbb\xbf" NRRD_222 "\n" EIGHT));
    expect_failure("a mark", &r, STATUS_INPUT, "EF BB BF");
    r = request_for(file_text("a.vtk", "\xef\xbb\xbf# vtk DataFile Version 3.0\n"));
    expect_failure("a mark", &r, STATUS_INPUT, "EF BB BF");
    r = request_for(file_write("a.xyz", "\xff\xfe\0\0\0\0\0\0", 8));
    expect_failure("no text", &r, STATUS_INPUT, "Plot3D");
}

/* A file cut after any byte, or with any one byte changed, is refused or read; it never does harm. */
static void test_every_byte(const char *name, const bytes *file, int is_strict) {
    for (size_t size = 0; size < file->size; size++) {
        read_image v;
        read_request r = request_for(file_write(name, file->data, size));
        int status = image_read(&r, &v);
        EXPECT(status == STATUS_INPUT || (!is_strict && status == 0), "%s cut to %zu of %zu bytes: status %d, %s", name,
               size, file->size, status, failure_text());
        EXPECT(status == 0 || is_zero(&v), "%s cut to %zu bytes: not zeroed", name, size);
        image_release(&v);
    }
    static const unsigned char changes[] = {0x01, 0x10, 0x80, 0xff};
    for (size_t i = 0; i < file->size; i++)
        for (size_t c = 0; c < sizeof changes; c++) {
            read_image v;
            file->data[i] ^= changes[c];
            read_request r = request_for(file_write(name, file->data, file->size));
            int status = image_read(&r, &v);
            EXPECT(status == 0 || status == STATUS_INPUT || status == STATUS_FAILED,
                   "%s with byte %zu changed: status %d", name, i, status);
            for (int64_t n = 0; !status && n < v.dims[0] * v.dims[1] * v.dims[2]; n++)
                (void)image_value(&v, (uint64_t)n);
            image_release(&v);
            file->data[i] ^= changes[c];
        }
}

static void test_bytes(void) {
    bytes samples = test_samples(TC_I16, 24, 0);
    bytes gzip = gzipped(samples.data, samples.size, AS_GZIP), bzip2 = bzipped(samples.data, samples.size);
    const bytes *parts[] = {&samples, &gzip, &bzip2};
    static const char *const names[] = {"raw", "gzip", "bzip2"};
    for (int i = 0; i < 3; i++) {
        bytes file = {0};
        bytes_text(&file,
                   "NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\nendian: little\nencoding: %s\nspace "
                   "directions: (1,0,0) (0,1,0) (0,0,1)\nkinds: domain domain domain\n\n",
                   names[i]);
        bytes_add(&file, parts[i]->data, parts[i]->size);
        test_every_byte("a.nrrd", &file, 1);
        bytes_free(&file);
    }
    for (int packed = 0; packed < 2; packed++) {
        bytes file = {0};
        bytes_text(&file, "NDims = 3\nDimSize = 4 3 2\nElementType = MET_SHORT\n%sElementSpacing = 1 2 3\n" LOCAL,
                   packed ? "CompressedData = True\n" : "");
        bytes_add(&file, parts[packed]->data, parts[packed]->size);
        test_every_byte("a.mha", &file, 1);
        bytes_free(&file);
    }
    for (int kind = 0; kind < 8; kind++) { /* version, byte order, gzip */
        nifti_fields f = nifti_plain(1 + (kind & 1), 4, 16, 4, 3, 2);
        f.big = kind >> 1 & 1;
        f.qform = 1;
        bytes file = nifti_header_bytes(&f);
        bytes_add(&file, samples.data, samples.size);
        bytes packed = gzipped(file.data, file.size, AS_GZIP);
        test_every_byte(kind & 4 ? "a.nii.gz" : "a.nii", kind & 4 ? &packed : &file, 1);
        bytes_free(&file);
        bytes_free(&packed);
    }
    bytes_free(&samples);
    bytes_free(&gzip);
    bytes_free(&bzip2);
}

int main(void) {
    folder_make("read-hostile");
    test_nrrd_header();
    test_nrrd_axes();
    test_nrrd_skips();
    test_nrrd_data();
    test_data_files();
    test_metaimage();
    test_nifti();
    test_choices_beyond();
    test_raw();
    test_other_files();
    test_encodings();
    test_bytes();
    folder_remove();
    return EXPECT_DONE();
}
