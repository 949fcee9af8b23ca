/*
 * tiff_pages.c - the pages of TIFF files; see tiff_pages.h
 *
 * Source: "TIFF Revision 6.0", Adobe; "BigTIFF", AWare Systems; libtiff's documentation. libtiff reads from the mapped
 * file, so that what is packed by gzip or comes on standard input is read as well.
 */
#include "image/tiff_pages.h"

#include "exit_status.h"
#include "failure.h"
#include "file/unpack.h"
#include "stored_types.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>

enum { PAGES_MOST = 1 << 20, ALLOCATION_MOST = 256 << 20, MESSAGE_BYTES = 160 };

/* A file as libtiff reads it. */
typedef struct reader {
    const char *path;
    const mapping *file;
    uint64_t position;
    char message[MESSAGE_BYTES]; /* libtiff's first */
    TIFF *tiff;
} reader;

/* --------------------------------------------------------------------------------------------------------- libtiff */

static tmsize_t take_bytes(thandle_t handle, void *to, tmsize_t bytes) {
    reader *r = (reader *)handle;
    const uint64_t left = r->position < r->file->size ? r->file->size - r->position : 0;
    const uint64_t taken = (uint64_t)bytes < left ? (uint64_t)bytes : left;
    if (taken) memcpy(to, r->file->bytes + r->position, taken);
    r->position += taken;
    return (tmsize_t)taken;
}

static tmsize_t put_nothing(thandle_t handle, void *from, tmsize_t bytes) {
    (void)handle, (void)from, (void)bytes;
    return 0;
}

static toff_t seek(thandle_t handle, toff_t offset, int from) {
    reader *r = (reader *)handle;
    r->position = offset + (from == SEEK_CUR ? r->position : from == SEEK_END ? r->file->size : 0);
    return r->position;
}

static int close_nothing(thandle_t handle) {
    (void)handle;
    return 0;
}

static toff_t size_of(thandle_t handle) { return ((reader *)handle)->file->size; }

static int map_all(thandle_t handle, void **base, toff_t *size) {
    const reader *r = (reader *)handle;
    *base = (void *)(uintptr_t)r->file->bytes;
    *size = r->file->size;
    return 1;
}

static void unmap_nothing(thandle_t handle, void *base, toff_t size) { (void)handle, (void)base, (void)size; }

static int keep_error(TIFF *tiff, void *user, const char *module, const char *format, va_list arguments) {
    reader *r = user;
    (void)tiff, (void)module;
    if (!*r->message) vsnprintf(r->message, sizeof r->message, format, arguments);
    for (char *at = r->message; *at; at++)
        if ((unsigned char)*at < ' ') *at = '?';
    return 1;
}

static int drop_warning(TIFF *tiff, void *user, const char *module, const char *format, va_list arguments) {
    (void)tiff, (void)user, (void)module, (void)format, (void)arguments;
    return 1;
}

/* Whether libtiff says that there is no memory, and not that the file asks for too much. "Out of memory reading of" a
 * tag is what libtiff 4.7 says of a tag that would be larger than the file. */
static int is_of_memory(const char *message) {
    static const char *const parts[] = {"memory", "malloc", "No space", "Insertion"};
    if (strncmp(message, "Out of memory reading of", 24) == 0) return 0;
    for (size_t n = 0; n < sizeof parts / sizeof *parts; n++)
        if (strstr(message, parts[n])) return !strstr(message, "limit");
    return 0;
}

static int fail_damaged(const reader *r, const char *what) {
    if (is_of_memory(r->message)) return fail(STATUS_FAILED, "%s: no memory for its pages: %s", r->path, r->message);
    return fail(STATUS_INPUT, "%s: %s%s%s; the file is damaged or cut", r->path, what, *r->message ? ": " : "",
                r->message);
}

static int is_tiff(const mapping *file) {
    static const char *const marks[] = {"II*", "MM\0*", "II+", "MM\0+"}; /* BigTIFF's have a + */
    for (size_t n = 0; n < sizeof marks / sizeof *marks; n++)
        if (file->size >= 4 && memcmp(file->bytes, marks[n], 4) == 0) return 1;
    return 0;
}

static int open_tiff(reader *r, const char *path, const mapping *file) {
    *r = (reader){.path = path, .file = file};
    if (!is_tiff(file))
        return fail(
            STATUS_INPUT,
            "%s: is no TIFF, by its first bytes; slices of raw samples are listed by a NRRD header, as in 'data file: "
            "slice.%%d 1 93 1'",
            path);
    TIFFOpenOptions *options = file->size ? TIFFOpenOptionsAlloc() : NULL;
    if (file->size && !options) return fail(STATUS_FAILED, "%s: no memory to read it", path);
    if (options) {
        TIFFOpenOptionsSetMaxSingleMemAlloc(options, ALLOCATION_MOST);
        TIFFOpenOptionsSetErrorHandlerExtR(options, keep_error, r);
        TIFFOpenOptionsSetWarningHandlerExtR(options, drop_warning, NULL);
        r->tiff = TIFFClientOpenExt("", "rc", r, take_bytes, put_nothing, seek, close_nothing, size_of, map_all,
                                    unmap_nothing, options);
        TIFFOpenOptionsFree(options);
    }
    return r->tiff ? 0 : fail_damaged(r, "its beginning cannot be read");
}

/* ----------------------------------------------------------------------------------------------------------- pages */

static const struct packing {
    uint16_t compression;
    unsigned limit; /* so many unpacked bytes to a packed one, at most */
} packings[] = {{COMPRESSION_NONE, 1},       {COMPRESSION_PACKBITS, 64},
                {COMPRESSION_LZW, 4096},     {COMPRESSION_ADOBE_DEFLATE, 1032},
                {COMPRESSION_DEFLATE, 1032}, {COMPRESSION_LZMA, 7050},
                {COMPRESSION_ZSTD, 50000}};

static const struct packing *packing_of_page(TIFF *t) {
    uint16_t compression = COMPRESSION_NONE;
    TIFFGetFieldDefaulted(t, TIFFTAG_COMPRESSION, &compression);
    for (size_t n = 0; n < sizeof packings / sizeof *packings; n++)
        if (packings[n].compression == compression && TIFFIsCODECConfigured(compression)) return &packings[n];
    return NULL;
}

static uint16_t short_field(TIFF *t, uint32_t tag) {
    uint16_t value = 0;
    TIFFGetFieldDefaulted(t, tag, &value);
    return value;
}

/* The type of samples of that format and so many bits; -1 where there is none. */
static int element_of(uint16_t format, uint16_t bits) {
    const int is_real = format == SAMPLEFORMAT_IEEEFP, is_signed = format == SAMPLEFORMAT_INT;
    if (!is_real && !is_signed && format != SAMPLEFORMAT_UINT && format != SAMPLEFORMAT_VOID) return -1;
    for (int element = 0; element < ELEMENT_COUNT; element++) {
        const int has_sign = element == TC_I8 || element == TC_I16 || element == TC_I32 || element == ELEMENT_I64;
        if (8 * element_bytes(element) == bits && element_is_real(element) == is_real &&
            (is_real || has_sign == is_signed))
            return element;
    }
    return -1;
}

uint64_t tiff_page_bytes(const tiff_shape *s) {
    uint64_t bytes = element_bytes(s->element);
    if (__builtin_mul_overflow(bytes, (uint64_t)s->samples, &bytes) ||
        __builtin_mul_overflow(bytes, (uint64_t)s->width, &bytes) ||
        __builtin_mul_overflow(bytes, (uint64_t)s->height, &bytes))
        return UINT64_MAX;
    return bytes;
}

static int same_shape(const tiff_shape *a, const tiff_shape *b) {
    return a->width == b->width && a->height == b->height && a->samples == b->samples && a->element == b->element;
}

static int read_shape(const reader *r, tiff_shape *s) {
    TIFF *t = r->tiff;
    uint32_t width = 0, height = 0, depth = 1;
    const uint16_t bits = short_field(t, TIFFTAG_BITSPERSAMPLE), format = short_field(t, TIFFTAG_SAMPLEFORMAT),
                   photometric = short_field(t, TIFFTAG_PHOTOMETRIC);
    TIFFGetField(t, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(t, TIFFTAG_IMAGELENGTH, &height);
    TIFFGetFieldDefaulted(t, TIFFTAG_IMAGEDEPTH, &depth);
    *s = (tiff_shape){width, height, short_field(t, TIFFTAG_SAMPLESPERPIXEL), element_of(format, bits)};
    if (!width || !height || !s->samples || depth > 1) return fail_damaged(r, "has a page without pixels");
    if (s->element < 0)
        return fail(STATUS_INPUT,
                    "%s: its samples of %u bits (format %u) cannot be read; integers of 8 to 64 bits and numbers of "
                    "floating point of 32 and 64 can",
                    r->path, bits, format);
    if (photometric == PHOTOMETRIC_YCBCR ||
        (s->samples > 1 && short_field(t, TIFFTAG_PLANARCONFIG) != PLANARCONFIG_CONTIG))
        return fail(STATUS_INPUT,
                    "%s: its values of a pixel do not lie beside each other; save it with interleaved ones", r->path);
    if (packing_of_page(t)) return 0;
    return fail(STATUS_INPUT,
                "%s: its compression (number %u) cannot be read; save it uncompressed, or by LZW or Deflate", r->path,
                short_field(t, TIFFTAG_COMPRESSION));
}

static int is_of_lower_resolution(TIFF *t) {
    uint32_t kind = 0;
    TIFFGetFieldDefaulted(t, TIFFTAG_SUBFILETYPE, &kind);
    return (kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) != 0;
}

/* A line "name=value" of the description; `otherwise` where there is none, or its value is none. */
static double note_of(const char *description, const char *name, double otherwise) {
    const size_t length = strlen(name);
    for (const char *at = description; *at; at += strcspn(at, "\n"), at += *at == '\n')
        if (strncmp(at, name, length) == 0 && at[length] == '=') {
            char *end;
            const double value = strtod(at + length + 1, &end);
            return end != at + length + 1 && value > 0 && value < 1e9 ? value : otherwise;
        }
    return otherwise;
}

/* More than there are pages, so that products of sizes do not overflow. */
static int64_t noted_size(double noted) { return noted <= PAGES_MOST ? (int64_t)noted : PAGES_MOST + 1; }

/* ImageJ writes channels, slices and frames in this order. */
static void read_imagej(TIFF *t, const char *text, tiff_notes *n) {
    static const char *const names[TIFF_DIMENSIONS] = {"channels", "slices", "frames"};
    float per_unit[2] = {0, 0};
    n->writer = TIFF_IMAGEJ;
    n->images = (int64_t)note_of(text, "images", 1);
    for (int d = 0; d < TIFF_DIMENSIONS; d++) {
        n->sizes[d] = noted_size(note_of(text, names[d], 1));
        n->order[d] = d;
    }
    n->spacing[2] = note_of(text, "spacing", 1);
    TIFFGetField(t, TIFFTAG_XRESOLUTION, &per_unit[0]);
    TIFFGetField(t, TIFFTAG_YRESOLUTION, &per_unit[1]);
    for (int axis = 0; axis < 2; axis++)
        if (per_unit[axis] > 0 && per_unit[axis] < 1e9f) n->spacing[axis] = 1 / (double)per_unit[axis];
}

/* The value of an attribute of the XML tag that begins at `tag`, with its end in *length; NULL where it has none. One
 * tag is all that is needed of OME-XML, so builds without expat read it too. */
static const char *attribute_of(const char *tag, const char *name, size_t *length) {
    const size_t name_length = strlen(name);
    for (const char *at = tag + strcspn(tag, " \t\r\n>"); *at && *at != '>';) {
        at += strspn(at, " \t\r\n/");
        const char *quote = at + strcspn(at, "\"'>");
        if (!*quote || *quote == '>') return NULL;
        const size_t value = strcspn(quote + 1, *quote == '"' ? "\"" : "'");
        *length = value;
        if (strncmp(at, name, name_length) == 0 && (at[name_length] == '=' || at[name_length] == ' ')) return quote + 1;
        if (!quote[1 + value]) return NULL;
        at = quote + value + 2;
    }
    return NULL;
}

static double number_of(const char *tag, const char *name, double otherwise) {
    size_t length;
    const char *text = attribute_of(tag, name, &length);
    char *end;
    const double value = text ? strtod(text, &end) : 0;
    return text && end == text + length && value > 0 && value < 1e9 ? value : otherwise;
}

/* Units of distances, by how many micrometres they are. Where none stands there it is the micrometre, as the model has
 * it. */
static const struct {
    const char *written, *name;
    double micrometres;
} units[] = {{"\xc2\xb5m", "um", 1}, {"\xce\xbcm", "um", 1}, {"nm", "nm", 1e-3},
             {"mm", "mm", 1e3},      {"cm", "cm", 1e4},      {"m", "m", 1e6}};

enum { UNIT_COUNT = sizeof units / sizeof *units };

/* The index of an attribute's unit; UNIT_COUNT for one that is not known. */
static int unit_of(const char *tag, const char *name) {
    size_t length;
    const char *text = attribute_of(tag, name, &length);
    int n = 0;
    while (text && n < UNIT_COUNT && (length != strlen(units[n].written) || strncmp(text, units[n].written, length)))
        n++;
    return n;
}

/* Distances in the unit of the first axis, as far as units are known. */
static void read_spacing(const char *tag, tiff_notes *n) {
    static const char *const steps[3] = {"PhysicalSizeX", "PhysicalSizeY", "PhysicalSizeZ"};
    static const char *const names[3] = {"PhysicalSizeXUnit", "PhysicalSizeYUnit", "PhysicalSizeZUnit"};
    const int first = unit_of(tag, names[0]);
    size_t length;
    for (int axis = 0; axis < 3; axis++) {
        const int own = unit_of(tag, names[axis]);
        n->spacing[axis] = number_of(tag, steps[axis], 1);
        if (own < UNIT_COUNT && first < UNIT_COUNT && attribute_of(tag, steps[axis], &length))
            n->spacing[axis] *= units[own].micrometres / units[first].micrometres;
    }
    if (first < UNIT_COUNT && attribute_of(tag, steps[0], &length)) n->units = units[first].name;
}

static void read_ome(const char *text, tiff_notes *n) {
    static const char kinds[] = "CZT"; /* as TIFF_CHANNELS and the next */
    static const char *const sizes[TIFF_DIMENSIONS] = {"SizeC", "SizeZ", "SizeT"};
    const char *plain = strstr(text, "<Pixels"), *tag = plain ? plain : strstr(text, ":Pixels");
    size_t length;
    const char *order = tag ? attribute_of(tag, "DimensionOrder", &length) : NULL;
    if (!order || length != 5 || strncmp(order, "XY", 2) != 0) return;
    for (int d = 0; d < TIFF_DIMENSIONS; d++) {
        const char *kind = memchr(kinds, order[2 + d], TIFF_DIMENSIONS);
        if (!kind || memchr(order + 2, order[2 + d], (size_t)d)) return;
        n->order[d] = (int)(kind - kinds);
        n->sizes[d] = noted_size(number_of(tag, sizes[d], 1));
    }
    n->writer = TIFF_OME;
    n->images = n->sizes[0] * n->sizes[1] * n->sizes[2];
    read_spacing(tag, n);
}

static void read_notes(TIFF *t, tiff_notes *n) {
    const char *text = NULL;
    *n = (tiff_notes){.spacing = {1, 1, 1}};
    if (!TIFFGetField(t, TIFFTAG_IMAGEDESCRIPTION, &text) || !text) return;
    if (strncmp(text, "ImageJ=", 7) == 0)
        read_imagej(t, text, n);
    else if (strstr(text, "openmicroscopy.org/Schemas/OME"))
        read_ome(text, n);
}

int tiff_measure(const char *path, const mapping *file, tiff_shape *shape, tiff_notes *notes, int64_t *pages,
                 int64_t *passed) {
    reader r;
    uint64_t packed_least = 0; /* bytes that the pages take at least */
    int status = open_tiff(&r, path, file);
    for (int more = !status; more && !status; more = TIFFReadDirectory(r.tiff)) {
        tiff_shape own;
        if (is_of_lower_resolution(r.tiff)) {
            ++*passed;
            continue;
        }
        if ((status = read_shape(&r, &own))) break;
        if (!shape->width) {
            *shape = own;
            read_notes(r.tiff, notes);
        }
        const uint64_t bytes = tiff_page_bytes(&own);
        const unsigned limit = packing_of_page(r.tiff)->limit;
        packed_least += bytes / limit + (bytes / limit == 0);
        if (!same_shape(&own, shape))
            status = fail(STATUS_INPUT,
                          "%s: page %" PRId64 " is of %" PRId64 " x %" PRId64
                          " pixels or of a type that is not that of the first page, %" PRId64 " x %" PRId64
                          ": name a file whose pages are alike",
                          path, *pages + 1, own.width, own.height, shape->width, shape->height);
        else if (packed_least > file->size)
            status = fail(STATUS_INPUT,
                          "%s: is %zu bytes long, which cannot hold the pages that it declares; the file is damaged or "
                          "cut",
                          path, file->size);
        else if (++*pages > PAGES_MOST)
            status = fail(STATUS_INPUT, "%s: has more than %d pages; split it", path, PAGES_MOST);
    }
    if (!status && *r.message) status = fail_damaged(&r, "has a page that cannot be read");
    if (r.tiff) TIFFClose(r.tiff);
    return status;
}

/* ---------------------------------------------------------------------------------------------------------- pixels */

static int load_strips(const reader *r, const tiff_shape *s, unsigned char *to) {
    const uint64_t bytes = tiff_page_bytes(s), row = bytes / (uint64_t)s->height;
    uint32_t rows = 0;
    TIFFGetFieldDefaulted(r->tiff, TIFFTAG_ROWSPERSTRIP, &rows);
    if (!rows || rows > s->height) rows = (uint32_t)s->height;
    for (uint64_t at = 0, strip = 0; at < bytes; at += row * rows, strip++) {
        const uint64_t wanted = bytes - at < row * rows ? bytes - at : row * rows;
        if (TIFFReadEncodedStrip(r->tiff, (uint32_t)strip, to + at, (tmsize_t)wanted) != (tmsize_t)wanted)
            return fail_damaged(r, "has pixels that cannot be read");
    }
    return 0;
}

static int load_tiles(const reader *r, const tiff_shape *s, unsigned char *to) {
    const uint64_t pixel = element_bytes(s->element) * (uint64_t)s->samples, row = pixel * (uint64_t)s->width;
    uint32_t width = 0, height = 0;
    TIFFGetField(r->tiff, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(r->tiff, TIFFTAG_TILELENGTH, &height);
    const uint64_t bytes = TIFFTileSize64(r->tiff);
    if (!width || !height || bytes / width / height != pixel) return fail_damaged(r, "has tiles without a size");
    int status = unpack_ratio_check(r->path, r->file->size, bytes, packing_of_page(r->tiff)->limit);
    unsigned char *tile = status ? NULL : malloc(bytes);
    if (!status && !tile) status = fail(STATUS_FAILED, "%s: no memory for a tile of %" PRIu64 " bytes", r->path, bytes);
    for (int64_t y = 0; y < s->height && !status; y += height)
        for (int64_t x = 0; x < s->width && !status; x += width) {
            const uint32_t number = TIFFComputeTile(r->tiff, (uint32_t)x, (uint32_t)y, 0, 0);
            const uint64_t kept = pixel * (uint64_t)(s->width - x < width ? s->width - x : width);
            if (TIFFReadEncodedTile(r->tiff, number, tile, (tmsize_t)bytes) != (tmsize_t)bytes)
                status = fail_damaged(r, "has pixels that cannot be read");
            for (int64_t n = 0; n < height && y + n < s->height && !status; n++)
                memcpy(to + (uint64_t)(y + n) * row + (uint64_t)x * pixel, tile + (uint64_t)n * width * pixel, kept);
        }
    free(tile);
    return status;
}

int tiff_load(const char *path, const mapping *file, const tiff_shape *shape, int64_t pages, unsigned char *to) {
    reader r;
    int status = open_tiff(&r, path, file);
    int64_t loaded = 0;
    for (int more = !status; more && !status && loaded < pages; more = TIFFReadDirectory(r.tiff)) {
        tiff_shape own;
        if (is_of_lower_resolution(r.tiff)) continue;
        if ((status = read_shape(&r, &own))) break;
        if (!same_shape(&own, shape))
            status = fail(STATUS_INPUT, "%s: was written to while it was read", path);
        else
            status = TIFFIsTiled(r.tiff) ? load_tiles(&r, shape, to) : load_strips(&r, shape, to);
        to += tiff_page_bytes(shape);
        loaded++;
    }
    if (!status && loaded < pages) status = fail(STATUS_INPUT, "%s: was written to while it was read", path);
    if (r.tiff) TIFFClose(r.tiff);
    return status;
}
