/*
 * ply.c - PLY 1.0, binary little-endian (Turk, Stanford, 1994)
 *
 *     vertex  float x y z [nx ny nz] [fields]    4 bytes each; x y z as double, 12 more bytes, where the mesh lies far
 *                                                from zero
 *     face    list uchar uint vertex_indices     13 bytes
 *             uint boundary_labels_0, _1         8 bytes more, of a label map
 *
 * Indices are uint, as int would end at 2^31. Readers (rply in Open3D, vcglib in MeshLab, vtkPLY in ParaView) take
 * either.
 *
 * Vertices with positions alone lie in the mesh as they lie in the file.
 */
#include "file_text.h"
#include "formats.h"
#include "stored_types.h"
#include "value_names.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VECTOR_BYTES = 3 * 4, FACE_BYTES = 1 + 3 * 4, LABEL_BYTES = 2 * 4 };

/* The properties that the format knows; others are called like their array. */
static const char *const known[] = {"x", "y", "z", "nx", "ny", "nz", NULL}, *const normals[] = {"nx", "ny", "nz"};

static int value_count(const shown_mesh *s) {
    int count = 0;
    for (int i = 0; i < s->array_count; i++) count += s->arrays[i].components;
    return count;
}

static void add_properties(file_text *header, const shown_mesh *s) {
    value_name *names = malloc(((size_t)value_count(s) + 1) * sizeof *names);
    size_t count = 0;
    if (!names) header->has_failed = 1;
    for (int i = 0; i < s->array_count && names; i++)
        for (int c = 0; c < s->arrays[i].components; c++) {
            const int is_normal = s->arrays[i].role == ROLE_NORMALS;
            char number[16] = "";
            if (s->arrays[i].components > 1) snprintf(number, sizeof number, "_%d", c);
            const char *name = normals[c % 3];
            if (!is_normal) {
                value_name_make(s->arrays[i].name, number, known, names, count);
                name = names[count++];
            }
            text_add(header, "property %s %s\n", stored_types[TC_F32].ply, name);
        }
    free(names);
}

static void make_header(const shown_mesh *s, file_text *header) {
    const char *type = stored_types[s->is_moved ? TC_F64 : TC_F32].ply;
    text_add(header, "ply\nformat binary_little_endian 1.0\ncomment tetracubes isosurface\n");
    for (int n = 0; shown_notes(s, n).name; n++)
        text_add(header, "comment %s=%s\n", shown_notes(s, n).name, shown_notes(s, n).value);
    text_add(header, "element vertex %llu\nproperty %s x\nproperty %s y\nproperty %s z\n",
             (unsigned long long)file_vertex_count(s), type, type, type);
    add_properties(header, s);
    text_add(header, "element face %llu\nproperty list uchar uint vertex_indices\n%send_header\n",
             (unsigned long long)s->triangle_count,
             s->labels ? "property uint boundary_labels_0\nproperty uint boundary_labels_1\n" : "");
}

static size_t position_bytes(const shown_mesh *s) { return s->is_moved ? 3 * sizeof(double) : VECTOR_BYTES; }

static unsigned char *put_position(const shown_mesh *s, uint64_t vertex, unsigned char *to) {
    double position[3];
    if (!s->is_moved) return put_bytes(to, s->mesh->positions + 3 * vertex, VECTOR_BYTES);
    shown_position(s, vertex, position);
    return put_bytes(to, position, sizeof position);
}

static unsigned char *encode_vertices(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    for (uint64_t v = first; v < end; v++) {
        uint64_t vertex = source_vertex(s, v);
        to = put_position(s, vertex, to);
        for (int i = 0; i < s->array_count; i++) {
            size_t components = (size_t)s->arrays[i].components;
            to = put_bytes(to, s->arrays[i].values + components * vertex, components * sizeof(float));
        }
    }
    return to;
}

static unsigned char *encode_faces(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    for (uint64_t t = first; t < end; t++) {
        uint32_t corners[3];
        for (uint64_t c = 0; c < 3; c++) corners[c] = (uint32_t)corner_vertex(s, 3 * t + c);
        *to++ = 3;
        to = put_bytes(to, corners, sizeof corners);
        if (s->labels) to = put_bytes(to, s->labels + 2 * (t - s->first_triangle), LABEL_BYTES);
    }
    return to;
}

void ply_write(output *o, const shown_mesh *s) {
    file_text header = {0};
    make_header(s, &header);
    size_t vertex_bytes = position_bytes(s) + (size_t)value_count(s) * sizeof(float);
    const size_t face_bytes = FACE_BYTES + (s->labels ? LABEL_BYTES : 0);
    uint64_t vertex_count = file_vertex_count(s), face_count = s->triangle_count;
    if (header.has_failed) {
        o->error = ENOMEM;
    } else {
        output_expect(o, header.length + vertex_count * vertex_bytes + face_count * face_bytes);
        output_bytes(o, header.bytes, header.length);
        if (s->soup || vertex_bytes > VECTOR_BYTES)
            output_span(o, vertex_span(s), vertex_bytes, encode_vertices, s);
        else
            output_span(o, vertex_span(s), vertex_bytes, NULL, s->mesh->positions);
        output_span(o, triangle_span(s), face_bytes, encode_faces, s);
    }
    text_release(&header);
}
