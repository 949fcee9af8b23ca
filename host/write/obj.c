/*
 * obj.c - Wavefront OBJ, text
 *
 *     v x y z          every vertex: numbers that read back as the same floats, or, where the mesh lies far from zero,
 *                      as the same doubles
 *     vn x y z         every normal, where the mesh has them
 *     f a b c          indices from 1; a//a b//b c//c with normals
 */
#include "decimal.h"
#include "vector_text.h"

#include <stdio.h>

enum { FACE_MOST = 2 + 3 * (1 + 10 + 2 + 10) };

static const char *const keywords[ROLE_COUNT] = {[ROLE_POSITIONS] = "v ", [ROLE_NORMALS] = "vn "};

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
            at = put_corner(at, (uint32_t)corner_vertex(s, corner) + 1, with_normals);
        *at++ = '\n';
    }
    return (unsigned char *)at;
}

void obj_write(output *o, const shown_mesh *s) {
    char header[128];
    int notes = 0;
    int length = snprintf(header, sizeof header, "# tetracubes isosurface: %llu vertices, %llu triangles\n",
                          (unsigned long long)file_vertex_count(s), (unsigned long long)s->mesh->triangle_count);
    output_bytes(o, header, (uint64_t)length);
    for (; shown_notes(s, notes).name; notes++) {
        length = snprintf(header, sizeof header, "# %s=%s\n", shown_notes(s, notes).name, shown_notes(s, notes).value);
        output_bytes(o, header, (uint64_t)length);
    }
    write_positions(o, s, keywords[ROLE_POSITIONS]);
    for (int n = 0; n < s->array_count; n++) write_vectors(o, s, keywords[s->arrays[n].role], s->arrays[n].values);
    output_records(o, s->mesh->triangle_count, FACE_MOST, encode_faces, s);
}
