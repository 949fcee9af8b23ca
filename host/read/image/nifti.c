/*
 * nifti.c - NIfTI-1, NIfTI-2 and Analyze 7.5: .nii, .nii.gz and pairs .hdr/.img, either byte order
 *
 * Source: nifti1.h and nifti2.h of the NIfTI Data Format Working Group, which also say what headers of Analyze have in
 * common with NIfTI-1. libnifti2 swaps the header and turns quaternions into matrices; it never opens a file: data
 * comes through source.h like that of all formats.
 *
 * World: the sform where its code is above 0, else the qform, else the voxel size alone, as always of Analyze. Values:
 * slope * stored + intercept in double, a slope of 0 meaning none; Analyze has the slope of SPM in the same field.
 * Headers are often wrong in what their writers do not use: such fields are passed over with a notice.
 */
#include "image/image.h"

#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "image/source.h"
#include "shortest.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <nifti2_io.h>

/* What both versions say, in one form. */
typedef struct nifti_header {
    const char *path;
    const read_request *request;
    int version;
    int is_swapped;
    int is_analyze;
    int is_single; /* data in the same file */
    int64_t dim[8];
    double pixdim[8];
    int datatype, intent;
    double vox_offset;
    double slope, intercept;
    int qform_code, sform_code, units;
    double quatern[3], qoffset[3];
    double sform[3][4];
    union {
        nifti_1_header v1;
        nifti_2_header v2;
        unsigned char bytes[sizeof(nifti_2_header)];
    } raw;
} nifti_header;

/* The size of the header, and where the data begins that follows it in the same file. */
static size_t header_bytes(const nifti_header *h) { return h->version == 1 ? 348 : 540; }
static size_t single_bytes(const nifti_header *h) { return h->version == 1 ? 352 : 544; }

static int is_gzip(const mapping *file) { return file->size > 2 && file->bytes[0] == 0x1f && file->bytes[1] == 0x8b; }

/* Copies the first bytes of the file, unpacked. */
static int read_start(const char *path, const mapping *file, void *to, size_t bytes) {
    if (is_gzip(file)) return unpack(path, ENCODING_DEFLATE, file->bytes, file->size, 0, to, bytes, NULL);
    if (file->size < bytes)
        return fail(STATUS_INPUT, "%s: is %zu bytes long, but a NIfTI header has %zu; the file is cut or no NIfTI",
                    path, file->size, bytes);
    memcpy(to, file->bytes, bytes);
    return 0;
}

static int not_nifti(const char *path) {
    return fail(STATUS_INPUT,
                "%s: does not begin with a header of NIfTI-1, NIfTI-2 or, in a pair .hdr/.img, Analyze 7.5; convert it "
                "to NIfTI",
                path);
}

/* Takes over the fields of a header in this machine's byte order. */
static void take_v1(nifti_header *h) {
    const nifti_1_header *r = &h->raw.v1;
    for (int i = 0; i < 8; i++) {
        h->dim[i] = r->dim[i];
        h->pixdim[i] = (double)r->pixdim[i];
    }
    h->datatype = r->datatype;
    h->vox_offset = (double)r->vox_offset;
    h->slope = (double)r->scl_slope;
    h->intercept = (double)r->scl_inter;
    h->intent = r->intent_code;
    h->qform_code = r->qform_code;
    h->sform_code = r->sform_code;
    h->units = r->xyzt_units;
    const float quatern[] = {r->quatern_b, r->quatern_c, r->quatern_d};
    const float qoffset[] = {r->qoffset_x, r->qoffset_y, r->qoffset_z};
    const float *const rows[] = {r->srow_x, r->srow_y, r->srow_z};
    for (int i = 0; i < 3; i++) {
        h->quatern[i] = (double)quatern[i];
        h->qoffset[i] = (double)qoffset[i];
        for (int c = 0; c < 4; c++) h->sform[i][c] = (double)rows[i][c];
    }
}

static void take_v2(nifti_header *h) {
    const nifti_2_header *r = &h->raw.v2;
    for (int i = 0; i < 8; i++) {
        h->dim[i] = r->dim[i];
        h->pixdim[i] = r->pixdim[i];
    }
    h->datatype = r->datatype;
    h->vox_offset = (double)r->vox_offset;
    h->slope = r->scl_slope;
    h->intercept = r->scl_inter;
    h->intent = r->intent_code;
    h->qform_code = r->qform_code;
    h->sform_code = r->sform_code;
    h->units = r->xyzt_units;
    const double quatern[] = {r->quatern_b, r->quatern_c, r->quatern_d};
    const double qoffset[] = {r->qoffset_x, r->qoffset_y, r->qoffset_z};
    const double *const rows[] = {r->srow_x, r->srow_y, r->srow_z};
    for (int i = 0; i < 3; i++) {
        h->quatern[i] = quatern[i];
        h->qoffset[i] = qoffset[i];
        for (int c = 0; c < 4; c++) h->sform[i][c] = rows[i][c];
    }
}

static int ends_in(const char *path, const char *ending) {
    size_t length = strlen(path);
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0) length -= 3;
    return length >= 4 && strncasecmp(path + length - 4, ending, 4) == 0;
}

/* 1 or 2 by the header's size, in either byte order, else by the magic text; 0: neither. */
static int find_version(const nifti_header *h) {
    int32_t size = h->raw.v1.sizeof_hdr;
    int32_t other = (int32_t)__builtin_bswap32((uint32_t)size);
    if (size == 348 || other == 348) return 1;
    if (size == 540 || other == 540) return 2;
    return !memcmp(h->raw.v1.magic, "n+1", 4) || !memcmp(h->raw.v1.magic, "ni1", 4) ? 1 : 0;
}

static int is_count(int64_t dimensions) { return dimensions >= 1 && dimensions <= 7; }

/* The number of dimensions tells the byte order; where it is none in either, the header's size does. */
static int find_order(const nifti_header *h) {
    const nifti_1_header *r = &h->raw.v1;
    int64_t native = h->version == 1 ? r->dim[0] : h->raw.v2.dim[0];
    int64_t other = h->version == 1 ? (int16_t)__builtin_bswap16((uint16_t)r->dim[0])
                                    : (int64_t)__builtin_bswap64((uint64_t)h->raw.v2.dim[0]);
    if (is_count(native) || is_count(other)) return !is_count(native);
    return r->sizeof_hdr != (int32_t)header_bytes(h);
}

static int read_header(const char *path, const mapping *file, nifti_header *h) {
    int status = read_start(path, file, h->raw.bytes, sizeof(nifti_1_header));
    if (status) return status;
    h->version = find_version(h);
    if (!h->version) return not_nifti(path);
    if (h->version == 2 && (status = read_start(path, file, h->raw.bytes, sizeof(nifti_2_header)))) return status;

    const char *magic = h->version == 1 ? h->raw.v1.magic : h->raw.v2.magic;
    int is_nifti = magic[0] == 'n' && (magic[1] == '+' || magic[1] == 'i') && magic[2] == '0' + h->version && !magic[3];
    h->is_analyze = !is_nifti && h->version == 1 && ends_in(path, ".hdr");
    h->is_single = is_nifti && magic[1] == '+';
    if (!is_nifti && !h->is_analyze) return not_nifti(path);
    h->is_swapped = find_order(h);
    if (h->is_swapped && h->version == 1) nifti_swap_as_nifti1(&h->raw.v1);
    if (h->is_swapped && h->version == 2) nifti_swap_as_nifti2(&h->raw.v2);
    if (h->version == 1)
        take_v1(h);
    else
        take_v2(h);
    if (h->is_analyze) h->qform_code = h->sform_code = h->intent = 0; /* Analyze has other fields there */
    if (h->is_analyze) h->intercept = 0;
    return 0;
}

/* The stored element, and how many make a sample. */
static int find_element(const nifti_header *h, int *element, int64_t *components, const char **meaning) {
    static const struct {
        int datatype, element, components;
        const char *meaning;
    } types[] = {
#define PLAIN_ROW(element, nrrd, metaimage, nifti, ...) {nifti, element, 1, NULL},
        STORED_NAMES(PLAIN_ROW)
#undef PLAIN_ROW
            {NIFTI_TYPE_RGB24, TC_U8, 3, "red, green, blue"},
        {NIFTI_TYPE_RGBA32, TC_U8, 4, "red, green, blue, alpha"},
        {NIFTI_TYPE_COMPLEX64, TC_F32, 2, "real, imaginary"},
        {NIFTI_TYPE_COMPLEX128, TC_F64, 2, "real, imaginary"},
    };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].datatype == h->datatype) {
            *element = types[i].element;
            *components = types[i].components;
            *meaning = types[i].meaning;
            return 0;
        }
    return fail(STATUS_INPUT, "%s: its data type %d (%s) cannot be read; convert it to float64", h->path, h->datatype,
                nifti_datatype_string(h->datatype));
}

/* CIFTI has values of points on the brain's surface and of single voxels, in a matrix. */
static int check_intent(const nifti_header *h) {
    if (h->version == 1 || h->intent < 3000 || h->intent > 3099) return 0;
    return fail(STATUS_INPUT,
                "%s: is CIFTI (intent %d), a matrix of values without a volume; take the volume out of it, by "
                "'wb_command -cifti-separate' for one",
                h->path, h->intent);
}

/* Axes 1 to 3 are of space, 4 is time, 5 the components; a data type of several values has those fastest. */
static int list_axes(const nifti_header *h, int64_t components, const char *meaning, axes *out) {
    *out = (axes){.meaning = meaning};
    if (!is_count(h->dim[0]))
        return fail(STATUS_INPUT, "%s: says that it has %" PRId64 " dimensions; 1 to 7 are possible", h->path,
                    h->dim[0]);
    if (components > 1) *out = (axes){.count = 1, .size = {components}, .role = {AXIS_COMPONENT}, .meaning = meaning};
    for (int i = 1; i <= h->dim[0]; i++, out->count++) {
        int is_unused = (i > 1 && h->dim[i] == 0) || (i > 3 && h->dim[i] < 0);
        out->size[out->count] = is_unused ? 1 : h->dim[i];
        out->role[out->count] = i <= 3 ? AXIS_SPACE : i == 4 ? AXIS_FRAME : AXIS_COMPONENT;
    }
    return 0;
}

static const char *space_name(int code) {
    static const char *const names[] = {"unknown", "scanner", "aligned", "talairach", "mni152", "other template"};
    return code >= 0 && code < (int)(sizeof names / sizeof *names) ? names[code] : "unknown";
}

static const char *units_name(int units) {
    static const char *const names[] = {
        [NIFTI_UNITS_METER] = "m", [NIFTI_UNITS_MM] = "mm", [NIFTI_UNITS_MICRON] = "um"};
    const int of_space = units & 7;
    return of_space && of_space <= NIFTI_UNITS_MICRON ? names[of_space] : "";
}

/* The voxel sizes that the matrix is made of; those that are none become 1, and a qform has none below 0. */
static void take_voxel_sizes(const nifti_header *h, double sizes[3], dataset *out) {
    int is_changed = 0;
    for (int i = 0; i < 3; i++) {
        double given = h->pixdim[i + 1];
        sizes[i] = !isfinite(given) || given == 0 || i + 1 > h->dim[0] ? 1 : h->qform_code > 0 ? fabs(given) : given;
        is_changed |= i + 1 <= h->dim[0] && sizes[i] != given;
    }
    if (is_changed && !h->request->has_spacing)
        dataset_notice(out, "its voxel sizes %s %s %s (pixdim) are taken for %s %s %s",
                       shortest_coordinate(h->pixdim[1]).text, shortest_coordinate(h->pixdim[2]).text,
                       shortest_coordinate(h->pixdim[3]).text, shortest_coordinate(sizes[0]).text,
                       shortest_coordinate(sizes[1]).text, shortest_coordinate(sizes[2]).text);
}

static double finite_or_zero(double value) { return isfinite(value) ? value : 0; }

static void take_qform(const nifti_header *h, const double sizes[3], dataset *out) {
    double q[3], offset[3];
    int is_changed = 0;
    for (int i = 0; i < 3; i++) {
        q[i] = finite_or_zero(h->quatern[i]);
        offset[i] = finite_or_zero(h->qoffset[i]);
        is_changed |= !isfinite(h->quatern[i]) || !isfinite(h->qoffset[i]);
    }
    if (is_changed) dataset_notice(out, "its qform has values that are not finite, they are taken for 0");
    nifti_dmat44 matrix = nifti_quatern_to_dmat44(q[0], q[1], q[2], offset[0], offset[1], offset[2], sizes[0], sizes[1],
                                                  sizes[2], h->pixdim[0] < 0 ? -1 : 1);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++) out->blocks->matrix[r][c] = matrix.m[r][c];
}

static int fill_matrix(nifti_header *h, dataset *out) {
    double sizes[3];
    int is_sform = h->sform_code > 0 && world_spans(h->sform), code = is_sform ? h->sform_code : h->qform_code;
    if (is_sform) {
        memcpy(out->blocks->matrix, h->sform, sizeof h->sform);
    } else {
        take_voxel_sizes(h, sizes, out);
        for (int i = 0; i < 3; i++) out->blocks->matrix[i][i] = sizes[i];
        if (h->qform_code > 0) take_qform(h, sizes, out);
    }
    if (h->sform_code > 0 && !is_sform)
        dataset_notice(out, "its sform does not span space, the %s is taken", code > 0 ? "qform" : "voxel size");
    snprintf(out->space, sizeof out->space, "%s", code > 0 ? space_name(code) : "voxel size only");
    if (code > 0) snprintf(out->world, sizeof out->world, "RAS");
    if (!h->request->has_spacing && !h->is_analyze) dataset_set_units(out, units_name(h->units));
    return world_complete(h->request, h->path, out->blocks->matrix);
}

static void fill_scaling(const nifti_header *h, layout *l, dataset *out) {
    double intercept = finite_or_zero(h->intercept);
    if (h->datatype == NIFTI_TYPE_RGB24 || h->datatype == NIFTI_TYPE_RGBA32) return; /* colours are not scaled */
    if (!isfinite(h->slope)) {
        dataset_notice(out, "its slope is not a number and is taken for none");
        return;
    }
    if (h->slope == 0) return;
    if (!isfinite(h->intercept))
        dataset_notice(out, "its intercept (scl_inter) is not a finite number and is taken for 0");
    if (h->slope == 1 && intercept == 0) return;
    if (h->is_analyze)
        dataset_notice(out, "its values are multiplied by %s (funused1), as SPM does",
                       shortest_coordinate(h->slope).text);
    l->scaled = 1;
    l->slope = h->slope;
    l->intercept = intercept;
}

/* ----------------------------------------------------------------------------------------------------------- files */

/* Finds the other file of a pair, with .gz or without. Of the two wanted endings the one in the same case as the path's
 * is tried first: x.hdr leads to x.img, X.HDR to X.IMG. Returns 0 where there is no such file. Symbolic links are
 * followed, as archives of scans have them: the name comes from the caller, not from a header. */
static int find_partner(const char *path, const char *own, const char *const wanted[2], char *partner, size_t size) {
    static const char *const packed[] = {"", ".gz", ".GZ"};
    size_t length = strlen(path);
    if (!ends_in(path, own)) return 0;
    if (strcasecmp(path + length - 3, ".gz") == 0) length -= 3;
    int is_upper = path[length - 1] == toupper((unsigned char)own[3]);
    for (int n = 0; n < 6; n++) {
        const char *ending = wanted[(n / 3) ^ is_upper];
        int written = snprintf(partner, size, "%.*s%s%s", (int)length - 4, path, ending, packed[n % 3]);
        if (written > 0 && (size_t)written < size && access(partner, F_OK) == 0 && !mapping_is_stream(partner))
            return 1;
    }
    return 0;
}

/* *start: where the data begins. file_bytes is the size of a file that is not packed, else 0. An offset within the
 * header means right behind it; four bytes for extensions are skipped where the file has room for them. */
static int find_start(const nifti_header *h, int is_single, size_t file_bytes, uint64_t bytes, uint64_t *start) {
    double offset = floor(h->is_analyze ? fabs(h->vox_offset) : h->vox_offset);
    if (!(offset >= 0) || offset > 0x1p60)
        return fail(STATUS_INPUT, "%s: says that its data starts at byte %g; correct vox_offset", h->path,
                    h->vox_offset);
    *start = (uint64_t)offset;
    if (!is_single || *start >= single_bytes(h)) return 0;
    int has_space = file_bytes < bytes + header_bytes(h) || file_bytes >= bytes + single_bytes(h);
    if (has_space)
        *start = single_bytes(h);
    else if (*start < header_bytes(h))
        *start = header_bytes(h);
    return 0;
}

static int find_data(const nifti_header *h, const char *image_path, const mapping *image, int is_single, uint64_t bytes,
                     source *from) {
    uint64_t start = 0;
    int is_packed = is_gzip(image), status = find_start(h, is_single, is_packed ? 0 : image->size, bytes, &start);
    from->header_path = image_path;
    from->encoding = is_packed ? ENCODING_DEFLATE : ENCODING_RAW;
    from->stream_skip = is_packed ? (int64_t)start : 0;
    from->start = is_packed ? 0 : start;
    return status;
}

/* Interprets the header, then loads data of the image file, which is the header's own or its partner. */
static int load(nifti_header *h, const char *image_path, const mapping *image, int is_single, dataset *out) {
    int element = TC_U8, status;
    int64_t components = 1;
    const char *meaning = NULL;
    axes stored;
    layout l;
    source from = {.axes = &stored};
    if ((status = check_intent(h)) || (status = find_element(h, &element, &components, &meaning)) ||
        (status = list_axes(h, components, meaning, &stored)) ||
        (status = layout_make(h->path, &stored, element, h->request, &l)) ||
        (status = find_data(h, image_path, image, is_single, l.bytes, &from)) || (status = fill_matrix(h, out)))
        return status;
    fill_scaling(h, &l, out);
    l.swapped = h->is_swapped;
    if (h->is_analyze)
        snprintf(out->format, sizeof out->format, "Analyze 7.5");
    else
        snprintf(out->format, sizeof out->format, "NIfTI-%d", h->version);
    return source_load(h->request, &from, &l, out);
}

int nifti_read(const read_request *request, const mapping *file, dataset *out) {
    static const char *const header_endings[] = {".hdr", ".HDR"}, *const image_endings[] = {".img", ".IMG"};
    char partner[4096];
    nifti_header h = {.path = request->path, .request = request};
    mapping other = {0};
    const mapping *header = file, *image = file;
    const char *image_path = request->path;
    int status = dataset_image_begin(out),
        by_image = !status && find_partner(request->path, ".img", header_endings, partner, sizeof partner);
    if (by_image) {
        if ((status = dataset_map(out, partner, &other))) goto cleanup;
        h.path = partner;
        header = &other;
    }
    if (status || (status = read_header(h.path, header, &h))) goto cleanup;
    int has_data = is_gzip(header) ? h.is_single : !h.is_analyze && header->size > single_bytes(&h);
    if (by_image && h.is_single && has_data) {
        status = fail(STATUS_INPUT, "%s: holds header and data in one; name it instead of %s", partner, request->path);
        goto cleanup;
    }
    if (!by_image && !(h.is_single && has_data) &&
        find_partner(request->path, ".hdr", image_endings, partner, sizeof partner)) {
        if ((status = dataset_map(out, partner, &other))) goto cleanup;
        image_path = partner;
        image = &other;
    } else if (!h.is_single && !has_data && mapping_is_stream(request->path)) {
        status = fail(STATUS_INPUT,
                      "%s: is the header of a pair .hdr/.img, and nothing lies beside %s: give the header's own name",
                      request->path, mapping_is_standard_input(request->path) ? "standard input" : "a pipe");
        goto cleanup;
    } else if (!by_image && !h.is_single && !has_data) {
        status =
            fail(STATUS_INPUT, "%s: is the header of a pair .hdr/.img, but the .img file is missing; put it beside",
                 request->path);
        goto cleanup;
    }
    status = load(&h, image_path, image, header == image, out);
cleanup:
    mapping_close(&other);
    return status;
}
