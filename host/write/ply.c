/*
 * ply.c - PLY 1.0, binary little-endian (Turk, Stanford, 1994)
 *
 *     vertex  float x y z [nx ny nz]             12 or 24 bytes
 *     face    list uchar uint vertex_indices     13 bytes
 *
 * Indices are uint: int would end at 2^31, and readers (rply in Open3D, vcglib in MeshLab, vtkPLY in ParaView) take
 * both by their declared type.
 *
 * Vertices without normals lie in the mesh as they lie in the file.
 */
#include "formats.h"

#include <stdio.h>

enum { HEADER_MOST = 1024, VECTOR_BYTES = 3 * 4, FACE_BYTES = 1 + 3 * 4 };

/* Writes the header into text[HEADER_MOST]. Returns its length. */
static size_t make_header(const shown_mesh *s, char *text) {
    return (size_t)snprintf(text, HEADER_MOST,
                            "ply\nformat binary_little_endian 1.0\ncomment tetracubes isosurface\nelement vertex %llu\n"
                            "property float x\nproperty float y\nproperty float z\n%s"
                            "element face %llu\nproperty list uchar uint vertex_indices\nend_header\n",
                            (unsigned long long)file_vertex_count(s),
                            s->mesh->normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
                            (unsigned long long)s->mesh->triangle_count);
}

static unsigned char *encode_vertices(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    const float *positions = s->mesh->positions, *normals = s->mesh->normals;
    for (uint64_t v = first; v < end; v++) {
        uint64_t from = 3 * source_vertex(s, v);
        to = put_bytes(to, positions + from, VECTOR_BYTES);
        if (normals) to = put_bytes(to, normals + from, VECTOR_BYTES);
    }
    return to;
}

static unsigned char *encode_faces(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    for (uint64_t t = first; t < end; t++) {
        uint32_t corners[3];
        for (uint64_t k = 0; k < 3; k++) corners[k] = corner_vertex(s, 3 * t + k);
        *to++ = 3;
        to = put_bytes(to, corners, sizeof corners);
    }
    return to;
}

void ply_write(output *o, const shown_mesh *s) {
    char header[HEADER_MOST];
    size_t header_bytes = make_header(s, header), vertex_bytes = s->mesh->normals ? 2 * VECTOR_BYTES : VECTOR_BYTES;
    uint64_t vertex_count = file_vertex_count(s), face_count = s->mesh->triangle_count;
    output_expect(o, header_bytes + vertex_count * vertex_bytes + face_count * FACE_BYTES);
    output_bytes(o, header, header_bytes);
    if (s->soup || s->mesh->normals)
        output_records(o, vertex_count, vertex_bytes, encode_vertices, s);
    else
        output_bytes(o, s->mesh->positions, vertex_count * vertex_bytes);
    output_records(o, face_count, FACE_BYTES, encode_faces, s);
}
