/*
 * Sides of triangles are sorted by their vertices, so that the triangles of an edge come together. A fan is a class of
 * triangle corners at one vertex, joined across edges of two triangles (disjoint sets).
 */
#include "topology.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct side {
    uint32_t low, high, corner; /* passed by triangle corner / 3, from its corner `corner % 3` on */
    bool forward;
} side;

static int side_compare(const void *left, const void *right) {
    const side *a = left, *b = right;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    return a->high != b->high ? (a->high < b->high ? -1 : 1) : 0;
}

static uint32_t set_find(uint32_t *parents, uint32_t n) {
    while (parents[n] != n) n = parents[n] = parents[parents[n]];
    return n;
}

static uint32_t corner_next(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

/* The corners of two sides meet crosswise where they run in opposite directions. */
static void sides_join(uint32_t *parents, const side *a, const side *b) {
    uint32_t a0 = a->corner, a1 = corner_next(a0), b0 = b->corner, b1 = corner_next(b0);
    bool crosswise = a->forward != b->forward;
    parents[set_find(parents, a0)] = set_find(parents, crosswise ? b1 : b0);
    parents[set_find(parents, a1)] = set_find(parents, crosswise ? b0 : b1);
}

static void *allocate(uint64_t count, size_t bytes) {
    void *memory = calloc(count + 1, bytes);
    if (memory) return memory;
    fprintf(stderr, "no memory for the topology of a mesh\n");
    exit(EXIT_FAILURE);
}

static double triangle_volume(const float *positions, const uint32_t *corners) {
    double p[3][3];
    for (int n = 0; n < 3; n++)
        for (int axis = 0; axis < 3; axis++) p[n][axis] = (double)positions[3 * (uint64_t)corners[n] + (uint64_t)axis];
    return (p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) - p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
            p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0])) /
           6;
}

static bool triangle_is_bad(const uint32_t *t, uint64_t vertex_count) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || t[0] >= vertex_count || t[1] >= vertex_count ||
           t[2] >= vertex_count;
}

static uint64_t edges_count(const side *sides, uint64_t side_count, uint32_t *parents, topology *result) {
    uint64_t edges = 0;
    for (uint64_t n = 0, end; n < side_count; n = end, edges++) {
        for (end = n + 1; end < side_count && !side_compare(&sides[n], &sides[end]); end++) {
        }
        if (end - n == 1) result->boundary_edges++;
        if (end - n > 2 || (end - n == 2 && sides[n].forward == sides[n + 1].forward)) result->bad_edges++;
        if (end - n == 2) sides_join(parents, &sides[n], &sides[n + 1]);
    }
    return edges;
}

void topology_of(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                 topology *result) {
    side *sides = allocate(3 * triangle_count, sizeof *sides);
    uint32_t *parents = allocate(3 * triangle_count, sizeof *parents);
    uint8_t *used = allocate(vertex_count, 1);
    uint64_t side_count = 0;
    *result = (topology){0};
    for (uint64_t t = 0; t < triangle_count; t++) {
        const uint32_t *corners = triangles + 3 * t;
        if (triangle_is_bad(corners, vertex_count)) {
            result->bad_triangles++;
            continue;
        }
        result->volume += triangle_volume(positions, corners);
        for (uint32_t n = 0; n < 3; n++) {
            uint32_t a = corners[n], b = corners[(n + 1) % 3], corner = (uint32_t)(3 * t) + n;
            sides[side_count++] = (side){a < b ? a : b, a < b ? b : a, corner, a < b};
            parents[corner] = corner;
            used[a] = 1;
        }
    }
    qsort(sides, side_count, sizeof *sides, side_compare);
    uint64_t edges = edges_count(sides, side_count, parents, result);
    for (uint64_t n = 0; n < side_count; n++) result->fans += parents[sides[n].corner] == sides[n].corner;
    for (uint64_t n = 0; n < vertex_count; n++) result->orphans += !used[n];
    result->euler_characteristic =
        (int64_t)vertex_count - (int64_t)edges + (int64_t)(triangle_count - result->bad_triangles);
    free(sides);
    free(parents);
    free(used);
}
