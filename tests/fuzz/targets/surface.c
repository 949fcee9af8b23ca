/* surface.c - what holds of every surface; see surface.h */
#include "surface.h"

#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

tc_context *surface_context(void) {
    static tc_context *context;
    tc_context_options options;
    tc_context_options_init(&options);
    options.engine = TC_ENGINE_REFERENCE;
    if (!context) CHECK(tc_context_create(&options, &context) == TC_OK);
    return context;
}

void surface_check_status(tc_status status) {
    CHECK(status == TC_OK || status == TC_ERROR_ARGUMENT || status == TC_ERROR_DATA || status == TC_ERROR_LIMIT);
    CHECK(status == TC_OK || *tc_message());
}

static void check_mesh(const tc_mesh_data *mesh, int normals) {
    CHECK((mesh->normals != NULL) == (normals && mesh->vertex_count > 0));
    for (uint64_t n = 0; n < 3 * mesh->triangle_count; n++) CHECK(mesh->triangles[n] < mesh->vertex_count);
    for (uint64_t n = 0; n < 3 * mesh->vertex_count; n++) {
        CHECK(isfinite(mesh->positions[n]));
        CHECK(!mesh->normals || fabsf(mesh->normals[n]) <= 1.0001f);
    }
}

static void check_carried(tc_grid *grid, const tc_extract_options *how, tc_type type, const void *values,
                          uint64_t vertex_count) {
    const tc_field field = {.struct_size = sizeof field, .type = type, .components = 1, .values = values};
    float *out = malloc(vertex_count * sizeof *out + 1);
    CHECK(tc_interpolate_field(grid, how, &field, out, vertex_count) == TC_OK);
    CHECK(tc_interpolate_field(grid, how, &field, out, vertex_count + 1) == TC_ERROR_ARGUMENT ||
          vertex_count == UINT64_MAX);
    free(out);
}

uint64_t surface_check(tc_grid *grid, const tc_extract_options *how, tc_type type, const void *values) {
    tc_counts counts = {.struct_size = sizeof counts};
    tc_mesh_data data = {.struct_size = sizeof data};
    tc_mesh *mesh = NULL;
    tc_status counted = tc_count(grid, how, &counts), extracted = tc_extract(grid, how, &mesh);
    surface_check_status(counted);
    CHECK(counted == extracted);
    CHECK((extracted == TC_OK) == (mesh != NULL));
    if (extracted) return 0;
    CHECK(tc_mesh_get(mesh, &data) == TC_OK);
    CHECK(data.vertex_count == counts.vertex_count && data.triangle_count == counts.triangle_count);
    CHECK(data.active_cell_count == counts.active_cell_count);
    check_mesh(&data, how->normals);
    check_carried(grid, how, type, values, data.vertex_count);
    tc_mesh_destroy(mesh);
    return counts.triangle_count;
}

void surface_check_complex(const tc_tetrahedra *complex, uint64_t point_count, uint64_t cell_count) {
    for (uint64_t n = 0; n < complex->tetrahedron_count; n++) {
        for (int v = 0; v < 4; v++) CHECK(complex->tetrahedra[4 * n + (unsigned)v] < point_count);
        CHECK(complex->cells[n] < cell_count);
        CHECK(n == 0 || complex->cells[n] >= complex->cells[n - 1]);
    }
}
