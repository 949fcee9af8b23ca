/*
 * mesh_summary.c - bounds, degenerate triangles and the hash of a mesh: one pass over each array
 *
 * A triangle is degenerate when the cross product of two of its sides, float positions subtracted and multiplied in
 * double, is exactly zero. A side of length zero makes it so, hence two corners at one position are covered.
 */
#include "mesh_check.h"

#include <math.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

static int is_finite(const float p[3]) { return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]); }

static void extend_bounds(double bounds[2][3], const float p[3]) {
    for (int axis = 0; axis < 3; axis++) {
        if (p[axis] < bounds[0][axis]) bounds[0][axis] = p[axis];
        if (p[axis] > bounds[1][axis]) bounds[1][axis] = p[axis];
    }
}

static int is_degenerate(const float a[3], const float b[3], const float c[3]) {
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)b[axis] - (double)a[axis];
        v[axis] = (double)c[axis] - (double)a[axis];
    }
    return u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0];
}

void mesh_summarize(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                    mesh_summary *result) {
    memset(result, 0, sizeof *result);
    double bounds[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint64_t v = 0; v < vertex_count; v++) {
        if (is_finite(positions + 3 * v))
            extend_bounds(bounds, positions + 3 * v);
        else
            result->nonfinite_vertices++;
    }
    if (result->nonfinite_vertices < vertex_count) memcpy(result->bounds, bounds, sizeof bounds);

    for (uint64_t t = 0; t < triangle_count; t++) {
        const uint32_t *v = triangles + 3 * t;
        if (v[0] >= vertex_count || v[1] >= vertex_count || v[2] >= vertex_count) continue;
        result->degenerate_triangles += (uint64_t)is_degenerate(
            positions + 3 * (uint64_t)v[0], positions + 3 * (uint64_t)v[1], positions + 3 * (uint64_t)v[2]);
    }
}

uint64_t mesh_hash(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count) {
    XXH64_state_t state;
    XXH64_reset(&state, 0);
    if (vertex_count > 0) XXH64_update(&state, positions, vertex_count * 3 * sizeof(float));
    if (triangle_count > 0) XXH64_update(&state, triangles, triangle_count * 3 * sizeof(uint32_t));
    return XXH64_digest(&state);
}
