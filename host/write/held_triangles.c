#include "held_triangles.h"

#include "exit_status.h"
#include "failure.h"

#include <stdlib.h>
#include <string.h>

int held_complete(held_triangles *held, const tc_mesh_data *next, tc_mesh_data *mesh, uint64_t *first_triangle) {
    if (!held->count) return 0;
    for (uint64_t c = 0; c < 3 * held->count; c++)
        if (held->missing[c] < next->vertex_count)
            memcpy(held->corners + 3 * c, next->positions + 3 * (uint64_t)held->missing[c], 3 * sizeof(float));
    *mesh = *next;
    mesh->vertex_count = 3 * held->count;
    mesh->triangle_count = held->count;
    mesh->positions = held->corners;
    mesh->triangles = held->indices;
    *first_triangle = held->first;
    return 1;
}

static int reserve_memory(held_triangles *held, uint64_t count) {
    if (count <= held->capacity) return 0;
    held_release(held);
    held->corners = malloc(count * 9 * sizeof *held->corners);
    held->missing = malloc(count * 3 * sizeof *held->missing);
    held->indices = malloc(count * 3 * sizeof *held->indices);
    if (!held->corners || !held->missing || !held->indices)
        return fail(STATUS_FAILED, "out of memory for triangles between two pieces of a mesh");
    for (uint64_t c = 0; c < 3 * count; c++) held->indices[c] = (uint32_t)c;
    held->capacity = count;
    return 0;
}

int held_take(held_triangles *held, uint64_t first_triangle, tc_mesh_data *piece) {
    uint64_t kept = 0;
    while (kept < 3 * piece->triangle_count && piece->triangles[kept] < piece->vertex_count) kept++;
    kept /= 3;
    held->count = 0;
    const uint64_t count = piece->triangle_count - kept;
    int status = reserve_memory(held, count);
    if (status) return status;
    held->first = first_triangle + kept;
    held->count = count;
    for (uint64_t c = 0; c < 3 * count; c++) {
        const uint32_t vertex = piece->triangles[3 * kept + c];
        const int is_own = vertex < piece->vertex_count;
        held->missing[c] = is_own ? UINT32_MAX : vertex - (uint32_t)piece->vertex_count;
        if (is_own) memcpy(held->corners + 3 * c, piece->positions + 3 * (uint64_t)vertex, 3 * sizeof(float));
    }
    piece->triangle_count = kept;
    return 0;
}

void held_release(held_triangles *held) {
    free(held->corners);
    free(held->missing);
    free(held->indices);
    *held = (held_triangles){0};
}
