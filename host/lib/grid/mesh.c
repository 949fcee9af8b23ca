#include "grid/mesh.h"

#include "opencl/context.h"
#include "failure.h"
#include "base/structs.h"

#include <stdlib.h>
#include <string.h>

tc_status mesh_allocate(tc_mesh *mesh, uint64_t vertex_count, uint64_t triangle_count, channel_set made) {
    if (vertex_count > UINT32_MAX)
        return (tc_status)fail(TC_ERROR_LIMIT,
                               "the surface has %llu vertices, and indices of 32 bits reach %lu: extract parts of the "
                               "volume, or stream it (tc_stream)",
                               (unsigned long long)vertex_count, (unsigned long)UINT32_MAX);
    tc_status status = TC_OK;
    for (int channel = 0; channel < CHANNEL_COUNT && !status; channel++)
        if (channel_in(made, channel))
            status = host_block_reserve(&mesh->channels[channel], vertex_count * CHANNEL_BYTES);
    if (!status) status = host_block_reserve(&mesh->triangles, triangle_count * TRIANGLE_BYTES);
    if (status) return status;
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
    mesh->made = made;
    return TC_OK;
}

tc_status mesh_allocate_labelled(tc_mesh *mesh, uint64_t vertex_count, uint64_t triangle_count) {
    tc_status status = mesh_allocate(mesh, vertex_count, triangle_count, POSITIONS_ALONE);
    if (!status) status = host_block_reserve(&mesh->boundary_labels, triangle_count * LABELS_BYTES);
    mesh->has_labels = !status;
    return status;
}

void mesh_clear(tc_mesh *mesh) {
    mesh->has_labels = false;
    mesh->vertex_count = mesh->triangle_count = mesh->active_cell_count = 0;
    mesh->made = 0;
    memset(mesh->origin, 0, sizeof mesh->origin);
    mesh->slab_count = 1;
    mesh->timings = (tc_timings){0};
}

static const float *channel_values(const tc_mesh *mesh, int channel) {
    return mesh->vertex_count && channel_in(mesh->made, channel) ? mesh->channels[channel].memory : NULL;
}

tc_status tc_mesh_get(tc_mesh *mesh, tc_mesh_data *data) {
    tc_status status = struct_clear(data, sizeof *data, "tc_mesh_get: data");
    if (status) return status;
    if (!mesh) return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_mesh_get needs a mesh");
    tc_mesh_data found = {.struct_size = sizeof found,
                          .vertex_count = mesh->vertex_count,
                          .triangle_count = mesh->triangle_count,
                          .active_cell_count = mesh->active_cell_count,
                          .triangles = mesh->triangle_count ? mesh->triangles.memory : NULL,
                          .slab_count = mesh->slab_count,
                          .timings = mesh->timings,
                          .origin = {mesh->origin[0], mesh->origin[1], mesh->origin[2]}};
    if (mesh->has_labels && mesh->triangle_count) found.boundary_labels = mesh->boundary_labels.memory;
    for (int n = 0; n < CHANNEL_COUNT; n++) mesh_values_set(&found, n, channel_values(mesh, n));
    struct_copy_out(data, &found);
    return TC_OK;
}

void tc_mesh_destroy(tc_mesh *mesh) {
    if (!mesh) return;
    for (int channel = 0; channel < CHANNEL_COUNT; channel++) host_block_release(&mesh->channels[channel]);
    host_block_release(&mesh->triangles);
    host_block_release(&mesh->boundary_labels);
    free(mesh);
}
