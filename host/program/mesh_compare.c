/* mesh_compare.c - comparison of bits, not of numbers: NaN equals itself, -0 differs from 0 */
#include "mesh_compare.h"

#include "vertex_values.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* Index of the first of count tuples, each of so many bytes, that differs; count where none does. */
static uint64_t first_difference(const void *a, const void *b, uint64_t count, size_t tuple) {
    if (count == 0 || memcmp(a, b, count * tuple) == 0) return count;
    uint64_t n = 0;
    while (memcmp((const char *)a + n * tuple, (const char *)b + n * tuple, tuple) == 0) n++;
    return n;
}

enum { TUPLE_TEXT_BYTES = 160 }; /* nine numbers */

static const char *tuple_text(const float *values, int components, char text[TUPLE_TEXT_BYTES]) {
    size_t used = 0;
    text[0] = '\0';
    for (int c = 0; c < components && used < TUPLE_TEXT_BYTES; c++)
        used += (size_t)snprintf(text + used, TUPLE_TEXT_BYTES - used, " %.9g", (double)values[c]);
    return text;
}

static int same_values(const tc_mesh_data *device, const tc_mesh_data *reference, int channel, char *text,
                       size_t bytes) {
    const mesh_channel *c = &mesh_channels[channel];
    const float *d = mesh_values(device, channel), *r = mesh_values(reference, channel);
    const size_t components = (size_t)c->components;
    if (!d != !r) {
        snprintf(text, bytes, "only one engine made %s", c->name);
        return 0;
    }
    uint64_t n = d ? first_difference(d, r, device->vertex_count, components * sizeof *d) : device->vertex_count;
    if (n == device->vertex_count) return 1;
    char of_device[TUPLE_TEXT_BYTES], of_reference[TUPLE_TEXT_BYTES];
    snprintf(text, bytes, "%s %" PRIu64 " is%s on the device,%s in the reference", c->one, n,
             tuple_text(d + components * n, c->components, of_device),
             tuple_text(r + components * n, c->components, of_reference));
    return 0;
}

static int same_triangles(const uint32_t *device, const uint32_t *reference, uint64_t count, char *text, size_t bytes) {
    uint64_t n = first_difference(device, reference, count, 3 * sizeof *device);
    if (n == count) return 1;
    const uint32_t *d = device + 3 * n, *r = reference + 3 * n;
    snprintf(text, bytes,
             "triangle %" PRIu64 " is %" PRIu32 " %" PRIu32 " %" PRIu32 " on the device, %" PRIu32 " %" PRIu32
             " %" PRIu32 " in the reference",
             n, d[0], d[1], d[2], r[0], r[1], r[2]);
    return 0;
}

static int same_labels(const tc_mesh_data *device, const tc_mesh_data *reference, char *text, size_t bytes) {
    const uint32_t *d = device->boundary_labels, *r = reference->boundary_labels;
    if (!d && !r) return 1;
    const uint64_t count = d && r ? device->triangle_count : 0, n = first_difference(d, r, count, 2 * sizeof *d);
    if (d && r && n == count) return 1;
    if (!d || !r)
        snprintf(text, bytes, "only one engine made labels");
    else
        snprintf(text, bytes,
                 "triangle %" PRIu64 " has the labels %" PRIu32 " %" PRIu32 " on the device, %" PRIu32 " %" PRIu32
                 " in the reference",
                 n, d[2 * n], d[2 * n + 1], r[2 * n], r[2 * n + 1]);
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
    for (int channel = 0; channel < CHANNEL_COUNT; channel++)
        if (!same_values(device, reference, channel, text, bytes)) return 0;
    return same_triangles(device->triangles, reference->triangles, device->triangle_count, text, bytes) &&
           same_labels(device, reference, text, bytes);
}
