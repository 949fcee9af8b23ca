/*
 * surface_normals.c - normals of vertices: the sum of the vector areas of the triangles around each
 *
 * A thread has a range of vertices and goes through the triangles, so that each sum runs in their order, whatever the
 * number of threads. Blocks of triangles that use no vertex of the range, as their least and greatest vertex tell, are
 * passed over: vertices and triangles of a mesh have much the same order.
 */
#include "exit_status.h"
#include "failure.h"
#include "parallel.h"
#include "surface_scene.h"

#include <stdlib.h>

enum { RANGE_LEAST = 1 << 18, RANGES_MOST = 64, BLOCK = 1 << 12 };

/* The least and the greatest vertex of a block of triangles. */
typedef struct block_span {
    uint32_t least, most;
} block_span;

typedef struct normals_job {
    scene *s;
    double scale; /* edges are measured by the size of the surface, so that areas stay within float32 */
    block_span *spans;
    uint64_t block_count, range_count;
    _Atomic uint64_t next_block, next_range;
} normals_job;

static uint64_t block_end(const normals_job *j, uint64_t block) {
    const uint64_t count = j->s->mesh->triangle_count, end = (block + 1) * BLOCK;
    return end < count ? end : count;
}

static void find_spans(void *shared) {
    normals_job *j = shared;
    uint64_t block;
    while ((block = atomic_fetch_add(&j->next_block, 1)) < j->block_count) {
        const uint32_t *at = j->s->mesh->triangles + 3 * BLOCK * block,
                       *end = j->s->mesh->triangles + 3 * block_end(j, block);
        block_span span = {UINT32_MAX, 0};
        for (; at < end; at++) {
            if (*at < span.least) span.least = *at;
            if (*at > span.most) span.most = *at;
        }
        j->spans[block] = span;
    }
}

static void vector_area(const normals_job *j, const uint32_t corners[3], float out[3]) {
    const float *p[3];
    double edges[2][3];
    for (int n = 0; n < 3; n++) p[n] = j->s->mesh->positions + (size_t)3 * corners[n];
    for (int n = 0; n < 2; n++)
        for (int axis = 0; axis < 3; axis++) edges[n][axis] = ((double)p[n + 1][axis] - (double)p[0][axis]) * j->scale;
    for (int axis = 0; axis < 3; axis++) {
        const int y = (axis + 1) % 3, z = (axis + 2) % 3;
        out[axis] = (float)(edges[0][y] * edges[1][z] - edges[0][z] * edges[1][y]);
    }
}

/* Adds what a triangle gives to vertices first to end - 1. */
static void sum_triangle(const normals_job *j, const uint32_t *corners, uint64_t first, uint64_t end) {
    int is_mine[3];
    float area[3];
    for (int n = 0; n < 3; n++) is_mine[n] = corners[n] >= first && corners[n] < end;
    if (!(is_mine[0] | is_mine[1] | is_mine[2])) return;
    vector_area(j, corners, area);
    if (!isfinite(area[0] + area[1] + area[2])) return;
    for (int n = 0; n < 3; n++)
        for (int axis = 0; is_mine[n] && axis < 3; axis++)
            j->s->made_normals[(size_t)3 * corners[n] + (size_t)axis] += area[axis];
}

static void sum_range(const normals_job *j, uint64_t first, uint64_t end) {
    for (uint64_t block = 0; block < j->block_count; block++) {
        if (j->spans[block].most < first || j->spans[block].least >= end) continue;
        for (uint64_t t = BLOCK * block; t < block_end(j, block); t++)
            sum_triangle(j, j->s->mesh->triangles + 3 * t, first, end);
    }
}

static void sum_ranges(void *shared) {
    normals_job *j = shared;
    const uint64_t vertices = j->s->mesh->vertex_count, each = vertices / j->range_count + 1;
    uint64_t n;
    while ((n = atomic_fetch_add(&j->next_range, 1)) < j->range_count) {
        const uint64_t first = n * each;
        if (first < vertices) sum_range(j, first, vertices - first < each ? vertices : first + each);
    }
}

int surface_normals(scene *s) {
    const uint64_t vertices = s->mesh->vertex_count, wanted = vertices / RANGE_LEAST + 1;
    normals_job j = {.s = s,
                     .block_count = s->mesh->triangle_count / BLOCK + 1,
                     .range_count = wanted < RANGES_MOST ? wanted : RANGES_MOST};
    double size = 0;
    s->normals = s->mesh->normals;
    if (s->normals) return 0;
    for (int axis = 0; axis < 3; axis++) size = fmax(size, s->bounds[1][axis] - s->bounds[0][axis]);
    j.scale = size > 0 ? 1 / size : 1;
    s->normals = s->made_normals = calloc((size_t)vertices, 3 * sizeof *s->made_normals);
    j.spans = malloc((size_t)j.block_count * sizeof *j.spans);
    if (s->normals && j.spans) {
        parallel_run(j.block_count, find_spans, &j);
        parallel_run(j.range_count, sum_ranges, &j);
    }
    const int is_done = s->normals && j.spans;
    free(j.spans);
    return is_done ? 0
                   : fail(STATUS_FAILED, "out of memory for the normals of a picture of %llu vertices",
                          (unsigned long long)vertices);
}
