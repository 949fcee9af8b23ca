/*
 * write.c - finds the format, checks that its counts suffice, and has it written
 */
#include "mesh_write.h"

#include "exit_status.h"
#include "failure.h"
#include "formats.h"
#include "output.h"

#include <string.h>
#include <strings.h>

typedef struct format {
    const char *name;
    void (*write)(output *o, const shown_mesh *s);
    int takes_fields;
    int has_doubles; /* for coordinates */
} format;

static const format formats[] = {{"ply", ply_write, 1, 1},
                                 {"stl", stl_write, 0, 0},
                                 {"obj", obj_write, 0, 1},
                                 {"vtp", vtp_write, 1, 1},
                                 {NULL, NULL, 0, 0}};

/* Values per vertex, of all fields together: a vertex must fit a block of the output many times. */
enum { FIELD_VALUES_MOST = 4096 };

static const format *find_format(const char *name) {
    for (const format *f = formats; f->name; f++)
        if (strcasecmp(f->name, name) == 0) return f;
    return NULL;
}

/* What follows the last dot of the file's name; "" where there is none. */
static const char *ending_of(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    return dot ? dot + 1 : "";
}

static int check_fields(const char *path, const mesh_write_options *options, const format *f) {
    int64_t values = 0;
    if (!options || !options->field_count) return 0;
    if (!f->takes_fields)
        return fail(STATUS_USAGE, "%s: %s holds no fields on vertices; write ply or vtp", path, f->name);
    for (int i = 0; i < options->field_count; i++) values += options->fields[i].components;
    if (values <= FIELD_VALUES_MOST) return 0;
    return fail(STATUS_USAGE, "%s: %lld values per vertex are more than the %d that are written; name fewer fields",
                path, (long long)values, FIELD_VALUES_MOST);
}

static int choose_format(const char *path, const mesh_write_options *options, const format **chosen) {
    int named = options && options->format;
    *chosen = find_format(named ? options->format : ending_of(path));
    if (*chosen) return check_fields(path, options, *chosen);
    if (named)
        return fail(STATUS_USAGE, "format \"%s\" is not known: meshes are written as ply, stl, obj or vtp",
                    options->format);
    if (output_is_dash(path)) return fail(STATUS_USAGE, "-o - has no ending: name the format by --format");
    return fail(STATUS_USAGE,
                "%s: its ending names no known format: let it end in .ply, .stl, .obj or .vtp, or name the format by "
                "--format",
                path);
}

static int check_counts(const char *path, const tc_mesh_data *mesh, int soup, const format *f) {
    int is_stl = f->write == stl_write;
    uint64_t count = is_stl ? mesh->triangle_count : mesh->vertex_count;
    if (!is_stl && soup && mesh->triangle_count > FORMAT_LIMIT / 3)
        return fail(STATUS_FAILED,
                    "%s: %llu triangles with vertices of their own are more than the 2^32 - 1 vertices that %s holds; "
                    "write shared vertices instead",
                    path, (unsigned long long)mesh->triangle_count, f->name);
    if (count > FORMAT_LIMIT)
        return fail(STATUS_FAILED, "%s: %llu %s are more than the 2^32 - 1 that %s holds%s", path,
                    (unsigned long long)count, is_stl ? "triangles" : "vertices", f->name,
                    is_stl ? "; write ply or obj instead" : "; extract a part of the volume");
    return 0;
}

int mesh_write_check(const char *path, const mesh_write_options *options) {
    const format *f;
    return choose_format(path, options, &f);
}

static int is_far(const tc_mesh_data *mesh) {
    return mesh->origin[0] != 0 || mesh->origin[1] != 0 || mesh->origin[2] != 0;
}

int mesh_write_has_doubles(const char *path, const mesh_write_options *options) {
    const format *f;
    return !choose_format(path, options, &f) && f->has_doubles;
}

int mesh_write_is_relative(const char *path, const tc_mesh_data *mesh, const mesh_write_options *options) {
    const format *f;
    if (choose_format(path, options, &f)) return 0;
    return is_far(mesh) && !f->has_doubles && !(options && options->origin_at);
}

static void set_offset(shown_mesh *s, const mesh_write_options *options, const format *f) {
    const double *at = options ? options->origin_at : NULL;
    if (!at && !f->has_doubles) return;
    for (int axis = 0; axis < 3; axis++) {
        s->offset[axis] = s->mesh->origin[axis] - (at ? at[axis] : 0);
        if (s->offset[axis] != 0) s->is_moved = 1;
    }
}

int mesh_write(const char *path, const tc_mesh_data *mesh, const mesh_write_options *options) {
    const format *f;
    output o;
    shown_mesh shown = {.mesh = mesh, .soup = options && options->soup};
    if (options) {
        shown.fields = options->fields;
        shown.field_count = options->field_count;
    }
    int status = choose_format(path, options, &f);
    if (!status) status = check_counts(path, mesh, shown.soup, f);
    if (!status) status = output_open(&o, path);
    if (status) return status;
    set_offset(&shown, options, f);
    f->write(&o, &shown);
    return output_close(&o);
}
