/*
 * write.c - finds the format, checks that the counts fit it, and calls its writer
 */
#include "mesh_write.h"

#include "exit_status.h"
#include "failure.h"
#include "formats.h"
#include "held_triangles.h"
#include "output_group.h"
#include "vtkhdf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

void (*vtkhdf_writer)(output *o, const shown_mesh *s);

void vtkhdf_write(output *o, const shown_mesh *s) { vtkhdf_writer(o, s); }

enum counted { COUNTS_vertices, COUNTS_triangles, COUNTS_nothing };
enum pieces { PIECES_NOT, PIECES_NUMBERS, PIECES_CORNERS };

typedef struct format {
    const char *name;
    void (*write)(output *o, const shown_mesh *s);
    int roles;       /* bits, HAS_... */
    int has_doubles; /* for coordinates */
    enum counted counted;
    int (*fits)(const shown_mesh *s); /* NULL: whatever the counts allow */
    enum pieces pieces;
} format;

#define FORMAT(name, label, roles, has_doubles, counts, fits, pieces)                                                  \
    {#name, name##_write, roles, has_doubles, COUNTS_##counts, fits, PIECES_##pieces},
static const format formats[] = {MESH_FORMATS(FORMAT)};

enum { FORMAT_COUNT = sizeof formats / sizeof *formats, LIST_BYTES = 96 };

/* Values per vertex, of all fields together: a block of the output has to hold many vertices. */
enum { FIELD_VALUES_MOST = 4096 };

static const format *find_format(const char *name) {
    for (const format *f = formats; f < formats + FORMAT_COUNT; f++)
        if (strcasecmp(f->name, name) == 0) return f;
    return NULL;
}

static int is_there(const format *f) { return f->write != vtkhdf_write || vtkhdf_writer; }

static int has_role(const format *f, vertex_role role) { return f->roles >> role & 1; }

static int has_data(const format *f) { return has_role(f, ROLE_DATA); }

static int is_of_any_size(const format *f) { return !f->fits && f->counted != COUNTS_triangles; }

static int goes_in_pieces(const format *f) { return f->pieces != PIECES_NOT; }

/* Makes "ply, vtp, stl or obj" of the formats that are meant, with `before` in front of each name. */
static const char *list_formats(int (*is_meant)(const format *f), const char *before, char list[LIST_BYTES]) {
    size_t used = 0;
    const format *last = formats;
    for (const format *f = formats; f < formats + FORMAT_COUNT; f++) last = is_there(f) && is_meant(f) ? f : last;
    for (const format *f = formats; f <= last; f++)
        if (is_there(f) && is_meant(f))
            used += (size_t)snprintf(list + used, LIST_BYTES - used, "%s%s%s",
                                     !used       ? ""
                                     : f == last ? " or "
                                                 : ", ",
                                     before, f->name);
    return list;
}

/* What follows the last dot of the file's name; "" where there is none. */
static const char *ending_of(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    return dot ? dot + 1 : "";
}

static int check_fields(const char *path, const mesh_write_options *options, const format *f) {
    int64_t values = 0;
    char list[LIST_BYTES];
    if (!options || !options->field_count) return 0;
    if (!has_data(f))
        return fail(STATUS_USAGE, "%s: %s holds no fields on vertices; write %s", path, f->name,
                    list_formats(has_data, "", list));
    for (int i = 0; i < options->field_count; i++) values += options->fields[i].components;
    if (values <= FIELD_VALUES_MOST) return 0;
    return fail(STATUS_USAGE, "%s: %lld values per vertex are more than the %d that are written; name fewer fields",
                path, (long long)values, FIELD_VALUES_MOST);
}

/* The format of those that are meant: others are not refused, but none of them is proposed. */
static int choose_of(int (*is_meant)(const format *f), const char *path, const mesh_write_options *options,
                     const format **chosen) {
    int named = options && options->format;
    char list[LIST_BYTES];
    *chosen = find_format(named ? options->format : ending_of(path));
    if (*chosen && !is_there(*chosen))
        return fail(STATUS_USAGE, "%s: is VTKHDF, for which libhdf5 was not built in: write vtp", path);
    if (*chosen) return check_fields(path, options, *chosen);
    if (named)
        return fail(STATUS_USAGE, "format \"%s\" is not known: meshes are written as %s", options->format,
                    list_formats(is_meant, "", list));
    if (output_is_dash(path)) return fail(STATUS_USAGE, "-o - has no ending: name the format by --format");
    return fail(STATUS_USAGE, "%s: its ending names no known format: let it end in %s, or name the format by --format",
                path, list_formats(is_meant, ".", list));
}

static int choose_format(const char *path, const mesh_write_options *options, const format **chosen) {
    return choose_of(is_there, path, options, chosen);
}

static int check_counts(const char *path, const tc_mesh_data *mesh, int soup, const format *f) {
    int by_triangles = f->counted == COUNTS_triangles;
    uint64_t count = by_triangles ? mesh->triangle_count : mesh->vertex_count;
    if (f->counted == COUNTS_nothing) return 0;
    if (!by_triangles && soup && mesh->triangle_count > FORMAT_LIMIT / 3)
        return fail(STATUS_FAILED,
                    "%s: %llu triangles with vertices of their own are more than the 2^32 - 1 vertices that %s holds; "
                    "write shared vertices instead",
                    path, (unsigned long long)mesh->triangle_count, f->name);
    if (count > FORMAT_LIMIT)
        return fail(STATUS_FAILED, "%s: %llu %s are more than the 2^32 - 1 that %s holds%s", path,
                    (unsigned long long)count, by_triangles ? "triangles" : "vertices", f->name,
                    by_triangles ? "; write ply or obj instead" : "; write vtp, or extract a part of the volume");
    return 0;
}

/* Whether the file's size fits the format. */
static int check_size(const char *path, const shown_mesh *s, const format *f) {
    char list[LIST_BYTES];
    if (!f->fits || f->fits(s)) return 0;
    return fail(STATUS_FAILED, "%s: %llu vertices and %llu triangles are more than %s holds; write %s", path,
                (unsigned long long)file_vertex_count(s), (unsigned long long)s->mesh->triangle_count, f->name,
                list_formats(is_of_any_size, "", list));
}

int mesh_write_check(const char *path, const mesh_write_options *options) {
    const format *f;
    return choose_format(path, options, &f);
}

static int is_zero(const double point[3]) { return point[0] == 0 && point[1] == 0 && point[2] == 0; }

static int is_far(const tc_mesh_data *mesh, const mesh_write_options *options) {
    for (int n = 0; options && n < options->part_count; n++)
        if (!is_zero(options->parts[n].origin)) return 1;
    return !is_zero(mesh->origin);
}

int mesh_write_has_doubles(const char *path, const mesh_write_options *options) {
    const format *f;
    return !choose_format(path, options, &f) && f->has_doubles;
}

int mesh_write_shares_vertices(const char *path, const mesh_write_options *options) {
    const format *f;
    return !choose_format(path, options, &f) && f->counted != COUNTS_triangles;
}

int mesh_write_lacks(const char *path, const mesh_write_options *options, vertex_role role) {
    const format *f;
    return !choose_format(path, options, &f) && !has_role(f, role);
}

int mesh_write_lacks_labels(const char *path, const mesh_write_options *options) {
    const format *f;
    return !choose_format(path, options, &f) && !(f->roles & HAS_LABELS);
}

int mesh_write_is_relative(const char *path, const tc_mesh_data *mesh, const mesh_write_options *options) {
    const format *f;
    if (choose_format(path, options, &f)) return 0;
    return is_far(mesh, options) && !f->has_doubles && !(options && options->origin_at);
}

/* Fills s->parts: what is added to the positions of each part. *parts, from malloc, is the caller's to free, also after
 * a failure. */
static int set_offsets(shown_mesh *s, const mesh_write_options *options, const format *f, shown_part **parts) {
    const mesh_part whole = {.vertex_count = s->vertex_count,
                             .origin = {s->mesh->origin[0], s->mesh->origin[1], s->mesh->origin[2]}};
    const int count = options ? options->part_count : 0;
    const mesh_part *from = count ? options->parts : &whole;
    const double *at = options ? options->origin_at : NULL;
    static const double world[3] = {0, 0, 0};
    const double *zero = at ? at : f->has_doubles ? world : s->mesh->origin;
    uint64_t end = 0;
    s->parts = *parts = calloc((size_t)count + 1, sizeof **parts);
    s->part_count = count ? count : 1;
    if (!*parts) return fail(STATUS_FAILED, "out of memory for the parts of the surface");
    for (int n = 0; n < s->part_count; n++) {
        shown_part *part = &(*parts)[n];
        part->vertex_end = end += from[n].vertex_count;
        for (int axis = 0; axis < 3; axis++) part->offset[axis] = from[n].origin[axis] - zero[axis];
        if (!is_zero(part->offset) && from[n].vertex_count) s->is_moved = 1;
    }
    return 0;
}

/* Fills s->arrays: channels, then fields. *arrays, from malloc, is the caller's to free, also after a failure. */
static int set_arrays(shown_mesh *s, const mesh_write_options *options, const format *f, vertex_array **arrays) {
    const int field_count = options ? options->field_count : 0;
    vertex_array *to = *arrays = calloc(CHANNEL_COUNT + (size_t)field_count, sizeof *to);
    if (!to) return fail(STATUS_FAILED, "out of memory for the values of the vertices");
    for (int n = 0; n < CHANNEL_COUNT; n++) {
        const mesh_channel *c = &mesh_channels[n];
        const float *values = mesh_values(s->mesh, n);
        if (values && has_role(f, c->role)) *to++ = (vertex_array){c->name, c->components, values, c->role};
    }
    for (int n = 0; n < field_count; n++) *to++ = options->fields[n];
    s->arrays = *arrays;
    s->array_count = (int)(to - *arrays);
    return 0;
}

static void set_notes(shown_mesh *s, const mesh_write_options *options) {
    s->world = options && options->world ? options->world : "";
    s->units = options && options->units ? options->units : "";
}

int mesh_write(const char *path, const tc_mesh_data *mesh, const mesh_write_options *options) {
    const format *f;
    output o;
    shown_part *parts = NULL;
    vertex_array *arrays = NULL;
    shown_mesh shown = {.mesh = mesh,
                        .vertex_count = mesh->vertex_count,
                        .triangle_count = mesh->triangle_count,
                        .soup = options && options->soup};
    set_notes(&shown, options);
    int status = choose_format(path, options, &f);
    if (!status) status = check_counts(path, mesh, shown.soup, f);
    if (!status) status = set_offsets(&shown, options, f, &parts);
    if (!status) status = set_arrays(&shown, options, f, &arrays);
    if (!status && f->roles & HAS_LABELS) shown.labels = mesh->boundary_labels;
    if (!status) status = check_size(path, &shown, f);
    if (!status) status = output_open(&o, path);
    if (!status) {
        f->write(&o, &shown);
        status = options && options->group ? output_wait(&o, options->group) : output_close(&o);
    }
    free(parts);
    free(arrays);
    return status;
}

/* ----------------------------------------------------------------------------------------------------------- pieces */

struct mesh_file {
    const format *format;
    const mesh_write_options *options;
    tc_mesh_data whole;
    output o;
    shown_mesh shown;
    shown_part *parts;
    vertex_array *arrays;
    held_triangles held; /* of a format that has triangles by their corners: those that wait for the next piece */
};

int mesh_file_check(const char *path, const mesh_write_options *options) {
    const format *f;
    char list[LIST_BYTES];
    if (!output_is_file(path))
        return fail(STATUS_USAGE,
                    "%s is no file: pieces of a mesh are written at many places of one; name a file that ends in %s",
                    output_is_dash(path) ? "-o -" : path, list_formats(goes_in_pieces, ".", list));
    int status = choose_of(goes_in_pieces, path, options, &f);
    if (status) return status;
    if (!goes_in_pieces(f))
        return fail(STATUS_USAGE,
                    "%s: %s cannot be written piece by piece, as parts, streams and what does not fit memory are; "
                    "write %s",
                    path, f->name, list_formats(goes_in_pieces, "", list));
    if (options && options->soup)
        return fail(STATUS_USAGE,
                    "%s: vertices of their own for every triangle (--soup) are not written piece by piece", path);
    return 0;
}

int mesh_file_takes_halves(const char *path, const mesh_write_options *options) {
    const format *f;
    return !choose_format(path, options, &f) && f->pieces == PIECES_NUMBERS;
}

int mesh_file_open(const char *path, const mesh_write_options *options, const tc_mesh_data *whole, mesh_file **file) {
    mesh_file *m = calloc(1, sizeof *m);
    *file = NULL;
    if (!m) return fail(STATUS_FAILED, "out of memory for a file");
    m->options = options;
    m->whole = *whole;
    m->shown =
        (shown_mesh){.mesh = &m->whole, .vertex_count = whole->vertex_count, .triangle_count = whole->triangle_count};
    set_notes(&m->shown, options);
    int status = choose_format(path, options, &m->format);
    if (!status) status = check_counts(path, whole, 0, m->format);
    if (!status) status = set_offsets(&m->shown, options, m->format, &m->parts);
    if (!status) status = set_arrays(&m->shown, options, m->format, &m->arrays);
    if (!status && options && options->shared)
        output_share(&m->o, path, options->shared);
    else if (!status)
        status = output_open(&m->o, path);
    if (!status) {
        *file = m;
        return 0;
    }
    free(m->parts);
    free(m->arrays);
    free(m);
    return status;
}

static int write_piece(mesh_file *m, uint64_t first_vertex, uint64_t first_triangle, const tc_mesh_data *piece) {
    m->shown.mesh = piece;
    m->shown.first_vertex = first_vertex;
    m->shown.first_triangle = first_triangle;
    output_rewind(&m->o);
    m->format->write(&m->o, &m->shown);
    return m->o.error ? output_status(&m->o) : 0;
}

/* The values of this piece's vertices. */
static void set_values(mesh_file *m, const tc_mesh_data *piece, const vertex_array *fields) {
    vertex_array *to = m->arrays;
    for (int n = 0; n < CHANNEL_COUNT; n++)
        if (mesh_values(&m->whole, n) && has_role(m->format, mesh_channels[n].role))
            (to++)->values = mesh_values(piece, n);
    for (int n = 0; n < m->options->field_count; n++) (to++)->values = fields[n].values;
}

int mesh_file_add(mesh_file *m, uint64_t first_vertex, uint64_t first_triangle, const tc_mesh_data *piece,
                  const vertex_array *fields) {
    tc_mesh_data ready;
    uint64_t first_ready;
    int status = 0;
    set_values(m, piece, fields);
    if (m->format->pieces == PIECES_NUMBERS) return write_piece(m, first_vertex, first_triangle, piece);
    if (held_complete(&m->held, piece, &ready, &first_ready)) status = write_piece(m, 0, first_ready, &ready);
    ready = *piece;
    if (!status) status = held_take(&m->held, first_triangle, &ready);
    return status ? status : write_piece(m, 0, first_triangle, &ready);
}

int mesh_file_waits(const mesh_file *m) { return m && m->held.count > 0; }

int mesh_file_complete(mesh_file *m, const tc_mesh_data *next) {
    tc_mesh_data ready;
    uint64_t first_ready;
    const int status = held_complete(&m->held, next, &ready, &first_ready) ? write_piece(m, 0, first_ready, &ready) : 0;
    m->held.count = 0;
    return status;
}

static void free_mesh_file(mesh_file *m) {
    held_release(&m->held);
    free(m->parts);
    free(m->arrays);
    free(m);
}

int mesh_file_close(mesh_file *m) {
    if (!m) return 0;
    const tc_mesh_data none = {.struct_size = sizeof none};
    const mesh_write_options *options = m->options;
    if (!m->o.position) write_piece(m, 0, 0, &none); /* there was no piece */
    const int status = options && options->group ? output_wait(&m->o, options->group) : output_close(&m->o);
    free_mesh_file(m);
    return status;
}

void mesh_file_discard(mesh_file *m) {
    if (!m) return;
    output_discard(&m->o);
    free_mesh_file(m);
}
