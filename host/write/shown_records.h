/* shown_records.h - the records of a mesh as several formats have them: values, coordinates and triangles in binary */
#ifndef SHOWN_RECORDS_H
#define SHOWN_RECORDS_H

#include "formats.h"

/* An array, and the mesh that says in which order it is shown. */
typedef struct shown_array {
    const shown_mesh *shown;
    vertex_array array;
} shown_array;

/* Records for output_records. Of a shown_array, the values of vertices: */
unsigned char *encode_values(const void *source, uint64_t first, uint64_t end, unsigned char *to);

/* Of a shown_mesh, the coordinates of vertices in either precision, and triangles of uint32: */
unsigned char *encode_positions_f64(const void *source, uint64_t first, uint64_t end, unsigned char *to);
unsigned char *encode_positions_f32(const void *source, uint64_t first, uint64_t end, unsigned char *to);
unsigned char *encode_triangles(const void *source, uint64_t first, uint64_t end, unsigned char *to);

/* Records for output_span. Those that lie in memory as they should lie in the file have no encode. */
typedef struct record_array {
    record_span span;
    size_t record_bytes;
    output_encode *encode;
    const void *source;
} record_array;

record_array records_of_values(const shown_array *s);
record_array records_of_positions(const shown_mesh *s, int as_doubles);
record_array records_of_triangles(const shown_mesh *s);

/* Of a label map: two labels of uint32 for each triangle. */
record_array records_of_labels(const shown_mesh *s);

static inline uint64_t record_array_bytes(const record_array *r) { return r->span.count * r->record_bytes; }

void write_records(output *o, const record_array *r);

#endif
