/* test_tiff.c - stacks in TIFF: every form and type, slices in files of their own, what ImageJ and OME-TIFF note,
 * damaged files */
#include "tiff_files.h"

static const tiff_form plain = {
    .type = TC_U16, .compression = TIFF_NONE, .width = 5, .height = 4, .samples = 1, .rows = 4};

static read_request write_tiff(const char *name, const tiff_form *f, int pages, uint64_t first) {
    bytes file = tiff_file(f, pages, first);
    read_request r = request_for(file_write(name, file.data, file.size));
    bytes_free(&file);
    return r;
}

static void test_forms(void) {
    static const int packings[] = {TIFF_NONE, TIFF_DEFLATE, TIFF_PACKBITS};
    for (int type = 0; type <= STORED_U64; type++)
        for (int n = 0; n < 3 * 4 * 3; n++) {
            tiff_form f = plain;
            char what[80];
            f.type = type;
            f.compression = packings[n % 3];
            f.is_big_endian = n / 3 & 1;
            f.is_big_tiff = n / 6 & 1;
            f.rows = n / 12 == 0 ? 4 : 3;
            f.tile = n / 12 == 2 ? 16 : 0;
            snprintf(what, sizeof what, "type %d, packing %d, big %d %d, rows %d, tiles %d", type, f.compression,
                     f.is_big_endian, f.is_big_tiff, f.rows, f.tile);
            read_request r = write_tiff(n % 2 ? "a.tif" : "a.TIFF", &f, 3, 0);
            expected e = {.stored = type, .dims = {5, 4, 3}, .format = "TIFF"};
            expect_volume(what, &r, &e);
        }
}

static void test_components(void) {
    for (int big = 0; big < 2; big++) {
        tiff_form f = plain;
        f.samples = 3;
        f.is_big_tiff = big;
        f.tile = big ? 16 : 0;
        read_request r = write_tiff("rgb.tif", &f, 2, 0);
        r.component = 1;
        expected e = {.stored = TC_U16, .dims = {5, 4, 2}, .offset = 1, .stride = 3};
        expect_volume("RGB", &r, &e);
        r.component = -1;
        expect_failure("RGB, none chosen", &r, STATUS_USAGE, "--component");
    }
}

static void test_lower_resolution(void) {
    tiff_form f = plain, small = plain;
    size_t link;
    small.width = small.height = small.rows = 2;
    small.subfile = 1;
    bytes file = tiff_begin(&f, &link);
    tiff_page(&file, &small, 7, &link);
    tiff_page(&file, &f, 0, &link);
    tiff_page(&file, &small, 9, &link);
    tiff_page(&file, &f, 20, &link);
    read_request r = request_for(file_write("a.tif", file.data, file.size));
    expected e = {.stored = TC_U16, .dims = {5, 4, 2}};
    expect_volume("with small pages", &r, &e);
    read_image v;
    if (!image_read(&r, &v)) EXPECT(strstr(v.d.notice, "2 pages of lower"), "notice '%s'", v.d.notice);
    image_release(&v);
    bytes_free(&file);
}

static void test_slices(void) {
    static const struct {
        const char *name, *files[3];
        const char *fails;
    } cases[] = {
        {"s1/%04d.tif", {"s1/0008.tif", "s1/0009.tif", "s1/0010.tif"}, NULL},
        {"s1", {NULL}, NULL},
        {"s1/", {NULL}, NULL},
        {"s2", {"s2/b10.tif", "s2/b8.tiff", "s2/b9.TIF"}, NULL},
        {"s3/a%d.b%%.tif", {"s3/a98.b%%.tif", "s3/a99.b%%.tif", "s3/a100.b%%.tif"}, NULL},
        {"s3/a%d.tif", {NULL}, "no file of such a name"},
        {"s4/%02d.tif", {"s4/01.tif", "s4/02.tif", "s4/04.tif"}, "slices 2 and 4"},
        {"s4/%03d.tif", {NULL}, "no file of such a name"},
        {"s5", {"s5/a.png", "s5/.tif", "s5/.hidden.tif"}, "without slices"},
        {"none/%d.tif", {NULL}, "cannot be read"},
        {"plain%.tif", {NULL}, "cannot be opened"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        for (int k = 0; k < 3 && cases[n].files[k]; k++) {
            char directory[80];
            snprintf(directory, sizeof directory, "%s", cases[n].files[k]);
            *strchr(directory, '/') = '\0';
            mkdir(file_path(directory), 0777);
            /* names as they sort by their numbers */
            const int slice = strchr(cases[n].files[k], 'b') == cases[n].files[k] + 3 ? (k + 2) % 3 : k;
            (void)write_tiff(cases[n].files[k], &plain, 1, 20 * (uint64_t)slice);
        }
        read_request r = request_for(file_path(cases[n].name));
        expected e = {.stored = TC_U16, .dims = {5, 4, 3}};
        if (cases[n].fails)
            expect_failure(cases[n].name, &r, STATUS_INPUT, cases[n].fails);
        else
            expect_volume(cases[n].name, &r, &e);
    }
    read_request lost = request_for(file_path("s4"));
    read_image v;
    if (!image_read(&lost, &v)) EXPECT(strstr(v.d.notice, "slices 2 and 4"), "a lost slice: notice '%s'", v.d.notice);
    image_release(&v);
    (void)write_tiff("s1/0009.tif", &plain, 2, 20); /* files of several pages follow each other */
    (void)write_tiff("s1/0010.tif", &plain, 1, 60);
    read_request r = request_for(file_path("s1"));
    expected e = {.stored = TC_U16, .dims = {5, 4, 4}};
    expect_volume("pages in slices", &r, &e);
    tiff_form other = plain;
    other.type = TC_U8;
    (void)write_tiff("s1/0011.tif", &other, 1, 0);
    expect_failure("a slice of another type", &r, STATUS_INPUT, "0011.tif");
    file_text("s1/0011.tif", "II*");
    expect_failure("a slice that is none", &r, STATUS_INPUT, "0011.tif");
}

static void test_imagej(void) {
    static const double matrix[12] = {0.5, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 1.5, 0};
    tiff_form f = plain;
    f.description = "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nunit=um\nspacing=1.5\n";
    f.resolution[0] = 2;
    f.resolution[1] = 4;
    read_request r = write_tiff("a.tif", &f, 12, 0);
    r.component = r.frame = 1;
    read_image v;
    int status = image_read(&r, &v);
    EXPECT(!status && v.dims[0] == 5 && v.dims[1] == 4 && v.dims[2] == 3, "ImageJ: %s", failure_text());
    for (uint64_t n = 0; !status && n < 60; n++) /* page c + 2 (z + 3 t) */
        EXPECT(image_value(&v, n) == test_value(TC_U16, n % 20 + 20 * (1 + 2 * (n / 20 + 3))), "ImageJ: sample %d",
               (int)n);
    EXPECT(status || !memcmp(v.matrix, matrix, sizeof matrix), "ImageJ: spacing");
    image_release(&v);

    f.description = "ImageJ=1.53t\nimages=6\nchannels=2\nframes=3\n"; /* no slices: time takes their place */
    r = write_tiff("a.tif", &f, 6, 0);
    r.component = 0;
    status = image_read(&r, &v);
    EXPECT(!status && v.dims[2] == 3 && image_value(&v, 20) == test_value(TC_U16, 40), "ImageJ in time: %s",
           failure_text());
    image_release(&v);
    f.description = "ImageJ=1.53t\nimages=500\nslices=500\n";
    r = write_tiff("a.tif", &f, 1, 0);
    expect_failure("ImageJ beyond 4 GiB", &r, STATUS_INPUT, "500 images");
    f.description = "ImageJ=1.53t\nimages=x\nslices=-3\nspacing=nan\n";
    r = write_tiff("a.tif", &f, 2, 0);
    status = image_read(&r, &v);
    EXPECT(!status && v.dims[2] == 2 && v.matrix[2][2] == 1, "ImageJ of nonsense: %s", failure_text());
    image_release(&v);
}

#define OME_PIXELS(order, c, z, t)                                                                                     \
    "<?xml version='1.0'?><OME xmlns='http://www.openmicroscopy.org/Schemas/OME/2016-06'><Image ID='Image:0'>"         \
    "<Pixels DimensionOrder='" order "' Type=\"uint16\" SizeX='5' SizeY='4' SizeC='" c "' SizeZ='" z "' SizeT='" t     \
    "' PhysicalSizeX='0.5' PhysicalSizeY=\"0.25\" PhysicalSizeZ='1.5' "

static void test_ome(void) {
    static const double matrix[12] = {0.5, 0, 0, 0, 0, 0.25, 0, 0, 0, 0, 1.5, 0};
    tiff_form f = plain;
    f.description = OME_PIXELS("XYZCT", "2", "3", "2") "PhysicalSizeXUnit='mm' PhysicalSizeYUnit='mm' "
                                                       "PhysicalSizeZUnit='mm'></Pixels></Image></OME>";
    read_request r = write_tiff("a.tif", &f, 12, 0);
    r.component = r.frame = 1;
    read_image v;
    int status = image_read(&r, &v);
    EXPECT(!status && v.dims[0] == 5 && v.dims[1] == 4 && v.dims[2] == 3, "OME: %s", failure_text());
    for (uint64_t n = 0; !status && n < 60; n++) /* page z + 3 (c + 2 t) */
        EXPECT(image_value(&v, n) == test_value(TC_U16, n % 20 + 20 * (n / 20 + 3 * (1 + 2))), "OME: sample %d",
               (int)n);
    EXPECT(status || !memcmp(v.matrix, matrix, sizeof matrix), "OME: spacing");
    image_release(&v);

    f.description = OME_PIXELS("XYCZT", "2", "3", "1") "/></Image></OME>";
    r = write_tiff("a.tif", &f, 6, 0);
    r.component = 1;
    status = image_read(&r, &v);
    EXPECT(!status && v.dims[2] == 3 && image_value(&v, 20) == test_value(TC_U16, 60), "OME, channels first: %s",
           failure_text());
    image_release(&v);

    static const double in_mm[12] = {0.5, 0, 0, 0, 0, 250, 0, 0, 0, 0, 0.0015, 0};
    f.description = "<ome:OME xmlns:ome='http://www.openmicroscopy.org/Schemas/OME/2016-06'><ome:Pixels "
                    "DimensionOrder='XYZCT' SizeC='1' SizeZ='6' SizeT='1' PhysicalSizeX='0.5' PhysicalSizeXUnit='mm' "
                    "PhysicalSizeY='0.25' PhysicalSizeYUnit='m' PhysicalSizeZ='1.5'/></ome:OME>"; /* a prefix; units */
    r = write_tiff("a.tif", &f, 6, 0);
    status = image_read(&r, &v);
    EXPECT(!status && v.dims[2] == 6 && strcmp(v.d.units, "mm") == 0, "OME with a prefix: %s", failure_text());
    for (int n = 0; n < 12 && !status; n++)
        EXPECT(fabs(((const double *)v.matrix)[n] - in_mm[n]) <= 1e-12 * in_mm[n], "OME's units: element %d", n);
    image_release(&v);

    f.description = OME_PIXELS("XYCZT", "2", "9", "1") "/></Image></OME>"; /* other files have the rest */
    r = write_tiff("a.tif", &f, 6, 0);
    status = image_read(&r, &v);
    EXPECT(!status && v.dims[2] == 6, "OME of several files: %s", failure_text());
    image_release(&v);

    static const char *const nonsense[] = {OME_PIXELS("XYCZT", "1e300", "-3", "x") "/>",
                                           OME_PIXELS("XYCCC", "2", "3", "1"), OME_PIXELS("XYCZ", "2", "3", "1"),
                                           "http://www.openmicroscopy.org/Schemas/OME <Pixels DimensionOrder='XYZ",
                                           "openmicroscopy.org/Schemas/OME"};
    for (size_t n = 0; n < sizeof nonsense / sizeof *nonsense; n++) {
        f.description = nonsense[n];
        r = write_tiff("a.tif", &f, 6, 0);
        status = image_read(&r, &v);
        EXPECT(!status && v.dims[2] == 6, "OME of nonsense %d: %s", (int)n, failure_text());
        image_release(&v);
    }
}

static void test_packed_and_placed(void) {
    static const double matrix[12] = {1, 0, 0, 5, 0, 2, 0, 6, 0, 0, 3, 7};
    bytes file = tiff_file(&plain, 3, 0), packed = gzipped(file.data, file.size, AS_GZIP);
    read_request r = request_for(file_write("a.tif.gz", packed.data, packed.size));
    expected e = {.stored = TC_U16, .dims = {5, 4, 3}, .matrix = matrix};
    r.has_spacing = r.has_origin = 1;
    for (int a = 0; a < 3; a++) {
        r.spacing[a] = a + 1;
        r.origin[a] = a + 5;
    }
    expect_volume("packed by gzip", &r, &e);
    bytes_free(&packed);
    bytes_free(&file);
}

static void test_failures(void) {
    tiff_form f = plain, other = plain;
    size_t link;
    other.width = 6;
    bytes file = tiff_begin(&f, &link);
    tiff_page(&file, &f, 0, &link);
    tiff_page(&file, &other, 0, &link);
    read_request r = request_for(file_write("a.tif", file.data, file.size));
    expect_failure("pages of two sizes", &r, STATUS_INPUT, "page 2");
    bytes_free(&file);
    f.compression = 7; /* JPEG */
    r = write_tiff("a.tif", &f, 1, 0);
    expect_failure("JPEG", &r, STATUS_INPUT, "compression (number 7)");
    for (int is_tiled = 0; is_tiled < 2; is_tiled++)
        for (int c = 0; c < 2; c++) {
            f = plain;
            f.compression = c ? TIFF_DEFLATE : TIFF_NONE;
            f.tile = is_tiled ? 16 : 0;
            file = tiff_file(&f, 1, 0);
            for (size_t size = 0; size + 4 < file.size; size++) { /* all but the link to the next page */
                r = request_for(file_write("a.tif", file.data, size));
                expect_failure("cut", &r, STATUS_INPUT, "a.tif");
            }
            bytes_free(&file);
            file = tiff_file(&f, 2, 0);
            for (size_t n = 0; n < file.size; n++) { /* a byte is wrong: whatever is read */
                file.data[n] ^= 0x81;
                r = request_for(file_write("a.tif", file.data, file.size));
                r.describe = 1;
                read_image v;
                if (image_read(&r, &v) == 0) image_release(&v);
                file.data[n] ^= 0x81;
            }
            bytes_free(&file);
        }
}

int main(void) {
    folder_make("tiff");
    test_forms();
    test_components();
    test_lower_resolution();
    test_slices();
    test_imagej();
    test_ome();
    test_packed_and_placed();
    test_failures();
    folder_remove();
    return EXPECT_DONE();
}
