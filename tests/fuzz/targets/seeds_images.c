/* seeds_images.c - raw, NRRD, MetaImage and NIfTI files; see seeds.h */
#include "seeds.h"

#include "tiff_files.h"

static const char plain[4] = {-1, -1, 0, 0}, detached[4] = {-1, -1, 1, 0}, second_value[4] = {1, -1, 0, 0},
                  second_frame[4] = {-1, 1, 0, 0}, second_of_both[4] = {1, 1, 0, 0}, length[4] = {-2, -1, 0, 0},
                  described[4] = {-1, -1, 0, 1}, placed[4] = {-1, -1, 0, 6};

static void add_raw(void) {
    for (int type = TC_U8; type <= TC_F64; type++) {
        bytes file = {0}, samples = test_samples(type, 24, type & 1);
        char name[32];
        static const double steps[6] = {1, 2, -3, 10, -20, 0.5};
        for (int a = 0; a < 3; a++) bytes_put(&file, (uint64_t)(4 - a), 8, 0);
        bytes_add(&file, steps, sizeof steps);
        bytes_put(&file, 0, 8, 0);
        bytes_put(&file, (uint64_t)type, 1, 0);
        bytes_put(&file, (uint64_t)type & 1, 1, 0);
        bytes_add(&file, samples.data, samples.size);
        snprintf(name, sizeof name, "type-%d", type);
        seed_file("raw", name, file.data, file.size, NULL, 0, plain);
        bytes_free(&file);
        bytes_free(&samples);
    }
}

/* Files packed as a whole, of formats that are found by what they begin with, and of none. */
static void add_packed(void) {
    static const char *const files[] = {
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n12345678",
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nPOINT_DATA 8\nSCALARS a "
        "int\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\n",
        "2 2 2\n0 1 0 1 0 1 0 1 0 0 1 1 0 0 1 1 0 0 0 0 1 1 1 1\n", "12345678"};
    static const char by_ending[4] = {-1, -1, 2, 0}, as_raw[4] = {-1, -1, 1, 0};
    for (int n = 0; n < 4; n++) {
        char name[32];
        bytes file = {0}, packed = gzipped((const unsigned char *)files[n], strlen(files[n]), AS_GZIP);
        for (int a = 0; a < 3; a++) bytes_put(&file, n == 3 ? 2 : 0, 8, 0);
        for (int byte = 0; byte < 56; byte++) bytes_put(&file, 0, 1, 0);
        bytes_put(&file, n == 3 ? 0 : 255, 2, 0); /* no type: the format is to be found */
        bytes_add(&file, packed.data, packed.size);
        snprintf(name, sizeof name, "packed-%d", n);
        seed_file("raw", name, file.data, file.size, NULL, 0, n == 3 ? as_raw : by_ending);
        bytes_free(&file);
        bytes_free(&packed);
    }
}

static const char nrrd_common[] = "NRRD0005\n# a comment\ncontent: a test\ndimension: 3\nsizes: 4 3 2\nendian: big\n"
                                  "labels: \"x\" \"y\" \"z\"\nkey:=value\n";

static void add_nrrd_types(void) {
    static const char *const types[] = {"uchar",      "int8",  "ushort", "int16_t",   "uint",
                                        "signed int", "float", "double", "long long", "uint64"};
    for (int type = 0; type < 10; type++) {
        bytes samples = test_samples(type, 24, 1), file = {0};
        char name[32];
        snprintf(name, sizeof name, "type-%d", type);
        bytes_text(&file, "%stype: %s\nencoding: raw\nspacings: 1 0.5 2\naxis mins: 1 2 3\ncenters: cell node cell\n\n",
                   nrrd_common, types[type]);
        bytes_add(&file, samples.data, samples.size);
        seed_file("nrrd", name, file.data, file.size, NULL, 0, plain);
        bytes_free(&file);
        bytes_free(&samples);
    }
}

static void add_nrrd_encodings(void) {
    bytes samples = test_samples(TC_I16, 24, 1);
    bytes gzip = gzipped(samples.data, samples.size, AS_GZIP), bzip2 = bzipped(samples.data, samples.size), text = {0};
    for (uint64_t i = 0; i < 24; i++) bytes_text(&text, "%.0f ", test_value(TC_I16, i));
    const bytes *parts[] = {&samples, &gzip, &bzip2, &text};
    static const char *const names[] = {"raw", "gzip", "bzip2", "ascii"};
    for (int n = 0; n < 4; n++) {
        bytes file = {0};
        char name[32];
        bytes_text(&file,
                   "%stype: short\nencoding: %s\nspace: left-posterior-superior\nspace directions: (1,0,0) (0,-1,0.5) "
                   "(0,0,2)\nspace origin: (10,-20,1e3)\nkinds: domain domain domain\n%s\n",
                   nrrd_common, names[n], n == 0 ? "byte skip: -1\n" : "");
        bytes_add(&file, parts[n]->data, parts[n]->size);
        seed_file("nrrd", names[n], file.data, file.size, NULL, 0, plain);
        bytes_free(&file);
        bytes_text(&file, "%stype: short\nencoding: %s\nline skip: 0\nbyte skip: 0\ndata file: %s\n", nrrd_common,
                   names[n], n == 3 ? "part%d.raw 1 1 1" : "samples.raw");
        snprintf(name, sizeof name, "detached-%s", names[n]);
        seed_file("nrrd", name, file.data, file.size, parts[n]->data, parts[n]->size, detached);
        bytes_free(&file);
    }
    bytes_free(&samples);
    bytes_free(&gzip);
    bytes_free(&bzip2);
    bytes_free(&text);
}

static void add_nrrd_axes(void) {
    static const char list[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\ndata file: LIST 2\n"
                               "a1.raw\nsub/a1.raw\n",
                      pattern[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n"
                                  "data file: slice.%03d.raw 1 11 10 2\n",
                      vector[] = "NRRD0003\ntype: uchar\ndimension: 4\nsizes: 2 2 2 1\nencoding: raw\nkinds: vector "
                                 "domain domain domain\nspace dimension: 3\nspace directions: none (1,0,0) (0,1,0) "
                                 "(0,0,1)\n\n12345678",
                      time[] =
                          "NRRD0002\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\nkinds: domain domain "
                          "domain time\nspace: 3D-right-handed-time\nspace origin: (0,0,0,1)\n"
                          "axis maxs: 1 2 3 4\nthicknesses: nan nan 1 nan\nunits: \"mm\" \"mm\" \"mm\" \"s\"\n"
                          "\n0123456789abcdef";
    seed_file("nrrd", "list", list, strlen(list), "1234", 4, detached);
    seed_file("nrrd", "pattern", pattern, strlen(pattern), "1234", 4, detached);
    seed_file("nrrd", "vector", vector, strlen(vector), NULL, 0, second_value);
    seed_file("nrrd", "time", time, strlen(time), NULL, 0, second_frame);
}

/* Headers that leave much unknown, data at the end of what they unpack to, digits, several values per sample. */
static void add_nrrd_loose(void) {
    static const char unknown[] = "NRRD00.01\nsizes: 2 2 2\ntype:uchar\nencoding: raw\nspacings: nan 0 inf\n"
                                  "axis mins: nan 1 inf\ndimension: 3\n\n12345678",
                      turned[] = "NRRD0005\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nspace: RAS\n"
                                 "spacedirections: (nan,nan,nan) (1,0,0) (0,1,0)\nspaceorigin: (nan,nan,nan)\n"
                                 "\n12345678",
                      hex[] = "NRRD0005\ntype: short\ndimension: 3\nsizes: 2 2 1\nendian: big\nencoding: hex\n\n"
                              "0123 4567 89ab cdEF",
                      vector[] = "NRRD0005\ntype: longlong\ndimension: 4\nsizes: 3 2 1 1\nencoding: ascii\n"
                                 "kinds: 3-vector space space space\n\n1 2 3.0 4 5e0 -6",
                      planes[] = "NRRD0005\ntype: uchar\ndimension: 5\nsizes: 2 1 2 2 2\nencoding: raw\n"
                                 "kinds: space space space vector time\n\n0123456789abcdef",
                      slabs[] = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nbyte skip: -3\n"
                                "data file: LIST 3\na1.raw\nsub/a1.raw\n";
    seed_file("nrrd", "unknown", unknown, strlen(unknown), NULL, 0, placed);
    seed_file("nrrd", "turned", turned, strlen(turned), NULL, 0, plain);
    seed_file("nrrd", "hex", hex, strlen(hex), NULL, 0, plain);
    seed_file("nrrd", "vector-length", vector, strlen(vector), NULL, 0, length);
    seed_file("nrrd", "planes-described", planes, strlen(planes), NULL, 0, described);
    seed_file("nrrd", "slabs", slabs, strlen(slabs), "x1234yz", 7, detached);
    for (int bzip2 = 0; bzip2 < 2; bzip2++) {
        static const char inner[] = "before 12345678 behind";
        bytes packed = bzip2 ? bzipped((const unsigned char *)inner, sizeof inner - 1)
                             : gzipped((const unsigned char *)inner, sizeof inner - 1, AS_GZIP),
              file = {0};
        bytes_text(&file, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: %s\nbyte skip: -8\n\n",
                   bzip2 ? "bzip2" : "gzip");
        bytes_add(&file, packed.data, packed.size);
        seed_file("nrrd", bzip2 ? "end-of-bzip2" : "end-of-gzip", file.data, file.size, NULL, 0, plain);
        bytes_free(&packed);
        bytes_free(&file);
    }
}

static void add_metaimage_loose(void) {
    static const char colons[] = "objecttype: Image\nndims: 3\nDimSize: 2.0 2 2 7\nElementSpacing: 0 -1 nan 4\n"
                                 "TransformMatrix: 0 1 0\n 1 0 0\n 0 0 1\nelementtype: met_uchar\n"
                                 "ElementDataFile: local\n12345678",
                      behind[] = "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nHeaderSize =  90\n"
                                 "ElementDataFile = LOCAL\nabcd12345678",
                      list[] = "NDims = 3\nDimSize = 2 2 1\nElementType = MET_UCHAR\nHeaderSize = -1\n"
                               "ElementDataFile = list\n1.raw\n1.raw\n1.raw\n",
                      colours[] = "NDims = 4\nDimSize = 2 1 1 2\nElementNumberOfChannels = 3\n"
                                  "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n0123456789ab";
    seed_file("metaimage", "colons", colons, strlen(colons), NULL, 0, placed);
    seed_file("metaimage", "behind-header", behind, strlen(behind), NULL, 0, plain);
    seed_file("metaimage", "list-longer", list, strlen(list), "1234", 4, detached);
    seed_file("metaimage", "colours", colours, strlen(colours), NULL, 0, described);
}

static void add_metaimage(void) {
    static const char common[] = "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\nElementSpacing = 1 0.5 2\n"
                                 "Offset = 1 -2 1e3\nTransformMatrix = 1 0 0 0 0 1 0 -1 0\nCenterOfRotation = 0 0 0\n"
                                 "AnatomicalOrientation = RAI\n";
    static const char *const types[] = {"MET_UCHAR", "MET_CHAR",  "MET_USHORT", "MET_SHORT",     "MET_UINT",
                                        "MET_INT",   "MET_FLOAT", "MET_DOUBLE", "MET_LONG_LONG", "MET_ULONG_LONG"};
    for (int n = 0; n < 30; n++) {
        int type = n % 10, form = n / 10; /* attached, compressed, in a file of its own */
        bytes samples = test_samples(type, 24, type & 1), packed = gzipped(samples.data, samples.size, AS_ZLIB),
              file = {0};
        const bytes *data = form == 1 ? &packed : &samples;
        char name[32];
        snprintf(name, sizeof name, "form-%d-type-%d", form, type);
        bytes_text(&file,
                   "%sElementType = %s\nBinaryData = True\nBinaryDataByteOrderMSB = %s\n%sElementDataFile = %s\n",
                   common, types[type], type & 1 ? "True" : "False",
                   form == 1 ? "CompressedData = True\nCompressedDataSize = 9\n" : "HeaderSize = 0\n",
                   form == 2 ? "samples.raw" : "LOCAL");
        if (form < 2) bytes_add(&file, data->data, data->size);
        seed_file("metaimage", name, file.data, file.size, form == 2 ? data->data : NULL, data->size,
                  form == 2 ? detached : plain);
        bytes_free(&file);
        bytes_free(&packed);
        bytes_free(&samples);
    }
    static const char list[] = "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\nElementSize = 1 1 1\n"
                               "ElementDataFile = LIST 2D\n1.raw\n1.raw\n",
                      pattern[] = "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"
                                  "ElementDataFile = s%d.raw 1 11 10\n",
                      text[] =
                          "NDims = 4\nDimSize = 2 2 2 2\nElementNumberOfChannels = 2\nElementType = MET_CHAR_ARRAY\n"
                          "BinaryData = False\nPosition = 1 2 3 4\nElementDataFile = LOCAL\n1 2 3 4 5 6 7 8 9 10 "
                          "11 12 13 14 15 16 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 -1";
    seed_file("metaimage", "list", list, strlen(list), "1234", 4, detached);
    seed_file("metaimage", "pattern", pattern, strlen(pattern), "1234", 4, detached);
    seed_file("metaimage", "text", text, strlen(text), NULL, 0, second_of_both);
}

static void add_nifti(int version, int big, int packed, int is_pair) {
    static const int codes[] = {2, 256, 512, 4, 768, 8, 16, 64, 1024, 1280};
    for (int type = 0; type < 10; type++) {
        char name[64];
        nifti_fields f = nifti_plain(version, codes[type], (int)stored_bytes(type) * 8, 4, 3, 2);
        f.big = big;
        f.qform = type & 1;
        f.sform = type >> 1 & 1;
        f.quatern[1] = 0.5;
        for (int n = 0; n < 3; n++) f.srow[5 * n] = n + 1;
        f.slope = type & 1 ? 2 : 0;
        if (is_pair) f.magic = "ni";
        if (is_pair) f.vox_offset = 0;
        bytes samples = test_samples(type, 24, big), header = nifti_header_bytes(&f);
        if (!is_pair) bytes_add(&header, samples.data, samples.size);
        bytes *last = is_pair ? &samples : &header, gzip = gzipped(last->data, last->size, AS_GZIP);
        snprintf(name, sizeof name, "version-%d-big-%d-packed-%d-pair-%d-type-%d", version, big, packed, is_pair, type);
        const char options[4] = {-1, -1, (char)(is_pair ? 2 : packed), 0};
        const bytes *stored = packed ? &gzip : last;
        if (is_pair)
            seed_file("nifti", name, header.data, version == 1 ? 348 : 540, stored->data, stored->size, options);
        else
            seed_file("nifti", name, stored->data, stored->size, NULL, 0, options);
        bytes_free(&samples);
        bytes_free(&header);
        bytes_free(&gzip);
    }
}

/* Analyze, forms of zeros, sizes of 0, one file that says that it is a pair, CIFTI. */
static void add_nifti_loose(void) {
    static const char pair[4] = {-1, -1, 2, 0};
    bytes samples = test_samples(TC_I16, 24, 0);
    for (int n = 0; n < 4; n++) {
        nifti_fields f = nifti_plain(n == 3 ? 2 : 1, 4, 16, 4, 3, 2);
        char name[32];
        f.dim[0] = 5;
        f.dim[4] = f.dim[5] = 0;
        f.sform = f.qform = n == 1;
        if (n == 1) f.quatern[0] = (double)NAN;
        if (n == 1)
            for (int i = 0; i < 4; i++) f.pixdim[i] = 0;
        f.vox_offset = 0;
        if (n == 0) f.magic = "";
        if (n == 2) f.magic = "ni";
        bytes file = nifti_header_bytes(&f);
        if (n == 0) memset(file.data + 344, 0, 4);
        if (n == 3) put_at(&file, 504, 3006, 4, 0);
        snprintf(name, sizeof name, "loose-%d", n);
        if (n) bytes_add(&file, samples.data, samples.size);
        if (n)
            seed_file("nifti", name, file.data, file.size, NULL, 0, plain);
        else
            seed_file("nifti", name, file.data, 348, samples.data, samples.size, pair);
        bytes_free(&file);
    }
    bytes_free(&samples);
}

/* Every type, both orders of axes and bytes; frames and components. */
static void add_npy(void) {
    static const char *const kinds[] = {"|u1", ">i1", "<u2", ">i2", "<u4", ">i4", "<f4", ">f8", "<i8", ">u8"};
    static const char *const shapes[] = {"(2, 3, 4)", "(24,)", "(2, 1, 3, 4)", "(1, 2, 4, 3)", "(2, 1, 2, 3, 2)"};
    for (int type = 0; type < 10; type++) {
        char dictionary[120], name[32];
        bytes file = {0}, samples = test_samples(type, 24, type & 1);
        snprintf(dictionary, sizeof dictionary, "{'descr': '%s', 'fortran_order': %s, 'shape': %s, }\n", kinds[type],
                 type % 3 ? "False" : "True", shapes[type % 5]);
        bytes_text(&file, "\x93NUMPY%c", 1 + type % 3);
        bytes_put(&file, 0, 1, 0);
        bytes_put(&file, strlen(dictionary), type % 3 ? 4 : 2, 0);
        bytes_text(&file, "%s", dictionary);
        bytes_add(&file, samples.data, samples.size);
        snprintf(name, sizeof name, "type-%d", type);
        seed_file("npy", name, file.data, file.size, NULL, 0, type % 5 < 2 ? plain : second_of_both);
        bytes_free(&file);
        bytes_free(&samples);
    }
}

/* Every type, packing and order of bytes, strips and tiles; what ImageJ notes. */
static void add_tiff(void) {
    static const int packings[] = {TIFF_NONE, TIFF_DEFLATE, TIFF_PACKBITS};
    for (int n = 0; n < 24; n++) {
        const tiff_form form = {.type = n % 10,
                                .is_big_endian = n & 1,
                                .is_big_tiff = n >> 1 & 1,
                                .compression = packings[n % 3],
                                .width = 4,
                                .height = 3,
                                .samples = n % 8 == 6 ? 3 : 1,
                                .rows = 1 + n % 3,
                                .tile = n & 4 ? 16 : 0,
                                .description = n & 8 ? "ImageJ=1.53t\nimages=2\nslices=1\nframes=2\nspacing=2\n" : NULL,
                                .resolution = {2, 3}};
        char name[32];
        bytes file = tiff_file(&form, 1 + n % 3, 0);
        snprintf(name, sizeof name, "form-%d", n);
        seed_file("tiff", name, file.data, file.size, NULL, 0, form.samples > 1 ? second_value : plain);
        bytes_free(&file);
    }
}

/* Headers that ask for a thousand million bytes, of eight packed ones. */
static void add_bombs(void) {
    bytes gzip = gzipped((const unsigned char *)"12345678", 8, AS_GZIP),
          bzip2 = bzipped((const unsigned char *)"12345678", 8);
    nifti_fields f = nifti_plain(1, 2, 8, 32767, 32767, 1);
    bytes header = nifti_header_bytes(&f), nifti = gzipped(header.data, header.size, AS_GZIP), file = {0};
    for (int n = 0; n < 2; n++) {
        const bytes *data = n ? &bzip2 : &gzip;
        bytes_text(&file, "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1000 1000 1000\nencoding: %s\n\n",
                   n ? "bzip2" : "gzip");
        bytes_add(&file, data->data, data->size);
        seed_file("nrrd", n ? "bomb-bzip2" : "bomb-gzip", file.data, file.size, NULL, 0, plain);
        bytes_free(&file);
    }
    bytes_text(&file, "NDims = 3\nDimSize = 1000 1000 1000\nElementType = MET_UCHAR\nCompressedData = True\n"
                      "ElementDataFile = LOCAL\n");
    bytes_add(&file, gzip.data, gzip.size);
    seed_file("metaimage", "bomb", file.data, file.size, NULL, 0, plain);
    seed_file("nifti", "bomb", nifti.data, nifti.size, NULL, 0, plain);
    bytes_free(&file);
    bytes_free(&nifti);
    bytes_free(&header);
    bytes_free(&gzip);
    bytes_free(&bzip2);
}

void seeds_images(void) {
    add_bombs();
    add_raw();
    add_packed();
    add_nrrd_types();
    add_nrrd_encodings();
    add_nrrd_axes();
    add_nrrd_loose();
    add_metaimage();
    add_metaimage_loose();
    add_nifti_loose();
    add_npy();
    add_tiff();
    for (int n = 0; n < 16; n++) add_nifti(1 + (n & 1), n >> 1 & 1, n >> 2 & 1, n >> 3);
}
