/*
 * test_read_lenient.c - MetaImage, NIfTI and Analyze files as programs write them, approximate where their readers are:
 * each is read as ITK or nibabel read it, with a notice where something was taken for something else; and images whose
 * place the request gives
 */
#include "image_headers.h"

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

/* What stands twice is taken as it stands last, with a notice. */
static void test_repeated_keys(void) {
    static const header_case cases[] = {
        {"NDims = 3\nDimSize = 5 4 3\nElementSpacing = 1 1 1\nelementspacing = 2 3 4\nElementType = MET_UCHAR\n"
         "Comment = a\nComment = b\nElementDataFile = LOCAL\n",
         "'ElementSpacing' twice: the last",
         {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0}}};
    check_headers("a.mha", cases, sizeof cases / sizeof *cases);
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

int main(void) {
    folder_make("read-lenient");
    test_metaimage();
    test_metaimage_data();
    test_repeated_keys();
    test_nifti_fields();
    test_nifti_places();
    test_nifti_order();
    test_capitals();
    test_analyze();
    test_cifti();
    test_replaced();
    folder_remove();
    return EXPECT_DONE();
}
