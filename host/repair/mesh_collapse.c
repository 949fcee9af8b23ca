/*
 * mesh_collapse.c - contraction of edges without length; see mesh_collapse.h
 *
 * Method. Clusters: vertices joined by edges whose ends are at one position (union-find). Near triangles have a corner
 * in a cluster, and only these are looked at any further; those with two corners in one cluster are dropped. From every
 * edge of a near triangle that is kept the way leads over its twin, through dropped triangles, from one of their two
 * edges with length to the other, until a kept triangle is met: the two are joined there, corner to corner. The corners
 * at clusters that are joined so, directly or by others, are one vertex of the result: a single fan, so that no vertex
 * is a meeting of several. Edges of three triangles or more are left alone: all corners at their ends stay together.
 */
#include "mesh_collapse.h"

#include "exit_status.h"
#include "failure.h"
#include "mesh_separate.h"

#include <stdlib.h>
#include <string.h>

#define NONE UINT64_MAX

enum { NO_MEMBER = UINT32_MAX };

/* Corner c of near triangle n is number 3 n + c, as is the edge from it to the next corner. */
typedef struct job {
    const float *positions;
    const uint32_t *triangles;
    uint64_t vertex_count, triangle_count;

    uint32_t *clusters; /* union-find of vertices */
    uint32_t *members;  /* number of a vertex among those of clusters, NO_MEMBER of others */
    uint32_t member_count;

    uint64_t *near; /* triangles, rising */
    uint8_t *is_dropped;
    uint64_t near_count;
    uint64_t *first, *around; /* around[first[m]] to around[first[m + 1] - 1]: corners at member m */
    uint64_t *joined;         /* union-find of corners: the least of each is its root */
    uint8_t *is_whole;        /* of members: their corners stay together */

    uint32_t *numbers; /* of vertices that are no members in the result; of members that of their first one */
    uint32_t *ids;     /* of corners that are roots: their vertex in the result */
} job;

/* ------------------------------------------------------------------------------------------------------- clusters */

static uint32_t cluster_of(const job *j, uint32_t v) {
    while (j->clusters[v] != v) v = j->clusters[v] = j->clusters[j->clusters[v]];
    return v;
}

static int is_one_place(const job *j, uint32_t a, uint32_t b) {
    const float *p = j->positions + 3 * (uint64_t)a, *q = j->positions + 3 * (uint64_t)b;
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

static void add_member(job *j, uint32_t v) {
    if (j->members[v] == NO_MEMBER) j->members[v] = j->member_count++;
}

static void find_clusters(job *j) {
    for (uint64_t v = 0; v < j->vertex_count; v++) {
        j->clusters[v] = (uint32_t)v;
        j->members[v] = NO_MEMBER;
    }
    for (uint64_t n = 0; n < 3 * j->triangle_count; n++) {
        uint32_t a = j->triangles[n], b = j->triangles[n % 3 == 2 ? n - 2 : n + 1];
        if (!is_one_place(j, a, b)) continue;
        add_member(j, a);
        add_member(j, b);
        a = cluster_of(j, a);
        b = cluster_of(j, b);
        j->clusters[a > b ? a : b] = a > b ? b : a;
    }
}

/* ---------------------------------------------------------------------------------------------------- near triangles
 */

static int is_member(const job *j, uint32_t v) { return j->members[v] != NO_MEMBER; }

static int is_near(const job *j, uint64_t t) {
    const uint32_t *v = j->triangles + 3 * t;
    return is_member(j, v[0]) || is_member(j, v[1]) || is_member(j, v[2]);
}

static uint32_t vertex_at(const job *j, uint64_t corner) { return j->triangles[3 * j->near[corner / 3] + corner % 3]; }

static uint64_t next_corner(uint64_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

static uint64_t previous_corner(uint64_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

static int is_collapsed(const job *j, uint64_t t) {
    const uint32_t a = cluster_of(j, j->triangles[3 * t]), b = cluster_of(j, j->triangles[3 * t + 1]),
                   c = cluster_of(j, j->triangles[3 * t + 2]);
    return a == b || b == c || c == a;
}

static void *array_of(uint64_t count, size_t bytes) {
    return count < PTRDIFF_MAX / bytes ? calloc((size_t)count + 1, bytes) : NULL;
}

static int find_near(job *j) {
    for (uint64_t t = 0; t < j->triangle_count; t++) j->near_count += (uint64_t)is_near(j, t);
    j->near = array_of(j->near_count, sizeof *j->near);
    j->is_dropped = array_of(j->near_count, 1);
    j->first = array_of(j->member_count + (uint64_t)1, sizeof *j->first);
    j->around = array_of(3 * j->near_count, sizeof *j->around);
    j->joined = array_of(3 * j->near_count, sizeof *j->joined);
    j->is_whole = array_of(j->member_count, 1);
    j->ids = array_of(3 * j->near_count, sizeof *j->ids);
    if (!j->near || !j->is_dropped || !j->first || !j->around || !j->joined || !j->is_whole || !j->ids) return 0;
    uint64_t count = 0;
    for (uint64_t t = 0; t < j->triangle_count; t++)
        if (is_near(j, t)) j->near[count++] = t;
    for (uint64_t n = 0; n < count; n++) j->is_dropped[n] = (uint8_t)is_collapsed(j, j->near[n]);
    return 1;
}

/* A counting sort of the corners by member: first[m] runs from where m begins to where it ends, so it begins one later.
 */
static void find_fans(job *j) {
    uint64_t *end = j->first + 1, sum = 0;
    for (uint64_t c = 0; c < 3 * j->near_count; c++)
        if (is_member(j, vertex_at(j, c))) end[j->members[vertex_at(j, c)]]++;
    for (uint32_t m = 0; m < j->member_count; m++) {
        uint64_t count = end[m];
        end[m] = sum;
        sum += count;
    }
    for (uint64_t c = 0; c < 3 * j->near_count; c++)
        if (is_member(j, vertex_at(j, c))) j->around[end[j->members[vertex_at(j, c)]]++] = c;
}

/* ----------------------------------------------------------------------------------------------------------- joining
 */

static uint64_t root_of(const job *j, uint64_t corner) {
    while (j->joined[corner] != corner) corner = j->joined[corner] = j->joined[j->joined[corner]];
    return corner;
}

static void join(const job *j, uint64_t a, uint64_t b) {
    if (!is_member(j, vertex_at(j, a)) || !is_member(j, vertex_at(j, b))) return;
    a = root_of(j, a);
    b = root_of(j, b);
    j->joined[a > b ? a : b] = a > b ? b : a;
}

/* The edge of the other triangle, the other way; NONE at a border, and where the edge has not two triangles that pass
 * it in turn: its ends then keep their corners together. */
static uint64_t twin_of(const job *j, uint64_t edge) {
    const uint32_t from = vertex_at(j, edge), to = vertex_at(j, next_corner(edge));
    const uint32_t m = j->members[is_member(j, from) ? from : to];
    uint64_t twin = NONE, same = 0, opposite = 0;
    for (uint64_t n = j->first[m]; n < j->first[m + 1]; n++) {
        const uint64_t edges[2] = {j->around[n], previous_corner(j->around[n])}; /* that begin here, that end here */
        for (int e = 0; e < 2; e++) {
            const uint32_t a = vertex_at(j, edges[e]), b = vertex_at(j, next_corner(edges[e]));
            same += a == from && b == to;
            if (a != to || b != from) continue;
            opposite++;
            twin = edges[e];
        }
    }
    if (same == 1 && opposite < 2) return opposite ? twin : NONE;
    if (is_member(j, from)) j->is_whole[j->members[from]] = 1;
    if (is_member(j, to)) j->is_whole[j->members[to]] = 1;
    return NONE;
}

/* Where the way that enters a dropped triangle by an edge leaves it: its other edge with length. */
static uint64_t way_out(const job *j, uint64_t edge) {
    const uint64_t end = next_corner(edge), third = next_corner(end);
    const int is_at_end = cluster_of(j, vertex_at(j, end)) == cluster_of(j, vertex_at(j, third));
    return is_at_end ? third : end;
}

/* Joins the corner where the edge begins to that of the kept triangle behind it. The way back from there joins those
 * where it ends. */
static void join_over(const job *j, uint64_t edge) {
    uint64_t twin = twin_of(j, edge);
    for (uint64_t n = 0; n < j->near_count && twin != NONE && j->is_dropped[twin / 3]; n++)
        twin = twin_of(j, way_out(j, twin));
    if (twin != NONE && !j->is_dropped[twin / 3]) join(j, edge, next_corner(twin));
}

static void join_corners(job *j) {
    for (uint64_t c = 0; c < 3 * j->near_count; c++) j->joined[c] = c;
    for (uint64_t c = 0; c < 3 * j->near_count; c++) {
        if (j->is_dropped[c / 3]) continue;
        if (is_member(j, vertex_at(j, c)) || is_member(j, vertex_at(j, next_corner(c)))) join_over(j, c);
    }
    for (uint32_t m = 0; m < j->member_count; m++) {
        uint64_t kept = NONE;
        for (uint64_t n = j->first[m]; j->is_whole[m] && n < j->first[m + 1]; n++) {
            if (j->is_dropped[j->around[n] / 3]) continue;
            if (kept != NONE) join(j, kept, j->around[n]);
            kept = j->around[n];
        }
    }
}

/* ------------------------------------------------------------------------------------------------------------ result
 */

static int is_vertex(const job *j, uint64_t corner) {
    return !j->is_dropped[corner / 3] && j->joined[corner] == corner;
}

/* Numbers the vertices of the result in the order of their sources, those of one source by corner. Returns how many. */
static uint64_t number_vertices(job *j) {
    uint64_t count = 0;
    for (uint64_t v = 0; v < j->vertex_count; v++) {
        const uint32_t m = j->members[v];
        j->numbers[v] = (uint32_t)count;
        if (m == NO_MEMBER) count++;
        for (uint64_t n = m == NO_MEMBER ? 1 : j->first[m]; m != NO_MEMBER && n < j->first[m + 1]; n++)
            if (is_vertex(j, j->around[n])) j->ids[j->around[n]] = (uint32_t)count++;
    }
    return count;
}

static void fill_sources(const job *j, uint32_t *sources) {
    for (uint64_t v = 0; v < j->vertex_count; v++) {
        const uint32_t m = j->members[v];
        if (m == NO_MEMBER) *sources++ = (uint32_t)v;
        for (uint64_t n = m == NO_MEMBER ? 1 : j->first[m]; m != NO_MEMBER && n < j->first[m + 1]; n++)
            if (is_vertex(j, j->around[n])) *sources++ = (uint32_t)v;
    }
}

static uint32_t new_vertex(const job *j, uint64_t corner) {
    const uint32_t v = vertex_at(j, corner);
    return is_member(j, v) ? j->ids[root_of(j, corner)] : j->numbers[v];
}

static void fill_triangles(const job *j, uint32_t *to) {
    uint64_t n = 0;
    for (uint64_t t = 0; t < j->triangle_count; t++) {
        const int near = n < j->near_count && j->near[n] == t;
        for (uint64_t c = 0; c < 3 && !(near && j->is_dropped[n]); c++)
            *to++ = near ? new_vertex(j, 3 * n + c) : j->numbers[j->triangles[3 * t + c]];
        n += (uint64_t)near;
    }
}

static int compare_edges(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Edges that are passed several times in one direction, rising, in the memory of the fans; how many there are. */
static uint64_t find_crowded(const job *j) {
    uint64_t *edges = j->around, count = 0, crowded = 0, kept = 0;
    for (uint64_t c = 0; c < 3 * j->near_count; c++)
        if (!j->is_dropped[c / 3]) edges[count++] = (uint64_t)new_vertex(j, c) << 32 | new_vertex(j, next_corner(c));
    qsort(edges, (size_t)count, sizeof *edges, compare_edges);
    for (uint64_t n = 1; n < count; n++) {
        const uint64_t from = edges[n] >> 32, to = edges[n] & UINT32_MAX;
        if (edges[n] == edges[n - 1]) edges[crowded++] = (from < to ? from : to) << 32 | (from < to ? to : from);
    }
    qsort(edges, (size_t)crowded, sizeof *edges, compare_edges);
    for (uint64_t n = 0; n < crowded; n++)
        if (!kept || edges[n] != edges[kept - 1]) edges[kept++] = edges[n];
    return kept;
}

/* Whether it is a vertex whose corners stay together. */
static int is_kept_whole(const job *j, const collapsed_mesh *mesh, uint64_t v) {
    const uint32_t m = j->members[mesh->sources[v]];
    return m != NO_MEMBER && j->is_whole[m];
}

/* Sheets that only dropped triangles held apart get edges of their own, but where the mesh had such edges before. */
static int separate(const job *j, collapsed_mesh *mesh) {
    uint64_t *edges = j->around, count = 0;
    mesh->crowded_edges = find_crowded(j);
    for (uint64_t n = 0; n < mesh->crowded_edges; n++)
        if (!is_kept_whole(j, mesh, edges[n] >> 32) && !is_kept_whole(j, mesh, edges[n] & UINT32_MAX))
            edges[count++] = edges[n];
    return count ? mesh_separate(mesh, edges, count) : 0;
}

static int make_result(job *j, collapsed_mesh *result) {
    for (uint64_t n = 0; n < j->near_count; n++) result->dropped_count += j->is_dropped[n];
    result->triangle_count = j->triangle_count - result->dropped_count;
    result->vertex_count = number_vertices(j);
    if (result->vertex_count > UINT32_MAX)
        return fail(STATUS_FAILED, "without triangles of zero area the mesh has more than 2^32 - 1 vertices");
    result->triangles = array_of(3 * result->triangle_count, sizeof *result->triangles);
    result->sources = array_of(result->vertex_count, sizeof *result->sources);
    if (!result->triangles || !result->sources) return fail(STATUS_FAILED, "out of memory for the smaller mesh");
    fill_sources(j, result->sources);
    fill_triangles(j, result->triangles);
    return separate(j, result);
}

int mesh_collapse(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                  collapsed_mesh *result) {
    job j = {.positions = positions,
             .triangles = triangles,
             .vertex_count = vertex_count,
             .triangle_count = triangle_count,
             .clusters = array_of(vertex_count, sizeof *j.clusters),
             .members = array_of(vertex_count, sizeof *j.members),
             .numbers = array_of(vertex_count, sizeof *j.numbers)};
    int status = 0;
    *result = (collapsed_mesh){0};
    if (!j.clusters || !j.members || !j.numbers) {
        status = fail(STATUS_FAILED, "out of memory to find triangles of zero area among %llu",
                      (unsigned long long)triangle_count);
        goto cleanup;
    }
    find_clusters(&j);
    if (!j.member_count) goto cleanup;
    if (!find_near(&j)) {
        status = fail(STATUS_FAILED, "out of memory for the neighbours of triangles of zero area");
        goto cleanup;
    }
    find_fans(&j);
    join_corners(&j);
    status = make_result(&j, result);
    if (status) collapsed_mesh_release(result);
cleanup:
    free(j.clusters);
    free(j.members);
    free(j.numbers);
    free(j.near);
    free(j.is_dropped);
    free(j.first);
    free(j.around);
    free(j.joined);
    free(j.is_whole);
    free(j.ids);
    return status;
}

void collapsed_mesh_release(collapsed_mesh *mesh) {
    free(mesh->triangles);
    free(mesh->sources);
    *mesh = (collapsed_mesh){0};
}
