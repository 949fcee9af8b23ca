#include "surface_files.h"

#include "command_line/name_pattern.h"
#include "counted.h"
#include "exit_status.h"
#include "failure.h"
#include "input/input.h"
#include "output.h"
#include "shortest.h"
#include "terminal/notice.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { ALL_BLOCKS = -1 };

/* ----------------------------------------------------------------------------------------------------------- names */

/* The file of one isovalue and block. */
static char *file_name(const char *pattern, const typed_isovalue *iso, int block) {
    char behind[24] = "";
    if (block != ALL_BLOCKS) snprintf(behind, sizeof behind, "_b%d", block);
    return name_pattern_fill(pattern, iso->text, behind);
}

char *surface_file_name(const options *o, const char *pattern, const typed_isovalue *iso, int block) {
    return file_name(pattern, iso, o->separate_blocks ? block : ALL_BLOCKS);
}

/* ----------------------------------------------------------------------------------------------------------- usage */

static int check_names(const options *o, const char *option, const char *pattern) {
    struct stat there;
    if (o->separate_blocks && output_is_dash(pattern))
        return fail(STATUS_USAGE, "--blocks separate writes several files: %s - is one stream; name files", option);
    if (o->separate_blocks && stat(pattern, &there) == 0 && !S_ISREG(there.st_mode))
        return fail(STATUS_USAGE, "--blocks separate writes several files: %s is no file; name files", pattern);
    for (size_t a = 0; a < o->isovalue_count; a++)
        for (size_t b = 0; b < a; b++)
            if (strcmp(o->isovalues[a].text, o->isovalues[b].text) == 0)
                return fail(STATUS_USAGE, "--iso: %s is given twice and both would be written to one file",
                            o->isovalues[a].text);
    return name_pattern_check(option, pattern, o->isovalue_count, "isovalue");
}

/* The files of an isovalue; before the input is read, that of the first block alone. */
static int check_files(const options *o, const dataset *d, const char *option, const char *pattern,
                       const typed_isovalue *iso) {
    const int first = o->separate_blocks ? 0 : ALL_BLOCKS;
    const int end = o->separate_blocks && d ? d->block_count : first + 1;
    int status = 0;
    for (int block = first; block < end && !status; block++) {
        char *path = file_name(pattern, iso, block);
        status = path ? input_overwrite_check(o, d, option, path) : STATUS_FAILED;
        if (!status) status = output_check(path);
        free(path);
    }
    return status;
}

int surface_names_check(const options *o, const dataset *d, const char *option, const char *pattern) {
    int status = check_names(o, option, pattern);
    for (size_t n = 0; n < o->isovalue_count && !status; n++)
        status = check_files(o, d, option, pattern, &o->isovalues[n]);
    return status;
}

int surface_files_check(const options *o, const dataset *d) {
    const vertex_array some = {.name = "", .components = 1};
    const mesh_write_options how = {
        .format = o->format, .soup = o->soup, .fields = &some, .field_count = o->carry != NULL};
    if (!o->output) return 0;
    if (o->part[1] && !output_is_file(o->output))
        return fail(STATUS_USAGE, "-o %s: a part is written at many places of a file: name a file", o->output);
    int status = o->part[1] ? 0 : mesh_write_check(o->output, &how);
    return status ? status : surface_names_check(o, d, "-o", o->output);
}

/* ------------------------------------------------------------------------------------------------------- precision */

const double *surface_file_zero(const options *o, int suits_world) {
    static const double world[3] = {0, 0, 0};
    if (options_given(o, "--origin-at")) return o->origin_at;
    return suits_world ? world : NULL;
}

static mesh_write_options write_options(const options *o, const result_mesh *mesh) {
    return (mesh_write_options){.format = o->format,
                                .soup = o->soup,
                                .parts = mesh->parts,
                                .part_count = mesh->part_count,
                                .origin_at = surface_file_zero(o, mesh->suits_world)};
}

void surface_files_tell_relative(const double *origin, int is_own) {
    static const char why[] =
        "the format has float32 alone, too coarse for cells so far from zero: coordinates are relative to";
    static const char what[] = "PLY, VTP, OBJ, OFF, NPZ and VTKHDF hold full coordinates";
    if (is_own)
        notice("%s each block's origin (--origin-at chooses one point; %s)", why, what);
    else if (origin[0] != 0 || origin[1] != 0 || origin[2] != 0)
        notice("%s %s,%s,%s (--origin-at chooses the point; %s)", why, shortest_number(origin[0]).text,
               shortest_number(origin[1]).text, shortest_number(origin[2]).text, what);
}

int surface_files_count_coarse(const options *o, const surface_source *source, const result_mesh *mesh,
                               surface_report *s) {
    static const double world[3] = {0, 0, 0};
    if (!o->output) return 0;
    const mesh_write_options how = write_options(o, mesh);
    const int has_doubles = mesh_write_has_doubles(o->output, &how), digits = has_doubles ? DBL_MANT_DIG : FLT_MANT_DIG;
    const double *zero = how.origin_at ? how.origin_at : has_doubles ? world : mesh->mesh.origin;
    const int has_own_origin = o->separate_blocks || !engine_origins_differ(source->engine, source->range);
    if (mesh_write_is_relative(o->output, &mesh->mesh, &how)) s->is_relative = 1;
    if (!has_doubles && !how.origin_at && has_own_origin) return 0; /* they are the mesh's own numbers */
    return precision_count_file(source, zero, digits, o->check, &s->coarse_in_file);
}

void surface_files_tell_precision(const options *o, int block_count, const surface_report *s) {
    if (s->is_relative) surface_files_tell_relative(s->origin, o->separate_blocks && block_count > 1);
    precision_tell_file(s, options_given(o, "--origin-at"));
}

void surface_files_tell_joined(const options *o, const surface_report *s) {
    const mesh_write_options how = {.format = o->format};
    const uint64_t degenerate = s->summary.degenerate_triangles;
    if (!degenerate || !notice_wanted() || mesh_write_shares_vertices(o->output, &how)) return;
    notice(
        "isovalue %s: %s of zero area: the format does not say which vertices triangles share, and programs that join "
        "those at one position find edges with more than two triangles: --drop-degenerate leaves them out",
        s->iso->text, counted(degenerate, "triangle is", "triangles are").text);
}

/* --------------------------------------------------------------------------------------------------------- writing */

int surface_files_write(const options *o, const dataset *d, const typed_isovalue *iso, int block,
                        const result_mesh *mesh, const carried_fields *fields, output_group *group) {
    mesh_write_options how = write_options(o, mesh);
    how.world = d->world;
    how.units = d->units;
    how.fields = fields->fields;
    how.field_count = fields->count;
    how.group = group;
    char *path = surface_file_name(o, o->output, iso, block);
    int status = path ? mesh_write(path, &mesh->mesh, &how) : STATUS_FAILED;
    free(path);
    return status;
}

int surface_files_open_pieces(const options *o, const dataset *d, int suits_world, const typed_isovalue *iso,
                              const tc_mesh_data *whole, const part_header *part, const output_shared *shared,
                              const carried_fields *fields, output_group *group, piece_file **file) {
    piece_file *p = calloc(1, sizeof *p);
    *file = NULL;
    if (!p) return fail(STATUS_FAILED, "out of memory for the file of a surface");
    p->how = (mesh_write_options){.format = o->format,
                                  .fields = fields->fields,
                                  .field_count = fields->count,
                                  .world = d->world,
                                  .units = d->units,
                                  .origin_at = surface_file_zero(o, suits_world),
                                  .group = shared ? NULL : group,
                                  .shared = shared};
    p->path = surface_file_name(o, o->output, iso, 0);
    int status = p->path ? 0 : STATUS_FAILED;
    if (!status && part)
        status = part_file_open(p->path, part, group, &p->part);
    else if (!status)
        status = mesh_file_open(p->path, &p->how, whole, &p->file);
    if (!status) {
        *file = p;
        return 0;
    }
    surface_files_close_pieces(p, status);
    return status;
}

int surface_files_add_piece(piece_file *p, uint64_t first_vertex, uint64_t first_triangle, const tc_mesh_data *piece,
                            const carried_fields *fields) {
    if (p->part) return part_file_add(p->part, first_vertex, first_triangle, piece, fields->fields);
    return mesh_file_add(p->file, first_vertex, first_triangle, piece, fields->fields);
}

int surface_files_close_pieces(piece_file *p, int status) {
    if (!p) return 0;
    int closed = 0;
    if (status) {
        mesh_file_discard(p->file);
        part_file_discard(p->part);
    } else {
        closed = p->part ? part_file_close(p->part) : mesh_file_close(p->file);
    }
    free(p->path);
    free(p);
    return closed;
}

/* "out_b0.ply to out_b2.ply" */
int surface_files_name(const options *o, const char *pattern, const typed_isovalue *iso, int block_count,
                       file_names *names) {
    int status = file_names_make(names, o->separate_blocks ? block_count : 1);
    for (int n = 0; n < names->count && !status; n++)
        if (!(names->names[n] = surface_file_name(o, pattern, iso, n))) status = STATUS_FAILED;
    return status;
}
