/* vector_text.c - vectors as lines of text; see vector_text.h */
#include "vector_text.h"

#include "decimal.h"

enum { BEFORE_MOST = 4, VECTOR_MOST = BEFORE_MOST + 3 * (1 + DECIMAL_F64_MOST) }; /* bytes of the longest line */

typedef struct vector_lines {
    const shown_mesh *shown;
    const char *before;
    const float *vectors; /* NULL: positions as doubles */
} vector_lines;

static unsigned char *encode_vectors(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const vector_lines *lines = source;
    const size_t before_length = strlen(lines->before);
    char *at = (char *)to;
    for (uint64_t v = first; v < end; v++) {
        const uint64_t vertex = source_vertex(lines->shown, v);
        double position[3] = {0};
        if (!lines->vectors) shown_position(lines->shown, vertex, position);
        memcpy(at, lines->before, before_length);
        at += before_length;
        for (uint64_t axis = 0; axis < 3; axis++) {
            at = lines->vectors ? put_float_text(at, lines->vectors[3 * vertex + axis])
                                : put_double_text(at, position[axis]);
            *at++ = axis < 2 ? ' ' : '\n';
        }
    }
    return (unsigned char *)at;
}

void write_vectors(output *o, const shown_mesh *s, const char *before, const float *vectors) {
    const vector_lines lines = {s, before, vectors};
    output_records(o, file_vertex_count(s), VECTOR_MOST, encode_vectors, &lines);
}

void write_positions(output *o, const shown_mesh *s, const char *before) {
    write_vectors(o, s, before, s->is_moved ? NULL : s->mesh->positions);
}
