/*
 * read.c - finds the format of a file, by its content first, then by its ending, and reads it; see read.h
 */
#include "read.h"

#include "exit_status.h"
#include "failure.h"
#include "mapping.h"
#include "readers.h"

#include <string.h>
#include <strings.h>

const char *volume_formats(void) {
    return "raw, NRRD"
#if defined(HAVE_ZLIB) && defined(HAVE_BZIP2)
           " (gzip, bzip2)"
#elif defined(HAVE_ZLIB)
           " (gzip)"
#elif defined(HAVE_BZIP2)
           " (bzip2)"
#endif
           ", MetaImage"
#ifdef HAVE_ZLIB
           " (zlib)"
#endif
#ifdef HAVE_NIFTI
           ", NIfTI and Analyze 7.5"
#ifdef HAVE_ZLIB
           " (gzip)"
#endif
#endif
           ", VTK legacy"
#ifdef HAVE_EXPAT
           ", VTK XML (.vti .vtr .vts .vtu"
#ifdef HAVE_ZLIB
           "; zlib"
#endif
#ifdef HAVE_LZ4
           "; LZ4"
#endif
#ifdef HAVE_LZMA
           "; LZMA"
#endif
           ")"
#endif
           ", Plot3D (grid and solution)";
}

static int ends_with(const char *path, const char *ending) {
    size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

static int starts_with(const mapping *file, const char *text) {
    size_t length = strlen(text);
    return file->size >= length && memcmp(file->bytes, text, length) == 0;
}

/* The size of the header, which begins every NIfTI header, in either byte order. */
static int begins_as_nifti(const mapping *file) {
    static const char sizes[4][4] = {{92, 1, 0, 0}, {0, 0, 1, 92}, {28, 2, 0, 0}, {0, 0, 2, 28}};
    for (int i = 0; i < 4; i++)
        if (file->size >= 348 && memcmp(file->bytes, sizes[i], 4) == 0) return 1;
    return 0;
}

/* The element VTKFile, after a prolog and comments if there are any. */
static int begins_as_vtk_xml(const mapping *file) {
    enum { PROLOG = 4096 };
    size_t size = file->size < PROLOG ? file->size : PROLOG;
    return size && memmem(file->bytes, size, "<VTKFile", 8) != NULL;
}

/* Endings of Plot3D's files that are no use alone, or may be anything. */
static int ends_as_half_of_a_pair(const char *path) {
    return ends_with(path, ".q") || ends_with(path, ".f") || ends_with(path, ".bin");
}

#ifndef HAVE_NIFTI
int nifti_read(const read_request *request, const mapping *file, dataset *out) {
    (void)file;
    (void)out;
    return fail(STATUS_INPUT, "%s: is NIfTI, which this program was built without (TETRACUBES_NIFTI); it reads %s",
                request->path, volume_formats());
}
#endif

/* What takes the file: a reader of images or one of datasets; neither where the format is not known. */
typedef struct readers {
    int (*image)(const read_request *request, const mapping *file, dataset *out);
    int (*grid)(const read_request *request, const mapping *file, dataset *out);
} readers;

static readers readers_of_ending(const char *path) {
    static const struct {
        const char *ending;
        readers read;
    } endings[] = {
        {".nrrd", {nrrd_read, NULL}},     {".nhdr", {nrrd_read, NULL}},   {".mha", {metaimage_read, NULL}},
        {".mhd", {metaimage_read, NULL}}, {".nii", {nifti_read, NULL}},   {".nii.gz", {nifti_read, NULL}},
        {".hdr", {nifti_read, NULL}},     {".img", {nifti_read, NULL}},   {".hdr.gz", {nifti_read, NULL}},
        {".img.gz", {nifti_read, NULL}},  {".raw", {raw_read, NULL}},     {".vtk", {NULL, vtk_legacy_read}},
        {".vti", {NULL, vtk_xml_read}},   {".vtr", {NULL, vtk_xml_read}}, {".vts", {NULL, vtk_xml_read}},
        {".vtu", {NULL, vtk_xml_read}},   {".xyz", {NULL, plot3d_read}},  {".x", {NULL, plot3d_read}},
        {".g", {NULL, plot3d_read}},      {".p3d", {NULL, plot3d_read}},
    };
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (ends_with(path, endings[i].ending)) return endings[i].read;
    return (readers){NULL, NULL};
}

static readers find_readers(const read_request *request, const mapping *file) {
    const int64_t *d = request->dims;
    if (d[0] || d[1] || d[2] || request->type >= 0) return (readers){raw_read, NULL};
    if (starts_with(file, "NRRD0")) return (readers){nrrd_read, NULL};
    if (starts_with(file, "ObjectType") || starts_with(file, "NDims")) return (readers){metaimage_read, NULL};
    if (starts_with(file, "# vtk DataFile Version")) return (readers){NULL, vtk_legacy_read};
    if (begins_as_vtk_xml(file)) return (readers){NULL, vtk_xml_read};
    if (begins_as_nifti(file)) return (readers){nifti_read, NULL};
    if (mapping_is_standard_input(request->path) && starts_with(file, "\x1f\x8b")) return (readers){nifti_read, NULL};
    return readers_of_ending(request->path);
}

/* Whether the first characters are ASCII in UTF-16, behind its byte order mark, or the begin of an element without. */
static int begins_as_utf16(const mapping *file) {
    enum { UNITS = 4 };
    if (file->size < 2 * UNITS) return 0;
    const unsigned char *b = file->bytes;
    const int has_mark = (b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff);
    const int is_big = has_mark ? b[0] == 0xfe : !b[0];
    if (!has_mark && b[is_big] != '<') return 0;
    for (int n = has_mark; n < UNITS; n++)
        if (b[2 * n + !is_big] || !b[2 * n + is_big] || b[2 * n + is_big] > 126) return 0;
    return 1;
}

/* Texts in a form that no reader takes, where what is wrong would not show in a message. */
static int refuse_encoding(const read_request *request, const mapping *file) {
    const int64_t *d = request->dims;
    if (d[0] || d[1] || d[2] || request->type >= 0) return 0;
    if (begins_as_utf16(file))
        return fail(STATUS_INPUT, "%s: is text in UTF-16, which is not read; convert it: iconv -f UTF-16 -t UTF-8",
                    request->path);
    if (starts_with(file, "\xef\xbb\xbfNRRD0") || starts_with(file, "\xef\xbb\xbf# vtk DataFile"))
        return fail(STATUS_INPUT,
                    "%s: begins with a byte order mark (EF BB BF), which its format does not have; remove these bytes",
                    request->path);
    return 0;
}

/* What a file that is not read is, where that can be told; NULL where not. */
static const char *name_of_unread(const char *path, const mapping *file) {
    static const struct {
        const char *ending, *name;
    } endings[] = {{".ex2", "Exodus"},          {".e", "Exodus"},
                   {".exo", "Exodus"},          {".cgns", "CGNS"},
                   {".stl", "a surface (STL)"}, {".ply", "a surface (PLY)"},
                   {".obj", "a surface (OBJ)"}, {".dcm", "DICOM"},
                   {".xdmf", "XDMF"},           {".msh", "a mesh of Gmsh or Fluent"},
                   {".case", "EnSight"}};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (ends_with(path, endings[i].ending)) return endings[i].name;
    if (starts_with(file, "CDF\1") || starts_with(file, "CDF\2") || starts_with(file, "CDF\5"))
        return "netCDF (Exodus and others)";
    if (starts_with(file, "\211HDF\r\n\032\n")) return "HDF5 (CGNS, netCDF, VTKHDF and others)";
    return NULL;
}

static int refuse_unknown(const char *path, const mapping *file) {
    const char *name = name_of_unread(path, file);
    if (mapping_is_standard_input(path) && !file->size)
        return fail(STATUS_INPUT, "-: standard input is empty: what should send to it may have failed");
    if (name)
        return fail(STATUS_INPUT, "%s: is %s, which this program does not read; it reads %s", path, name,
                    volume_formats());
    if (ends_as_half_of_a_pair(path))
        return fail(STATUS_USAGE,
                    "%s: Plot3D needs two inputs, the grid, then its solution or function file; samples without a "
                    "header need --dims and --type",
                    path);
    return fail(STATUS_INPUT,
                "%s: its format is not known; this program reads %s; for samples without a header give --dims and "
                "--type",
                path, volume_formats());
}

/* Points of other grids lie where their coordinates say. */
static int check_placement(const read_request *request, const dataset *d) {
    const char *option = request->has_spacing ? "--spacing" : request->has_origin ? "--origin" : NULL;
    for (int n = 0; option && n < d->block_count; n++)
        if (d->blocks[n].kind != GRID_UNIFORM)
            return fail(STATUS_USAGE,
                        "%s: its points have coordinates of their own, and %s is for uniform grids: leave it out",
                        request->path, option);
    return 0;
}

/* Whether an earlier block has two such fields, too. */
static int was_told(const dataset *d, int block, const dataset_field *f) {
    for (int n = 0; n < block; n++) {
        int count = 0;
        for (int m = 0; m < d->blocks[n].field_count; m++)
            count += d->blocks[n].fields[m].on_cells == f->on_cells && !strcmp(d->blocks[n].fields[m].name, f->name);
        if (count > 1) return 1;
    }
    return 0;
}

/* Of fields of one name the first is taken (select.h). */
static void tell_repeated(dataset *d) {
    for (int n = 0; n < d->block_count; n++)
        for (int m = 1; m < d->blocks[n].field_count; m++) {
            const dataset_field *f = &d->blocks[n].fields[m];
            int earlier = 0;
            for (int k = 0; k < m && earlier < 2; k++) {
                const dataset_field *e = &d->blocks[n].fields[k];
                earlier += e->on_cells == f->on_cells && !strcmp(e->name, f->name);
            }
            if (earlier != 1 || was_told(d, n, f)) continue; /* 2: told for the second */
            dataset_notice(d, "several arrays of %s %s%.60s%s: the first is taken", f->on_cells ? "cells" : "points",
                           *f->name ? "have the name '" : "have no name", f->name, *f->name ? "'" : "");
        }
}

/* Grids have one frame, as images of three axes do. */
static int read_grid(int (*reader)(const read_request *request, const mapping *file, dataset *out),
                     const read_request *request, const mapping *file, dataset *out) {
    if (request->frame > 0) return fail(STATUS_USAGE, "%s: has one frame; leave out --frame", request->path);
    int status = reader(request, file, out);
    if (!status) tell_repeated(out);
    return status ? status : check_placement(request, out);
}

/* Two inputs are Plot3D, whose files say nothing about themselves; files that do are none. What begins as NIfTI may be
 * a grid of 348 points along x. */
static int may_be_plot3d(readers r) {
    return r.image == nifti_read || (!r.image && (!r.grid || r.grid == plot3d_read));
}

static int refuse_pair(const read_request *request) {
    return fail(STATUS_USAGE,
                "%s: holds all it has in one file, '%s' is a second one: two inputs are a Plot3D grid and its solution",
                request->path, request->path2);
}

int dataset_read(const read_request *request, dataset *out) {
    *out = (dataset){0};
    mapping file;
    if (request->path2 && (mapping_is_standard_input(request->path) || mapping_is_standard_input(request->path2)))
        return fail(STATUS_USAGE, "-: standard input is one file, and two inputs are a Plot3D grid and its solution: "
                                  "give the names of both");
    if (request->path2 && !may_be_plot3d(readers_of_ending(request->path))) return refuse_pair(request);
    int status = mapping_open(request->path, &file);
    if (status) return status;
    readers read = find_readers(request, &file);
    if ((status = refuse_encoding(request, &file))) {
    } else if (request->path2) {
        status = may_be_plot3d(read) ? read_grid(plot3d_read, request, &file, out) : refuse_pair(request);
    } else if (read.image) {
        status = read.image(request, &file, out);
    } else if (read.grid) {
        status = read_grid(read.grid, request, &file, out);
    } else {
        status = refuse_unknown(request->path, &file);
    }
    mapping_close(&file);
    if (!status && out->notice_lost)
        status = fail(STATUS_FAILED, "%s: no memory for what is to be told", request->path);
    if (status) dataset_release(out);
    return status;
}
