/* mesh_packages.h - parsers of OFF, GLB, HTML and NPZ, as those of mesh_files.h */
#ifndef MESH_PACKAGES_H
#define MESH_PACKAGES_H

#include "mesh_files.h"

static inline tc_mesh_data parse_off(const char *text, size_t bytes) {
    unsigned long long vertex_count = 0, triangle_count = 0;
    int length = 0;
    char *end;
    const int is_good = sscanf(text, "OFF\n%llu %llu 0%n", &vertex_count, &triangle_count, &length) == 2 && length;
    EXPECT(is_good, "OFF header: %.50s", text);
    if (!is_good) return make_mesh(0, 0, 0);
    tc_mesh_data mesh = make_mesh(vertex_count, vertex_count ? triangle_count : 0, 0);
    const char *at = text + length;
    for (uint64_t v = 0; v < vertex_count; v++) at = parse_floats(at, (float *)(uintptr_t)mesh.positions + 3 * v);
    int wrong = 0;
    for (uint64_t t = 0; t < mesh.triangle_count; t++) {
        wrong += strncmp(at, "\n3 ", 3) != 0;
        at += 2;
        for (int k = 0; k < 3; k++, at = end)
            ((uint32_t *)(uintptr_t)mesh.triangles)[3 * t + (uint64_t)k] = (uint32_t)strtoul(at, &end, 10);
    }
    EXPECT(!wrong && at + 1 == text + bytes && *at == '\n', "OFF: %d lines of faces are wrong, or its end", wrong);
    return mesh;
}

/* -------------------------------------------------------------------------------------------------------------- GLB */

/* The number behind the n-th time that the text is there; -1 where it is not. */
static inline long long number_behind(const char *text, const char *name, int n) {
    for (; text && n >= 0; n--)
        if ((text = strstr(text, name))) text += strlen(name);
    return text ? strtoll(text, NULL, 10) : -1;
}

static inline void expect_bounds(const char *json, const float *positions, uint64_t count) {
    const char *low = strstr(json, "\"min\":["), *high = strstr(json, "\"max\":[");
    char *end;
    EXPECT(low && high, "GLB: no bounds in %s", json);
    for (uint64_t axis = 0; axis < 3 && low && high; axis++) {
        float least = INFINITY, most = -INFINITY;
        for (uint64_t v = 0; v < count; v++) {
            least = fminf(least, positions[3 * v + axis]);
            most = fmaxf(most, positions[3 * v + axis]);
        }
        low += axis ? 1 : 7;
        high += axis ? 1 : 7;
        EXPECT(strtof(low, &end) == least, "GLB: min %s is not %g", low, (double)least);
        low = end;
        EXPECT(strtof(high, &end) == most, "GLB: max %s is not %g", high, (double)most);
        high = end;
    }
}

/* An empty mesh where there is none in the file. */
static inline tc_mesh_data parse_glb(const char *text, size_t bytes) {
    const uint32_t json_bytes = bytes >= 20 ? get_u32(text + 12) : 0;
    int is_good = bytes >= 20 && get_u32(text) == 0x46546c67 && get_u32(text + 4) == 2 && get_u32(text + 8) == bytes &&
                  json_bytes % 4 == 0 && memcmp(text + 16, "JSON", 4) == 0 && json_bytes <= bytes - 20;
    EXPECT(is_good, "GLB header of %zu bytes", bytes);
    if (!is_good) return make_mesh(0, 0, 0);
    char *json = allocate((size_t)json_bytes + 1);
    memcpy(json, text + 20, json_bytes);
    json[json_bytes] = '\0';
    const char *chunk = text + 20 + json_bytes;
    if (chunk == text + bytes) {
        EXPECT(strstr(json, "\"scenes\":[{}]") && !strstr(json, "accessors"), "GLB of nothing: %s", json);
        free(json);
        return make_mesh(0, 0, 0);
    }
    const int with_normals = strstr(json, "\"NORMAL\":1") != NULL;
    const long long vertices = number_behind(json, "\"count\":", 0),
                    corners = number_behind(json, "\"count\":", 1 + with_normals);
    const uint64_t v = (uint64_t)vertices, c = (uint64_t)corners, vectors = 12 * v, binary = get_u32(chunk);
    is_good = vertices > 0 && corners > 0 && corners % 3 == 0 && memcmp(chunk + 4, "BIN", 4) == 0 &&
              binary == (1 + (uint64_t)with_normals) * vectors + 4 * c && chunk + 8 + binary == text + bytes &&
              number_behind(json, "\"byteLength\":", 2 + with_normals) == (long long)binary &&
              number_behind(json, "\"byteOffset\":", 1) == (long long)vectors &&
              number_behind(json, "\"byteLength\":", 0) == (long long)vectors &&
              number_behind(json, "\"indices\":", 0) == 1 + with_normals && strstr(json, "\"POSITION\":0") &&
              strstr(json, "\"componentType\":5125") && strstr(json, "\"material\":0");
    EXPECT(is_good, "GLB: %s", json);
    tc_mesh_data mesh = make_mesh(is_good ? v : 0, is_good ? c / 3 : 0, is_good && with_normals);
    const char *at = chunk + 8;
    if (is_good) {
        memcpy((float *)(uintptr_t)mesh.positions, at, vectors);
        if (with_normals) memcpy((float *)(uintptr_t)mesh.normals, at += vectors, vectors);
        memcpy((uint32_t *)(uintptr_t)mesh.triangles, at + vectors, 4 * c);
        expect_bounds(json, mesh.positions, v);
    }
    free(json);
    return mesh;
}

/* ------------------------------------------------------------------------------------------------------------- HTML */

/* What the page's script of that name holds, decoded to so many bytes; zeros where it holds something else. */
static inline void *html_array(const char *text, const char *name, uint64_t bytes) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char tag[80];
    snprintf(tag, sizeof tag, "\n<script type=\"text/plain\" id=\"%s\">", name);
    unsigned char *out = calloc(bytes + 3, 1), values[256];
    const char *at = strstr(text, tag);
    memset(values, 255, sizeof values);
    for (unsigned n = 0; n < 64; n++) values[(unsigned char)digits[n]] = (unsigned char)n;
    EXPECT(out && at, "HTML: no %s", name);
    if (!out || !at) return out;
    at += strlen(tag);
    const size_t length = strcspn(at, "<");
    int wrong = length != bytes / 3 * 4 || strncmp(at + length, "</script>\n", 10) != 0;
    for (size_t n = 0; n < length && !wrong; n++) {
        const unsigned value = values[(unsigned char)at[n]];
        wrong |= value > 63;
        for (unsigned bit = 0; bit < 6; bit++)
            out[(6 * n + bit) / 8] |= (unsigned char)((value >> (5 - bit) & 1) << (7 - (6 * n + bit) % 8));
    }
    EXPECT(!wrong, "HTML: %s of %zu characters", name, length);
    return out;
}

static inline tc_mesh_data parse_html(const char *text, size_t bytes) {
    const char *about = strstr(text, "<script type=\"application/json\" id=\"mesh\">");
    const long long vertices = about ? number_behind(about, "\"vertices\": ", 0) : -1,
                    triangles = about ? number_behind(about, "\"triangles\": ", 0) : -1;
    EXPECT(strncmp(text, "<!DOCTYPE html>\n", 16) == 0 && text[bytes - 1] == '\n' && vertices >= 0 && triangles >= 0,
           "HTML: a page of %lld vertices and %lld triangles", vertices, triangles);
    tc_mesh_data mesh = {0};
    if (vertices < 0 || triangles < 0) return make_mesh(0, 0, 0);
    mesh.vertex_count = (uint64_t)vertices;
    mesh.triangle_count = (uint64_t)triangles;
    mesh.positions = html_array(text, "positions", 12 * mesh.vertex_count);
    mesh.triangles = html_array(text, "triangles", 12 * mesh.triangle_count);
    if (strstr(about, "\"normals\": true")) mesh.normals = html_array(text, "normals", 12 * mesh.vertex_count);
    return mesh;
}

/* -------------------------------------------------------------------------------------------------------------- NPZ */

static inline uint32_t sum_of(const char *data, uint64_t bytes) {
    uint32_t c = UINT32_MAX;
    for (uint64_t n = 0; n < bytes; n++) {
        c ^= (unsigned char)data[n];
        for (int bit = 0; bit < 8; bit++) c = c & 1 ? 0xedb88320u ^ c >> 1 : c >> 1;
    }
    return ~c;
}

static inline uint64_t get_u64(const char *at) { return get_u32(at) | (uint64_t)get_u32(at + 4) << 32; }

/* The values of a member, whose header has to say this; NULL where it is not there. *rows: of them. */
static inline const char *npz_member(const char *text, size_t bytes, const char *name, const char *type, int columns,
                                     uint64_t *rows) {
    for (const char *at = text; at + 30 < text + bytes && get_u32(at) == 0x04034b50;) {
        const size_t name_length = (unsigned char)at[26], extra = (unsigned char)at[28];
        const char *data = at + 30 + name_length + extra;
        const uint64_t size = get_u64(data - 16);
        char header[200], wanted[200];
        EXPECT(extra == 20 && get_u32(at + 18) == UINT32_MAX && get_u64(data - 8) == size &&
                   size <= (uint64_t)(text + bytes - data) && sum_of(data, size) == get_u32(at + 14),
               "NPZ: header or sum of %.*s", (int)name_length, at + 30);
        if (strlen(name) + 4 != name_length || strncmp(at + 30, name, strlen(name)) != 0) {
            at = data + size;
            continue;
        }
        const size_t length = (size_t)(unsigned char)data[8];
        *rows = (size - 10 - length) / (4 * (uint64_t)columns);
        snprintf(header, sizeof header, "%.*s", (int)length, data + 10);
        snprintf(wanted, sizeof wanted,
                 columns > 1 ? "{'descr': '<%s', 'fortran_order': False, 'shape': (%llu, %d), }"
                             : "{'descr': '<%s', 'fortran_order': False, 'shape': (%llu,), }",
                 type, (unsigned long long)*rows, columns);
        EXPECT(!memcmp(data, "\x93NUMPY\1", 8) && (10 + length) % 64 == 0 && data[9] == 0 && data[9 + length] == '\n' &&
                   !strncmp(header, wanted, strlen(wanted)),
               "NPZ: %s, not %s", header, wanted);
        return data + 10 + length;
    }
    return NULL;
}

static inline tc_mesh_data parse_npz(const char *text, size_t bytes) {
    uint64_t vertices = 0, triangles = 0, count = 0;
    const char *points = npz_member(text, bytes, "vertices", "f4", 3, &vertices),
               *faces = npz_member(text, bytes, "faces", "u4", 3, &triangles),
               *normals = npz_member(text, bytes, "normals", "f4", 3, &count);
    EXPECT(points && faces && (!normals || count == vertices), "NPZ: arrays are missing");
    if (!points || !faces) return make_mesh(0, 0, 0);
    tc_mesh_data mesh = make_mesh(vertices, vertices ? triangles : 0, normals != NULL);
    memcpy((float *)(uintptr_t)mesh.positions, points, 12 * vertices);
    if (normals) memcpy((float *)(uintptr_t)mesh.normals, normals, 12 * vertices);
    memcpy((uint32_t *)(uintptr_t)mesh.triangles, faces, 12 * mesh.triangle_count);
    return mesh;
}

#endif
