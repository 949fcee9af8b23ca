/*
 * test_read_lenient.c - images as programs write them, approximate where their readers are: each is read as ITK,
 * nibabel or pynrrd read it, with a notice where something was taken for something else
 */
#include "read_files.h"

enum { COUNT = 60 };

static expected plain(int type, const double *matrix) {
    return (expected){.stored = type, .dims = {5, 4, 3}, .matrix = matrix};
}

/* notice: a part of it; NULL: there must be none. */
static void expect_noticed(const char *what, const read_request *request, const expected *e, const char *notice) {
    read_image v;
    expect_volume(what, request, e);
    if (image_read(request, &v)) return;
    EXPECT(notice ? strstr(v.d.notice, notice) != NULL : !*v.d.notice, "%s: notice '%s'", what, v.d.notice);
    image_release(&v);
}

/* ------------------------------------------------------------------------------------------------------------ NRRD */

#define NRRD_U8 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: raw\n"

typedef struct header_case {
    const char *header, *notice;
    double matrix[12];
} header_case;

static void check_headers(const char *name, const header_case *cases, size_t count) {
    bytes samples = test_samples(TC_U8, COUNT, 0);
    for (size_t n = 0; n < count; n++) {
        read_request r = request_for(file_behind(name, cases[n].header, &samples));
        expected e = plain(TC_U8, cases[n].matrix);
        expect_noticed(cases[n].header, &r, &e, cases[n].notice);
    }
    bytes_free(&samples);
}

static void test_nrrd_headers(void) {
    static const header_case cases[] = {
        {NRRD_U8 "spacings: nan nan 2\n\n", "axis 2 is not known", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0}},
        {NRRD_U8 "spacings: 2 2 2\naxis mins: nan 2 3\n\n",
         "minimum of axis 1 is not known",
         {2, 0, 0, 0, 0, 2, 0, 3, 0, 0, 2, 4}},
        {NRRD_U8 "spacings: nan 4 2\naxis mins: 0 nan nan\naxis maxs: 10 nan nan\n\n",
         "minimum of axis 3",
         {2, 0, 0, 1, 0, 4, 0, 0, 0, 0, 2, 0}},
        {NRRD_U8 "space: RAS\nspacedirections: (2,0,0) (0,3,0) (0,0,4)\nspaceorigin: (5,6,7)\n\n",
         NULL,
         {2, 0, 0, 5, 0, 3, 0, 6, 0, 0, 4, 7}},
        {NRRD_U8 "space: RAS\nspace directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (nan,nan,nan)\n\n",
         "origin is not known",
         {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0}},
        {"NRRD00.01\r\ntype: uchar\r\nsizes:   5 4\t3\r\nspacings: 1 2 3\r\ndimension: 3\r\nencoding:raw\r\n\r\n",
         NULL,
         {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0}},
        {"NRRD0005\ntype:uchar\ndimension:3\nsizes:5 4 3\nencoding:raw\nkinds: x-axis ??? space\nmy: own\n\n",
         NULL,
         {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {NRRD_U8 "space: RAS\nspace directions: none none none\n\n",
         "none of its space directions is known",
         {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {NRRD_U8 "space: RAS\nspace directions: (nan,nan,nan) none none\nspace origin: (7,8,9)\n\n",
         "spacing is taken for 1",
         {1, 0, 0, 7, 0, 1, 0, 8, 0, 0, 1, 9}},
        {NRRD_U8 "space directions: none none none\nspacings: 2 3 4\n\n", NULL, {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0}},
    };
    check_headers("a.nrrd", cases, sizeof cases / sizeof *cases);
}

/* What stands twice is taken as it stands last, with a notice. */
static void test_repeated(void) {
    static const header_case nrrd[] = {
        {NRRD_U8 "spacings: 1 1 1\nspacings: 2 3 4\n\n",
         "'spacings' twice: the last",
         {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0}},
        {NRRD_U8 "dimension: 2\n\n", "'dimension' twice: the first", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {NRRD_U8 "content: a\ncontent: b\n\n", NULL, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}};
    static const header_case meta[] = {
        {"NDims = 3\nDimSize = 5 4 3\nElementSpacing = 1 1 1\nelementspacing = 2 3 4\nElementType = MET_UCHAR\n"
         "Comment = a\nComment = b\nElementDataFile = LOCAL\n",
         "'ElementSpacing' twice: the last",
         {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0}}};
    check_headers("a.nrrd", nrrd, sizeof nrrd / sizeof *nrrd);
    check_headers("a.mha", meta, sizeof meta / sizeof *meta);
}

/* Axes that are none of space, told by NaN alone. */
static void test_nrrd_outside(void) {
    static const struct {
        const char *fields;
        int component, frame;
        uint64_t offset, stride;
    } cases[] = {
        {"sizes: 3 5 4 3\nspace: RAS\nspace directions: (nan,nan,nan) (1,0,0) (0,1,0) (0,0,1)\n", 1, -1, 1, 3},
        {"sizes: 3 5 4 3\nspacings: nan 1 1 1\n", 2, -1, 2, 3},
        {"sizes: 5 4 3 3\nspacings: 1 1 1 NaN\n", -1, 1, 60, 1},
        {"sizes: 3 5 4 3\nspacings: nan 1 1 1\nkinds: list domain domain domain\n", 0, -1, 0, 3},
    };
    bytes samples = test_samples(TC_U8, 3 * (uint64_t)COUNT, 0);
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        char header[512];
        snprintf(header, sizeof header, "NRRD0005\ntype: uchar\ndimension: 4\nencoding: raw\n%s\n", cases[n].fields);
        read_request r = request_for(file_behind("a.nrrd", header, &samples));
        expected e = {.stored = TC_U8, .dims = {5, 4, 3}, .offset = cases[n].offset, .stride = cases[n].stride};
        r.component = cases[n].component;
        r.frame = cases[n].frame;
        expect_noticed(cases[n].fields, &r, &e, NULL);
    }
    bytes_free(&samples);
}

static bytes hex_text(const bytes *samples) {
    bytes text = {0};
    for (size_t n = 0; n < samples->size; n++)
        bytes_text(&text, n % 3 ? "%02x" : n % 2 ? " %02X\n" : "%02X", samples->data[n]);
    return text;
}

static void test_nrrd_hex(void) {
    for (int big = 0; big < 2; big++) {
        bytes samples = test_samples(TC_I16, COUNT, big), text = hex_text(&samples);
        char header[256];
        snprintf(header, sizeof header,
                 "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 3\nendian: %s\nencoding: %s\n\n",
                 big ? "big" : "little", big ? "HEX" : "hex");
        read_request r = request_for(file_behind("a.nrrd", header, &text));
        expected e = plain(TC_I16, NULL);
        expect_noticed("hexadecimal", &r, &e, NULL);
        bytes_text(&text, " 0");
        r = request_for(file_behind("a.nrrd", header, &text));
        expect_noticed("hexadecimal, with more behind it", &r, &e, "more data");
        bytes_free(&samples);
        bytes_free(&text);
    }
}

/* Whole numbers of text may have a point. */
static void test_nrrd_text(void) {
    bytes text = {0};
    for (uint64_t n = 0; n < COUNT; n++) bytes_text(&text, n % 2 ? "%.1f " : "%.17e\n", test_value(TC_I16, n));
    read_request r = request_for(
        file_behind("a.nrrd", "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 3\nencoding: ascii\n\n", &text));
    expected e = plain(TC_I16, NULL);
    expect_noticed("integers with a point", &r, &e, NULL);
    bytes_free(&text);
}

/* Data at the end of what streams unpack to, and some bytes before their end. */
static void test_nrrd_byte_skip(void) {
    static const char *const encodings[] = {"raw", "gzip", "bzip2"};
    static const char behind[] = "and behind";
    for (int encoding = 0; encoding < 3; encoding++)
        for (int more = 0; more < 3; more++) { /* nothing behind, something, in two members */
            size_t length = more ? strlen(behind) : 0;
            char header[256];
            bytes inner = {0}, samples = test_samples(TC_U8, COUNT, 0);
            bytes_text(&inner, "before the data");
            bytes_add(&inner, samples.data, samples.size);
            bytes_add(&inner, behind, length);
            size_t cut = more == 2 ? 30 : inner.size;
            bytes file = {0}, parts[2] = {{0}, {0}};
            for (int n = 0; n < 2 && (!n || cut < inner.size); n++) {
                const unsigned char *at = inner.data + (n ? cut : 0);
                size_t size = n ? inner.size - cut : cut;
                if (encoding == 0) bytes_add(&parts[n], at, size);
                if (encoding == 1) parts[n] = gzipped(at, size, AS_GZIP);
                if (encoding == 2) parts[n] = bzipped(at, size);
                bytes_add(&file, parts[n].data, parts[n].size);
            }
            file_write("d.raw", file.data, file.size);
            snprintf(header, sizeof header,
                     "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: %s\nbyte skip: %d\ndata file: "
                     "d.raw\n",
                     encodings[encoding], -1 - (int)length);
            read_request r = request_for(file_text("d.nhdr", header));
            expected e = plain(TC_U8, NULL);
            expect_noticed(header, &r, &e, NULL);
            bytes_free(&inner);
            bytes_free(&samples);
            bytes_free(&file);
            bytes_free(&parts[0]);
            bytes_free(&parts[1]);
        }
}

/* Data files by list and by pattern, of every number of axes; each with a line, then two bytes before its part. */
static void test_nrrd_lists(void) {
    static const struct {
        const char *sizes, *files;
        int parts, is_reversed;
    } cases[] = {
        {"5 4 3", "data file: LIST\nc0.raw\nc1.raw\nc2.raw", 3, 0},
        {"5 4 3", "datafile: LIST\r\n./c0.raw  \r\nc1.raw\r\n\r\nc2.raw\r\n", 3, 0},
        {"5 4 3", "data file: LIST 2\nc0.raw\nc1.raw\nc2.raw\n", 3, 0},
        {"5 4 3", "data file:\tLIST 3\nc0.raw\nc1.raw\nc2.raw\n", 3, 0},
        {"5 4 3",
         "data file: LIST 1\nc0.raw\nc1.raw\nc2.raw\nc3.raw\nc4.raw\nc5.raw\nc6.raw\nc7.raw\nc8.raw\nc9.raw\n"
         "c10.raw\nc11.raw\n",
         12, 0},
        {"5 4 3", "data file: c%d.raw 0 2 1", 3, 0},
        {"5 4 3", "data file: c%d.raw 0 2 1 2\n", 3, 0},
        {"5 4 3", "data file: c%d.raw 0 11 1 1\n", 12, 0},
        {"5 4 3", "data file: c%d.raw 0 2 1 3\n", 3, 0},
        {"5 4 3", "data file: c%d.raw 2 0 -1\n", 3, 1},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        bytes samples = test_samples(TC_U8, COUNT, 0);
        size_t size = samples.size / (size_t)cases[n].parts;
        for (int part = 0; part < cases[n].parts; part++) {
            bytes file = {0};
            char name[32];
            int place = cases[n].is_reversed ? cases[n].parts - 1 - part : part;
            snprintf(name, sizeof name, "c%d.raw", part);
            bytes_text(&file, "line\nxy");
            bytes_add(&file, samples.data + (size_t)place * size, size);
            file_write(name, file.data, file.size);
            bytes_free(&file);
        }
        char header[1024];
        snprintf(header, sizeof header,
                 "NRRD0004\ntype: uchar\ndimension: 3\nsizes: %s\nencoding: raw\nline skip: 1\nbyteskip: 2\n%s",
                 cases[n].sizes, cases[n].files);
        read_request r = request_for(file_text("d.nhdr", header));
        expected e = plain(TC_U8, NULL);
        expect_noticed(header, &r, &e, NULL);
        bytes_free(&samples);
    }
    bytes samples = test_samples(TC_U8, COUNT, 0);
    file_write("50% x.raw", samples.data, samples.size);
    read_request r = request_for(file_text("d.nhdr", "NRRD0004\ndata file: 50% x.raw\ntype: uchar\ndimension: 3\n"
                                                     "sizes: 5 4 3\nencoding: raw\n"));
    expected e = plain(TC_U8, NULL);
    expect_noticed("a name with a percent sign, before the dimension", &r, &e, NULL);
    bytes_free(&samples);
}

/* Masks that are nearly empty: bzip2 packs them more than a million times. */
static void test_packed_masks(void) {
    enum { SIDE = 200 };
    size_t size = (size_t)SIDE * SIDE * SIDE;
    unsigned char *mask = calloc(size, 1);
    mask[size / 2] = 1;
    for (int bzip2 = 0; bzip2 < 2; bzip2++) {
        bytes packed = bzip2 ? bzipped(mask, size) : gzipped(mask, size, AS_GZIP);
        char header[256];
        snprintf(header, sizeof header, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: %d %d %d\nencoding: %s\n\n", SIDE,
                 SIDE, SIDE, bzip2 ? "bzip2" : "gzip");
        read_request r = request_for(file_behind("m.nrrd", header, &packed));
        read_image v;
        int status = image_read(&r, &v);
        EXPECT(status == 0 && !memcmp(v.samples, mask, size), "a mask of %zu packed bytes: %s", packed.size,
               failure_text());
        image_release(&v);
        bytes_free(&packed);
    }
    free(mask);
}

/* ------------------------------------------------------------------------------------------------------- MetaImage */

#define META  "ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementType = MET_UCHAR\n"
#define LOCAL "ElementDataFile = LOCAL\n"
#define IS_ONE                                                                                                         \
    { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 }

static void test_metaimage(void) {
    static const header_case cases[] = {
        {META "ElementSpacing = 2 3 4 5\n" LOCAL, "ElementSpacing has 4 values", {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0}},
        {META "Offset = 1 2 3 4\n" LOCAL, "Offset has 4 values", {1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 1, 3}},
        {META "TransformMatrix = 0 1 0 9 1 0 0 9 0 0 1 9 9 9 9 9\n" LOCAL,
         "TransformMatrix has 16",
         {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}},
        {META "TransformMatrix = 0 1 0\n 1 0 0\n 0 0 1\n" LOCAL, NULL, {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}},
        {META "ElementSpacing = 1 -2 1\n" LOCAL, NULL, {1, 0, 0, 0, 0, -2, 0, 0, 0, 0, 1, 0}},
        {META "Position = 1 2 3\nOffset = 4 5 6\nOrigin = 7 8 9\n" LOCAL, NULL, {1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6}},
        {META "Orientation = 0 1 0 1 0 0 0 0 1\n" LOCAL, NULL, {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}},
        {"ObjectType: Image\nNDims: 3\nDimSize: 5 4 3\nElementType: MET_UCHAR\nElementDataFile: LOCAL\n", NULL, IS_ONE},
        {"ndims=3\nDIMSIZE = 5.0 4.0 3.0\nelementtype = met_uchar\nElementdatafile = Local\n", NULL, IS_ONE},
        {"OBJECTTYPE = Image\r\nNDims = 3\r\nDimSize = 5 4 3\r\nElementType = MET_UCHAR\r\nComment = a: b = c\r\n"
         "ElementDataFile = LOCAL\r\n",
         NULL, IS_ONE},
        {"ObjectType = Image\nNDims = 5\nDimSize = 5 4 3 1 1\nElementType = MET_UCHAR\n" LOCAL, NULL, IS_ONE},
        {"NDims = 3\nDimSize = 5 4 3 9\nElementType = MET_UCHAR_ARRAY\nElementNumberOfChannels = 1\n" LOCAL,
         "DimSize has 4", IS_ONE},
    };
    check_headers("a.mha", cases, sizeof cases / sizeof *cases);
    static const header_case flat[] = {{"NDims = 2\nDimSize = 20 3\nTransformMatrix = 0 1 0 1 0 0 0 0 1\nElementType = "
                                        "MET_UCHAR\n" LOCAL,
                                        "TransformMatrix has 9",
                                        {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}}};
    bytes samples = test_samples(TC_U8, COUNT, 0);
    read_request r = request_for(file_behind("a.mha", flat[0].header, &samples));
    expected e = {.stored = TC_U8, .dims = {20, 3, 1}, .matrix = flat[0].matrix};
    expect_noticed("a matrix for three axes of two", &r, &e, flat[0].notice);
    bytes_free(&samples);
}

/* HeaderSize counts from the file's begin; the order of bytes has two keys, of which one goes before the other; text is
 * never packed; a list of files may be longer than the sizes. */
static void test_metaimage_data(void) {
    bytes samples = test_samples(TC_I16, COUNT, 1), text = {0}, file = {0};
    static const char order[] = "NDims = 3\nDimSize = 5 4 3\nElementType = MET_SHORT\nElementByteOrderMSB = True\n"
                                "BinaryDataByteOrderMSB = False\n";
    expected e = plain(TC_I16, NULL);
    char header[512];
    for (int n = 0; n < 3; n++) { /* at the header's end, behind bytes that are none, at the file's end */
        int length = snprintf(header, sizeof header, "%sHeaderSize = %3d\n" LOCAL, order, 0), padding = n ? 7 : 0;
        snprintf(header, sizeof header, "%sHeaderSize = %3d\n" LOCAL, order, n == 2 ? -1 : length + padding);
        bytes_add(&file, "padding", (size_t)padding);
        bytes_add(&file, samples.data, samples.size);
        read_request r = request_for(file_behind("a.mha", header, &file));
        expect_noticed(header, &r, &e, NULL);
        bytes_free(&file);
    }
    for (uint64_t n = 0; n < COUNT; n++) bytes_text(&text, "%.0f ", test_value(TC_I16, n));
    snprintf(header, sizeof header, "%sBinaryData = False\nCompressedData = True\n" LOCAL, order);
    read_request r = request_for(file_behind("a.mha", header, &text));
    expect_noticed("text that is said to be packed", &r, &e, NULL);
    for (int n = 0; n < 4; n++) {
        char name[16];
        snprintf(name, sizeof name, "m%d.raw", n);
        file_write(name, samples.data + (n % 3) * 40, 40);
    }
    snprintf(header, sizeof header, "%sElementDataFile = list\nm0.raw\nm1.raw\nm2.raw\nm3.raw\n", order);
    r = request_for(file_text("a.mhd", header));
    expect_noticed("a list of four files for three", &r, &e, "names 4 data files");
    bytes_free(&samples);
    bytes_free(&text);
}

/* --------------------------------------------------------------------------------------------------- NIfTI, Analyze */

/* The header, so many bytes of padding, the samples. */
static const char *write_nifti(const char *name, const nifti_fields *f, size_t padding, int is_packed) {
    bytes file = nifti_header_bytes(f), samples = test_samples(TC_I16, COUNT, f->big);
    file.size -= 4;
    bytes_add(&file, "paddingpaddingpadding", padding);
    bytes_add(&file, samples.data, samples.size);
    bytes packed = gzipped(file.data, file.size, AS_GZIP);
    const char *path = file_write(name, is_packed ? packed.data : file.data, is_packed ? packed.size : file.size);
    bytes_free(&file);
    bytes_free(&samples);
    bytes_free(&packed);
    return path;
}

static const double ones[12] = IS_ONE, sizes_234[12] = {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0},
                    turned[12] = {-2, 0, 0, 5, 0, -3, 0, 6, 0, 0, 4, 7};

static nifti_fields nifti_234(int version) {
    nifti_fields f = nifti_plain(version, 4, 16, 5, 4, 3);
    for (int n = 0; n < 3; n++) f.pixdim[n + 1] = n + 2;
    f.quatern[2] = 1;
    for (int n = 0; n < 3; n++) f.qoffset[n] = n + 5;
    return f;
}

static void check_nifti(const char *what, const nifti_fields *f, const double *matrix, const char *notice) {
    expected e = plain(TC_I16, matrix);
    for (int packed = 0; packed < 2; packed++) {
        read_request r = request_for(write_nifti(packed ? "a.nii.gz" : "a.nii", f, 4, packed));
        expect_noticed(what, &r, &e, notice);
    }
}

static void test_nifti_fields(void) {
    for (int version = 1; version <= 2; version++) {
        nifti_fields f = nifti_234(version);
        f.dim[0] = 5;
        f.dim[4] = 0;
        f.dim[5] = -1;
        check_nifti("sizes of 0 and less", &f, sizes_234, NULL);
        f = nifti_234(version);
        for (int n = 4; n < 8; n++) f.dim[n] = -n * 77;
        check_nifti("sizes of axes that are not there", &f, sizes_234, NULL);

        f = nifti_234(version);
        for (int n = 0; n < 8; n++) f.pixdim[n] = 0;
        check_nifti("no voxel sizes", &f, ones, "0 0 0 (pixdim) are taken for 1 1 1");
        f.pixdim[1] = NAN;
        check_nifti("a voxel size that is no number", &f, ones, "(pixdim) are taken for 1 1 1");
        f = nifti_234(version);
        f.pixdim[2] = -3;
        f.qform = 1;
        check_nifti("a voxel size below 0 with a qform", &f, turned, "are taken for 2 3 4");
        f.pixdim[2] = 3;
        f.pixdim[0] = 0;
        check_nifti("qfac 0", &f, turned, NULL);
        f.sform = 2;
        check_nifti("an sform of zeros, a qform", &f, turned, "the qform is taken");
        f.srow[0] = NAN;
        check_nifti("an sform of no numbers, a qform", &f, turned, "the qform is taken");
        f.qform = 0;
        check_nifti("an sform alone, of no numbers", &f, sizes_234, "the voxel size is taken");
        f = nifti_234(version);
        f.qform = 1;
        f.quatern[2] = NAN;
        f.qoffset[0] = INFINITY;
        static const double from_rest[12] = {2, 0, 0, 0, 0, 3, 0, 6, 0, 0, 4, 7};
        check_nifti("a qform of no numbers", &f, from_rest, "qform has values that are not finite");
        f = nifti_234(version);
        f.slope = NAN;
        check_nifti("a slope that is none", &f, sizes_234, "slope");
        f.slope = 1;
        f.intercept = INFINITY;
        check_nifti("an intercept that is none", &f, sizes_234, "intercept");
    }
}

/* Where data begins: offsets within the header, odd ones, with a fraction; pairs that say that they are one file, and
 * the other way round. */
static void test_nifti_places(void) {
    static const struct {
        double offset;
        size_t padding;
    } cases[] = {{0, 4}, {0, 0}, {-4, 0}, {-4, 4}, {1, 5}, {0.5, 4}, {9, 13}};
    for (int version = 1; version <= 2; version++)
        for (size_t n = 0; n < 2 * sizeof cases / sizeof *cases; n++) {
            nifti_fields f = nifti_234(version);
            expected e = plain(TC_I16, sizes_234);
            f.vox_offset = cases[n / 2].offset + (n / 2 > 1 ? (version == 1 ? 352 : 544) : 0);
            if (version == 2 && cases[n / 2].offset == 0.5) f.vox_offset = 544;
            if (n & 1) f.magic = "ni";
            read_request r = request_for(write_nifti("a.nii", &f, cases[n / 2].padding, 0));
            expect_noticed(n & 1 ? "ni in one file" : "an offset", &r, &e, NULL);
        }
    nifti_fields f = nifti_234(1);
    f.vox_offset = 0;
    bytes header = nifti_header_bytes(&f), samples = test_samples(TC_I16, COUNT, 0);
    file_write("n.hdr", header.data, header.size);
    file_write("n.img", samples.data, samples.size);
    expected e = plain(TC_I16, sizes_234);
    read_request r = request_for(file_path("n.hdr"));
    expect_noticed("n+ in a pair", &r, &e, NULL);
    r = request_for(file_path("n.img"));
    expect_noticed("n+ in a pair, by its image", &r, &e, NULL);
    bytes_free(&header);
    bytes_free(&samples);
}

/* The number of dimensions tells the byte order, whatever the header's size says. */
static void test_nifti_order(void) {
    for (int kind = 0; kind < 3; kind++) {
        nifti_fields f = nifti_234(1);
        f.big = kind == 2;
        bytes file = nifti_header_bytes(&f), samples = test_samples(TC_I16, COUNT, f.big);
        put_at(&file, 0, kind == 1 ? 0 : 348, 4, kind == 0);
        bytes_add(&file, samples.data, samples.size);
        read_request r = request_for(file_write("a.nii", file.data, file.size));
        expected e = plain(TC_I16, sizes_234);
        expect_noticed("the size of the header is wrong", &r, &e, NULL);
        bytes_free(&file);
        bytes_free(&samples);
    }
}

static void test_capitals(void) {
    static const char *const names[][2] = {
        {"U.HDR", "U.IMG"}, {"V.HDR", "V.img"}, {"w.hdr", "w.IMG"}, {"x.hdr", "x.img.GZ"}};
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        for (int by_image = 0; by_image < 2; by_image++) {
            nifti_fields f = nifti_234(1);
            f.magic = "ni";
            f.vox_offset = 0;
            bytes header = nifti_header_bytes(&f), samples = test_samples(TC_I16, COUNT, 0);
            bytes packed = gzipped(samples.data, samples.size, AS_GZIP), *data = n == 3 ? &packed : &samples;
            file_write(names[n][0], header.data, 348);
            file_write(names[n][1], data->data, data->size);
            read_request r = request_for(file_path(names[n][by_image]));
            expected e = plain(TC_I16, sizes_234);
            expect_noticed(names[n][by_image], &r, &e, NULL);
            bytes_free(&header);
            bytes_free(&samples);
            bytes_free(&packed);
        }
}

/* Fields of NIfTI are other things in Analyze: they are no codes of forms there. */
static void test_analyze(void) {
    for (int big = 0; big < 2; big++)
        for (int scaled = 0; scaled < 2; scaled++) {
            nifti_fields f = nifti_234(1);
            f.big = big;
            f.magic = "";
            f.vox_offset = big ? -8 : 0;
            f.slope = scaled ? 2 : 0;
            f.intercept = NAN;
            f.qform = f.sform = 257;
            f.dim[0] = 4;
            f.dim[4] = 0;
            bytes header = nifti_header_bytes(&f), samples = test_samples(TC_I16, COUNT, big), image = {0};
            memset(header.data + 344, 0, 4);
            bytes_add(&image, "skipped!", big ? 8 : 0);
            bytes_add(&image, samples.data, samples.size);
            file_write("s.hdr", header.data, 348);
            file_write("s.img", image.data, image.size);
            expected e = plain(TC_I16, sizes_234);
            e.format = "Analyze 7.5";
            e.space = "voxel size only";
            if (scaled) e.slope = 2;
            read_request r = request_for(file_path("s.hdr"));
            expect_volume("Analyze", &r, &e);
            r = request_for(file_path("s.img"));
            expect_volume("Analyze, by its image", &r, &e);
            bytes_free(&header);
            bytes_free(&samples);
            bytes_free(&image);
        }
    remove(file_path("s.img"));
    read_request r = request_for(file_path("s.hdr"));
    expect_failure("Analyze without its image", &r, STATUS_INPUT, ".img file is missing");
}

static void test_cifti(void) {
    nifti_fields f = nifti_plain(2, 16, 32, 1, 1, 1);
    f.dim[0] = 6;
    f.dim[5] = 5;
    f.dim[6] = 12;
    bytes file = nifti_header_bytes(&f);
    put_at(&file, 504, 3006, 4, 0);
    for (int n = 0; n < 240; n++) bytes_put(&file, 0, 1, 0);
    read_request r = request_for(file_write("a.dscalar.nii", file.data, file.size));
    expect_failure("CIFTI", &r, STATUS_INPUT, "CIFTI");
    bytes_free(&file);
}

/* ------------------------------------------------------------------------------------- what the request stands for */

/* Spacing and origin of the request, of headers that have none, wrong ones, and turned axes. */
static void test_replaced(void) {
    static const double plain_matrix[12] = {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30},
                        turned_matrix[12] = {0, -3, 0, 10, 2, 0, 0, 20, 0, 0, 4, 30};
    static const struct {
        const char *name, *header;
        const double *matrix;
    } cases[] = {
        {"a.nrrd", NRRD_U8 "\n", plain_matrix},
        {"a.nrrd", NRRD_U8 "spacings: 0 inf nan\naxis mins: nan inf 0\n\n", plain_matrix},
        {"a.nrrd", NRRD_U8 "space: RAS\nspace directions: (0,7,0) (-8,0,0) (0,0,0)\nspace origin: none\n\n",
         turned_matrix},
        {"a.mha", META LOCAL, plain_matrix},
        {"a.mha", META "ElementSpacing = 0 1\nOffset = nan\n" LOCAL, plain_matrix},
        {"a.mha", META "ElementSpacing = 7 8 9\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\n" LOCAL, turned_matrix},
    };
    bytes samples = test_samples(TC_U8, COUNT, 0);
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        read_request r = request_for(file_behind(cases[n].name, cases[n].header, &samples));
        r.has_spacing = r.has_origin = 1;
        for (int a = 0; a < 3; a++) r.spacing[a] = a + 2;
        for (int a = 0; a < 3; a++) r.origin[a] = 10 * (a + 1);
        expected e = plain(TC_U8, cases[n].matrix);
        expect_noticed(cases[n].header, &r, &e, NULL);
    }
    bytes_free(&samples);
    nifti_fields f = nifti_234(1);
    for (int a = 1; a < 4; a++) f.pixdim[a] = 0;
    read_request r = request_for(write_nifti("a.nii", &f, 4, 0));
    r.has_spacing = r.has_origin = 1;
    for (int a = 0; a < 3; a++) r.spacing[a] = a + 2;
    for (int a = 0; a < 3; a++) r.origin[a] = 10 * (a + 1);
    expected e = plain(TC_I16, plain_matrix);
    expect_noticed("no voxel sizes, but those of the request", &r, &e, NULL);
}

/* All components, side by side, of data that has them so, or one volume after another; the first of the frames. */
static void test_described(void) {
    static const struct {
        const char *fields;
        int64_t frames;
        uint64_t of_component, of_sample; /* strides */
    } cases[] = {
        {"dimension: 4\nsizes: 3 5 4 3\nkinds: vector domain domain domain\n", 1, 1, 3},
        {"dimension: 4\nsizes: 5 4 3 3\nkinds: domain domain domain vector\n", 1, 60, 1},
        {"dimension: 5\nsizes: 3 5 4 3 2\nkinds: vector domain domain domain time\n", 2, 1, 3},
    };
    for (int type = 0; type <= STORED_U64; type++)
        for (size_t n = 0; n < 2 * sizeof cases / sizeof *cases; n++) {
            static const char *const names[] = {"uchar", "int8",  "ushort", "short",    "uint",
                                                "int",   "float", "double", "longlong", "ulonglong"};
            int big = n & 1;
            char header[512];
            bytes samples = test_samples(type, 6 * (uint64_t)COUNT, big);
            snprintf(header, sizeof header, "NRRD0005\ntype: %s\n%sendian: %s\nencoding: raw\n\n", names[type],
                     cases[n / 2].fields, big ? "big" : "little");
            read_request r = request_for(file_behind("a.nrrd", header, &samples));
            read_image v;
            r.describe = 1;
            int status = image_read(&r, &v);
            EXPECT(status == 0 && v.components == 3 && v.d.frames == cases[n / 2].frames, "%s: status %d, %s", header,
                   status, failure_text());
            uint64_t wrong = 0;
            for (uint64_t i = 0; i < 3 * (uint64_t)COUNT && !status; i++)
                wrong += image_value(&v, i) !=
                         test_value(type, i % 3 * cases[n / 2].of_component + i / 3 * cases[n / 2].of_sample);
            EXPECT(!wrong, "%s: %" PRIu64 " values are wrong", header, wrong);
            image_release(&v);
            bytes_free(&samples);
        }
}

int main(void) {
    folder_make("read-lenient");
    test_nrrd_headers();
    test_nrrd_outside();
    test_repeated();
    test_nrrd_hex();
    test_nrrd_text();
    test_nrrd_byte_skip();
    test_nrrd_lists();
    test_packed_masks();
    test_metaimage();
    test_metaimage_data();
    test_nifti_fields();
    test_nifti_places();
    test_nifti_order();
    test_capitals();
    test_analyze();
    test_cifti();
    test_replaced();
    test_described();
    folder_remove();
    return EXPECT_DONE();
}
