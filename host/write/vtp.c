/*
 * vtp.c - VTK XML PolyData (.vtp): points and their values, triangles
 *
 * Source: "VTK XML Formats" in VTK's file format documentation. Arrays lie as raw appended data, one after the other;
 * connectivity and offsets are Int32 where that is enough, else Int64. Arrays that lie in the mesh as they should lie
 * in the file are written without a copy.
 */
#include "shown_records.h"
#include "vtk_appended.h"

#include <errno.h>
#include <stdlib.h>

/* The attributes of points that the format knows; other arrays have names of their own. */
static const char *const attributes[ROLE_COUNT] = {[ROLE_NORMALS] = "Normals"};

static int is_wide(const shown_mesh *s) { return vtk_needs_wide(file_vertex_count(s), 3 * s->triangle_count); }

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

static vtk_array file_array(const shown_array *s) {
    const char *attribute = attributes[s->array.role];
    const record_array records = records_of_values(s);
    return (vtk_array){.name = attribute ? attribute : s->array.name,
                       .type = TC_F32,
                       .components = s->array.components,
                       .span = records.span,
                       .record_bytes = records.record_bytes,
                       .encode = records.encode,
                       .source = records.source};
}

static void add_arrays(vtk_file *f, const shown_mesh *s, shown_array *shown) {
    static const char *const own[] = {"Points", "connectivity", "offsets", NULL};
    text_add(&f->text, "      <PointData");
    for (int role = 0; role < ROLE_COUNT; role++)
        if (attributes[role] && shows_role(s, (vertex_role)role))
            text_add(&f->text, " %s=\"%s\"", attributes[role], attributes[role]);
    text_add(&f->text, ">\n");
    for (int i = 0; i < s->array_count; i++) {
        shown[i] = (shown_array){s, s->arrays[i]};
        const vtk_array array = file_array(&shown[i]);
        vtk_field_add(f, &array, own);
    }
    text_add(&f->text, "      </PointData>\n");
}

/* Two of each triangle, as vtkSurfaceNets3D names them. */
static void add_labels(vtk_file *f, const shown_mesh *s) {
    const record_array records = records_of_labels(s);
    if (!s->labels) return;
    text_add(&f->text, "      <CellData Scalars=\"BoundaryLabels\">\n");
    vtk_array_add(f, &(vtk_array){.name = "BoundaryLabels",
                                  .type = TC_U32,
                                  .components = 2,
                                  .span = records.span,
                                  .record_bytes = records.record_bytes,
                                  .source = records.source});
    text_add(&f->text, "      </CellData>\n");
}

/* points: the positions as they are in the mesh; moved ones are in double precision. */
static void add_positions(vtk_file *f, const shown_mesh *s, const shown_array *points) {
    const vtk_array plain = file_array(points);
    if (!s->is_moved) {
        vtk_array_add(f, &plain);
        return;
    }
    vtk_array_add(f, &(vtk_array){.name = "Points",
                                  .type = TC_F64,
                                  .components = 3,
                                  .span = vertex_span(s),
                                  .record_bytes = 3 * sizeof(double),
                                  .encode = encode_positions_f64,
                                  .source = s});
}

static void add_triangles(vtk_file *f, const shown_mesh *s) {
    int wide = is_wide(s), is_plain = !s->soup && !wide && !s->first_vertex;
    vtk_array_add(f, &(vtk_array){.name = "connectivity",
                                  .type = vtk_index_type(wide),
                                  .components = 1,
                                  .span = triangle_span(s),
                                  .record_bytes = wide ? 24 : 12,
                                  .encode = is_plain ? NULL : encode_corners,
                                  .source = is_plain ? (const void *)s->mesh->triangles : s});
    vtk_array_add(f, &(vtk_array){.name = "offsets",
                                  .type = vtk_index_type(wide),
                                  .components = 1,
                                  .span = triangle_span(s),
                                  .record_bytes = wide ? 8 : 4,
                                  .encode = encode_ends,
                                  .source = s});
}

void vtp_write(output *o, const shown_mesh *s) {
    vtk_file f = {.o = o};
    shown_array *arrays = malloc(((size_t)s->array_count + 1) * sizeof *arrays);
    const shown_array points = {s, {"Points", 3, s->mesh->positions, ROLE_POSITIONS}};
    if (!arrays) {
        o->error = ENOMEM;
        return;
    }
    vtk_notes_add(&f, s->world, s->units);
    text_add(&f.text,
             "    <Piece NumberOfPoints=\"%llu\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
             "NumberOfPolys=\"%llu\">\n",
             (unsigned long long)file_vertex_count(s), (unsigned long long)s->triangle_count);
    add_arrays(&f, s, arrays);
    add_labels(&f, s);
    text_add(&f.text, "      <Points>\n");
    add_positions(&f, s, &points);
    text_add(&f.text, "      </Points>\n      <Polys>\n");
    add_triangles(&f, s);
    text_add(&f.text, "      </Polys>\n    </Piece>\n");
    vtk_file_write(&f, "PolyData");
    free(arrays);
}
