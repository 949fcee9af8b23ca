/*
 * ply.c - PLY 1.0, binary little-endian (Turk, Stanford, 1994)
 *
 *     vertex  float x y z [nx ny nz] [fields]    4 bytes each; x y z as double, 12 more bytes, where the mesh lies far
 *                                                from zero
 *     face    list uchar uint vertex_indices     13 bytes
 *
 * Indices are uint, as int would end at 2^31. Readers (rply in Open3D, vcglib in MeshLab, vtkPLY in ParaView) take
 * either.
 *
 * Vertices with positions alone lie in the mesh as they lie in the file.
 */
#include "file_text.h"
#include "formats.h"
#include "stored_types.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VECTOR_BYTES = 3 * 4, FACE_BYTES = 1 + 3 * 4, NAME_BYTES = 128, NAME_KEPT = 100 };

typedef char property_name[NAME_BYTES];

/* The properties that the format knows; others are called like their array. */
static const char *const known[ROLE_COUNT][3] = {
    [ROLE_POSITIONS] = {"x", "y", "z"}, [ROLE_NORMALS] = {"nx", "ny", "nz"}};

static int is_taken(const char *name, const property_name *names, size_t count) {
    for (int role = 0; role < ROLE_COUNT; role++)
        for (int c = 0; c < 3; c++)
            if (known[role][c] && strcmp(name, known[role][c]) == 0) return 1;
    for (size_t i = 0; i < count; i++)
        if (strcmp(name, names[i]) == 0) return 1;
    return 0;
}

/* Makes names[count] of the array's name: letters, digits and '_', other than every name before it. */
static void name_property(const vertex_array *array, int component, property_name *names, size_t count) {
    char *name = names[count];
    size_t length = 0;
    for (const char *c = array->name; *c && length < NAME_KEPT; c++) {
        int is_word = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9');
        name[length++] = (char)(is_word ? *c : '_');
    }
    name[length] = 0;
    if (!length) length = (size_t)sprintf(name, "field");
    if (array->components > 1) length += (size_t)sprintf(name + length, "_%d", component);
    while (is_taken(name, names, count) && length < NAME_BYTES - 1) {
        name[length++] = '_';
        name[length] = 0;
    }
}

static int value_count(const shown_mesh *s) {
    int count = 0;
    for (int i = 0; i < s->array_count; i++) count += s->arrays[i].components;
    return count;
}

static void add_properties(file_text *header, const shown_mesh *s) {
    property_name *names = malloc(((size_t)value_count(s) + 1) * sizeof *names);
    size_t count = 0;
    if (!names) header->has_failed = 1;
    for (int i = 0; i < s->array_count && names; i++)
        for (int c = 0; c < s->arrays[i].components; c++) {
            const char *const *own = known[s->arrays[i].role];
            if (!own[0]) name_property(&s->arrays[i], c, names, count);
            text_add(header, "property %s %s\n", stored_types[TC_F32].ply, own[0] ? own[c] : names[count++]);
        }
    free(names);
}

static void make_header(const shown_mesh *s, file_text *header) {
    const char *type = stored_types[s->is_moved ? TC_F64 : TC_F32].ply;
    text_add(header,
             "ply\nformat binary_little_endian 1.0\ncomment tetracubes isosurface\nelement vertex %llu\n"
             "property %s x\nproperty %s y\nproperty %s z\n",
             (unsigned long long)file_vertex_count(s), type, type, type);
    add_properties(header, s);
    text_add(header, "element face %llu\nproperty list uchar uint vertex_indices\nend_header\n",
             (unsigned long long)s->mesh->triangle_count);
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
        for (uint64_t c = 0; c < 3; c++) corners[c] = corner_vertex(s, 3 * t + c);
        *to++ = 3;
        to = put_bytes(to, corners, sizeof corners);
    }
    return to;
}

void ply_write(output *o, const shown_mesh *s) {
    file_text header = {0};
    make_header(s, &header);
    size_t vertex_bytes = position_bytes(s) + (size_t)value_count(s) * sizeof(float);
    uint64_t vertex_count = file_vertex_count(s), face_count = s->mesh->triangle_count;
    if (header.has_failed) {
        o->error = ENOMEM;
    } else {
        output_expect(o, header.length + vertex_count * vertex_bytes + face_count * FACE_BYTES);
        output_bytes(o, header.bytes, header.length);
        if (s->soup || vertex_bytes > VECTOR_BYTES)
            output_records(o, vertex_count, vertex_bytes, encode_vertices, s);
        else
            output_bytes(o, s->mesh->positions, vertex_count * vertex_bytes);
        output_records(o, face_count, FACE_BYTES, encode_faces, s);
    }
    text_release(&header);
}
