/*
 * glb.c - glTF 2.0, binary (.glb): one mesh of one material, or of one for each label, as browsers and viewers show it
 *
 * Source: "glTF 2.0 Specification", Khronos Group. A header, a chunk of JSON that describes what follows, and a chunk
 * with positions, normals where the mesh has them, and triangles of uint32. Sizes have 32 bits. Coordinates are float32
 * as they are: glTF's y points upwards in a viewer, its unit is the metre, and neither is made so here. A mesh without
 * triangles is a scene with nothing in it, as the format has no empty arrays. Triangles of a label map have the
 * material of their inner side's label, named by it.
 */
#include "decimal.h"
#include "file_text.h"
#include "label_colour.h"
#include "label_order.h"

#include <errno.h>
#include <math.h>

enum { HEADER_BYTES = 12, CHUNK_HEADER_BYTES = 8, JSON_MOST = 4096, LABELS_JSON_MOST = 1 << 25 };

/* componentType, target of a view */
enum { GL_UNSIGNED_INT = 5125, GL_FLOAT = 5126, GL_ARRAY_BUFFER = 34962, GL_ELEMENT_ARRAY_BUFFER = 34963 };

/* A view of the binary chunk: of vertices, and last of triangles. */
typedef struct glb_view {
    record_array records;
    const char *bounds; /* more of the accessor's text */
    int target;
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
    return binary_bytes(s) <=
           UINT32_MAX - HEADER_BYTES - 2 * CHUNK_HEADER_BYTES - (s->labels ? LABELS_JSON_MOST : JSON_MOST);
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

/* Triangles that follow each other and have one material; label 0: the mesh has none. */
typedef struct glb_primitive {
    uint32_t label;
    uint64_t first, end;
} glb_primitive;

static int next_primitive(const label_order *order, glb_primitive *p) {
    const uint64_t count = order->shown->mesh->triangle_count;
    p->first = p->end;
    if (p->first == count) return 0;
    p->label = order->triangles ? label_order_at(order, p->first)[0] : 0;
    p->end = order->triangles ? label_order_end(order, p->first, 0) : count;
    return 1;
}

/* The format has linear components; a polynomial that is within 0.002 of sRGB's curve. */
static double linear_of(double c) { return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878); }

static void add_material(file_text *t, uint32_t label) {
    if (label) {
        double colour[3];
        label_colour(label, colour);
        text_add(t, "{\"name\":\"label %u\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[", label);
        for (int n = 0; n < 3; n++) text_add(t, "%s0.%03d", n ? "," : "", (int)(1000 * linear_of(colour[n]) + 0.5));
    } else {
        text_add(t, "{\"name\":\"surface\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.8,0.8");
    }
    text_add(t, ",1],\"metallicFactor\":0,\"roughnessFactor\":0.6},\"doubleSided\":true}");
}

/* The accessors of primitives follow those of vertices. */
static void add_mesh(file_text *t, const label_order *order, int vectors) {
    text_add(t, "\"materials\":[");
    for (glb_primitive p = {0}; next_primitive(order, &p);) {
        text_add(t, p.first ? "," : "");
        add_material(t, p.label);
    }
    text_add(t, "],\"meshes\":[{\"primitives\":[");
    int n = 0;
    for (glb_primitive p = {0}; next_primitive(order, &p); n++)
        text_add(t, "%s{\"attributes\":{\"POSITION\":0%s},\"indices\":%d,\"material\":%d}", n ? "," : "",
                 vectors > 1 ? ",\"NORMAL\":1" : "", vectors + n, n);
    text_add(t, "]}],");
}

/* An accessor sees all of its view; that of triangles those of a primitive. */
static void add_accessors(file_text *t, const label_order *order, const glb_view *views, int count) {
    uint64_t offset = 0;
    text_add(t, "\"accessors\":[");
    for (int n = 0; n < count - 1; n++)
        text_add(t, "{\"bufferView\":%d,\"componentType\":%d,\"count\":%llu,\"type\":\"VEC3\"%s},", n, GL_FLOAT,
                 (unsigned long long)views[n].records.span.count, views[n].bounds);
    for (glb_primitive p = {0}; next_primitive(order, &p);) {
        text_add(t, "%s{\"bufferView\":%d,", p.first ? "," : "", count - 1);
        if (p.first) text_add(t, "\"byteOffset\":%llu,", 12ull * p.first);
        text_add(t, "\"componentType\":%d,\"count\":%llu,\"type\":\"SCALAR\"}", GL_UNSIGNED_INT,
                 3ull * (p.end - p.first));
    }
    text_add(t, "],\"bufferViews\":[");
    for (int n = 0; n < count; n++) {
        const uint64_t bytes = record_array_bytes(&views[n].records);
        text_add(t, "%s{\"buffer\":0,\"byteOffset\":%llu,\"byteLength\":%llu,\"target\":%d}", n ? "," : "",
                 (unsigned long long)offset, (unsigned long long)bytes, views[n].target);
        offset += bytes;
    }
    text_add(t, "],\"buffers\":[{\"byteLength\":%llu}]", (unsigned long long)offset);
}

static void add_json(file_text *t, const label_order *order, const glb_view *views, int count) {
    const shown_mesh *s = order->shown;
    text_add(t, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"tetracubes\"");
    for (int n = 0; shown_notes(s, n).name; n++)
        text_add(t, "%s\"%s\":\"%s\"", n ? "," : ",\"extras\":{", shown_notes(s, n).name, shown_notes(s, n).value);
    text_add(t, "%s},\"scene\":0,", shown_notes(s, 0).name ? "}" : "");
    if (is_empty(s)) {
        text_add(t, "\"scenes\":[{}]}");
    } else {
        text_add(t, "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"name\":\"isosurface\"}],");
        add_mesh(t, order, count - 1);
        add_accessors(t, order, views, count);
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
    label_order order;
    int count = 0;
    glb_view views[VIEWS_MOST];
    if (label_order_make(s, &order)) o->error = ENOMEM;
    add_bounds(&bounds, s);
    views[count++] = (glb_view){records_of_positions(s, 0), bounds.bytes, GL_ARRAY_BUFFER};
    if (normals) views[count++] = (glb_view){records_of_values(&shown), "", GL_ARRAY_BUFFER};
    views[count++] = (glb_view){records_of_ordered(s, &order), "", GL_ELEMENT_ARRAY_BUFFER};
    if (!bounds.has_failed) add_json(&json, &order, views, count);
    if (bounds.has_failed || json.has_failed)
        o->error = ENOMEM;
    else
        write_file(o, s, &json, views, count);
    text_release(&json);
    text_release(&bounds);
    label_order_release(&order);
}
