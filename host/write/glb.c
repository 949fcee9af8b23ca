/*
 * glb.c - glTF 2.0, binary (.glb): one mesh of one material, as browsers and viewers show it
 *
 * Source: "glTF 2.0 Specification", Khronos Group. A header, a chunk of JSON that describes what follows, and a chunk
 * with positions, normals where the mesh has them, and triangles of uint32. Sizes have 32 bits. Coordinates are float32
 * as they are: glTF's y points upwards in a viewer, its unit is the metre, and neither is made so here. A mesh without
 * triangles is a scene with nothing in it, as the format has no empty arrays.
 */
#include "decimal.h"
#include "file_text.h"
#include "shown_records.h"

#include <errno.h>
#include <math.h>

enum { HEADER_BYTES = 12, CHUNK_HEADER_BYTES = 8, JSON_MOST = 4096 };

/* componentType, target of a view */
enum { GL_UNSIGNED_INT = 5125, GL_FLOAT = 5126, GL_ARRAY_BUFFER = 34962, GL_ELEMENT_ARRAY_BUFFER = 34963 };

/* A view of the binary chunk, and the accessor of the same number that sees all of it. */
typedef struct glb_view {
    record_array records;
    const char *type, *bounds; /* bounds: more of the accessor's text */
    uint64_t element_count;
    int component_type, target;
} glb_view;

enum { VIEWS_MOST = 3 };

static int is_empty(const shown_mesh *s) { return !s->mesh->triangle_count; }

static const vertex_array *find_normals(const shown_mesh *s) {
    for (int n = 0; n < s->array_count; n++)
        if (s->arrays[n].role == ROLE_NORMALS) return &s->arrays[n];
    return NULL;
}

static uint64_t binary_bytes(const shown_mesh *s) {
    const uint64_t vectors = shows_role(s, ROLE_NORMALS) ? 2 : 1;
    return is_empty(s) ? 0 : (vectors * file_vertex_count(s) + s->mesh->triangle_count) * 12;
}

int glb_fits(const shown_mesh *s) {
    return binary_bytes(s) <= UINT32_MAX - HEADER_BYTES - 2 * CHUNK_HEADER_BYTES - JSON_MOST;
}

static void add_vector(file_text *t, const char *name, const float *vector) {
    text_add(t, ",\"%s\":", name);
    for (int axis = 0; axis < 3; axis++) {
        char number[DECIMAL_MOST + 1];
        *put_float_text(number, vector[axis]) = '\0';
        text_add(t, "%c%s", axis ? ',' : '[', number);
    }
    text_add(t, "]");
}

/* "min":[...],"max":[...]: what the format asks for of positions, exactly as they are. */
static void add_bounds(file_text *t, const shown_mesh *s) {
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint64_t v = 0; v < file_vertex_count(s); v++) {
        float position[3];
        shown_position_f32(s, source_vertex(s, v), position);
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fminf(low[axis], position[axis]);
            high[axis] = fmaxf(high[axis], position[axis]);
        }
    }
    add_vector(t, "min", low);
    add_vector(t, "max", high);
}

static void add_accessors(file_text *t, const glb_view *views, int count) {
    uint64_t offset = 0;
    text_add(t, "\"accessors\":[");
    for (int n = 0; n < count; n++)
        text_add(t, "%s{\"bufferView\":%d,\"componentType\":%d,\"count\":%llu,\"type\":\"%s\"%s}", n ? "," : "", n,
                 views[n].component_type, (unsigned long long)views[n].element_count, views[n].type, views[n].bounds);
    text_add(t, "],\"bufferViews\":[");
    for (int n = 0; n < count; n++) {
        const uint64_t bytes = record_array_bytes(&views[n].records);
        text_add(t, "%s{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu,\"target\":%d}", n ? "," : "",
                 (unsigned long long)offset, (unsigned long long)bytes, views[n].target);
        offset += bytes;
    }
    text_add(t, "],\"buffers\":[{\"byteLength\":%llu}]", (unsigned long long)offset);
}

static void add_json(file_text *t, const shown_mesh *s, const glb_view *views, int count) {
    text_add(t, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"tetracubes\"");
    for (int n = 0; shown_notes(s, n).name; n++)
        text_add(t, "%s\"%s\":\"%s\"", n ? "," : ",\"extras\":{", shown_notes(s, n).name, shown_notes(s, n).value);
    text_add(t, "%s},\"scene\":0,", shown_notes(s, 0).name ? "}" : "");
    if (is_empty(s)) {
        text_add(t, "\"scenes\":[{}]}");
    } else {
        text_add(t, "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"name\":\"isosurface\"}],"
                    "\"materials\":[{\"name\":\"surface\",\"pbrMetallicRoughness\":{\"baseColorFactor\":"
                    "[0.8,0.8,0.8,1],\"metallicFactor\":0,\"roughnessFactor\":0.6},\"doubleSided\":true}],");
        text_add(t,
                 "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0%s},\"indices\":%d,\"material\":0}]}],",
                 count > 2 ? ",\"NORMAL\":1" : "", count - 1);
        add_accessors(t, views, count);
        text_add(t, "}");
    }
    text_fill(t, ' ', (4 - t->length % 4) % 4);
}

static void put_chunk_header(output *o, uint64_t bytes, const char type[4]) {
    const uint32_t length = (uint32_t)bytes;
    output_bytes(o, &length, sizeof length);
    output_bytes(o, type, 4);
}

static void write_file(output *o, const shown_mesh *s, const file_text *json, const glb_view *views, int count) {
    const uint64_t binary = binary_bytes(s), binary_chunk = binary ? CHUNK_HEADER_BYTES + binary : 0;
    const uint32_t header[3] = {0x46546c67, 2, /* "glTF", version */
                                (uint32_t)(HEADER_BYTES + CHUNK_HEADER_BYTES + json->length + binary_chunk)};
    output_expect(o, header[2]);
    output_bytes(o, header, sizeof header);
    put_chunk_header(o, json->length, "JSON");
    output_bytes(o, json->bytes, json->length);
    if (!binary) return;
    put_chunk_header(o, binary, "BIN");
    for (int n = 0; n < count; n++) write_records(o, &views[n].records);
}

void glb_write(output *o, const shown_mesh *s) {
    file_text json = {0}, bounds = {0};
    const vertex_array *normals = find_normals(s);
    const shown_array shown = {s, normals ? *normals : (vertex_array){0}};
    const uint64_t vertices = file_vertex_count(s);
    int count = 0;
    glb_view views[VIEWS_MOST];
    add_bounds(&bounds, s);
    views[count++] = (glb_view){records_of_positions(s, 0), "VEC3", bounds.bytes, vertices, GL_FLOAT, GL_ARRAY_BUFFER};
    if (normals)
        views[count++] = (glb_view){records_of_values(&shown), "VEC3", "", vertices, GL_FLOAT, GL_ARRAY_BUFFER};
    views[count++] = (glb_view){records_of_triangles(s),     "SCALAR",        "",
                                3 * s->mesh->triangle_count, GL_UNSIGNED_INT, GL_ELEMENT_ARRAY_BUFFER};
    if (!bounds.has_failed) add_json(&json, s, views, count);
    if (bounds.has_failed || json.has_failed)
        o->error = ENOMEM;
    else
        write_file(o, s, &json, views, count);
    text_release(&json);
    text_release(&bounds);
}
