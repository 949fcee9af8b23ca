/* mesh_compare.c - comparison of bits, not of numbers: NaN equals itself, -0 differs from 0 */
#include "mesh_compare.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* Index of the first of count triples that differs; count where none does. */
static uint64_t first_difference(const void *a, const void *b, uint64_t count) {
    enum { TRIPLE = 12 };
    if (count == 0 || memcmp(a, b, count * TRIPLE) == 0) return count;
    uint64_t n = 0;
    while (memcmp((const char *)a + n * TRIPLE, (const char *)b + n * TRIPLE, TRIPLE) == 0) n++;
    return n;
}

static int same_vectors(const char *what, const float *device, const float *reference, uint64_t count, char *text,
                        size_t bytes) {
    if (!device != !reference) {
        snprintf(text, bytes, "only one engine made %ss", what);
        return 0;
    }
    uint64_t n = device ? first_difference(device, reference, count) : count;
    if (n == count) return 1;
    const float *d = device + 3 * n, *r = reference + 3 * n;
    snprintf(text, bytes, "%s %" PRIu64 " is %.9g %.9g %.9g on the device, %.9g %.9g %.9g in the reference", what, n,
             (double)d[0], (double)d[1], (double)d[2], (double)r[0], (double)r[1], (double)r[2]);
    return 0;
}

static int same_triangles(const uint32_t *device, const uint32_t *reference, uint64_t count, char *text, size_t bytes) {
    uint64_t n = first_difference(device, reference, count);
    if (n == count) return 1;
    const uint32_t *d = device + 3 * n, *r = reference + 3 * n;
    snprintf(text, bytes,
             "triangle %" PRIu64 " is %" PRIu32 " %" PRIu32 " %" PRIu32 " on the device, %" PRIu32 " %" PRIu32
             " %" PRIu32 " in the reference",
             n, d[0], d[1], d[2], r[0], r[1], r[2]);
    return 0;
}

int meshes_are_same(const tc_mesh_data *device, const tc_mesh_data *reference, char *text, size_t bytes) {
    if (bytes) text[0] = '\0';
    if (device->vertex_count != reference->vertex_count || device->triangle_count != reference->triangle_count ||
        device->active_cell_count != reference->active_cell_count) {
        snprintf(text, bytes,
                 "%" PRIu64 " vertices, %" PRIu64 " triangles, %" PRIu64 " active cells on the device, %" PRIu64
                 ", %" PRIu64 ", %" PRIu64 " in the reference",
                 device->vertex_count, device->triangle_count, device->active_cell_count, reference->vertex_count,
                 reference->triangle_count, reference->active_cell_count);
        return 0;
    }
    return same_vectors("vertex", device->positions, reference->positions, device->vertex_count, text, bytes) &&
           same_vectors("normal", device->normals, reference->normals, device->vertex_count, text, bytes) &&
           same_triangles(device->triangles, reference->triangles, device->triangle_count, text, bytes);
}
