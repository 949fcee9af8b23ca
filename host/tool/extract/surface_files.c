#include "surface_files.h"

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

/* Where "_b0" goes: before the last dot of the name's last part, or at its end. */
static const char *ending_of(const char *path) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    return dot ? dot : path + strlen(path);
}

/* The file of one isovalue and block, from malloc: with several isovalues every % stands for the isovalue as typed. */
static char *file_name(const options *o, const typed_isovalue *iso, int block) {
    const char *stand_in = o->isovalue_count > 1 ? iso->text : "%", *ending = ending_of(o->output);
    char number[24] = "";
    if (block != ALL_BLOCKS) snprintf(number, sizeof number, "_b%d", block);
    size_t bytes = strlen(number) + 1;
    for (const char *c = o->output; *c; c++) bytes += *c == '%' ? strlen(stand_in) : 1;
    char *path = malloc(bytes), *at = path;
    for (const char *c = o->output; path; c++) {
        if (c == ending) at = stpcpy(at, number);
        if (!*c) break;
        at = *c == '%' ? stpcpy(at, stand_in) : (*at = *c, at + 1);
    }
    if (path)
        *at = '\0';
    else
        fail(STATUS_FAILED, "out of memory for the name of the output");
    return path;
}

/* ----------------------------------------------------------------------------------------------------------- usage */

int surface_files_check(const options *o) {
    struct stat there;
    const mesh_field some = {.name = "", .components = 1};
    const mesh_write_options how = {
        .format = o->format, .soup = o->soup, .fields = &some, .field_count = o->carry != NULL};
    if (!o->output) return 0;
    if (o->separate_blocks && output_is_dash(o->output))
        return fail(STATUS_USAGE, "--blocks separate writes several files: -o - is one stream; name files");
    if (o->separate_blocks && stat(o->output, &there) == 0 && !S_ISREG(there.st_mode))
        return fail(STATUS_USAGE, "--blocks separate writes several files: %s is no file; name files", o->output);
    if (o->isovalue_count > 1 && !strchr(o->output, '%'))
        return fail(STATUS_USAGE, "-o %s: with several isovalues the name needs a %%, which stands for the isovalue",
                    o->output);
    for (size_t a = 0; a < o->isovalue_count; a++)
        for (size_t b = 0; b < a; b++)
            if (strcmp(o->isovalues[a].text, o->isovalues[b].text) == 0)
                return fail(STATUS_USAGE, "--iso: %s is given twice and both would be written to one file",
                            o->isovalues[a].text);
    int status = mesh_write_check(o->output, &how);
    for (size_t n = 0; n < o->isovalue_count && !status; n++) {
        char *path = file_name(o, &o->isovalues[n], ALL_BLOCKS);
        status = path ? input_overwrite_check(o, path) : STATUS_FAILED;
        free(path);
    }
    for (size_t n = 0; n < o->isovalue_count && !status; n++) {
        char *path = file_name(o, &o->isovalues[n], o->separate_blocks ? 0 : ALL_BLOCKS);
        status = path ? output_check(path) : STATUS_FAILED;
        free(path);
    }
    return status;
}

/* --------------------------------------------------------------------------------------------------------- writing */

/* One block's part of the mesh, from vertex and triangle on, as a mesh of its own. */
static int write_part(const options *o, const char *path, const tc_mesh_data *mesh, uint64_t vertex, uint64_t triangle,
                      mesh_part size, mesh_write_options *how) {
    mesh_field *fields = calloc((size_t)how->field_count + 1, sizeof *fields);
    uint32_t *triangles = malloc((size_t)(3 * size.triangle_count + 1) * sizeof *triangles);
    int status =
        fields && triangles ? input_overwrite_check(o, path) : fail(STATUS_FAILED, "out of memory for %s", path);
    tc_mesh_data part = *mesh;
    part.vertex_count = size.vertex_count;
    part.triangle_count = size.triangle_count;
    memcpy(part.origin, size.origin, sizeof part.origin);
    part.positions += 3 * vertex;
    if (part.normals) part.normals += 3 * vertex;
    for (uint64_t n = 0; triangles && n < 3 * size.triangle_count; n++)
        triangles[n] = mesh->triangles[3 * triangle + n] - (uint32_t)vertex;
    part.triangles = triangles;
    for (int n = 0; fields && n < how->field_count; n++) {
        fields[n] = how->fields[n];
        fields[n].values += vertex * (uint64_t)fields[n].components;
    }
    how->fields = fields;
    if (!status) status = mesh_write(path, &part, how);
    free(fields);
    free(triangles);
    return status;
}

static int write_parts(const options *o, const typed_isovalue *iso, const final_surface *shown,
                       const mesh_write_options *how) {
    uint64_t vertex = 0, triangle = 0;
    int status = 0;
    for (int n = 0; n < shown->part_count && !status; n++) {
        const mesh_part *size = &shown->parts[n];
        mesh_write_options own = *how;
        char *path = file_name(o, iso, n);
        status = path ? write_part(o, path, &shown->mesh, vertex, triangle, *size, &own) : STATUS_FAILED;
        free(path);
        vertex += size->vertex_count;
        triangle += size->triangle_count;
    }
    return status;
}

/* "out_b0.ply to out_b2.ply" */
static char *describe_files(const options *o, const typed_isovalue *iso, int block_count) {
    char *first = file_name(o, iso, 0), *last = file_name(o, iso, block_count - 1), *text = NULL;
    if (block_count < 2) {
        free(last);
        return first;
    }
    if (first && last && asprintf(&text, "%s to %s", first, last) < 0) {
        text = NULL;
        fail(STATUS_FAILED, "out of memory for the names of the output");
    }
    free(first);
    free(last);
    return text;
}

static mesh_write_options write_options(const options *o, const final_surface *shown) {
    return (mesh_write_options){.format = o->format,
                                .soup = o->soup,
                                .parts = shown->parts,
                                .part_count = shown->part_count,
                                .origin_at = options_given(o, "--origin-at") ? o->origin_at : NULL};
}

/* STL holds float32 alone: its coordinates count from the mesh's origin. */
static void tell_relative(const double *origin, int is_own) {
    static const char why[] = "STL holds float32 alone, too coarse so far from zero: coordinates in it are relative to";
    static const char what[] = "PLY, VTP and OBJ hold full coordinates";
    if (is_own)
        notice("%s each block's origin (--origin-at chooses one point; %s)", why, what);
    else if (origin[0] != 0 || origin[1] != 0 || origin[2] != 0)
        notice("%s %s,%s,%s (--origin-at chooses the point; %s)", why, shortest_number(origin[0]).text,
               shortest_number(origin[1]).text, shortest_number(origin[2]).text, what);
}

int surface_files_tell_numbers(const options *o, const surface_source *source, const final_surface *shown,
                               precision_verdict *verdict) {
    static const double world[3] = {0, 0, 0};
    *verdict = (precision_verdict){0};
    if (!o->output) return 0;
    const mesh_write_options how = write_options(o, shown);
    const int has_doubles = mesh_write_has_doubles(o->output, &how), digits = has_doubles ? DBL_MANT_DIG : FLT_MANT_DIG;
    const double *zero = how.origin_at ? how.origin_at : has_doubles ? world : shown->mesh.origin;
    const int is_own = o->separate_blocks && shown->part_count > 1 && !how.origin_at && !has_doubles;
    if (mesh_write_is_relative(o->output, &shown->mesh, &how)) tell_relative(shown->mesh.origin, is_own);
    if (is_own || (!has_doubles && !how.origin_at && !engine_origins_differ(source->engine))) return 0; /* the mesh's */
    return precision_tell_file(source, zero, how.origin_at != NULL, digits, o->check, verdict);
}

int surface_files_write(const options *o, const typed_isovalue *iso, const final_surface *shown,
                        const mesh_field *fields, int field_count, char **written) {
    mesh_write_options how = write_options(o, shown);
    how.fields = fields;
    how.field_count = field_count;
    *written = o->separate_blocks ? describe_files(o, iso, shown->part_count) : file_name(o, iso, ALL_BLOCKS);
    if (!*written) return STATUS_FAILED;
    if (!o->separate_blocks) return mesh_write(*written, &shown->mesh, &how);
    how.part_count = 0; /* each file has one */
    return write_parts(o, iso, shown, &how);
}
