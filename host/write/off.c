/*
 * off.c - OFF, text (Geomview's Object File Format)
 *
 *     OFF              then the numbers of vertices, faces and edges, which may be 0
 *     x y z            every vertex: numbers that read back as the same floats, or, where the mesh lies far from zero,
 *                      as the same doubles
 *     3 a b c          every triangle, indices from 0
 */
#include "decimal.h"
#include "vector_text.h"

#include <stdio.h>

enum { FACE_MOST = 2 + 3 * (1 + 10) };

static unsigned char *encode_faces(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    char *at = (char *)to;
    for (uint64_t t = first; t < end; t++) {
        *at++ = '3';
        for (uint64_t corner = 3 * t; corner < 3 * t + 3; corner++) {
            *at++ = ' ';
            at = put_u32_text(at, (uint32_t)corner_vertex(source, corner));
        }
        *at++ = '\n';
    }
    return (unsigned char *)at;
}

void off_write(output *o, const shown_mesh *s) {
    char header[64];
    int length = snprintf(header, sizeof header, "OFF\n%llu %llu 0\n", (unsigned long long)file_vertex_count(s),
                          (unsigned long long)s->mesh->triangle_count);
    output_bytes(o, header, (uint64_t)length);
    write_positions(o, s, "");
    output_records(o, s->mesh->triangle_count, FACE_MOST, encode_faces, s);
}
