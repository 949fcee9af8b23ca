/*
 * obj.c - Wavefront OBJ, text
 *
 *     v x y z          every vertex: numbers that read back as the same floats, or, where the mesh lies far from zero,
 *                      as the same doubles
 *     vn x y z         every normal, where the mesh has them
 *     f a b c          indices from 1; a//a b//b c//c with normals
 */
#include "decimal.h"
#include "formats.h"

#include <stdio.h>

enum {
    VECTOR_MOST = 3 + 3 * (1 + DECIMAL_F64_MOST), /* bytes of the longest line */
    FACE_MOST = 2 + 3 * (1 + 10 + 2 + 10),
};

static const char *const keywords[ROLE_COUNT] = {[ROLE_POSITIONS] = "v", [ROLE_NORMALS] = "vn"};

/* What the lines of vectors are made of. */
typedef struct vector_lines {
    const shown_mesh *shown;
    const char *keyword;
    const float *vectors;
} vector_lines;

static unsigned char *encode_vectors(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const vector_lines *lines = source;
    size_t keyword_length = strlen(lines->keyword);
    char *at = (char *)to;
    for (uint64_t v = first; v < end; v++) {
        const float *vector = lines->vectors + 3 * source_vertex(lines->shown, v);
        memcpy(at, lines->keyword, keyword_length);
        at += keyword_length;
        for (int axis = 0; axis < 3; axis++) {
            *at++ = ' ';
            at = put_float_text(at, vector[axis]);
        }
        *at++ = '\n';
    }
    return (unsigned char *)at;
}

/* Positions as doubles. */
static unsigned char *encode_positions(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    char *at = (char *)to;
    for (uint64_t v = first; v < end; v++) {
        double position[3];
        shown_position(s, source_vertex(s, v), position);
        *at++ = 'v';
        for (int axis = 0; axis < 3; axis++) {
            *at++ = ' ';
            at = put_double_text(at, position[axis]);
        }
        *at++ = '\n';
    }
    return (unsigned char *)at;
}

static char *put_corner(char *to, uint32_t index, int with_normal) {
    *to++ = ' ';
    to = put_u32_text(to, index);
    if (!with_normal) return to;
    *to++ = '/';
    *to++ = '/';
    return put_u32_text(to, index);
}

static unsigned char *encode_faces(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    int with_normals = shows_role(s, ROLE_NORMALS);
    char *at = (char *)to;
    for (uint64_t t = first; t < end; t++) {
        *at++ = 'f';
        for (uint64_t corner = 3 * t; corner < 3 * t + 3; corner++)
            at = put_corner(at, corner_vertex(s, corner) + 1, with_normals);
        *at++ = '\n';
    }
    return (unsigned char *)at;
}

static void write_vectors(output *o, const shown_mesh *s, vertex_role role, const float *vectors) {
    const vector_lines lines = {s, keywords[role], vectors};
    output_records(o, file_vertex_count(s), VECTOR_MOST, encode_vectors, &lines);
}

void obj_write(output *o, const shown_mesh *s) {
    char header[128];
    int length = snprintf(header, sizeof header, "# tetracubes isosurface: %llu vertices, %llu triangles\n",
                          (unsigned long long)file_vertex_count(s), (unsigned long long)s->mesh->triangle_count);
    output_bytes(o, header, (uint64_t)length);
    if (s->is_moved)
        output_records(o, file_vertex_count(s), VECTOR_MOST, encode_positions, s);
    else
        write_vectors(o, s, ROLE_POSITIONS, s->mesh->positions);
    for (int n = 0; n < s->array_count; n++) write_vectors(o, s, s->arrays[n].role, s->arrays[n].values);
    output_records(o, s->mesh->triangle_count, FACE_MOST, encode_faces, s);
}
