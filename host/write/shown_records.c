/* shown_records.c - records of a mesh in binary; see shown_records.h */
#include "shown_records.h"

unsigned char *encode_values(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_array *s = source;
    size_t components = (size_t)s->array.components;
    for (uint64_t v = first; v < end; v++)
        to = put_bytes(to, s->array.values + components * source_vertex(s->shown, v), components * sizeof(float));
    return to;
}

unsigned char *encode_positions_f64(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    for (uint64_t v = first; v < end; v++) {
        double position[3];
        shown_position(s, source_vertex(s, v), position);
        to = put_bytes(to, position, sizeof position);
    }
    return to;
}

unsigned char *encode_positions_f32(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    for (uint64_t v = first; v < end; v++) {
        float position[3];
        shown_position_f32(s, source_vertex(s, v), position);
        to = put_bytes(to, position, sizeof position);
    }
    return to;
}

unsigned char *encode_triangles(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    for (uint64_t c = 3 * first; c < 3 * end; c++) {
        const uint32_t vertex = (uint32_t)corner_vertex(s, c);
        to = put_bytes(to, &vertex, sizeof vertex);
    }
    return to;
}

record_array records_of_values(const shown_array *s) {
    const int is_plain = !s->shown->soup;
    return (record_array){.span = vertex_span(s->shown),
                          .record_bytes = (size_t)s->array.components * sizeof(float),
                          .encode = is_plain ? NULL : encode_values,
                          .source = is_plain ? (const void *)s->array.values : s};
}

record_array records_of_positions(const shown_mesh *s, int as_doubles) {
    const int is_plain = !s->soup && !s->is_moved && !as_doubles;
    return (record_array){.span = vertex_span(s),
                          .record_bytes = 3 * (as_doubles ? sizeof(double) : sizeof(float)),
                          .encode = is_plain     ? NULL
                                    : as_doubles ? encode_positions_f64
                                                 : encode_positions_f32,
                          .source = is_plain ? (const void *)s->mesh->positions : s};
}

record_array records_of_triangles(const shown_mesh *s) {
    const int is_plain = !s->soup && !s->first_vertex;
    return (record_array){.span = triangle_span(s),
                          .record_bytes = 3 * sizeof(uint32_t),
                          .encode = is_plain ? NULL : encode_triangles,
                          .source = is_plain ? (const void *)s->mesh->triangles : s};
}

record_array records_of_labels(const shown_mesh *s) {
    return (record_array){.span = triangle_span(s), .record_bytes = 2 * sizeof(uint32_t), .source = s->labels};
}

void write_records(output *o, const record_array *r) { output_span(o, r->span, r->record_bytes, r->encode, r->source); }
