/*
 * test_nrrd_lenient.c - NRRD files as programs write them, approximate where their readers are: each is read as pynrrd
 * or ITK read it, with a notice where something was taken for something else
 */
#include "image_headers.h"

static void test_headers(void) {
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
static void test_repeated_fields(void) {
    static const header_case cases[] = {
        {NRRD_U8 "spacings: 1 1 1\nspacings: 2 3 4\n\n",
         "'spacings' twice: the last",
         {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0}},
        {NRRD_U8 "dimension: 2\n\n", "'dimension' twice: the first", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}},
        {NRRD_U8 "content: a\ncontent: b\n\n", NULL, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}};
    check_headers("a.nrrd", cases, sizeof cases / sizeof *cases);
}

/* Axes that are none of space, told by NaN alone. */
static void test_outside(void) {
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

static void test_hex(void) {
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
static void test_text(void) {
    bytes text = {0};
    for (uint64_t n = 0; n < COUNT; n++) bytes_text(&text, n % 2 ? "%.1f " : "%.17e\n", test_value(TC_I16, n));
    read_request r = request_for(
        file_behind("a.nrrd", "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 3\nencoding: ascii\n\n", &text));
    expected e = plain(TC_I16, NULL);
    expect_noticed("integers with a point", &r, &e, NULL);
    bytes_free(&text);
}

/* Data at the end of what streams unpack to, and some bytes before their end. */
static void test_byte_skip(void) {
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
static void test_lists(void) {
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
    folder_make("nrrd-lenient");
    test_headers();
    test_repeated_fields();
    test_outside();
    test_hex();
    test_text();
    test_byte_skip();
    test_lists();
    test_packed_masks();
    test_described();
    folder_remove();
    return EXPECT_DONE();
}
