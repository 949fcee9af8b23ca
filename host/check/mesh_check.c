/*
 * mesh_check.c - is it a manifold, is it oriented, what is its topology: by looking around every vertex
 *
 * Method. A triangle is seen from each of its corners as (next, previous): it leaves the vertex along the edge to
 * next and comes back along the edge from previous. The corners of all triangles are grouped by vertex with a
 * counting sort. Sorting one vertex's few edge ends by neighbour then shows every edge at the vertex with its
 * triangles and their directions; an edge is counted from its lower end. Corners that share an edge end are united, and
 * what stays apart are different fans. No table of edges is ever made.
 *
 * Memory. Vertices are taken in windows, consecutive runs whose corners fit a buffer. The lowest and highest vertex of
 * every block of triangles is kept, so that a window reads only the blocks that reach into it. Where the order of
 * vertices follows space, as in extracted meshes, all windows together read the triangles about once. In any order they
 * read them at most 33 times: the buffer holds at least a sixteenth of the corners, and two windows in a row together
 * hold more than the buffer does.
 *
 * Components come from a union-find over vertices (Tarjan 1975, path halving; the lower index becomes the root).
 */
#include "mesh_check.h"

#include "exit_status.h"
#include "failure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef BLOCK_TRIANGLES /* a test makes both tiny, to have many of them in a small mesh */
#define BLOCK_TRIANGLES (UINT64_C(1) << 16)
#define WINDOW_CORNERS  (UINT64_C(1) << 23) /* 64 MiB */
#endif

enum { WINDOW_SHARE = 16, INSERTION_SORT_MOST = 48 };

typedef struct corner {
    uint32_t next, previous;
} corner;

typedef struct vertex_range {
    uint32_t first, last; /* inclusive; first > last where there are none */
} vertex_range;

typedef struct mesh {
    const uint32_t *triangles;
    uint64_t triangle_count;
    uint64_t vertex_count; /* that an index can name */
} mesh;

typedef struct workspace {
    uint64_t *starts;     /* of each vertex's corners, in the order of all; see group_corners */
    uint32_t *parents;    /* union-find over vertices */
    vertex_range *blocks; /* vertices used by each block of triangles */
    corner *corners;      /* of one window */
    uint64_t *ends;       /* edge ends of one vertex: neighbour << 32 | corner << 1 | 1 where the edge comes in */
    uint32_t *fans;       /* union-find over the corners of one vertex */
    uint64_t edge_count;
} workspace;

static uint64_t min_u64(uint64_t a, uint64_t b) { return a < b ? a : b; }
static uint64_t max_u64(uint64_t a, uint64_t b) { return a > b ? a : b; }

static uint64_t block_count(const mesh *m) { return (m->triangle_count + BLOCK_TRIANGLES - 1) / BLOCK_TRIANGLES; }

static int is_valid(const mesh *m, const uint32_t v[3]) {
    return v[0] < m->vertex_count && v[1] < m->vertex_count && v[2] < m->vertex_count && v[0] != v[1] && v[1] != v[2] &&
           v[2] != v[0];
}

static uint32_t find_root(uint32_t *parents, uint32_t i) {
    while (parents[i] != i) {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    return i;
}

/* Joins two sets; 1 where they were different ones. */
static uint32_t unite(uint32_t *parents, uint32_t i, uint32_t j) {
    i = find_root(parents, i);
    j = find_root(parents, j);
    if (i == j) return 0;
    if (i < j)
        parents[j] = i;
    else
        parents[i] = j;
    return 1;
}

/* Reads every triangle once: counts each vertex's corners into starts[vertex + 2], joins components, notes the blocks'
 * vertices. */
static void survey_triangles(const mesh *m, workspace *w, mesh_topology *result) {
    for (uint64_t block = 0; block < block_count(m); block++) {
        vertex_range range = {UINT32_MAX, 0};
        uint64_t end = min_u64((block + 1) * BLOCK_TRIANGLES, m->triangle_count);
        for (uint64_t t = block * BLOCK_TRIANGLES; t < end; t++) {
            const uint32_t *v = m->triangles + 3 * t;
            if (!is_valid(m, v)) {
                result->invalid_triangles++;
                continue;
            }
            for (int k = 0; k < 3; k++) {
                w->starts[(uint64_t)v[k] + 2]++;
                if (v[k] < range.first) range.first = v[k];
                if (v[k] > range.last) range.last = v[k];
            }
            unite(w->parents, v[0], v[1]);
            unite(w->parents, v[1], v[2]);
        }
        w->blocks[block] = range;
    }
}

/* Turns the counts in starts into sums: starts[v + 1] becomes where v's corners start. Returns the largest count. */
static uint64_t sum_starts(const mesh *m, workspace *w, uint64_t *used_vertices, uint64_t *components) {
    uint64_t most = 0;
    *used_vertices = *components = 0;
    for (uint64_t v = 0; v < m->vertex_count; v++) {
        uint64_t count = w->starts[v + 2];
        most = max_u64(most, count);
        *used_vertices += count > 0;
        *components += count > 0 && w->parents[v] == v;
        w->starts[v + 2] = w->starts[v + 1] + count;
    }
    return most;
}

/* Fills w->corners with those of vertices first <= v < end. starts[v + 1] is v's cursor: it moves from the start to the
 * end of v's corners, which is the start of those of v + 1, so that afterwards starts[v] is v's start. */
static void group_corners(const mesh *m, workspace *w, uint64_t first, uint64_t end) {
    uint64_t base = w->starts[first];
    for (uint64_t block = 0; block < block_count(m); block++) {
        if (w->blocks[block].last < first || w->blocks[block].first >= end) continue;
        uint64_t block_end = min_u64((block + 1) * BLOCK_TRIANGLES, m->triangle_count);
        for (uint64_t t = block * BLOCK_TRIANGLES; t < block_end; t++) {
            const uint32_t *v = m->triangles + 3 * t;
            if (!is_valid(m, v)) continue;
            for (int k = 0; k < 3; k++) {
                if (v[k] < first || v[k] >= end) continue;
                corner c = {v[(k + 1) % 3], v[(k + 2) % 3]};
                w->corners[w->starts[(uint64_t)v[k] + 1]++ - base] = c;
            }
        }
    }
}

static int compare_u64(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static void sort_u64(uint64_t *values, uint64_t count) {
    if (count > INSERTION_SORT_MOST) {
        qsort(values, count, sizeof *values, compare_u64);
        return;
    }
    for (uint64_t i = 1; i < count; i++) {
        uint64_t value = values[i], j = i;
        for (; j > 0 && values[j - 1] > value; j--) values[j] = values[j - 1];
        values[j] = value;
    }
}

/* The count triangles at one vertex: counts its edges to higher vertices and tells whether it has several fans. */
static void inspect_vertex(workspace *w, uint64_t vertex, const corner *corners, uint32_t count,
                           mesh_topology *result) {
    for (uint32_t i = 0; i < count; i++) {
        /* group_corners has filled them. NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult) */
        w->ends[2 * (uint64_t)i] = (uint64_t)corners[i].next << 32 | (uint64_t)i << 1;
        w->ends[2 * (uint64_t)i + 1] = (uint64_t)corners[i].previous << 32 | (uint64_t)i << 1 | 1;
        w->fans[i] = i;
    }
    uint64_t end_count = 2 * (uint64_t)count;
    sort_u64(w->ends, end_count);

    uint32_t fan_count = count;
    for (uint64_t first = 0, end; first < end_count; first = end) {
        uint64_t neighbour = w->ends[first] >> 32, incoming = 0;
        uint32_t first_corner = (uint32_t)w->ends[first] >> 1;
        for (end = first; end < end_count && w->ends[end] >> 32 == neighbour; end++) {
            incoming += w->ends[end] & 1;
            if (end > first) fan_count -= unite(w->fans, first_corner, (uint32_t)w->ends[end] >> 1);
        }
        if (neighbour < vertex) continue;
        w->edge_count++;
        result->boundary_edges += end - first == 1;
        result->misoriented_edges += end - first == 2 && incoming != 1;
        result->nonmanifold_edges += end - first > 2;
        result->unbalanced_edges += 2 * incoming != end - first;
    }
    result->nonmanifold_vertices += fan_count > 1;
}

/* Takes the vertices window by window; capacity corners fit into one. */
static void inspect_vertices(const mesh *m, workspace *w, uint64_t capacity, mesh_topology *result) {
    for (uint64_t first = 0, end; first < m->vertex_count; first = end) {
        uint64_t base = w->starts[first];
        for (end = first + 1; end < m->vertex_count && w->starts[end + 2] - base <= capacity;) end++;
        group_corners(m, w, first, end);
        /* The workspace is the caller's. NOLINTNEXTLINE(clang-analyzer-unix.Malloc) */
        for (uint64_t v = first; v < end; v++) {
            uint64_t count = w->starts[v + 1] - w->starts[v];
            inspect_vertex(w, v, w->corners + (w->starts[v] - base), (uint32_t)count, result);
        }
    }
}

/* Adds a triangle's area and the signed volume between it and the origin, each times its constant factor. */
static void measure_triangle(const float *a, const float *b, const float *c, double *twice_area, double *six_volumes) {
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)b[axis] - (double)a[axis];
        v[axis] = (double)c[axis] - (double)a[axis];
    }
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double area = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!isfinite(area)) return;
    *twice_area += area;
    *six_volumes += (double)a[0] * n[0] + (double)a[1] * n[1] + (double)a[2] * n[2];
}

/* Sums by block first: the rounding of a sum grows with its length. */
static void measure_mesh(const mesh *m, const float *positions, mesh_topology *result) {
    for (uint64_t first = 0; first < m->triangle_count; first += BLOCK_TRIANGLES) {
        uint64_t end = min_u64(first + BLOCK_TRIANGLES, m->triangle_count);
        double twice_area = 0, six_volumes = 0;
        for (uint64_t t = first; t < end; t++) {
            const uint32_t *v = m->triangles + 3 * t;
            if (!is_valid(m, v)) continue;
            measure_triangle(positions + 3 * (uint64_t)v[0], positions + 3 * (uint64_t)v[1],
                             positions + 3 * (uint64_t)v[2], &twice_area, &six_volumes);
        }
        result->area += twice_area / 2;
        result->volume += six_volumes / 6;
    }
}

static int out_of_memory(uint64_t vertex_count, uint64_t triangle_count) {
    return fail(STATUS_FAILED,
                "no memory to check a mesh of %llu vertices and %llu triangles: about 12 bytes per vertex and 2 per "
                "triangle are needed; free memory or extract without the check",
                (unsigned long long)vertex_count, (unsigned long long)triangle_count);
}

static int allocate_survey(const mesh *m, workspace *w) {
    w->starts = calloc(m->vertex_count + 2, sizeof *w->starts);
    w->parents = malloc((m->vertex_count + 1) * sizeof *w->parents);
    w->blocks = malloc((block_count(m) + 1) * sizeof *w->blocks);
    if (!w->starts || !w->parents || !w->blocks) return out_of_memory(m->vertex_count, m->triangle_count);
    for (uint64_t v = 0; v < m->vertex_count; v++) w->parents[v] = (uint32_t)v;
    return 0;
}

static int allocate_window(const mesh *m, workspace *w, uint64_t capacity, uint64_t most_corners) {
    if (most_corners > INT32_MAX)
        return fail(STATUS_FAILED, "the mesh cannot be checked: %llu triangles share one vertex, more than %d",
                    (unsigned long long)most_corners, INT32_MAX);
    w->corners = malloc(capacity * sizeof *w->corners);
    w->ends = malloc((2 * most_corners + 1) * sizeof *w->ends);
    w->fans = malloc((most_corners + 1) * sizeof *w->fans);
    if (!w->corners || !w->ends || !w->fans) return out_of_memory(m->vertex_count, m->triangle_count);
    return 0;
}

int mesh_check(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
               mesh_topology *result) {
    mesh m = {triangles, triangle_count, min_u64(vertex_count, (uint64_t)UINT32_MAX + 1)};
    workspace w = {0};
    uint64_t used_vertices, most_corners, capacity;
    memset(result, 0, sizeof *result);

    int status = allocate_survey(&m, &w);
    if (status) goto cleanup;
    survey_triangles(&m, &w, result);
    most_corners = sum_starts(&m, &w, &used_vertices, &result->components);
    capacity = max_u64(max_u64(WINDOW_CORNERS, 3 * triangle_count / WINDOW_SHARE), most_corners);
    capacity = min_u64(capacity, 3 * triangle_count + 1);

    status = allocate_window(&m, &w, capacity, most_corners);
    if (status) goto cleanup;
    inspect_vertices(&m, &w, capacity, result);
    measure_mesh(&m, positions, result);
    result->orphan_vertices = vertex_count - used_vertices;
    result->euler_characteristic =
        (int64_t)vertex_count - (int64_t)w.edge_count + (int64_t)(triangle_count - result->invalid_triangles);

cleanup:
    if (status) memset(result, 0, sizeof *result);
    free(w.starts);
    free(w.parents);
    free(w.blocks);
    free(w.corners);
    free(w.ends);
    free(w.fans);
    return status;
}
