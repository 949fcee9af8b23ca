#include "read_formats.h"

#include "file/xml_root.h"
#include "image/image.h"
#include "plot3d/plot3d.h"
#include "vtk_hdf/vtk_hdf.h"
#include "vtk_legacy/vtk_legacy.h"
#include "vtk_parallel/vtk_parallel.h"
#include "vtk_xml/vtk_xml.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* --------------------------------------------------------------------------------------------------- how they begin */

int path_ends_with(const char *path, const char *ending) {
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

int file_starts_with(const mapping *file, const char *text) {
    size_t length = strlen(text);
    return file->size >= length && memcmp(file->bytes, text, length) == 0;
}

static int begins_as_nrrd(const mapping *file) { return file_starts_with(file, "NRRD0"); }

static int begins_as_metaimage(const mapping *file) {
    return file_starts_with(file, "ObjectType") || file_starts_with(file, "NDims");
}

static int begins_as_npy(const mapping *file) { return file_starts_with(file, "\x93NUMPY"); }

/* Either byte order, the classic form and BigTIFF. */
static int begins_as_tiff(const mapping *file) {
    static const char beginnings[4][4] = {"II*", {'M', 'M', 0, '*'}, "II+", {'M', 'M', 0, '+'}};
    for (int i = 0; i < 4; i++)
        if (file->size >= 8 && memcmp(file->bytes, beginnings[i], 4) == 0) return 1;
    return 0;
}

/* Behind nothing, or behind 512 bytes of others, as MATLAB's, or 1024, 2048. */
static int begins_as_hdf5(const mapping *file) {
    static const char signature[8] = "\211HDF\r\n\032\n";
    for (size_t at = 0; at <= 2048 && at + 8 <= file->size; at = at ? 2 * at : 512)
        if (memcmp(file->bytes + at, signature, 8) == 0) return 1;
    return 0;
}

/* By the size of the header, which begins every NIfTI header, in either byte order. */
static int begins_as_nifti(const mapping *file) {
    static const char sizes[4][4] = {{92, 1, 0, 0}, {0, 0, 1, 92}, {28, 2, 0, 0}, {0, 0, 2, 28}};
    for (int i = 0; i < 4; i++)
        if (file->size >= 348 && memcmp(file->bytes, sizes[i], 4) == 0) return 1;
    return 0;
}

static int begins_as_vtk_legacy(const mapping *file) { return file_starts_with(file, "# vtk DataFile Version"); }

static int begins_as_vtk_xml(const mapping *file) {
    char type[XML_TYPE_BYTES];
    return xml_root_type(file, type);
}

static int begins_as_vtk_parallel(const mapping *file) {
    char type[XML_TYPE_BYTES];
    return xml_root_type(file, type) && xml_type_is_index(type);
}

/* ------------------------------------------------------------------------------------------------------------ table */

enum { RAW, NRRD, METAIMAGE, NIFTI, NPY, TIFF, HDF5, VTK_LEGACY, VTK_PARALLEL, VTK_XML, PLOT3D, FORMAT_COUNT };

/* What begins as NIfTI may be a Plot3D grid of 348 points along x. */
const read_format read_formats[FORMAT_COUNT] = {
    [RAW] = {.name = "raw", .endings = "|.raw|", .read = raw_read, .has_frames = 1},
    [NRRD] = {.name = "NRRD",
              .notes = {{"gzip", LIBRARY_ZLIB}, {"bzip2", LIBRARY_BZIP2}},
              .endings = "|.nrrd|.nhdr|",
              .begins = begins_as_nrrd,
              .read = nrrd_read,
              .has_frames = 1},
    [METAIMAGE] = {.name = "MetaImage",
                   .notes = {{"zlib", LIBRARY_ZLIB}},
                   .endings = "|.mha|.mhd|",
                   .begins = begins_as_metaimage,
                   .read = metaimage_read,
                   .has_frames = 1},
    [NIFTI] = {.name = "NIfTI and Analyze 7.5",
               .library = LIBRARY_NIFTI,
               .notes = {{"gzip", LIBRARY_ZLIB}},
               .endings = "|.nii|.nii.gz|.hdr|.img|.hdr.gz|.img.gz|",
               .begins = begins_as_nifti,
               .read = IF_BUILT(HAVE_NIFTI, nifti_read),
               .instead = "convert it to NRRD",
               .has_frames = 1,
               .unpacks = 1,
               .may_be_half = 1},
    [NPY] = {.name = "numpy", .endings = "|.npy|", .begins = begins_as_npy, .read = npy_read, .has_frames = 1},
    [TIFF] = {.name = "TIFF",
              .library = LIBRARY_TIFF,
              .notes = {{"stacks and slices", LIBRARY_NONE}},
              .endings = "|.tif|.tiff|",
              .begins = begins_as_tiff,
              .read = IF_BUILT(HAVE_TIFF, tiff_read),
              .instead = "convert it to NRRD",
              .has_frames = 1},
    [HDF5] = {.name = "HDF5",
              .library = LIBRARY_HDF5,
              .notes = {{"images", LIBRARY_NONE}, {"VTKHDF", LIBRARY_NONE}},
              .endings = "|.h5|.hdf5|.vtkhdf|",
              .begins = begins_as_hdf5,
              .read = IF_BUILT(HAVE_HDF5, vtk_hdf_read),
              .instead = "save the array as .npy or NRRD",
              .has_frames = 1},
    [VTK_LEGACY] = {.name = "VTK legacy", .endings = "|.vtk|", .begins = begins_as_vtk_legacy, .read = vtk_legacy_read},
    [VTK_PARALLEL] = {.name = "parallel VTK XML",
                      .library = LIBRARY_EXPAT,
                      .notes = {{".pvti .pvtr .pvts .pvtu .vtm", LIBRARY_NONE}},
                      .endings = "|.pvti|.pvtr|.pvts|.pvtu|.vtm|.vtmb|",
                      .begins = begins_as_vtk_parallel,
                      .read = IF_BUILT(HAVE_EXPAT, vtk_parallel_read),
                      .instead = "save the whole grid as VTK legacy (.vtk)"},
    [VTK_XML] = {.name = "VTK XML",
                 .library = LIBRARY_EXPAT,
                 .notes = {{".vti .vtr .vts .vtu", LIBRARY_NONE},
                           {"zlib", LIBRARY_ZLIB},
                           {"LZ4", LIBRARY_LZ4},
                           {"LZMA", LIBRARY_LZMA}},
                 .endings = "|.vti|.vtr|.vts|.vtu|",
                 .begins = begins_as_vtk_xml,
                 .read = IF_BUILT(HAVE_EXPAT, vtk_xml_read),
                 .instead = "save the file as VTK legacy (.vtk)"},
    [PLOT3D] = {.name = "Plot3D",
                .notes = {{"grid and solution", LIBRARY_NONE}},
                .endings = "|.xyz|.x|.g|.p3d|",
                .read = plot3d_read,
                .may_be_half = 1},
};

const int read_format_count = FORMAT_COUNT;
const read_format *const raw_format = &read_formats[RAW], *const plot3d_format = &read_formats[PLOT3D],
                         *const tiff_format = &read_formats[TIFF], *const hdf5_format = &read_formats[HDF5];

const read_format *read_format_of_content(const mapping *file) {
    for (const read_format *f = read_formats; f < read_formats + FORMAT_COUNT; f++)
        if (f->begins && f->begins(file)) return f;
    return NULL;
}

const read_format *read_format_of_ending(const char *path) {
    for (const read_format *f = read_formats; f < read_formats + FORMAT_COUNT; f++)
        for (const char *at = f->endings + 1; *at; at += strcspn(at, "|") + 1) {
            char ending[16];
            snprintf(ending, sizeof ending, "%.*s", (int)strcspn(at, "|"), at);
            if (path_ends_with(path, ending)) return f;
            strncat(ending, ".gz", sizeof ending - strlen(ending) - 1);
            if (path_ends_with(path, ending)) return f;
        }
    return NULL;
}

const char *read_formats_text(char text[FORMATS_TEXT]) {
    size_t used = 0;
    text[0] = '\0';
    for (const read_format *f = read_formats; f < read_formats + FORMAT_COUNT; f++) {
        const char *before = " (";
        if (!f->read) continue;
        used += (size_t)snprintf(text + used, FORMATS_TEXT - used, "%s%s", used ? ", " : "", f->name);
        for (int n = 0; f->notes[n].text; n++) {
            if (!library_is_built(f->notes[n].library)) continue;
            used += (size_t)snprintf(text + used, FORMATS_TEXT - used, "%s%s", before, f->notes[n].text);
            before = ", ";
        }
        if (before[0] == ',') used += (size_t)snprintf(text + used, FORMATS_TEXT - used, ")");
    }
    return text;
}
