/*
 * stl.c - STL, binary (3D Systems, 1989)
 *
 * An 80-byte header that does not begin with "solid" (that would make it the text form), the count of triangles as
 * uint32, then 50 bytes per triangle: normal, three corners, attribute count 0. The normal is the triangle's own, by
 * the right-hand rule; zero where the triangle has no area.
 */
#include "formats.h"

#include <math.h>
#include <stdio.h>

enum { HEADER_BYTES = 80, TRIANGLE_BYTES = 50 };

static void facet_normal(const float *a, const float *b, const float *c, float normal[3]) {
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)b[axis] - (double)a[axis];
        v[axis] = (double)c[axis] - (double)a[axis];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    int has_area = length > 0 && isfinite(length);
    double scale = has_area ? 1 / length : 0;
    for (int axis = 0; axis < 3; axis++) normal[axis] = has_area ? (float)(n[axis] * scale) : 0;
}

static unsigned char *encode_triangles(const void *source, uint64_t first, uint64_t end, unsigned char *to) {
    const shown_mesh *s = source;
    const tc_mesh_data *mesh = s->mesh;
    for (uint64_t t = first; t < end; t++) {
        const uint32_t *vertices = mesh->triangles + 3 * (t - s->first_triangle);
        const float *corners[3];
        float vectors[4][3];
        for (int c = 0; c < 3; c++) corners[c] = mesh->positions + 3 * (uint64_t)vertices[c];
        facet_normal(corners[0], corners[1], corners[2], vectors[0]);
        for (int c = 0; c < 3; c++) shown_position_f32(s, vertices[c], vectors[1 + c]);
        to = put_bytes(to, vectors, sizeof vectors);
        to = put_bytes(to, &(uint16_t){0}, 2);
    }
    return to;
}

/* Ignores s->soup: in STL every triangle has vertices of its own. */
void stl_write(output *o, const shown_mesh *s) {
    char header[HEADER_BYTES + 4] = "binary STL, tetracubes isosurface";
    for (int n = 0; shown_notes(s, n).name; n++) {
        const size_t used = strlen(header);
        snprintf(header + used, HEADER_BYTES - used, "%s%s=%s", n ? " " : ". ", shown_notes(s, n).name,
                 shown_notes(s, n).value);
    }
    uint32_t count = (uint32_t)s->triangle_count;
    memcpy(header + HEADER_BYTES, &count, sizeof count);
    output_expect(o, sizeof header + (uint64_t)count * TRIANGLE_BYTES);
    output_bytes(o, header, sizeof header);
    output_span(o, triangle_span(s), TRIANGLE_BYTES, encode_triangles, s);
}
