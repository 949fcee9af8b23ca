/*
 * vtp.c - VTK XML PolyData (.vtp): points, normals and fields of the points, triangles
 *
 * Source: "VTK XML Formats" in VTK's file format documentation. Arrays lie as raw appended data, one after the other;
 * connectivity and offsets are Int32 where that is enough, else Int64. Arrays that lie in the mesh as they should lie
 * in the file are written without a copy.
 */
#include "formats.h"
#include "vtk_appended.h"

#include <errno.h>
#include <stdlib.h>

/* Values of the vertices, and the mesh that says in which order they are shown. */
typedef struct shown_values {
    const shown_mesh *shown;
    const float *values;
    int components;
} shown_values;

static unsigned char *encode_values(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_values *s = source;
    size_t components = (size_t)s->components;
    for (uint64_t v = first; v < end; v++)
        to = put_bytes(to, s->values + components * source_vertex(s->shown, v), components * sizeof(float));
    return to;
}

static unsigned char *encode_positions(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    for (uint64_t v = first; v < end; v++) {
        double position[3];
        shown_position(s, source_vertex(s, v), position);
        to = put_bytes(to, position, sizeof position);
    }
    return to;
}

static int is_wide(const shown_mesh *s) { return vtk_needs_wide(file_vertex_count(s), 3 * s->mesh->triangle_count); }

static unsigned char *encode_corners(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    int wide = is_wide(s);
    for (uint64_t c = 3 * first; c < 3 * end; c++) to = put_index(to, corner_vertex(s, c), wide);
    return to;
}

static unsigned char *encode_ends(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    int wide = is_wide(source);
    for (uint64_t t = first; t < end; t++) to = put_index(to, 3 * (t + 1), wide);
    return to;
}

static vtk_array array_of(const char *name, const shown_values *values) {
    int is_plain = !values->shown->soup;
    return (vtk_array){.name = name,
                       .type = TC_F32,
                       .components = values->components,
                       .record_count = file_vertex_count(values->shown),
                       .record_bytes = (size_t)values->components * sizeof(float),
                       .encode = is_plain ? NULL : encode_values,
                       .source = is_plain ? (const void *)values->values : values};
}

static void add_values(vtk_file *f, const char *name, const shown_values *values) {
    const vtk_array array = array_of(name, values);
    vtk_array_add(f, &array);
}

static void add_fields(vtk_file *f, const shown_mesh *s, shown_values *fields) {
    const char *own[] = {"Points", "connectivity", "offsets", s->mesh->normals ? "Normals" : NULL, NULL};
    for (int i = 0; i < s->field_count; i++) {
        fields[i] = (shown_values){s, s->fields[i].values, s->fields[i].components};
        const vtk_array array = array_of(s->fields[i].name, &fields[i]);
        vtk_field_add(f, &array, own);
    }
}

/* In double precision. */
static void add_positions(vtk_file *f, const shown_mesh *s) {
    vtk_array_add(f, &(vtk_array){.name = "Points",
                                  .type = TC_F64,
                                  .components = 3,
                                  .record_count = file_vertex_count(s),
                                  .record_bytes = 3 * sizeof(double),
                                  .encode = encode_positions,
                                  .source = s});
}

static void add_triangles(vtk_file *f, const shown_mesh *s) {
    int wide = is_wide(s), is_plain = !s->soup && !wide;
    vtk_array_add(f, &(vtk_array){.name = "connectivity",
                                  .type = vtk_index_type(wide),
                                  .components = 1,
                                  .record_count = s->mesh->triangle_count,
                                  .record_bytes = wide ? 24 : 12,
                                  .encode = is_plain ? NULL : encode_corners,
                                  .source = is_plain ? (const void *)s->mesh->triangles : s});
    vtk_array_add(f, &(vtk_array){.name = "offsets",
                                  .type = vtk_index_type(wide),
                                  .components = 1,
                                  .record_count = s->mesh->triangle_count,
                                  .record_bytes = wide ? 8 : 4,
                                  .encode = encode_ends,
                                  .source = s});
}

void vtp_write(output *o, const shown_mesh *s) {
    vtk_file f = {.o = o};
    shown_values *fields = malloc(((size_t)s->field_count + 1) * sizeof *fields);
    shown_values points = {s, s->mesh->positions, 3}, normals = {s, s->mesh->normals, 3};
    if (!fields) {
        o->error = ENOMEM;
        return;
    }
    text_add(&f.text,
             "    <Piece NumberOfPoints=\"%llu\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
             "NumberOfPolys=\"%llu\">\n      <PointData%s>\n",
             (unsigned long long)file_vertex_count(s), (unsigned long long)s->mesh->triangle_count,
             s->mesh->normals ? " Normals=\"Normals\"" : "");
    if (s->mesh->normals) add_values(&f, "Normals", &normals);
    add_fields(&f, s, fields);
    text_add(&f.text, "      </PointData>\n      <Points>\n");
    if (s->is_moved)
        add_positions(&f, s);
    else
        add_values(&f, "Points", &points);
    text_add(&f.text, "      </Points>\n      <Polys>\n");
    add_triangles(&f, s);
    text_add(&f.text, "      </Polys>\n    </Piece>\n");
    vtk_file_write(&f, "PolyData");
    free(fields);
}
