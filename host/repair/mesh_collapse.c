/*
 * mesh_collapse.c - contraction of edges of zero length; see mesh_collapse.h
 *
 * Method.
 *   1. Vertices that edges of zero length join form a set (union-find); they are its members. A triangle with two
 *      corners in one set is dropped. From here on only local triangles are looked at, those with a member as a
 *      corner.
 *   2. From each kept half-edge a walk finds the kept triangle on the other side: over the twin of the half-edge,
 *      through a dropped triangle to the other of its two edges that have a length, over the twin of that, and so on.
 *      The two kept triangles become neighbours there: their corners at the two ends are united.
 *   3. United corners are a fan, and every fan becomes one vertex. So no vertex joins several fans.
 * Where an edge has three triangles or more, nobody knows which of them are neighbours: all corners at its ends stay
 * together.
 */
#include "mesh_collapse.h"

#include "exit_status.h"
#include "failure.h"
#include "half_edges.h"
#include "mesh_separate.h"

enum { NO_MEMBER = UINT32_MAX, UNUSED = UINT32_MAX };

/* Corners and half-edges are those of the local triangles (half_edges.h). */
typedef struct job {
    const float *positions;
    const uint32_t *triangles;
    uint64_t vertex_count, triangle_count;

    uint32_t *sets;    /* union-find over vertices */
    uint32_t *members; /* of vertices: which member it is; NO_MEMBER of those that are in no set */
    uint32_t member_count;

    uint64_t *local; /* triangles, ascending */
    uint8_t *is_dropped;
    uint64_t local_count;
    uint64_t *starts, *corners; /* corners[starts[m]] to corners[starts[m + 1] - 1] are the corners at member m */
    uint64_t *fans;             /* union-find over corners */
    uint8_t *stays_together;    /* of members: whether all their corners are one fan */

    uint32_t *vertex_indices; /* in the result: of vertices that are no members; UNUSED: no kept triangle uses it */
    uint32_t *fan_indices;    /* of corners that are roots: their fan's vertex */
} job;

/* ------------------------------------------------------------------------------------------------- sets of vertices */

static uint32_t set_of(const job *j, uint32_t v) {
    while (j->sets[v] != v) v = j->sets[v] = j->sets[j->sets[v]];
    return v;
}

static int has_zero_length(const job *j, uint32_t a, uint32_t b) {
    const float *p = j->positions + 3 * (uint64_t)a, *q = j->positions + 3 * (uint64_t)b;
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

static void add_member(job *j, uint32_t v) {
    if (j->members[v] == NO_MEMBER) j->members[v] = j->member_count++;
}

static void find_sets(job *j) {
    for (uint64_t v = 0; v < j->vertex_count; v++) {
        j->sets[v] = (uint32_t)v;
        j->members[v] = NO_MEMBER;
    }
    for (uint64_t n = 0; n < 3 * j->triangle_count; n++) {
        uint32_t a = j->triangles[n], b = j->triangles[next_corner(n)];
        if (!has_zero_length(j, a, b)) continue;
        add_member(j, a);
        add_member(j, b);
        a = set_of(j, a);
        b = set_of(j, b);
        j->sets[a > b ? a : b] = a > b ? b : a;
    }
}

/* -------------------------------------------------------------------------------------------------- local triangles */

static int is_member(const job *j, uint32_t v) { return j->members[v] != NO_MEMBER; }

static int is_local(const job *j, uint64_t t) {
    const uint32_t *v = j->triangles + 3 * t;
    return is_member(j, v[0]) || is_member(j, v[1]) || is_member(j, v[2]);
}

static uint32_t vertex_at(const job *j, uint64_t corner) { return j->triangles[3 * j->local[corner / 3] + corner % 3]; }

static int is_collapsed(const job *j, uint64_t t) {
    const uint32_t a = set_of(j, j->triangles[3 * t]), b = set_of(j, j->triangles[3 * t + 1]),
                   c = set_of(j, j->triangles[3 * t + 2]);
    return a == b || b == c || c == a;
}

static int find_local(job *j) {
    for (uint64_t t = 0; t < j->triangle_count; t++) j->local_count += (uint64_t)is_local(j, t);
    j->local = array_allocate(j->local_count, sizeof *j->local);
    j->is_dropped = array_allocate(j->local_count, 1);
    j->starts = array_allocate(j->member_count + (uint64_t)1, sizeof *j->starts);
    j->corners = array_allocate(3 * j->local_count, sizeof *j->corners);
    j->fans = array_allocate(3 * j->local_count, sizeof *j->fans);
    j->stays_together = array_allocate(j->member_count, 1);
    j->fan_indices = array_allocate(3 * j->local_count, sizeof *j->fan_indices);
    if (!j->local || !j->is_dropped || !j->starts || !j->corners || !j->fans || !j->stays_together || !j->fan_indices)
        return 0;
    uint64_t count = 0;
    for (uint64_t t = 0; t < j->triangle_count; t++)
        if (is_local(j, t)) j->local[count++] = t;
    for (uint64_t n = 0; n < count; n++) j->is_dropped[n] = (uint8_t)is_collapsed(j, j->local[n]);
    return 1;
}

/* A counting sort by member. starts[m + 1] is m's cursor: it moves from the start of m's corners to their end, which is
 * the start of those of m + 1. */
static void sort_corners(job *j) {
    uint64_t *cursors = j->starts + 1, sum = 0;
    for (uint64_t c = 0; c < 3 * j->local_count; c++)
        if (is_member(j, vertex_at(j, c))) cursors[j->members[vertex_at(j, c)]]++;
    for (uint32_t m = 0; m < j->member_count; m++) {
        uint64_t count = cursors[m];
        cursors[m] = sum;
        sum += count;
    }
    for (uint64_t c = 0; c < 3 * j->local_count; c++)
        if (is_member(j, vertex_at(j, c))) j->corners[cursors[j->members[vertex_at(j, c)]]++] = c;
}

/* ------------------------------------------------------------------------------------------------------------- fans */

static void unite_corners(const job *j, uint64_t a, uint64_t b) {
    if (is_member(j, vertex_at(j, a)) && is_member(j, vertex_at(j, b))) set_unite(j->fans, a, b);
}

/* The half-edge of the neighbour, in the other direction; NO_INDEX at a border. NO_INDEX too where the edge has several
 * half-edges in one direction; the corners at its ends then stay together. */
static uint64_t twin_of(const job *j, uint64_t half_edge) {
    const uint32_t from = vertex_at(j, half_edge), to = vertex_at(j, next_corner(half_edge));
    const uint32_t m = j->members[is_member(j, from) ? from : to];
    uint64_t twin = NO_INDEX, same = 0, opposite = 0;
    for (uint64_t n = j->starts[m]; n < j->starts[m + 1]; n++) {
        const uint64_t here[2] = {j->corners[n],
                                  previous_corner(j->corners[n])}; /* the one that starts and ends here */
        for (int e = 0; e < 2; e++) {
            const uint32_t a = vertex_at(j, here[e]), b = vertex_at(j, next_corner(here[e]));
            same += a == from && b == to;
            if (a != to || b != from) continue;
            opposite++;
            twin = here[e];
        }
    }
    if (same == 1 && opposite < 2) return opposite ? twin : NO_INDEX;
    if (is_member(j, from)) j->stays_together[j->members[from]] = 1;
    if (is_member(j, to)) j->stays_together[j->members[to]] = 1;
    return NO_INDEX;
}

/* The walk enters a dropped triangle by a half-edge and leaves it by the other one that has a length. */
static uint64_t way_out(const job *j, uint64_t half_edge) {
    const uint64_t end = next_corner(half_edge), third = next_corner(end);
    const int is_at_end = set_of(j, vertex_at(j, end)) == set_of(j, vertex_at(j, third));
    return is_at_end ? third : end;
}

/* Unites the corner at the start of a half-edge with that of the kept triangle on the other side. The walk from there
 * unites the corners at its end. */
static void unite_across(const job *j, uint64_t half_edge) {
    uint64_t twin = twin_of(j, half_edge);
    for (uint64_t n = 0; n < j->local_count && twin != NO_INDEX && j->is_dropped[twin / 3]; n++)
        twin = twin_of(j, way_out(j, twin));
    if (twin != NO_INDEX && !j->is_dropped[twin / 3]) unite_corners(j, half_edge, next_corner(twin));
}

static void find_fans(job *j) {
    for (uint64_t c = 0; c < 3 * j->local_count; c++) j->fans[c] = c;
    for (uint64_t c = 0; c < 3 * j->local_count; c++) {
        if (j->is_dropped[c / 3]) continue;
        if (is_member(j, vertex_at(j, c)) || is_member(j, vertex_at(j, next_corner(c)))) unite_across(j, c);
    }
    for (uint32_t m = 0; m < j->member_count; m++) {
        uint64_t kept = NO_INDEX;
        for (uint64_t n = j->starts[m]; j->stays_together[m] && n < j->starts[m + 1]; n++) {
            if (j->is_dropped[j->corners[n] / 3]) continue;
            if (kept != NO_INDEX) unite_corners(j, kept, j->corners[n]);
            kept = j->corners[n];
        }
    }
}

/* ----------------------------------------------------------------------------------------------------------- result */

static int is_kept_root(const job *j, uint64_t corner) {
    return !j->is_dropped[corner / 3] && j->fans[corner] == corner;
}

/* Marks the vertices of dropped triangles that no kept triangle uses, as those of a spike whose ring became a point. */
static void mark_unused(job *j) {
    uint64_t n = 0;
    for (uint64_t c = 0; c < 3 * j->local_count; c++)
        if (j->is_dropped[c / 3]) j->vertex_indices[vertex_at(j, c)] = UNUSED;
    for (uint64_t t = 0; t < j->triangle_count; t++) {
        const int local = n < j->local_count && j->local[n] == t;
        for (uint64_t c = 0; c < 3 && !(local && j->is_dropped[n]); c++) j->vertex_indices[j->triangles[3 * t + c]] = 0;
        n += (uint64_t)local;
    }
}

static int is_kept_single(const job *j, uint64_t v) {
    return j->members[v] == NO_MEMBER && j->vertex_indices[v] != UNUSED;
}

/* Gives the vertices of the result their indices: in the order of their sources, the fans of one source by their lowest
 * corner. Returns how many there are. */
static uint64_t index_vertices(job *j) {
    uint64_t count = 0;
    for (uint64_t v = 0; v < j->vertex_count; v++) {
        const uint32_t m = j->members[v];
        if (is_kept_single(j, v)) j->vertex_indices[v] = (uint32_t)count++;
        for (uint64_t n = m == NO_MEMBER ? 1 : j->starts[m]; m != NO_MEMBER && n < j->starts[m + 1]; n++)
            if (is_kept_root(j, j->corners[n])) j->fan_indices[j->corners[n]] = (uint32_t)count++;
    }
    return count;
}

static void fill_sources(const job *j, uint32_t *sources) {
    for (uint64_t v = 0; v < j->vertex_count; v++) {
        const uint32_t m = j->members[v];
        if (is_kept_single(j, v)) *sources++ = (uint32_t)v;
        for (uint64_t n = m == NO_MEMBER ? 1 : j->starts[m]; m != NO_MEMBER && n < j->starts[m + 1]; n++)
            if (is_kept_root(j, j->corners[n])) *sources++ = (uint32_t)v;
    }
}

static uint32_t new_vertex(const job *j, uint64_t corner) {
    const uint32_t v = vertex_at(j, corner);
    return is_member(j, v) ? j->fan_indices[set_root(j->fans, corner)] : j->vertex_indices[v];
}

static void fill_triangles(const job *j, uint32_t *to) {
    uint64_t n = 0;
    for (uint64_t t = 0; t < j->triangle_count; t++) {
        const int local = n < j->local_count && j->local[n] == t;
        for (uint64_t c = 0; c < 3 && !(local && j->is_dropped[n]); c++)
            *to++ = local ? new_vertex(j, 3 * n + c) : j->vertex_indices[j->triangles[3 * t + c]];
        n += (uint64_t)local;
    }
}

/* Writes the edges of the result with several half-edges in one direction, ascending, over j->corners, which nothing
 * needs any more. Returns how many there are. */
static uint64_t find_nonmanifold(const job *j) {
    uint64_t *edges = j->corners, count = 0, repeated = 0, kept = 0;
    for (uint64_t c = 0; c < 3 * j->local_count; c++)
        if (!j->is_dropped[c / 3]) edges[count++] = (uint64_t)new_vertex(j, c) << 32 | new_vertex(j, next_corner(c));
    qsort(edges, (size_t)count, sizeof *edges, edge_compare);
    for (uint64_t n = 1; n < count; n++) {
        const uint32_t from = (uint32_t)(edges[n] >> 32), to = (uint32_t)edges[n];
        if (edges[n] == edges[n - 1]) edges[repeated++] = edge_between(from, to);
    }
    qsort(edges, (size_t)repeated, sizeof *edges, edge_compare);
    for (uint64_t n = 0; n < repeated; n++)
        if (!kept || edges[n] != edges[kept - 1]) edges[kept++] = edges[n];
    return kept;
}

/* Whether all corners of the vertex stay together. */
static int is_kept_whole(const job *j, const collapsed_mesh *mesh, uint32_t v) {
    const uint32_t m = j->members[mesh->sources[v]];
    return m != NO_MEMBER && j->stays_together[m];
}

/* Separates the sheets that only dropped triangles held apart. Edges that were not manifold before stay as they are. */
static int separate(const job *j, collapsed_mesh *mesh) {
    uint64_t *edges = j->corners, count = 0;
    mesh->nonmanifold_edges = find_nonmanifold(j);
    for (uint64_t n = 0; n < mesh->nonmanifold_edges; n++)
        if (!is_kept_whole(j, mesh, edge_lower(edges[n])) && !is_kept_whole(j, mesh, edge_higher(edges[n])))
            edges[count++] = edges[n];
    return count ? mesh_separate(mesh, edges, count) : 0;
}

static int make_result(job *j, collapsed_mesh *result) {
    for (uint64_t n = 0; n < j->local_count; n++) result->dropped_count += j->is_dropped[n];
    result->triangle_count = j->triangle_count - result->dropped_count;
    mark_unused(j);
    result->vertex_count = index_vertices(j);
    if (result->vertex_count > UINT32_MAX)
        return fail(STATUS_FAILED, "without triangles of zero area the mesh has more than 2^32 - 1 vertices");
    result->triangles = array_allocate(3 * result->triangle_count, sizeof *result->triangles);
    result->sources = array_allocate(result->vertex_count, sizeof *result->sources);
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
             .sets = array_allocate(vertex_count, sizeof *j.sets),
             .members = array_allocate(vertex_count, sizeof *j.members),
             .vertex_indices = array_allocate(vertex_count, sizeof *j.vertex_indices)};
    int status = 0;
    *result = (collapsed_mesh){0};
    if (!j.sets || !j.members || !j.vertex_indices) {
        status = fail(STATUS_FAILED, "out of memory to find triangles of zero area among %llu",
                      (unsigned long long)triangle_count);
        goto cleanup;
    }
    find_sets(&j);
    if (!j.member_count) goto cleanup;
    if (!find_local(&j)) {
        status = fail(STATUS_FAILED, "out of memory for the neighbours of triangles of zero area");
        goto cleanup;
    }
    sort_corners(&j);
    find_fans(&j);
    status = make_result(&j, result);
    if (status) collapsed_mesh_release(result);
cleanup:
    free(j.sets);
    free(j.members);
    free(j.vertex_indices);
    free(j.local);
    free(j.is_dropped);
    free(j.starts);
    free(j.corners);
    free(j.fans);
    free(j.stays_together);
    free(j.fan_indices);
    return status;
}

void collapsed_mesh_release(collapsed_mesh *mesh) {
    free(mesh->triangles);
    free(mesh->sources);
    *mesh = (collapsed_mesh){0};
}
