/*
 * obj.c - Wavefront OBJ, text
 *
 *     v x y z          every vertex, numbers that read back as the same floats
 *     vn x y z         every normal, where the mesh has them
 *     f a b c          indices from 1; a//a b//b c//c with normals
 */
#include "decimal.h"
#include "formats.h"

enum {
    VECTOR_MOST = 3 + 3 * (1 + DECIMAL_MOST), /* bytes of the longest line */
    FACE_MOST = 2 + 3 * (1 + 10 + 2 + 10),
};

static void write_vectors(output *o, const char *keyword, const float *vectors, const tc_mesh_data *mesh, int soup) {
    uint64_t count = file_vertex_count(mesh, soup);
    size_t keyword_length = strlen(keyword);
    for (uint64_t v = 0; v < count;) {
        uint64_t end = output_block_end(v, count, VECTOR_MOST);
        char *start = (char *)output_reserve(o, (size_t)(end - v) * VECTOR_MOST), *to = start;
        for (; v < end; v++) {
            const float *vector = vectors + 3 * source_vertex(mesh, soup, v);
            memcpy(to, keyword, keyword_length);
            to += keyword_length;
            for (int axis = 0; axis < 3; axis++) {
                *to++ = ' ';
                to = put_float_text(to, vector[axis]);
            }
            *to++ = '\n';
        }
        output_advance(o, (size_t)(to - start));
    }
}

static char *put_corner(char *to, uint32_t index, int with_normal) {
    *to++ = ' ';
    to = put_u32_text(to, index);
    if (!with_normal) return to;
    *to++ = '/';
    *to++ = '/';
    return put_u32_text(to, index);
}

static void write_faces(output *o, const tc_mesh_data *mesh, int soup) {
    for (uint64_t t = 0; t < mesh->triangle_count;) {
        uint64_t end = output_block_end(t, mesh->triangle_count, FACE_MOST);
        char *start = (char *)output_reserve(o, (size_t)(end - t) * FACE_MOST), *to = start;
        for (; t < end; t++) {
            *to++ = 'f';
            for (uint64_t corner = 3 * t; corner < 3 * t + 3; corner++)
                to = put_corner(to, corner_vertex(mesh, soup, corner) + 1, mesh->normals != NULL);
            *to++ = '\n';
        }
        output_advance(o, (size_t)(to - start));
    }
}

void obj_write(output *o, const tc_mesh_data *mesh, int soup) {
    output_text(o, "# tetracubes isosurface: %llu vertices, %llu triangles\n",
                (unsigned long long)file_vertex_count(mesh, soup), (unsigned long long)mesh->triangle_count);
    write_vectors(o, "v", mesh->positions, mesh, soup);
    if (mesh->normals) write_vectors(o, "vn", mesh->normals, mesh, soup);
    write_faces(o, mesh, soup);
}
