/* test_read.c - every kind of volume file, made at run time, reads back with the same values, type and world space */
#include "read_files.h"
#include "read_formats.h"

static const int64_t dims[3] = {5, 4, 3};
enum { COUNT = 60 };

static const char *const nrrd_names[] = {"uchar", "int8_t", "unsigned short int", "signed short", "uint32", "int",
                                         "float", "double", "long long int",      "uint64_t"};
static const char *const meta_names[] = {"MET_UCHAR", "MET_CHAR",  "MET_USHORT", "MET_SHORT",     "MET_UINT",
                                         "MET_INT",   "MET_FLOAT", "MET_DOUBLE", "MET_LONG_LONG", "MET_ULONG_LONG"};
static const int nifti_types[] = {2, 256, 512, 4, 768, 8, 16, 64, 1024, 1280};

static expected plain(int type, const char *format) {
    return (expected){.stored = type, .dims = {dims[0], dims[1], dims[2]}, .format = format};
}

static void test_raw(void) {
    for (int type = 0; type <= TC_F64; type++)
        for (int big = 0; big < 2; big++)
            for (uint64_t skip = 0; skip < 9; skip++) {
                bytes file = {0}, samples = test_samples(type, COUNT, big);
                bytes_add(&file, "skipskip", (size_t)skip);
                bytes_add(&file, samples.data, samples.size);
                read_request r = request_for(file_write("a.raw", file.data, file.size));
                static const double matrix[12] = {2, 0, 0, -1, 0, 3, 0, 0.5, 0, 0, 4, 7};
                memcpy(r.dims, dims, sizeof dims);
                r.type = type;
                r.big_endian = big;
                r.skip = skip;
                for (int i = 0; i < 3; i++) {
                    r.spacing[i] = matrix[5 * i];
                    r.origin[i] = matrix[4 * i + 3];
                }
                expected e = plain(type, "raw");
                e.matrix = matrix;
                expect_volume("raw", &r, &e);

                read_image v;
                int native = big == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) || stored_bytes(type) == 1;
                if (image_read(&r, &v) == 0)
                    EXPECT(!!v.d.mapping == (native && skip % stored_bytes(type) == 0) && !v.d.mapping == !!v.d.memory,
                           "raw of type %d, big %d, skip %d is %s", type, big, (int)skip,
                           v.d.mapping ? "mapped" : "copied");
                image_release(&v);
                bytes_free(&file);
                bytes_free(&samples);
            }
}

/* Attached NRRD of a type, byte order and encoding, its header followed by what `more` says. */
static read_request write_nrrd(int type, int big, const char *encoding, const char *more) {
    bytes file = {0}, samples = test_samples(type, COUNT, big), packed = {0};
    bytes_text(&file, "NRRD0004\n# comment\ntype: %s\ndimension: 3\nsizes: 5 4 3\nendian: %s\nencoding: %s\n%s\n",
               nrrd_names[type], big ? "big" : "little", encoding, more);
    if (encoding[0] == 'g')
        packed = gzipped(samples.data, samples.size, AS_GZIP);
    else if (encoding[0] == 'b')
        packed = bzipped(samples.data, samples.size);
    else if (encoding[0] == 't')
        for (uint64_t i = 0; i < COUNT; i++) bytes_text(&packed, i % 3 ? "%.17g\n" : "%.17g, ", test_value(type, i));
    else
        bytes_add(&packed, samples.data, samples.size);
    bytes_add(&file, packed.data, packed.size);
    read_request r = request_for(file_write("a.nrrd", file.data, file.size));
    bytes_free(&file);
    bytes_free(&samples);
    bytes_free(&packed);
    return r;
}

static void test_nrrd_encodings(void) {
    static const char *const encodings[] = {"raw", "gzip", "bzip2", "text"};
    for (int type = 0; type <= STORED_U64; type++)
        for (int big = 0; big < 2; big++)
            for (int e = 0; e < 4; e++) {
                /* comments of varying length put the samples at every alignment */
                char more[32];
                snprintf(more, sizeof more, "key:=%.*s\n", type + e, "0123456789abcdef");
                read_request r = write_nrrd(type, big, encodings[e], more);
                expected wanted = plain(type, "NRRD");
                expect_volume(encodings[e], &r, &wanted);
            }
}

static void test_nrrd_world(void) {
    static const struct {
        const char *fields, *space;
        double matrix[12];
    } cases[] = {
        {"spacings: 2 -3 0.5\n", "", {2, 0, 0, 0, 0, -3, 0, 0, 0, 0, 0.5, 0}},
        {"space: left-posterior-superior\nspace directions: (1,2,3) (0,4,5) (0,0,-6)\nspace origin: (7,8,9)\ncenters: "
         "cell "
         "cell node\n",
         "left-posterior-superior",
         {1, 0, 0, 7, 2, 4, 0, 8, 3, 5, -6, 9}},
        {"space dimension: 3\nspace directions: ( 0, 0 ,1) (0,1,0) (1,0,0)\r\n",
         "",
         {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0}},
        {"axis mins: 1 2 3\nspacings: 2 2 2\ncenters: node cell ???\n", "", {2, 0, 0, 1, 0, 2, 0, 3, 0, 0, 2, 4}},
        {"axismins: 0 0 0\naxis maxs: 10 8 4\ncenterings: cell cell node\n", "", {2, 0, 0, 1, 0, 2, 0, 1, 0, 0, 2, 0}},
        {"SPACE: RAS\ncontent: a: b\nunits: \"mm\" \"mm\" \"mm\"\n", "RAS", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        read_request r = write_nrrd(TC_I16, 0, "raw", cases[i].fields);
        expected e = plain(TC_I16, "NRRD");
        e.matrix = cases[i].matrix;
        e.space = cases[i].space;
        expect_volume(cases[i].fields, &r, &e);
    }
}

/* Writes header text and the samples behind it. */
static read_request write_with_samples(const char *name, const char *header, int type, uint64_t count, int big) {
    bytes samples = test_samples(type, count, big);
    read_request r = request_for(file_behind(name, header, &samples));
    bytes_free(&samples);
    return r;
}

static void test_nrrd_choices(void) {
    static const struct {
        const char *fields;
        int component, frame;
        int64_t dims[3];
        uint64_t offset, stride;
    } cases[] = {
        {"dimension: 4\nsizes: 2 5 4 3\nkinds: vector domain domain domain\n", 1, -1, {5, 4, 3}, 1, 2},
        {"dimension: 4\nsizes: 2 5 4 3\nspace: RAS\nspace directions: none (1,0,0) (0,1,0) (0,0,1)\n",
         0,
         -1,
         {5, 4, 3},
         0,
         2},
        {"dimension: 4\nsizes: 5 4 3 2\nspace: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1) none\n",
         -1,
         1,
         {5, 4, 3},
         60,
         1},
        {"dimension: 4\nsizes: 5 4 3 2\nspace: RAST\nspace directions: (1,0,0,0) (0,1,0,0) (0,0,1,0) (0,0,0,2)\n",
         -1,
         1,
         {5, 4, 3},
         60,
         1},
        {"dimension: 4\nsizes: 5 4 3 2\n", -1, 0, {5, 4, 3}, 0, 1},
        {"dimension: 4\nsizes: 5 4 3 2\nkinds: domain domain domain complex\n", 1, -1, {5, 4, 3}, 60, 1},
        {"dimension: 5\nsizes: 1 3 5 4 2\nkinds: stub 3-vector space space time\n", 2, 1, {5, 4, 1}, 62, 3},
        {"dimension: 2\nsizes: 30 4\n", -1, -1, {30, 4, 1}, 0, 1},
        {"dimension: 1\nsizes: 120\n", 0, 0, {120, 1, 1}, 0, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[512];
        snprintf(header, sizeof header, "NRRD0005\ntype: float\n%sendian: little\nencoding: raw\n\n", cases[i].fields);
        read_request r = write_with_samples("a.nrrd", header, TC_F32, 120, 0);
        r.component = cases[i].component;
        r.frame = cases[i].frame;
        expected e = {.stored = TC_F32, .offset = cases[i].offset, .stride = cases[i].stride};
        memcpy(e.dims, cases[i].dims, sizeof e.dims);
        expect_volume(cases[i].fields, &r, &e);
    }
}

/* Writes the samples as files named by the format, `count` to each, packed as the encoding says, after `before`. */
static void write_parts(const char *format, int first, int parts, int type, const char *before, int is_packed) {
    bytes samples = test_samples(type, COUNT, 0);
    size_t size = samples.size / (size_t)parts;
    for (int i = 0; i < parts; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s", format);
        char *hash = strchr(name, '#');
        if (hash) snprintf(hash, 16, "%03d.raw", first + i);
        bytes file = {0}, packed = {0};
        bytes_add(&file, before, strlen(before));
        if (is_packed) packed = gzipped(samples.data + (size_t)i * size, size, AS_ZLIB);
        bytes_add(&file, is_packed ? packed.data : samples.data + (size_t)i * size, is_packed ? packed.size : size);
        file_write(name, file.data, file.size);
        bytes_free(&file);
        bytes_free(&packed);
    }
    bytes_free(&samples);
}

static void test_nrrd_detached(void) {
    static const char head[] = "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 3\nendian: little\n";
    static const struct {
        const char *rest, *before;
        int parts, is_packed;
    } cases[] = {
        {"encoding: raw\ndata file: s001.raw\n", "", 1, 0},
        {"encoding: raw\ndatafile: ./s001.raw", "", 1, 0},
        {"encoding: raw\nline skip: 2\nbyte skip: 3\ndata file: s001.raw\n", "one\ntwo\nxyz", 1, 0},
        {"encoding: raw\nbyte skip: -1\ndata file: s001.raw\n", "anything", 1, 0},
        {"encoding: gzip\nlineskip: 1\ndata file: s001.raw\n", "one\n", 1, 1},
        {"encoding: raw\nbyte skip: 1\ndata file: LIST\ns001.raw\ns002.raw\ns003.raw\n", "x", 3, 0},
        {"encoding: raw\ndata file: LIST 3\ns001.raw\ns002.raw\ns003.raw\n", "", 3, 0},
        {"encoding: raw\ndata file: s%03d.raw 1 3 1\n", "", 3, 0},
        {"encoding: gz\ndata file: s%03d.raw 1 12 1 1\n", "", 12, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[512];
        snprintf(header, sizeof header, "%s%s", head, cases[i].rest);
        write_parts("s#", 1, cases[i].parts, TC_I16, cases[i].before, cases[i].is_packed);
        read_request r = request_for(file_text("d.nhdr", header));
        expected e = plain(TC_I16, "NRRD");
        expect_volume(cases[i].rest, &r, &e);
    }
    mkdir(file_path("below"), 0700);
    write_parts("below/s#", 1, 1, TC_I16, "", 0);
    char header[512];
    snprintf(header, sizeof header, "%sencoding: raw\ndata file: below/s001.raw\n", head);
    read_request r = request_for(file_text("d.nhdr", header));
    expected e = plain(TC_I16, "NRRD");
    expect_volume("a folder below", &r, &e);
}

static void test_nrrd_stream_skip(void) {
    bytes inner = {0}, samples = test_samples(TC_U8, COUNT, 0), file = {0};
    bytes_text(&inner, "0123456789");
    bytes_add(&inner, samples.data, samples.size);
    bytes_text(&inner, "behind");
    bytes first = gzipped(inner.data, 30, AS_GZIP), second = gzipped(inner.data + 30, inner.size - 30, AS_GZIP);
    bytes_text(&file, "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: gzip\nbyte skip: 10\n\n");
    bytes_add(&file, first.data, first.size);
    bytes_add(&file, second.data, second.size);
    read_request r = request_for(file_write("a.nrrd", file.data, file.size));
    expected e = plain(TC_U8, "NRRD");
    expect_volume("two gzip members, bytes skipped inside", &r, &e);
    read_image v;
    EXPECT(image_read(&r, &v) == 0 && strstr(v.d.notice, "more data"), "notice: '%s'", v.d.notice);
    image_release(&v);
    r = write_nrrd(TC_U8, 0, "gzip", "");
    EXPECT(image_read(&r, &v) == 0 && !*v.d.notice, "notice: '%s'", v.d.notice);
    image_release(&v);
    bytes_free(&inner);
    bytes_free(&samples);
    bytes_free(&file);
    bytes_free(&first);
    bytes_free(&second);
}

/* More bytes than are unpacked at once. */
static void test_nrrd_long_skip(void) {
    enum { SKIPPED = 200000 };
    bytes inner = {0}, samples = test_samples(TC_U8, COUNT, 0), file = {0};
    for (unsigned n = 0; n < SKIPPED; n++) bytes_put(&inner, n * 2654435761u >> 24, 1, 0);
    bytes_add(&inner, samples.data, samples.size);
    for (int bzip2 = 0; bzip2 < 2; bzip2++) {
        bytes packed = bzip2 ? bzipped(inner.data, inner.size) : gzipped(inner.data, inner.size, AS_GZIP);
        bytes_text(&file, "NRRD0001\ntype: uchar\ndimension: 3\nsizes: 5 4 3\nencoding: %s\nbyte skip: %d\n\n",
                   bzip2 ? "bzip2" : "gzip", SKIPPED);
        bytes_add(&file, packed.data, packed.size);
        read_request r = request_for(file_write("a.nrrd", file.data, file.size));
        expected e = plain(TC_U8, "NRRD");
        expect_volume("many bytes skipped", &r, &e);
        bytes_free(&packed);
        bytes_free(&file);
    }
    bytes_free(&inner);
    bytes_free(&samples);
}

static void test_metaimage_types(void) {
    for (int type = 0; type <= STORED_U64; type++)
        for (int kind = 0; kind < 4; kind++) { /* little, big, zlib, text */
            int big = kind == 1;
            bytes file = {0}, samples = test_samples(type, COUNT, big),
                  packed = gzipped(samples.data, samples.size, AS_ZLIB);
            bytes_text(&file,
                       "NDims = 3\nDimSize = 5 4 3\nElementType = %s\nBinaryData = %s\nElementByteOrderMSB = %s\n",
                       meta_names[type], kind == 3 ? "False" : "True", big ? "True" : "False");
            if (kind == 2) bytes_text(&file, "CompressedData = True\nCompressedDataSize = %zu\n", packed.size - 3);
            bytes_text(&file, "ElementDataFile = LOCAL\n");
            for (uint64_t i = 0; i < COUNT && kind == 3; i++) bytes_text(&file, "%.17g ", test_value(type, i));
            if (kind < 2) bytes_add(&file, samples.data, samples.size);
            if (kind == 2) bytes_add(&file, packed.data, packed.size);
            read_request r = request_for(file_write("a.mha", file.data, file.size));
            expected e = plain(type, "MetaImage");
            expect_volume(meta_names[type], &r, &e);
            bytes_free(&file);
            bytes_free(&samples);
            bytes_free(&packed);
        }
}

static void test_metaimage_headers(void) {
    static const double turned[12] = {2, 0, 0, 10, 0, 0, -4, 20, 0, 3, 0, 30};
    static const double spaced[12] = {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0};
    static const struct {
        const char *fields, *before;
        int parts, is_packed;
        const double *matrix;
    } cases[] = {
        {"ElementSpacing = 2 3 4\nElementSize = 9 9 9\nOffset = 10 20 30\nTransformMatrix = 1 0 0 0 0 1 0 -1 "
         "0\nAnatomicalOrientation = ???\nElementDataFile = s001.raw\n",
         "", 1, 0, turned},
        {"ElementSize = 2 3 4\nRotation = 1 0 0 0 1 0 0 0 1\nPosition = 0 0 0\nElementDataFile = s001.raw\n", "", 1, 0,
         spaced},
        {"HeaderSize = 4\nElementDataFile = s001.raw\n", "abcd", 1, 0, NULL},
        {"HeaderSize = -1\nElementDataFile = s001.raw\n", "abcdefg", 1, 0, NULL},
        {"ElementDataFile = LIST\ns001.raw\ns002.raw\ns003.raw\n", "", 3, 0, NULL},
        {"ElementDataFile = LIST 2D\ns001.raw\ns002.raw\ns003.raw\n", "", 3, 0, NULL},
        {"CompressedData = True\nElementDataFile = s%03d.raw 1 3 1\n", "", 3, 1, NULL},
        {"ElementDataFile = s%03d.raw 1 3\n", "", 3, 0, NULL},
        {"ElementDataFile = s%03d.raw 1\n", "", 3, 0, NULL},
        {"ElementDataFile = s%03d.raw\n", "", 3, 0, NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char header[512];
        snprintf(header, sizeof header, "ObjectType = Image\nNDims = 3\nDimSize = 5 4 3\nElementType = MET_SHORT\n%s",
                 cases[i].fields);
        write_parts("s#", 1, cases[i].parts, TC_I16, cases[i].before, cases[i].is_packed);
        read_request r = request_for(file_text("d.mhd", header));
        expected e = plain(TC_I16, "MetaImage");
        e.matrix = cases[i].matrix;
        expect_volume(cases[i].fields, &r, &e);
    }
    read_request r =
        write_with_samples("a.mha",
                           "NDims = 4\nDimSize = 5 4 3 2\nElementType = MET_USHORT_ARRAY\nElementNumberOfChannels "
                           "= 3\nElementDataFile = LOCAL\n",
                           TC_U16, 360, 0);
    expected e = {.stored = TC_U16, .dims = {5, 4, 3}, .offset = 182, .stride = 3};
    r.component = 2;
    r.frame = 1;
    expect_volume("MetaImage channels and frames", &r, &e);
    r = write_with_samples("a.mha", "NDims = 2\nDimSize = 5 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
                           TC_U8, 20, 0);
    e = (expected){.stored = TC_U8, .dims = {5, 4, 1}};
    expect_volume("MetaImage of two axes", &r, &e);
}

static read_request write_nifti(const char *name, const nifti_fields *f, int stored, uint64_t count, int is_packed) {
    bytes file = nifti_header_bytes(f), samples = test_samples(stored, count, f->big);
    bytes_add(&file, samples.data, samples.size);
    bytes packed = gzipped(file.data, file.size, AS_GZIP);
    const char *path = file_write(name, is_packed ? packed.data : file.data, is_packed ? packed.size : file.size);
    bytes_free(&file);
    bytes_free(&samples);
    bytes_free(&packed);
    return request_for(path);
}

static void test_nifti_types(void) {
    for (int type = 0; type <= STORED_U64; type++)
        for (int kind = 0; kind < 16; kind++) { /* version, byte order, gzip, slope */
            nifti_fields f = nifti_plain(1 + (kind & 1), nifti_types[type], 8 * (int)stored_bytes(type), 5, 4, 3);
            f.big = kind >> 1 & 1;
            int is_packed = kind >> 2 & 1, is_scaled = kind >> 3;
            f.slope = is_scaled ? 0.5 : 1;
            f.intercept = is_scaled ? -3.25 : 0;
            read_request r = write_nifti(is_packed ? "a.nii.gz" : "a.nii", &f, type, COUNT, is_packed);
            expected e = plain(type, f.version == 1 ? "NIfTI-1" : "NIfTI-2");
            e.space = "voxel size only";
            if (is_scaled) {
                e.slope = f.slope;
                e.intercept = f.intercept;
            }
            expect_volume(e.format, &r, &e);
        }
}

static void test_nifti_world(void) {
    static const double from_sform[12] = {0, -2, 0, 90, 3, 0, 0, -126, 0, 0, 4, -72};
    static const double from_qform[12] = {-2, 0, 0, 5, 0, -3, 0, 6, 0, 0, -4, 7}; /* half a turn about z, qfac -1 */
    static const double from_pixdim[12] = {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0};
    for (int kind = 0; kind < 12; kind++) {
        nifti_fields f = nifti_plain(1 + kind % 2, 4, 16, 5, 4, 3);
        f.big = kind / 2 % 2;
        double pixdim[4] = {-1, 2, 3, 4}, quatern[3] = {0, 0, 1}, qoffset[3] = {5, 6, 7};
        memcpy(f.pixdim, pixdim, sizeof pixdim);
        memcpy(f.quatern, quatern, sizeof quatern);
        memcpy(f.qoffset, qoffset, sizeof qoffset);
        memcpy(f.srow, from_sform, sizeof f.srow);
        f.slope = 0;
        f.intercept = 99;
        f.sform = kind < 4 ? 4 : 0;
        f.qform = kind < 8 ? 1 : 0;
        expected e = plain(TC_I16, NULL);
        e.matrix = kind < 4 ? from_sform : kind < 8 ? from_qform : from_pixdim;
        e.space = kind < 4 ? "mni152" : kind < 8 ? "scanner" : "voxel size only";
        read_request r = write_nifti("a.nii", &f, TC_I16, COUNT, 0);
        expect_volume(e.space, &r, &e);
    }
}

static void test_nifti_choices(void) {
    nifti_fields f = nifti_plain(1, 128, 24, 5, 4, 3);
    f.slope = 7; /* colours are not scaled */
    read_request r = write_nifti("a.nii", &f, TC_U8, 3 * COUNT, 0);
    expected e = {.stored = TC_U8, .dims = {5, 4, 3}, .offset = 2, .stride = 3};
    r.component = 2;
    expect_volume("RGB", &r, &e);

    f = nifti_plain(2, 1792, 128, 5, 4, 3);
    f.big = 1;
    r = write_nifti("a.nii", &f, TC_F64, 2 * COUNT, 0);
    e = (expected){.stored = TC_F64, .dims = {5, 4, 3}, .offset = 1, .stride = 2};
    r.component = 1;
    expect_volume("complex", &r, &e);

    f = nifti_plain(1, 16, 32, 5, 4, 3);
    f.dim[0] = 5;
    f.dim[4] = 2;
    f.dim[5] = 3;
    r = write_nifti("a.nii", &f, TC_F32, 6 * COUNT, 0);
    e = (expected){.stored = TC_F32, .dims = {5, 4, 3}, .offset = COUNT + 2 * 2 * COUNT};
    r.frame = 1;
    r.component = 2;
    expect_volume("time and vector", &r, &e);
}

static void test_nifti_pair(void) {
    for (int is_packed = 0; is_packed < 2; is_packed++) {
        nifti_fields f = nifti_plain(1, 512, 16, 5, 4, 3);
        f.magic = "ni";
        f.vox_offset = 16;
        bytes header = nifti_header_bytes(&f), image = {0}, samples = test_samples(TC_U16, COUNT, 0);
        file_write("p.hdr", header.data, 348);
        bytes_text(&image, "0123456789abcdef");
        bytes_add(&image, samples.data, samples.size);
        bytes packed = gzipped(image.data, image.size, AS_GZIP);
        remove(file_path("p.img"));
        if (is_packed)
            file_write("p.img.gz", packed.data, packed.size);
        else
            file_write("p.img", image.data, image.size);
        expected e = plain(TC_U16, "NIfTI-1");
        read_request r = request_for(file_path("p.hdr"));
        expect_volume("pair, by its header", &r, &e);
        r = request_for(file_path(is_packed ? "p.img.gz" : "p.img"));
        expect_volume("pair, by its image", &r, &e);
        bytes_free(&header);
        bytes_free(&image);
        bytes_free(&samples);
        bytes_free(&packed);
    }
}

/* A single file's data cannot start within its header, so an offset of 0 means right behind it. */
static void test_nifti_offset(void) {
    for (int version = 1; version <= 2; version++) {
        nifti_fields f = nifti_plain(version, 4, 16, 5, 4, 3);
        f.vox_offset = 0;
        read_request r = write_nifti("a.nii", &f, TC_I16, COUNT, 0);
        expected e = plain(TC_I16, NULL);
        expect_volume("vox_offset 0", &r, &e);
    }
}

/* The content decides before the ending does. */
static void test_detection(void) {
    read_request r = write_nrrd(TC_U8, 0, "raw", "");
    rename(file_path("a.nrrd"), file_path("b.nii"));
    r.path = file_path("b.nii");
    expected e = plain(TC_U8, "NRRD");
    expect_volume("NRRD named .nii", &r, &e);
    nifti_fields f = nifti_plain(1, 2, 8, 5, 4, 3);
    r = write_nifti("c.dat", &f, TC_U8, COUNT, 0);
    e.format = "NIfTI-1";
    expect_volume("NIfTI named .dat", &r, &e);
    char formats[FORMATS_TEXT];
    EXPECT(strstr(read_formats_text(formats), "raw, NRRD (gzip, bzip2), MetaImage (zlib), NIfTI"), "formats: %s",
           formats);
}

int main(void) {
    folder_make("read");
    test_raw();
    test_nrrd_encodings();
    test_nrrd_world();
    test_nrrd_choices();
    test_nrrd_detached();
    test_nrrd_stream_skip();
    test_nrrd_long_skip();
    test_metaimage_types();
    test_metaimage_headers();
    test_nifti_types();
    test_nifti_world();
    test_nifti_choices();
    test_nifti_pair();
    test_nifti_offset();
    test_detection();
    folder_remove();
    return EXPECT_DONE();
}
