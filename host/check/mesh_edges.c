/*
 * mesh_edges.c - half-edges grouped by their lower vertex, those of one vertex sorted by the higher one; see
 * mesh_edges.h
 */
#include "mesh_edges.h"

#include "exit_status.h"
#include "failure.h"

#include <math.h>
#include <stdlib.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

typedef struct half_edge {
    uint32_t higher;
    uint32_t triangle;
    int is_down; /* from the higher vertex to the lower one */
} half_edge;

typedef struct job {
    const float *positions;
    const uint32_t *triangles;
    uint64_t vertex_count, triangle_count;
    double fold_cosine;
    uint64_t *ends; /* of each lower vertex: behind its half-edges */
    half_edge *edges;
} job;

static uint32_t lower_of(uint32_t a, uint32_t b) { return a < b ? a : b; }

static void group(job *j) {
    const uint32_t *t = j->triangles;
    uint64_t sum = 0;
    for (uint64_t n = 0; n < 3 * j->triangle_count; n++) j->ends[lower_of(t[n], t[n / 3 * 3 + (n + 1) % 3])]++;
    for (uint64_t v = 0; v < j->vertex_count; v++) {
        sum += j->ends[v];
        j->ends[v] = sum - j->ends[v];
    }
    for (uint64_t n = 0; n < 3 * j->triangle_count; n++) {
        const uint32_t a = t[n], b = t[n / 3 * 3 + (n + 1) % 3];
        j->edges[j->ends[lower_of(a, b)]++] = (half_edge){a < b ? b : a, (uint32_t)(n / 3), a > b};
    }
}

static int compare(const void *a, const void *b) {
    const half_edge *x = a, *y = b;
    return (x->higher > y->higher) - (x->higher < y->higher);
}

static double normal_component(const job *j, uint32_t triangle, int axis) {
    const uint32_t *v = j->triangles + 3 * (uint64_t)triangle;
    const float *a = j->positions + 3 * (uint64_t)v[0], *b = j->positions + 3 * (uint64_t)v[1],
                *c = j->positions + 3 * (uint64_t)v[2];
    const int p = (axis + 1) % 3, q = (axis + 2) % 3;
    return ((double)b[p] - a[p]) * ((double)c[q] - a[q]) - ((double)b[q] - a[q]) * ((double)c[p] - a[p]);
}

static int is_folded(const job *j, uint32_t one, uint32_t other) {
    double product = 0, squares[2] = {0, 0};
    for (int axis = 0; axis < 3; axis++) {
        const double a = normal_component(j, one, axis), b = normal_component(j, other, axis);
        product += a * b;
        squares[0] += a * a;
        squares[1] += b * b;
    }
    return squares[0] > 0 && squares[1] > 0 && product < j->fold_cosine * sqrt(squares[0] * squares[1]);
}

static uint64_t border_hash(const job *j, uint32_t lower, const half_edge *e) {
    float ends[6];
    for (uint64_t k = 0; k < 3; k++) {
        ends[k] = j->positions[3 * (uint64_t)(e->is_down ? e->higher : lower) + k];
        ends[3 + k] = j->positions[3 * (uint64_t)(e->is_down ? lower : e->higher) + k];
    }
    return XXH64(ends, sizeof ends, 0);
}

static void sum_edges(const job *j, mesh_edges *result) {
    for (uint64_t v = 0, first = 0; v < j->vertex_count; first = j->ends[v++]) {
        half_edge *e = j->edges + first;
        const uint64_t count = j->ends[v] - first;
        if (count > 1) qsort(e, (size_t)count, sizeof *e, compare);
        for (uint64_t n = 0, end; n < count; n = end) {
            for (end = n + 1; end < count && e[end].higher == e[n].higher;) end++;
            if (end == n + 1) result->border += border_hash(j, (uint32_t)v, &e[n]);
            if (end == n + 2 && is_folded(j, e[n].triangle, e[n + 1].triangle)) result->folded++;
        }
    }
}

int mesh_edges_find(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                    double fold_cosine, mesh_edges *result) {
    job j = {positions, triangles, vertex_count, triangle_count, fold_cosine, NULL, NULL};
    int status = 0;
    *result = (mesh_edges){0, 0};
    j.ends = calloc((size_t)vertex_count + 1, sizeof *j.ends);
    j.edges = malloc((size_t)(3 * triangle_count + 1) * sizeof *j.edges);
    if (j.ends && j.edges) {
        group(&j);
        sum_edges(&j, result);
    } else {
        status = fail(STATUS_FAILED, "no memory to look at the edges of %llu triangles: 36 bytes each are needed",
                      (unsigned long long)triangle_count);
    }
    free(j.ends);
    free(j.edges);
    return status;
}
