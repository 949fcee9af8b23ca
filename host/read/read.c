/*
 * read.c - finds the format of a file, by its content first, then by its ending, and reads it; see read.h
 */
#include "read.h"

#include "dataset/region.h"
#include "exit_status.h"
#include "failure.h"
#include "file/gunzip.h"
#include "file/mapping.h"
#include "image/slices.h"
#include "read_formats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Samples without a header: all about them is in the request. */
static int is_raw(const read_request *request) {
    const int64_t *d = request->dims;
    return d[0] || d[1] || d[2] || request->type >= 0;
}

/* Endings of Plot3D's files that are no use alone, or may be anything. */
static int ends_as_half_of_a_pair(const char *path) {
    return path_ends_with(path, ".q") || path_ends_with(path, ".f") || path_ends_with(path, ".bin");
}

/* Whether the file begins with ASCII characters in UTF-16: after a byte order mark, or, without one, with '<'. */
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

/* Refuses encodings of text that no reader takes. The reader's own message would not show what is wrong. */
static int refuse_encoding(const read_request *request, const mapping *file) {
    if (is_raw(request)) return 0;
    if (begins_as_utf16(file))
        return fail(STATUS_INPUT, "%s: is text in UTF-16, which is not read; convert it: iconv -f UTF-16 -t UTF-8",
                    request->path);
    if (file_starts_with(file, "\xef\xbb\xbfNRRD0") || file_starts_with(file, "\xef\xbb\xbf# vtk DataFile"))
        return fail(STATUS_INPUT,
                    "%s: begins with a byte order mark (EF BB BF), which its format does not have; remove these bytes",
                    request->path);
    return 0;
}

/* A known format that this program does not read, and how its files come in all the same. */
typedef struct unread {
    const char *ending, *name, *advice;
} unread;

#define BY_PYTHON "save it as .vtu, by ParaView or PyVista, or contour it from Python (tetracubes.contour_cells)"
#define BY_VTK    "save it as .vtu or .vtm, by ParaView"
#define NO_VOLUME "a surface has no isosurfaces"

/* NULL where it is unknown. */
static const unread *find_unread(const char *path, const mapping *file) {
    static const unread endings[] = {{".ex2", "Exodus", BY_PYTHON},
                                     {".e", "Exodus", BY_PYTHON},
                                     {".exo", "Exodus", BY_PYTHON},
                                     {".cgns", "CGNS", BY_VTK},
                                     {".stl", "a surface (STL)", NO_VOLUME},
                                     {".ply", "a surface (PLY)", NO_VOLUME},
                                     {".obj", "a surface (OBJ)", NO_VOLUME},
                                     {".dcm", "DICOM", "convert it to NIfTI, as dcm2niix does"},
                                     {".xdmf", "XDMF", BY_VTK},
                                     {".msh", "a mesh of Gmsh or Fluent", "convert it: meshio convert FILE a.vtu"},
                                     {".case", "EnSight", BY_VTK}};
    static const unread netcdf = {"", "netCDF (Exodus and others)", "convert it to HDF5: nccopy -k nc4 FILE a.h5"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++)
        if (path_ends_with(path, endings[i].ending)) return &endings[i];
    const int is_netcdf =
        file_starts_with(file, "CDF\1") || file_starts_with(file, "CDF\2") || file_starts_with(file, "CDF\5");
    return is_netcdf ? &netcdf : NULL;
}

static const read_format *find_format(const read_request *request, const mapping *file) {
    if (is_raw(request) && !request->raw_else) return raw_format;
    const read_format *format = read_format_of_content(file);
    if (format == hdf5_format && find_unread(request->path, file)) return NULL; /* CGNS and Exodus lie in it */
    if (!format) format = read_format_of_ending(request->path);
    return format || !request->raw_else ? format : raw_format;
}

static int refuse_unknown(const char *path, const mapping *file) {
    const unread *known = find_unread(path, file);
    char formats[FORMATS_TEXT];
    if (mapping_is_stream(path) && !file->size)
        return fail(STATUS_INPUT, "%s: %s is empty: what should send to it may have failed", path,
                    mapping_is_standard_input(path) ? "standard input" : "the pipe");
    if (known)
        return fail(STATUS_INPUT, "%s: is %s, which this program does not read: %s; it reads %s", path, known->name,
                    known->advice, read_formats_text(formats));
    if (ends_as_half_of_a_pair(path))
        return fail(STATUS_USAGE,
                    "%s: Plot3D needs two inputs, the grid, then its solution or function file; samples without a "
                    "header need --dims and --type",
                    path);
    return fail(STATUS_INPUT,
                "%s: its format is not known; this program reads %s; for samples without a header give --dims and "
                "--type",
                path, read_formats_text(formats));
}

/* --spacing and --origin are for uniform grids: points of others have coordinates of their own. */
static int check_placement(const read_request *request, const dataset *d) {
    const char *option = request->has_spacing ? "--spacing" : request->has_origin ? "--origin" : NULL;
    for (int n = 0; option && n < d->block_count; n++)
        if (d->blocks[n].kind != BLOCK_UNIFORM)
            return fail(STATUS_USAGE,
                        "%s: its points have coordinates of their own, and %s is for uniform grids: leave it out",
                        request->path, option);
    return 0;
}

/* Whether an earlier block has several fields of this name, too: then the notice is there already. */
static int was_told(const dataset *d, int block, const dataset_field *f) {
    for (int n = 0; n < block; n++) {
        int count = 0;
        for (int m = 0; m < d->blocks[n].field_count; m++)
            count += d->blocks[n].fields[m].on_cells == f->on_cells && !strcmp(d->blocks[n].fields[m].name, f->name);
        if (count > 1) return 1;
    }
    return 0;
}

/* Where fields have the same name the first is taken (select.h); a notice says so. */
static void tell_repeated(dataset *d) {
    for (int n = 0; n < d->block_count; n++)
        for (int m = 1; m < d->blocks[n].field_count; m++) {
            const dataset_field *f = &d->blocks[n].fields[m];
            int earlier = 0;
            for (int other = 0; other < m && earlier < 2; other++) {
                const dataset_field *e = &d->blocks[n].fields[other];
                earlier += e->on_cells == f->on_cells && !strcmp(e->name, f->name);
            }
            if (earlier != 1 || was_told(d, n, f)) continue; /* 2: the second has been told of */
            dataset_notice(d, "several arrays of %s %s%.60s%s: the first is taken", f->on_cells ? "cells" : "points",
                           *f->name ? "have the name '" : "have no name", f->name, *f->name ? "'" : "");
        }
}

static int refuse_absent(const read_format *format, const char *path) {
    char is[64];
    snprintf(is, sizeof is, "is %s", format->name);
    return library_fail(format->library, path, is, format->instead);
}

/* Grids have one frame, as images of three axes do. */
static int read_as(const read_format *format, const read_request *request, const mapping *file, dataset *out) {
    if (!format->read) return refuse_absent(format, request->path);
    if (!format->has_frames && request->frame > 0)
        return fail(STATUS_USAGE, "%s: has one frame; leave out --frame", request->path);
    int status = format->read(request, file, out);
    if (!status) tell_repeated(out);
    if (!status) status = check_placement(request, out);
    if (!status && !out->frames) status = region_cut_blocks(request, out); /* images are cut already */
    return status;
}

/* Two inputs can only be Plot3D, whose files do not say what they are. So a file whose format is known is none of them,
 * unless a Plot3D file may look like it. */
static int may_be_plot3d(const read_format *format) { return !format || format->may_be_half; }

static int refuse_pair(const read_request *request) {
    return fail(STATUS_USAGE,
                "%s: holds all it has in one file, '%s' is a second one: two inputs are a Plot3D grid and its solution",
                request->path, request->path2);
}

/* Whether a file is packed as a whole. A NIfTI file's reader unpacks it itself, and samples without a header may begin
 * like anything. */
static int is_packed(const read_request *request, const char *path, const mapping *file) {
    if (!gunzip_begins(file)) return 0;
    if (mapping_is_stream(path)) return !is_raw(request) || request->raw_else;
    if (is_raw(request) && !request->raw_else) return path_ends_with(path, ".gz");
    const read_format *format = read_format_of_ending(path);
    return !format || !format->unpacks;
}

/* Maps a file of the input, unpacked where it is packed. */
static int map_unpacked(const read_request *request, const char *path, dataset *out, mapping *file) {
    int status = dataset_map(out, path, file);
    if (status || !is_packed(request, path, file)) return status;
    status = gunzip(path, file);
    mapping_close(file);
    return status ? status : dataset_map(out, path, file);
}

/* The same of the second input, which its reader maps. */
static int unpack_second(const read_request *request, dataset *out) {
    mapping file;
    int status = request->path2 ? map_unpacked(request, request->path2, out, &file) : 0;
    if (request->path2 && !status) mapping_close(&file);
    return status;
}

/* Names stand for their own files again. */
static void restore_names(const read_request *request) {
    mapping_restore(request->path);
    if (request->path2) mapping_restore(request->path2);
}

/* What was read, unless notices were lost or a status says that it failed; then nothing. */
static int finish(const read_request *request, dataset *out, int status) {
    if (!status && out->notice_lost)
        status = fail(STATUS_FAILED, "%s: no memory for what is to be told", request->path);
    if (status) dataset_release(out);
    return status;
}

static int read_named(const read_request *request, dataset *out) {
    mapping file = {0};
    if (tiff_format->read && !request->path2 && !is_raw(request) && slices_are_named(request->path))
        return finish(request, out, read_as(tiff_format, request, &file, out));
    if (is_raw(request) && !request->raw_else && slices_are_named(request->path))
        return fail(STATUS_USAGE,
                    "%s: folders and numbered names are for TIFF; a NRRD header lists slices of raw samples, by a line "
                    "as 'data file: slice.%%d 1 93 1'",
                    request->path);
    if (request->path2 && (mapping_is_standard_input(request->path) || mapping_is_standard_input(request->path2)))
        return fail(STATUS_USAGE,
                    "%s: standard input is one file, and two inputs are a Plot3D grid and its solution: "
                    "give the names of both",
                    mapping_is_standard_input(request->path) ? request->path : request->path2);
    if (request->path2 && !may_be_plot3d(read_format_of_ending(request->path))) return refuse_pair(request);
    int status = map_unpacked(request, request->path, out, &file);
    if (status) {
        restore_names(request);
        return finish(request, out, status);
    }
    const read_format *format = find_format(request, &file);
    if (request->path2 && may_be_plot3d(format)) format = plot3d_format;
    if ((status = refuse_encoding(request, &file))) {
    } else if (request->path2 && format != plot3d_format) {
        status = refuse_pair(request);
    } else if (!(status = unpack_second(request, out))) {
        status = format ? read_as(format, request, &file, out) : refuse_unknown(request->path, &file);
    }
    mapping_close(&file);
    restore_names(request);
    return finish(request, out, status);
}

/* "file.h5:/path/to/dataset", where there is no file of all that name: the file, and the dataset's name in it. */
int dataset_read(const read_request *request, dataset *out) {
    read_request own = *request;
    const char *colon = strstr(request->path, ":/");
    *out = (dataset){0};
    if (!colon || request->inside || mapping_is_stream(request->path) || access(request->path, F_OK) == 0)
        return read_named(request, out);
    char *path = strndup(request->path, (size_t)(colon - request->path));
    if (!path) return fail(STATUS_FAILED, "%s: no memory for its name", request->path);
    own.path = path;
    own.inside = colon + 1;
    int status = read_named(&own, out);
    free(path);
    return status;
}
