/*
 * reader.c - a reader given any bytes: a status with a text, or a dataset that holds what dataset.h promises
 *
 * Compiled once per format, FORMAT being its number. The first byte of the options is the component, as read_request
 * has it, the second the frame; the third chooses the file's ending and the field, the fourth what stands for the
 * header's word.
 * Raw files say all else in front of their samples, in a struct raw_description; where it leaves out sizes and type,
 * the format is found as for any file.
 */
#include "check.h"
#include "files.h"
#include "hang.h"

#include "dataset/layout.h"
#include "exit_status.h"
#include "failure.h"
#include "field/select.h"
#include "image/image.h"
#include "plot3d/plot3d.h"
#include "read.h"
#include "vtk_hdf/vtk_hdf.h"
#include "vtk_legacy/vtk_legacy.h"
#include "vtk_parallel/vtk_parallel.h"
#include "vtk_xml/vtk_xml.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
const char *__lsan_default_suppressions(void);

/* What libhdf5 keeps of files that are damaged is its own. */
const char *__lsan_default_suppressions(void) { return "leak:libhdf5"; }

enum { RAW, NRRD, METAIMAGE, NIFTI, VTK_LEGACY, VTK_XML, PLOT3D, NPY, TIFF, VTK_PARALLEL, HDF5 };

typedef struct format {
    const char *paths[4];
    int (*read)(const read_request *request, const mapping *file, dataset *out);
} format;

static const format formats[] = {
    [RAW] = {.paths = {"in/a.raw", "in/a.raw.gz", "in/a.xyz", "in/a.img"}}, /* what begins as another format is that */
    [NRRD] = {{"in/a.nrrd", "in/a.nhdr", "in/a.nrrd", "in/a.nhdr"}, .read = nrrd_read},
    [METAIMAGE] = {{"in/a.mha", "in/a.mhd", "in/a.mha", "in/a.mhd"}, .read = metaimage_read},
    [NIFTI] = {{"in/a.nii", "in/a.nii.gz", "in/a.hdr", "in/a.img"}, .read = nifti_read},
    [VTK_LEGACY] = {{"in/a.vtk", "in/a.vtk", "in/a.vtk", "in/a.vtk"}, .read = vtk_legacy_read},
    [VTK_XML] = {{"in/a.vtu", "in/a.vti", "in/a.vts", "in/a.vtr"}, .read = vtk_xml_read},
    [PLOT3D] = {{"in/a.xyz", "in/a.g", "in/a.x", "in/a.p3d"}, .read = plot3d_read},
    [NPY] = {{"in/a.npy", "in/a.npy", "in/a.npy", "in/a.npy"}, .read = npy_read},
    [TIFF] = {{"in/a.tif", "in/a.tiff", "in/a.tif", "in/a.tif"}, .read = tiff_read},
    [VTK_PARALLEL] = {{"in/a.pvti", "in/a.pvtu", "in/a.pvts", "in/a.vtm"}, .read = vtk_parallel_read},
    [HDF5] = {{"in/a.h5", "in/a.hdf5", "in/a.vtkhdf", "in/a.h5"}, .read = vtk_hdf_read},
};

/* ---------------------------------------------------------------------------------------------------- after reading */

static volatile uint8_t sink;

/* Reads every byte. */
static void touch(const void *memory, uint64_t bytes) {
    const uint8_t *at = memory;
    uint8_t sum = 0;
    for (uint64_t n = 0; n < bytes; n++) sum = (uint8_t)(sum + at[n]);
    sink = sum;
}

static void check_type(tc_type type, const void *values) {
    CHECK(tc_type_bytes(type) != 0);
    CHECK(values != NULL);
    CHECK((uintptr_t)values % tc_type_bytes(type) == 0);
}

static void check_coordinates(coordinates c, int64_t count) {
    CHECK(!c.f32 + !c.f64 == 1 || (count == 0 && !c.f32 + !c.f64 == 2));
    if (c.f32) touch(c.f32, (uint64_t)count * sizeof *c.f32);
    if (c.f64) touch(c.f64, (uint64_t)count * sizeof *c.f64);
}

static void check_cells(const dataset_block *b) {
    if (!b->cell_count) return;
    CHECK(b->cell_types && b->cell_offsets && b->cell_offsets[0] == 0);
    touch(b->cell_types, (uint64_t)b->cell_count);
    for (int64_t c = 0; c < b->cell_count; c++) {
        CHECK(b->cell_offsets[c + 1] >= b->cell_offsets[c]);
        for (int64_t n = b->cell_offsets[c]; n < b->cell_offsets[c + 1]; n++)
            CHECK(b->cell_points[n] >= 0 && b->cell_points[n] < b->point_count);
    }
}

static void check_faces(const dataset_block *b) {
    if (!b->cell_faces) return;
    CHECK(b->cell_faces[0] == 0 && b->face_offsets && b->face_offsets[0] == 0);
    for (int64_t c = 0; c < b->cell_count; c++) CHECK(b->cell_faces[c + 1] >= b->cell_faces[c]);
    for (int64_t f = 0; f < b->cell_faces[b->cell_count]; f++) {
        CHECK(b->face_offsets[f + 1] >= b->face_offsets[f]);
        for (int64_t n = b->face_offsets[f]; n < b->face_offsets[f + 1]; n++)
            CHECK(b->face_points[n] >= 0 && b->face_points[n] < b->point_count);
    }
}

static void check_geometry(const dataset_block *b) {
    CHECK(b->point_count >= 0 && b->cell_count >= 0);
    if (b->kind == BLOCK_UNSTRUCTURED) {
        check_cells(b);
        check_faces(b);
    } else {
        int64_t points = 1, cubes = 1, cells = 1; /* of a flat grid, VTK's files count the cells of fewer dimensions */
        for (int a = 0; a < 3; a++) {
            CHECK(b->dims[a] >= 0);
            CHECK(!__builtin_mul_overflow(points, b->dims[a], &points));
            cubes *= b->dims[a] - 1;
            cells *= b->dims[a] > 1 ? b->dims[a] - 1 : 1;
        }
        CHECK(b->point_count == points);
        CHECK(b->cell_count == cubes || b->cell_count == cells || points == 0);
    }
    for (int a = 0; a < 3 && b->kind == BLOCK_RECTILINEAR; a++) check_coordinates(b->axes[a], b->dims[a]);
    if (b->kind == BLOCK_CURVILINEAR || b->kind == BLOCK_UNSTRUCTURED) check_coordinates(b->points, 3 * b->point_count);
    for (int n = 0; n < 12 && b->kind == BLOCK_UNIFORM; n++) CHECK(isfinite(b->matrix[n / 4][n % 4]));
    if (b->blanked_points) touch(b->blanked_points, (uint64_t)b->point_count);
    if (b->blanked_cells) touch(b->blanked_cells, (uint64_t)b->cell_count);
}

static void check_field(const dataset_block *b, const dataset_field *f) {
    uint64_t tuples = (uint64_t)(f->on_cells ? b->cell_count : b->point_count);
    CHECK(f->name && f->components >= 1);
    touch(f->name, strlen(f->name));
    if (!tuples) return;
    check_type(f->type, f->values);
    touch(f->values, tuples * (uint64_t)f->components * tc_type_bytes(f->type));
}

static void check_dataset(const dataset *d) {
    for (int n = 0; n < d->block_count; n++) {
        const dataset_block *b = &d->blocks[n];
        check_geometry(b);
        for (int f = 0; f < b->field_count; f++) check_field(b, &b->fields[f]);
    }
    for (int n = 0; n < d->notice_count; n++) touch(d->notices[n], strlen(d->notices[n]));
    touch(d->format, strlen(d->format));
    touch(d->space, strlen(d->space));
}

/* What the tool does next: the samples of one field, and all fields that may be carried. */
static void select_fields(dataset *d, const char *path, uint8_t choice, int component) {
    scalar s;
    point_field carried;
    const char **names = NULL;
    int count = common_field_names(d, &names);
    const read_request wanted = {.path = path,
                                 .field = count > 0 && choice & 0x80 ? names[choice % count] : NULL,
                                 .component = component,
                                 .has_nodata = choice & 0x40,
                                 .nodata = choice};
    if (scalar_select(d, &wanted, &s) == 0)
        for (int n = 0; n < d->block_count; n++) {
            if (!d->blocks[n].point_count) continue;
            check_type(s.blocks[n].type, s.blocks[n].samples);
            touch(s.blocks[n].samples, (uint64_t)d->blocks[n].point_count * tc_type_bytes(s.blocks[n].type));
        }
    for (int n = 0; n < count && n < 4; n++) (void)point_field_select(d, path, names[n], &carried);
    free(names);
}

/* ---------------------------------------------------------------------------------------------------------- reading */

static void check_image(const dataset *d) {
    const dataset_block *b = d->blocks;
    CHECK(d->frames >= 0);
    if (!d->frames) return;
    CHECK(d->block_count == 1 && b->kind == BLOCK_UNIFORM && b->field_count == 1 && b->fields->components >= 1);
    for (int n = 0; n < 12; n++) CHECK(isfinite(b->matrix[n / 4][n % 4]));
}

/* The reader of the format, whatever the file's beginning says; what it fails with is released as dataset_read does. */
static int read_by(const format *f, const read_request *request, dataset *out) {
    mapping file;
    *out = (dataset){0};
    int status = mapping_open(request->path, &file);
    if (!status) status = f->read(request, &file, out);
    mapping_close(&file);
    if (status) dataset_release(out);
    return status;
}

/* In front of a raw file's samples. */
typedef struct raw_description {
    int64_t dims[3];
    double spacing[3], origin[3];
    uint64_t skip;
    int8_t type;
    uint8_t big_endian;
} raw_description;

enum { RAW_BYTES = 82 };

static void describe_raw(const uint8_t **data, size_t *size, read_request *request) {
    raw_description raw = {.type = 0};
    size_t taken = *size < RAW_BYTES ? *size : RAW_BYTES;
    if (taken) memcpy(&raw, *data, taken);
    *data += taken;
    *size -= taken;
    memcpy(request->dims, raw.dims, sizeof raw.dims);
    memcpy(request->spacing, raw.spacing, sizeof raw.spacing);
    memcpy(request->origin, raw.origin, sizeof raw.origin);
    request->skip = raw.skip;
    request->type = raw.type < 0 ? -1 : raw.type % (TC_F64 + 1);
    request->big_endian = raw.big_endian & 1;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint8_t options[OPTION_BYTES];
    read_request request;
    dataset d;
    hang_watch();
    read_request_init(&request, "");
    if (FORMAT == RAW) describe_raw(&data, &size, &request);
    uint8_t choice = size > 1 ? data[size - 2] : 0;
    request.path = formats[FORMAT].paths[choice & 3];
    files_open(request.path, data, size, options);
    request.component = (int8_t)options[0] < COMPONENT_MAGNITUDE ? COMPONENT_OPEN : (int8_t)options[0];
    request.frame = (int8_t)options[1];
    request.describe = options[3] & 1;
    request.has_spacing = options[3] >> 1 & 1;
    request.has_origin = options[3] >> 2 & 1;
    if ((FORMAT == PLOT3D && !(choice & 4)) || (FORMAT == RAW && choice & 8)) request.path2 = FILES_FOLDER "1.q";

    fail(0, "(no text)");
    int status = FORMAT == RAW ? dataset_read(&request, &d) : read_by(&formats[FORMAT], &request, &d);
    if (!status) {
        check_dataset(&d);
        check_image(&d);
        select_fields(&d, request.path, choice, request.component);
        dataset_release(&d);
    } else {
        static const dataset zero;
        CHECK(status == STATUS_INPUT || status == STATUS_USAGE);
        CHECK(status == STATUS_USAGE || strstr(failure_text(), FILES_FOLDER) != NULL);
        CHECK(memcmp(&d, &zero, sizeof d) == 0);
    }
    files_close();
    return 0;
}
