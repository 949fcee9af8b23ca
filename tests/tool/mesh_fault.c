/*
 * mesh_fault.c - a fault to be found: preloaded into the tool, it damages the first mesh that the library hands out
 *
 * Method: stands before the library's tc_mesh_get (LD_PRELOAD) and changes one item of the first mesh of the process,
 * as MESH_FAULT says: "position" and "normal" by one bit, "triangle" by swapping corners; "winding" does the latter to
 * every mesh, so that the engines still agree. "limit": no mesh is handed out, as if each had too many vertices.
 */
#include "tetracubes.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

tc_status tc_mesh_get(tc_mesh *mesh, tc_mesh_data *data);

static void flip_last_bit(const float *values, uint64_t count) {
    uint32_t bits;
    if (!values || !count) return;
    void *last = (void *)(uintptr_t)(values + 3 * count - 1);
    memcpy(&bits, last, sizeof bits);
    bits ^= 1;
    memcpy(last, &bits, sizeof bits);
}

static void swap_last_corners(const uint32_t *triangles, uint64_t count) {
    if (!count) return;
    uint32_t *last = (uint32_t *)(uintptr_t)(triangles + 3 * (count - 1));
    uint32_t corner = last[0];
    last[0] = last[1];
    last[1] = corner;
}

__attribute__((visibility("default"))) tc_status tc_mesh_get(tc_mesh *mesh, tc_mesh_data *data) {
    static int calls;
    tc_status (*real)(tc_mesh *, tc_mesh_data *) = NULL;
    const char *fault = getenv("MESH_FAULT");
    *(void **)&real = dlsym(RTLD_NEXT, "tc_mesh_get");
    tc_status status = real(mesh, data);
    int first = calls++ == 0;
    if (status || !fault) return status;
    if (!strcmp(fault, "limit")) return TC_ERROR_LIMIT;
    if (first && !strcmp(fault, "position")) flip_last_bit(data->positions, data->vertex_count);
    if (first && !strcmp(fault, "normal")) flip_last_bit(data->normals, data->vertex_count);
    if (first && !strcmp(fault, "triangle")) swap_last_corners(data->triangles, data->triangle_count);
    if (!strcmp(fault, "winding")) swap_last_corners(data->triangles, data->triangle_count);
    return status;
}
