/*
 * mesh_files.h - random meshes, and parsers of the written formats that share nothing with the writers
 *
 * The parsers take a whole file and return a mesh to be freed by free_mesh; what is not as it should be is an EXPECT
 * that fails, and the mesh is then empty or cut short.
 */
#ifndef MESH_FILES_H
#define MESH_FILES_H

#include "expect.h"
#include "random.h"
#include "tetracubes.h"
#include "vtk_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(size_t bytes) {
    void *memory = malloc(bytes > 0 ? bytes : 1);
    if (!memory) exit(EXIT_FAILURE);
    return memory;
}

/* ----------------------------------------------------------------------------------------------------------- meshes */

/* Floats of every exponent, subnormals and both zeros included, now and then a plain one. */
static float random_float(void) {
    for (;;) {
        uint64_t r = random_u64();
        uint32_t bits = (uint32_t)r;
        float value;
        memcpy(&value, &bits, sizeof value);
        if (r >> 62 == 0) return (float)(bits >> 8) / 65536 - 100;
        if (isfinite(value)) return value;
    }
}

static tc_mesh_data make_mesh(uint64_t vertex_count, uint64_t triangle_count, int with_normals) {
    float *positions = allocate(vertex_count * 12), *normals = with_normals ? allocate(vertex_count * 12) : NULL;
    uint32_t *triangles = allocate(triangle_count * 12);
    for (uint64_t i = 0; i < 3 * vertex_count; i++) {
        positions[i] = random_float();
        if (normals) normals[i] = random_float();
    }
    for (uint64_t i = 0; i < 3 * triangle_count; i++) triangles[i] = (uint32_t)(random_u64() % vertex_count);
    if (vertex_count > 0) memcpy(positions, (float[3]){-0.0f, 1e-45f, -3.40282347e38f}, 12);
    return (tc_mesh_data){.struct_size = sizeof(tc_mesh_data),
                          .vertex_count = vertex_count,
                          .triangle_count = triangle_count,
                          .positions = positions,
                          .normals = normals,
                          .triangles = triangles};
}

static void free_mesh(tc_mesh_data *mesh) {
    free((void *)(uintptr_t)mesh->positions);
    free((void *)(uintptr_t)mesh->normals);
    free((void *)(uintptr_t)mesh->triangles);
}

/* ---------------------------------------------------------------------------------------------------------- parsers */

static inline char *read_file(const char *path, size_t *bytes) {
    FILE *file = fopen(path, "rb");
    *bytes = 0;
    if (!file) return NULL;
    fseek(file, 0, SEEK_END);
    *bytes = (size_t)ftell(file);
    rewind(file);
    char *text = allocate(*bytes + 1);
    text[fread(text, 1, *bytes, file)] = '\0';
    fclose(file);
    return text;
}

static uint32_t get_u32(const char *at) {
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void get_floats(const char *at, float *values) {
    for (int i = 0; i < 3; i++) {
        uint32_t bits = get_u32(at + 4 * i);
        memcpy(values + i, &bits, 4);
    }
}

/* An empty mesh where the text is not the PLY that is expected here, byte by byte. */
static inline tc_mesh_data parse_ply(const char *text, size_t bytes) {
    const char *normal_lines = "property float nx\nproperty float ny\nproperty float nz\n";
    unsigned long long vertex_count = 0, triangle_count = 0;
    int length = 0;
    sscanf(text,
           "ply\nformat binary_little_endian 1.0\ncomment tetracubes isosurface\nelement vertex %llu\nproperty float "
           "x\nproperty float y\nproperty float z\n%n",
           &vertex_count, &length);
    const char *at = text + length, *data;
    int with_normals = strncmp(at, normal_lines, strlen(normal_lines)) == 0;
    if (with_normals) at += strlen(normal_lines);
    sscanf(at, "element face %llu\n%n", &triangle_count, &length);
    at += length;
    const char *rest = "property list uchar uint vertex_indices\nend_header\n";
    data = at + strlen(rest);
    size_t vertex_bytes = with_normals ? 24 : 12;
    int is_good = strncmp(at, rest, strlen(rest)) == 0 &&
                  bytes == (size_t)(data - text) + vertex_count * vertex_bytes + triangle_count * 13;
    EXPECT(is_good, "PLY header or size (%zu bytes): %.300s", bytes, text);
    if (!is_good) return make_mesh(0, 0, 0);

    tc_mesh_data mesh = make_mesh(vertex_count, vertex_count ? triangle_count : 0, with_normals);
    for (uint64_t v = 0; v < vertex_count; v++, data += vertex_bytes) {
        get_floats(data, (float *)(uintptr_t)mesh.positions + 3 * v);
        if (with_normals) get_floats(data + 12, (float *)(uintptr_t)mesh.normals + 3 * v);
    }
    int bad_sizes = 0;
    for (uint64_t t = 0; t < mesh.triangle_count; t++, data += 13) {
        bad_sizes += *data != 3;
        for (int k = 0; k < 3; k++)
            ((uint32_t *)(uintptr_t)mesh.triangles)[3 * t + (uint64_t)k] = get_u32(data + 1 + 4 * k);
    }
    EXPECT(bad_sizes == 0, "%d PLY faces are no triangles", bad_sizes);
    return mesh;
}

/* Positions as soup; the facet normals take the place of the normals, once per triangle's first vertex. */
static inline tc_mesh_data parse_stl(const char *text, size_t bytes) {
    uint32_t count = bytes >= 84 ? get_u32(text + 80) : 0;
    EXPECT(bytes == 84 + 50 * (size_t)count, "STL of %zu bytes", bytes);
    EXPECT(strncmp(text, "solid", 5) != 0, "binary STL begins with solid");
    if (bytes != 84 + 50 * (size_t)count) return make_mesh(0, 0, 0);
    tc_mesh_data mesh = make_mesh(3 * (uint64_t)count, count, 1);
    const char *at = text + 84;
    int bad_attributes = 0;
    for (uint32_t t = 0; t < count; t++, at += 50) {
        float *corner = (float *)(uintptr_t)mesh.positions + 9 * (uint64_t)t;
        get_floats(at, (float *)(uintptr_t)mesh.normals + 9 * (uint64_t)t);
        for (int k = 0; k < 3; k++) {
            get_floats(at + 12 + 12 * k, corner + 3 * k);
            ((uint32_t *)(uintptr_t)mesh.triangles)[3 * t + (uint32_t)k] = 3 * t + (uint32_t)k;
        }
        bad_attributes += at[48] != 0 || at[49] != 0;
    }
    EXPECT(bad_attributes == 0, "%d STL attribute counts are not 0", bad_attributes);
    return mesh;
}

static uint64_t count_lines(const char *text, const char *keyword) {
    uint64_t count = 0;
    for (const char *line = text; line; line = strchr(line, '\n')) {
        line += *line == '\n';
        count += strncmp(line, keyword, strlen(keyword)) == 0;
    }
    return count;
}

static const char *parse_floats(const char *at, float *values) {
    char *end;
    for (int axis = 0; axis < 3; axis++, at = end) values[axis] = strtof(at, &end);
    return at;
}

/* Indices with or without normals' indices, which must be the same. */
static const char *parse_face(const char *at, uint32_t *triangle, int with_normals) {
    char *end;
    for (int k = 0; k < 3; k++, at = end) {
        triangle[k] = (uint32_t)strtoul(at, &end, 10) - 1;
        if (!with_normals) continue;
        if (strncmp(end, "//", 2) != 0 || (uint32_t)strtoul(end + 2, &end, 10) - 1 != triangle[k]) return "bad face";
    }
    return at;
}

static inline tc_mesh_data parse_obj(const char *text, size_t bytes) {
    uint64_t normal_count = count_lines(text, "vn "), v = 0, n = 0, t = 0;
    tc_mesh_data mesh =
        make_mesh(count_lines(text, "v "), count_lines(text, "v ") ? count_lines(text, "f ") : 0, normal_count > 0);
    EXPECT(normal_count == 0 || normal_count == mesh.vertex_count, "%llu OBJ normals",
           (unsigned long long)normal_count);
    for (const char *at = text; at < text + bytes && normal_count <= mesh.vertex_count; at++) {
        if (strncmp(at, "v ", 2) == 0)
            at = parse_floats(at + 2, (float *)(uintptr_t)mesh.positions + 3 * v++);
        else if (strncmp(at, "vn ", 3) == 0)
            at = parse_floats(at + 3, (float *)(uintptr_t)mesh.normals + 3 * n++);
        else if (strncmp(at, "f ", 2) == 0)
            at = parse_face(at + 2, (uint32_t *)(uintptr_t)mesh.triangles + 3 * t++, mesh.normals != NULL);
        else if (*at == '#')
            at = strchr(at, '\n');
        else
            at = "unknown line";
        if (at && *at == '\n') continue;
        EXPECT(0, "OBJ line %llu ends in: %.20s", (unsigned long long)(v + n + t), at ? at : "");
        break;
    }
    return mesh;
}

static inline tc_mesh_data parse_vtp(const char *text, size_t bytes) {
    vtk_values points = vtk_find(text, bytes, "Points"), normals = vtk_find(text, bytes, "Normals"),
               corners = vtk_find(text, bytes, "connectivity"), ends = vtk_find(text, bytes, "offsets");
    uint64_t vertex_count = vtk_count(text, "NumberOfPoints"), triangle_count = vtk_count(text, "NumberOfPolys");
    size_t index_bytes = vtk_index_bytes(&corners);
    int is_good = points.data && points.components == 3 && strcmp(points.type, "Float32") == 0 &&
                  points.bytes == 12 * vertex_count && corners.data && ends.data &&
                  corners.bytes == 3 * triangle_count * index_bytes && ends.bytes == triangle_count * index_bytes &&
                  strcmp(corners.type, ends.type) == 0 &&
                  (!normals.data || (normals.bytes == points.bytes && normals.components == 3));
    EXPECT(is_good, "VTP header or size (%zu bytes): %.500s", bytes, text);
    if (!is_good) return make_mesh(0, 0, 0);

    tc_mesh_data mesh = make_mesh(vertex_count, vertex_count ? triangle_count : 0, normals.data != NULL);
    memcpy((float *)(uintptr_t)mesh.positions, points.data, points.bytes);
    if (normals.data) memcpy((float *)(uintptr_t)mesh.normals, normals.data, normals.bytes);
    uint64_t wrong = 0;
    for (uint64_t t = 0; t < mesh.triangle_count; t++) {
        wrong += vtk_index(&ends, t) != (int64_t)(3 * t + 3);
        for (uint64_t k = 0; k < 3; k++)
            ((uint32_t *)(uintptr_t)mesh.triangles)[3 * t + k] = (uint32_t)vtk_index(&corners, 3 * t + k);
    }
    EXPECT(wrong == 0, "%llu VTP offsets are wrong", (unsigned long long)wrong);
    return mesh;
}

#endif
