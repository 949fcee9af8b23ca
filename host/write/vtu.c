/*
 * vtu.c - a tetrahedral complex as VTK XML UnstructuredGrid (.vtu); see mesh_write.h
 *
 * Source: "VTK XML Formats" in VTK's file format documentation. Arrays lie as raw appended data, in the types of the
 * fields; connectivity and offsets are Int32 where that is enough, else Int64.
 */
#include "mesh_write.h"

#include "dataset/dataset.h"
#include "exit_status.h"
#include "failure.h"
#include "vtk_appended.h"

#include <string.h>
#include <strings.h>

enum { VTK_TETRA = 10 };

static int is_wide(const complex_file *c) { return vtk_needs_wide(c->point_count, 4 * c->tetrahedron_count); }

static unsigned char *encode_corners(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const complex_file *c = source;
    int wide = is_wide(c);
    for (uint64_t corner = 4 * first; corner < 4 * end; corner++) to = put_index(to, c->tetrahedra[corner], wide);
    return to;
}

static unsigned char *encode_ends(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    int wide = is_wide(source);
    for (uint64_t t = first; t < end; t++) to = put_index(to, 4 * (t + 1), wide);
    return to;
}

static unsigned char *encode_types(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    (void)source;
    memset(to, VTK_TETRA, (size_t)(end - first));
    return to + (end - first);
}

static void add_field(vtk_file *f, const complex_file *c, const dataset_field *field) {
    static const char *const own[] = {"Points", "connectivity", "offsets", "types", NULL};
    const vtk_array array = {.name = field->name,
                             .type = (int)field->type,
                             .components = field->components,
                             .span = {c->point_count, 0, c->point_count},
                             .record_bytes = (size_t)field->components * sample_bytes(field->type),
                             .source = field->values};
    vtk_field_add(f, &array, own);
}

static void add_cells(vtk_file *f, const complex_file *c) {
    int wide = is_wide(c);
    vtk_array_add(f, &(vtk_array){.name = "connectivity",
                                  .type = vtk_index_type(wide),
                                  .components = 1,
                                  .span = {c->tetrahedron_count, 0, c->tetrahedron_count},
                                  .record_bytes = wide ? 32 : 16,
                                  .encode = wide ? encode_corners : NULL,
                                  .source = wide ? (const void *)c : c->tetrahedra});
    vtk_array_add(f, &(vtk_array){.name = "offsets",
                                  .type = vtk_index_type(wide),
                                  .components = 1,
                                  .span = {c->tetrahedron_count, 0, c->tetrahedron_count},
                                  .record_bytes = wide ? 8 : 4,
                                  .encode = encode_ends,
                                  .source = c});
    vtk_array_add(f, &(vtk_array){.name = "types",
                                  .type = TC_U8,
                                  .components = 1,
                                  .span = {c->tetrahedron_count, 0, c->tetrahedron_count},
                                  .record_bytes = 1,
                                  .encode = encode_types,
                                  .source = c});
}

int complex_write_check(const char *path, const char *format) {
    const size_t length = strlen(path);
    if (format && strcasecmp(format, "vtu") != 0)
        return fail(STATUS_USAGE, "format \"%s\" is not known for tetrahedra: they are written as vtu", format);
    if (format || output_is_dash(path) || (length > 4 && strcasecmp(path + length - 4, ".vtu") == 0)) return 0;
    return fail(STATUS_USAGE,
                "%s: tetrahedra are written as VTK XML, vtu: let the name end in .vtu, or name the format by --format",
                path);
}

int complex_write(const char *path, const complex_file *c) {
    output o;
    vtk_file f = {.o = &o};
    int status = output_open(&o, path);
    if (status) return status;
    vtk_notes_add(&f, c->world, c->units);
    text_add(&f.text, "    <Piece NumberOfPoints=\"%llu\" NumberOfCells=\"%llu\">\n      <PointData>\n",
             (unsigned long long)c->point_count, (unsigned long long)c->tetrahedron_count);
    for (int i = 0; i < c->field_count; i++) add_field(&f, c, &c->fields[i]);
    text_add(&f.text, "      </PointData>\n      <Points>\n");
    vtk_array_add(&f, &(vtk_array){.name = "Points",
                                   .type = c->points_f64 ? TC_F64 : TC_F32,
                                   .components = 3,
                                   .span = {c->point_count, 0, c->point_count},
                                   .record_bytes = c->points_f64 ? 24 : 12,
                                   .source = c->points_f64 ? (const void *)c->points_f64 : c->points});
    text_add(&f.text, "      </Points>\n      <Cells>\n");
    add_cells(&f, c);
    text_add(&f.text, "      </Cells>\n    </Piece>\n");
    vtk_file_write(&f, "UnstructuredGrid");
    return output_close(&o);
}
