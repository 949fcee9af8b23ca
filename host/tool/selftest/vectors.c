#include "vectors.h"

#include "exit_status.h"
#include "failure.h"
#include "field.h"
#include "mesh_check.h"
#include "volume.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const char vectors_text[]; /* vectors.txt */

/* ---------------------------------------------------------------------------------------------------------- reading */

/* "-", or several of nodata=V, seed=S, tetrahedra with commas between. */
static int parse_options(vector *v) {
    char text[sizeof v->options], *rest = NULL;
    snprintf(text, sizeof text, "%s", v->options);
    if (strcmp(text, "-") == 0) return 1;
    for (char *at = strtok_r(text, ",", &rest); at; at = strtok_r(NULL, ",", &rest)) {
        char *end = at + strlen(at);
        if (strncmp(at, "nodata=", 7) == 0) {
            v->has_nodata = 1;
            v->nodata = strtod(at + 7, &end);
        } else if (strncmp(at, "seed=", 5) == 0) {
            v->seed = strtoull(at + 5, &end, 10);
        } else if (strcmp(at, "tetrahedra") == 0) {
            v->is_complex = 1;
        } else if (strcmp(at, "closed") == 0) {
            v->is_closed = 1;
        } else {
            return 0;
        }
        if (*end) return 0;
    }
    return 1;
}

static int parse_method(const char *text, tc_method *method) {
    for (int n = 0; tc_method_name((tc_method)n); n++) {
        if (strcmp(text, tc_method_name((tc_method)n)) != 0) continue;
        *method = (tc_method)n;
        return 1;
    }
    return 0;
}

static int parse_type(const char *text, tc_type *type) {
    for (int n = TC_U8; n <= TC_F64; n++)
        if (strcmp(text, tc_type_name((tc_type)n)) == 0) {
            *type = (tc_type)n;
            return 1;
        }
    return 0;
}

static int parse_line(const char *line, vector *v) {
    char type[8], method[8];
    int end = 0;
    *v = (vector){0};
    const int64_t most = 4096;
    if (sscanf(line, "%31s %" SCNd64 " %" SCNd64 " %" SCNd64 " %7s %lf %7s %63s %" SCNu64 " %" SCNu64 " %" SCNx64 " %n",
               v->field, &v->dims[0], &v->dims[1], &v->dims[2], type, &v->isovalue, method, v->options, &v->vertices,
               &v->triangles, &v->hash, &end) != 11 ||
        line[end] || !field_find(v->field) || !parse_type(type, &v->type) || !isfinite(v->isovalue))
        return 0;
    for (int axis = 0; axis < 3; axis++)
        if (v->dims[axis] < 2 || v->dims[axis] > most) return 0;
    return parse_method(method, &v->method) && parse_options(v);
}

static int append(vector_list *list, const vector *v) {
    vector *grown = realloc(list->vectors, (size_t)(list->count + 1) * sizeof *grown);
    if (!grown) return fail(STATUS_FAILED, "out of memory for vectors");
    list->vectors = grown;
    grown[list->count++] = *v;
    return 0;
}

static int read_lines(FILE *file, const char *name, vector_list *list) {
    char line[512];
    int status = 0;
    for (int number = 1; !status && fgets(line, sizeof line, file); number++) {
        vector v;
        const char *at = line + strspn(line, " \t\r\n");
        if (!*at || *at == '#') continue;
        status = parse_line(at, &v) ? append(list, &v)
                                    : fail(STATUS_INPUT,
                                           "%s: line %d is no vector: FIELD NX NY NZ TYPE ISOVALUE "
                                           "tetra|hybrid|snap -|nodata=V|seed=S|tetrahedra VERTICES TRIANGLES HASH",
                                           name, number);
    }
    if (!status && ferror(file)) status = fail(STATUS_INPUT, "%s: %s", name, strerror(errno));
    if (!status && !list->count) status = fail(STATUS_INPUT, "%s: no vectors in it", name);
    return status;
}

int vectors_read(const char *path, vector_list *list) {
    *list = (vector_list){0};
    FILE *file = path ? fopen(path, "r") : fmemopen((void *)(size_t)vectors_text, strlen(vectors_text), "r");
    if (!file && path) return fail(STATUS_INPUT, "%s: %s", path, strerror(errno));
    if (!file) return fail(STATUS_FAILED, "out of memory for vectors");
    int status = read_lines(file, path ? path : "vectors.txt", list);
    fclose(file);
    return status;
}

void vectors_release(vector_list *list) {
    free(list->vectors);
    *list = (vector_list){0};
}

/* ------------------------------------------------------------------------------------------------------- extraction */

/* i, j, k. */
static int make_points(const vector *v, selftest_volume *out) {
    const size_t nx = (size_t)v->dims[0], ny = (size_t)v->dims[1], count = nx * ny * (size_t)v->dims[2];
    out->points = malloc(3 * count * sizeof *out->points);
    if (!out->points) return fail(STATUS_FAILED, "out of memory for the points of a vector");
    for (size_t n = 0; n < count; n++) {
        const size_t index[3] = {n % nx, n / nx % ny, n / nx / ny};
        for (int axis = 0; axis < 3; axis++) out->points[3 * n + (size_t)axis] = (float)index[axis];
    }
    return 0;
}

static int make_volume(const vector *v, selftest_volume *out) {
    const size_t count = (size_t)(v->dims[0] * v->dims[1] * v->dims[2]);
    *out = (selftest_volume){.is_complex = v->is_complex, .complex.struct_size = sizeof out->complex};
    tc_grid_options_init(&out->grid);
    out->samples = malloc(count * tc_type_bytes(v->type));
    if (!out->samples) return fail(STATUS_FAILED, "out of memory for the samples of a vector");
    field_sample(field_find(v->field), v->dims, v->type, v->seed, 0, v->dims[2], out->samples);
    memcpy(out->grid.dims, v->dims, sizeof out->grid.dims);
    out->grid.type = v->type;
    out->grid.samples = out->samples;
    out->grid.has_nodata = v->has_nodata;
    out->grid.nodata = v->nodata;
    return v->is_complex ? make_points(v, out) : 0;
}

static void compare(const vector *v, const tc_mesh_data *m, char *text, size_t bytes) {
    const uint64_t hash = mesh_hash(m->positions, m->vertex_count, m->triangles, m->triangle_count);
    if (m->vertex_count != v->vertices || m->triangle_count != v->triangles)
        snprintf(text, bytes, "%" PRIu64 " vertices and %" PRIu64 " triangles, should be %" PRIu64 " and %" PRIu64,
                 m->vertex_count, m->triangle_count, v->vertices, v->triangles);
    else if (hash != v->hash)
        snprintf(text, bytes, "hash %016" PRIx64 ", should be %016" PRIx64, hash, v->hash);
}

int vector_try(const vector *v, tc_context *device, char *text, size_t bytes) {
    tc_extract_options how;
    selftest_volume from;
    tc_grid *grid = NULL;
    tc_mesh *mesh = NULL;
    tc_mesh_data data = {.struct_size = sizeof data};
    int status = make_volume(v, &from);
    tc_extract_options_init(&how);
    how.isovalue = v->isovalue;
    how.method = v->method;
    how.closed = v->is_closed;
    if (!status) {
        tc_status made = v->is_complex ? tc_tetrahedralize_grid(&from.grid, &from.complex) : TC_OK;
        if (!made) made = selftest_grid_create(&from, device, &grid);
        if (!made) made = tc_extract(grid, &how, &mesh);
        if (!made) made = tc_mesh_get(mesh, &data);
        if (made)
            snprintf(text, bytes, "%s", tc_message());
        else
            compare(v, &data, text, bytes);
    }
    tc_mesh_destroy(mesh);
    tc_grid_destroy(grid);
    selftest_volume_release(&from);
    return status;
}
