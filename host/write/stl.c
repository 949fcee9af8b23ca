/*
 * stl.c - STL, binary (3D Systems, 1989)
 *
 * An 80-byte header that does not begin with "solid" (that would make it the text form), the count of triangles as
 * uint32, then 50 bytes per triangle: normal, three corners, attribute count 0. The normal is the triangle's own, by
 * the right-hand rule; zero where the triangle has no area.
 */
#include "formats.h"

#include <math.h>

enum { HEADER_BYTES = 80, TRIANGLE_BYTES = 50 };

static void facet_normal(const float *a, const float *b, const float *c, float normal[3]) {
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)b[axis] - (double)a[axis];
        v[axis] = (double)c[axis] - (double)a[axis];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int axis = 0; axis < 3; axis++) normal[axis] = length > 0 && isfinite(length) ? (float)(n[axis] / length) : 0;
}

static unsigned char *put_triangle(unsigned char *to, const float *positions, const uint32_t v[3]) {
    const float *corners[3];
    float normal[3];
    for (int k = 0; k < 3; k++) corners[k] = positions + 3 * (uint64_t)v[k];
    facet_normal(corners[0], corners[1], corners[2], normal);
    to = put_floats(to, normal, 3);
    for (int k = 0; k < 3; k++) to = put_floats(to, corners[k], 3);
    *to++ = 0;
    *to++ = 0;
    return to;
}

void stl_write(output *o, const tc_mesh_data *mesh, int soup) {
    (void)soup; /* the only form there is */
    unsigned char *header = output_reserve(o, HEADER_BYTES + 4);
    memset(header, 0, HEADER_BYTES);
    strcpy((char *)header, "binary STL, tetracubes isosurface");
    put_u32(header + HEADER_BYTES, (uint32_t)mesh->triangle_count);
    output_advance(o, HEADER_BYTES + 4);

    for (uint64_t t = 0; t < mesh->triangle_count;) {
        uint64_t end = output_block_end(t, mesh->triangle_count, TRIANGLE_BYTES);
        unsigned char *start = output_reserve(o, (size_t)(end - t) * TRIANGLE_BYTES), *to = start;
        for (; t < end; t++) to = put_triangle(to, mesh->positions, mesh->triangles + 3 * t);
        output_advance(o, (size_t)(to - start));
    }
}
