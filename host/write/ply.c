/*
 * ply.c - PLY 1.0, binary little-endian (Turk, Stanford, 1994)
 *
 *     vertex  float x y z [nx ny nz]             12 or 24 bytes
 *     face    list uchar uint vertex_indices     13 bytes
 *
 * Indices are uint: int would end at 2^31, and readers (rply in Open3D, vcglib in MeshLab, vtkPLY in ParaView) take
 * both by their declared type.
 */
#include "formats.h"

enum { FACE_BYTES = 1 + 3 * 4 };

static void write_header(output *o, const tc_mesh_data *mesh, int soup) {
    output_text(o,
                "ply\nformat binary_little_endian 1.0\ncomment tetracubes isosurface\nelement vertex %llu\n"
                "property float x\nproperty float y\nproperty float z\n",
                (unsigned long long)file_vertex_count(mesh, soup));
    if (mesh->normals) output_text(o, "property float nx\nproperty float ny\nproperty float nz\n");
    output_text(o, "element face %llu\nproperty list uchar uint vertex_indices\nend_header\n",
                (unsigned long long)mesh->triangle_count);
}

static void write_vertices(output *o, const tc_mesh_data *mesh, int soup) {
    uint64_t count = file_vertex_count(mesh, soup);
    size_t vertex_bytes = mesh->normals ? 24 : 12;
    for (uint64_t v = 0; v < count;) {
        uint64_t end = output_block_end(v, count, vertex_bytes);
        unsigned char *start = output_reserve(o, (size_t)(end - v) * vertex_bytes), *to = start;
        for (; v < end; v++) {
            uint64_t source = 3 * source_vertex(mesh, soup, v);
            to = put_floats(to, mesh->positions + source, 3);
            if (mesh->normals) to = put_floats(to, mesh->normals + source, 3);
        }
        output_advance(o, (size_t)(to - start));
    }
}

static void write_faces(output *o, const tc_mesh_data *mesh, int soup) {
    for (uint64_t t = 0; t < mesh->triangle_count;) {
        uint64_t end = output_block_end(t, mesh->triangle_count, FACE_BYTES);
        unsigned char *start = output_reserve(o, (size_t)(end - t) * FACE_BYTES), *to = start;
        for (; t < end; t++) {
            *to++ = 3;
            for (uint64_t corner = 3 * t; corner < 3 * t + 3; corner++)
                to = put_u32(to, corner_vertex(mesh, soup, corner));
        }
        output_advance(o, (size_t)(to - start));
    }
}

void ply_write(output *o, const tc_mesh_data *mesh, int soup) {
    write_header(o, mesh, soup);
    write_vertices(o, mesh, soup);
    write_faces(o, mesh, soup);
}
