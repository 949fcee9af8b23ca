/*
 * nifti.c - NIfTI-1 and NIfTI-2: .nii, .nii.gz and pairs .hdr/.img, either byte order
 *
 * Source: nifti1.h and nifti2.h of the NIfTI Data Format Working Group. libnifti2 swaps the header and makes the
 * matrices from it; it is given the header in memory, after every field that it acts on has been checked, and never
 * opens a file: data comes through source.h like that of all formats.
 *
 * World: the sform where its code is above 0, else the qform, else the voxel size alone. Values: slope * stored +
 * intercept in double, a slope of 0 meaning none.
 */
#include "readers.h"

#include "exit_status.h"
#include "failure.h"
#include "source.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <nifti2_io.h>

/* What both versions say, in one form. */
typedef struct nifti_header {
    const char *path;
    int version;
    int is_swapped;
    int is_single; /* data in the same file */
    int64_t dim[8];
    double pixdim[8];
    int datatype;
    double vox_offset;
    double slope, intercept;
    int qform_code, sform_code;
    union {
        nifti_1_header v1;
        nifti_2_header v2;
        unsigned char bytes[sizeof(nifti_2_header)];
    } raw;
} nifti_header;

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
                "%s: does not begin with a NIfTI-1 or NIfTI-2 header; convert it to NIfTI (ANALYZE 7.5 is "
                "not read)",
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
    h->qform_code = r->qform_code;
    h->sform_code = r->sform_code;
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
    h->qform_code = r->qform_code;
    h->sform_code = r->sform_code;
}

static int read_header(const char *path, const mapping *file, nifti_header *h) {
    int32_t size = 0;
    int status = read_start(path, file, &size, sizeof size);
    if (status) return status;
    h->is_swapped = size != 348 && size != 540;
    if (h->is_swapped) size = (int32_t)__builtin_bswap32((uint32_t)size);
    if (size != 348 && size != 540) return not_nifti(path);
    if ((status = read_start(path, file, h->raw.bytes, (size_t)size))) return status;

    h->version = size == 348 ? 1 : 2;
    const char *magic = h->version == 1 ? h->raw.v1.magic : h->raw.v2.magic;
    h->is_single = magic[1] == '+';
    if (magic[0] != 'n' || (magic[1] != '+' && magic[1] != 'i') || magic[2] != '0' + h->version || magic[3])
        return not_nifti(path);
    if (h->is_swapped && h->version == 1) nifti_swap_as_nifti1(&h->raw.v1);
    if (h->is_swapped && h->version == 2) nifti_swap_as_nifti2(&h->raw.v2);
    if (h->version == 1)
        take_v1(h);
    else
        take_v2(h);
    return 0;
}

/* The stored element, and how many make a sample. */
static int find_element(const nifti_header *h, int *element, int64_t *components, const char **meaning) {
    static const struct {
        int datatype, element, components;
        const char *meaning;
    } types[] = {
        {NIFTI_TYPE_UINT8, TC_U8, 1, NULL},
        {NIFTI_TYPE_INT8, TC_I8, 1, NULL},
        {NIFTI_TYPE_UINT16, TC_U16, 1, NULL},
        {NIFTI_TYPE_INT16, TC_I16, 1, NULL},
        {NIFTI_TYPE_UINT32, TC_U32, 1, NULL},
        {NIFTI_TYPE_INT32, TC_I32, 1, NULL},
        {NIFTI_TYPE_UINT64, ELEMENT_U64, 1, NULL},
        {NIFTI_TYPE_INT64, ELEMENT_I64, 1, NULL},
        {NIFTI_TYPE_FLOAT32, TC_F32, 1, NULL},
        {NIFTI_TYPE_FLOAT64, TC_F64, 1, NULL},
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

/* Axes 1 to 3 are of space, 4 is time, 5 the components; a data type of several values has those fastest. */
static int list_axes(const nifti_header *h, int64_t components, const char *meaning, axes *out) {
    *out = (axes){.meaning = meaning};
    if (h->dim[0] < 1 || h->dim[0] > 7)
        return fail(STATUS_INPUT, "%s: says that it has %" PRId64 " dimensions; 1 to 7 are possible", h->path,
                    h->dim[0]);
    if (components > 1) *out = (axes){.count = 1, .size = {components}, .role = {AXIS_COMPONENT}, .meaning = meaning};
    for (int i = 1; i <= h->dim[0]; i++, out->count++) {
        out->size[out->count] = h->dim[i];
        out->role[out->count] = i <= 3 ? AXIS_SPACE : i == 4 ? AXIS_FRAME : AXIS_COMPONENT;
    }
    return 0;
}

static const char *space_name(int code) {
    static const char *const names[] = {"unknown", "scanner", "aligned", "talairach", "mni152", "other template"};
    return code >= 0 && code < (int)(sizeof names / sizeof *names) ? names[code] : "unknown";
}

/* The voxel sizes that the matrix is made of; the library would replace bad ones silently. */
static int check_voxel_sizes(nifti_header *h) {
    for (int i = 1; i <= 3; i++) {
        double *size = &h->pixdim[i];
        if (i > h->dim[0]) { /* one sample: any size does */
            if (h->version == 1) h->raw.v1.pixdim[i] = 1;
            if (h->version == 2) h->raw.v2.pixdim[i] = 1;
            continue;
        }
        int is_needed = h->sform_code <= 0, is_positive = h->qform_code > 0;
        if (is_needed && (!isfinite(*size) || *size == 0 || (is_positive && *size < 0)))
            return fail(STATUS_INPUT, "%s: its voxel size along axis %d is %g; correct pixdim[%d]", h->path, i, *size,
                        i);
    }
    return 0;
}

static int fill_matrix(nifti_header *h, volume *out) {
    int status = check_voxel_sizes(h);
    if (status) return status;
    nifti_set_debug_level(0);
    errno = 0;
    nifti_image *image =
        h->version == 1 ? nifti_convert_n1hdr2nim(h->raw.v1, NULL) : nifti_convert_n2hdr2nim(h->raw.v2, NULL);
    if (!image && errno == ENOMEM) return fail(STATUS_FAILED, "%s: no memory to interpret its header", h->path);
    if (!image) return fail(STATUS_INPUT, "%s: libnifti2 cannot interpret its header", h->path);
    const nifti_dmat44 *matrix = image->sform_code > 0 ? &image->sto_xyz : &image->qto_xyz;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++) out->matrix[r][c] = matrix->m[r][c];
    int code = image->sform_code > 0 ? image->sform_code : image->qform_code;
    snprintf(out->space, sizeof out->space, "%s", code > 0 ? space_name(code) : "voxel size only");
    nifti_image_free(image);
    return matrix_check(h->path, out->matrix);
}

static int fill_scaling(const nifti_header *h, layout *l, volume *out) {
    if (h->datatype == NIFTI_TYPE_RGB24 || h->datatype == NIFTI_TYPE_RGBA32) return 0; /* colours are not scaled */
    if (!isfinite(h->slope)) {
        snprintf(out->notice, sizeof out->notice, "its slope is not a number and is taken for none");
        return 0;
    }
    if (h->slope == 0 || (h->slope == 1 && h->intercept == 0)) return 0;
    if (!isfinite(h->intercept))
        return fail(STATUS_INPUT, "%s: its intercept (scl_inter) is not a finite number; correct it", h->path);
    l->scaled = 1;
    l->slope = h->slope;
    l->intercept = h->intercept;
    return 0;
}

/* With an existing file of another ending beside it: x.hdr gives x.img or x.img.gz. Returns 0 where there is none. The
 * name is the caller's, no header's, so links are followed, as archives of scans have them. */
static int find_partner(const char *path, const char *own, const char *wanted, char *partner, size_t size) {
    size_t length = strlen(path);
    if (length > 3 && strcmp(path + length - 3, ".gz") == 0) length -= 3;
    if (length < 4 || strncasecmp(path + length - 4, own, 4)) return 0;
    for (int gz = 0; gz < 2; gz++) {
        int written = snprintf(partner, size, "%.*s%s%s", (int)length - 4, path, wanted, gz ? ".gz" : "");
        if (written > 0 && (size_t)written < size && access(partner, F_OK) == 0) return 1;
    }
    return 0;
}

/* Finds the file and the place of the data. */
static int find_data(const nifti_header *h, const char *image_path, const mapping *image, source *from) {
    double least = h->is_single ? (h->version == 1 ? 352 : 544) : 0;
    double offset = h->vox_offset < least && h->vox_offset >= 0 ? least : h->vox_offset;
    if (!(offset >= 0) || offset > 0x1p60 || floor(offset) != offset)
        return fail(STATUS_INPUT, "%s: says that its data starts at byte %g; correct vox_offset", h->path,
                    h->vox_offset);
    from->header_path = image_path;
    if (is_gzip(image)) {
        from->encoding = ENCODING_DEFLATE;
        from->stream_skip = (uint64_t)offset;
    } else {
        from->start = (uint64_t)offset;
    }
    return 0;
}

/* Interprets the header, then loads data of the image file, which is the header's own or its partner. */
static int load(const read_request *request, nifti_header *h, const char *image_path, const mapping *image,
                volume *out) {
    int element = TC_U8, status;
    int64_t components = 1;
    const char *meaning = NULL;
    axes stored;
    layout l;
    source from = {.axes = &stored};
    if ((status = find_element(h, &element, &components, &meaning)) ||
        (status = list_axes(h, components, meaning, &stored)) ||
        (status = layout_make(h->path, &stored, element, request, &l)) ||
        (status = find_data(h, image_path, image, &from)) || (status = fill_matrix(h, out)) ||
        (status = fill_scaling(h, &l, out)))
        return status;
    l.swapped = h->is_swapped;
    snprintf(out->format, sizeof out->format, "NIfTI-%d", h->version);
    return source_load(&from, &l, out);
}

int nifti_read(const read_request *request, const mapping *file, volume *out) {
    char partner[4096];
    nifti_header h = {.path = request->path};
    mapping header = {0}, image = {0};
    const mapping *header_file = file, *image_file = file;
    const char *image_path = request->path;
    int status = 0;
    if (find_partner(request->path, ".img", ".hdr", partner, sizeof partner)) {
        if ((status = mapping_open(partner, &header))) goto cleanup;
        h.path = partner;
        header_file = &header;
    }
    if ((status = read_header(h.path, header_file, &h))) goto cleanup;
    if (!h.is_single && header_file == file) {
        if (!find_partner(request->path, ".hdr", ".img", partner, sizeof partner)) {
            status =
                fail(STATUS_INPUT, "%s: is the header of a pair .hdr/.img, but the .img file is missing; put it beside",
                     request->path);
            goto cleanup;
        }
        if ((status = mapping_open(partner, &image))) goto cleanup;
        image_path = partner;
        image_file = &image;
    } else if (h.is_single && header_file != file) {
        status = fail(STATUS_INPUT, "%s: holds header and data in one; name it instead of %s", partner, request->path);
        goto cleanup;
    }
    status = load(request, &h, image_path, image_file, out);
cleanup:
    mapping_close(&header);
    mapping_close(&image);
    return status;
}
