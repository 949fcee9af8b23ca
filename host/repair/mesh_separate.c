/*
 * mesh_separate.c - an edge for each sheet; see mesh_separate.h
 *
 * Method. The triangles that pass an edge in one direction are paired with those that pass it in the other, at first in
 * any order; at a border one may be left alone. Pairs make fans of the corners at a vertex; fans are the vertices of
 * the result. Passages of one edge that share the fans at both ends, and are not just one pair, are in conflict. Then
 * the fan at the lower end is cut at all of them: from each triangle that begins there the way leads around the vertex
 * to the next one that ends there, and these two become a pair. Each part of the fan is thereby closed on itself, a fan
 * of its own. Fans are split only, never joined, so that this comes to an end, with no conflict left.
 *
 * Of the mesh only triangles with a corner at an end of such an edge are looked at.
 */
#include "mesh_separate.h"

#include "exit_status.h"
#include "failure.h"

#include <stdlib.h>
#include <string.h>

#define NONE UINT64_MAX

/* Corner c of local triangle n is number 3 n + c, as is the edge from it to the next corner. */
typedef struct passage {
    uint64_t edge;   /* lower vertex << 32 | higher vertex */
    uint64_t number; /* of the edge that begins at the lower vertex 2 n, else 2 n + 1 */
} passage;

/* An edge to be separated: its passages, those up before those down. */
typedef struct crowd {
    uint64_t first, count;
} crowd;

typedef struct job {
    const uint32_t *triangles;
    const uint64_t *edges; /* to be separated, rising */
    uint64_t edge_count;
    uint8_t *is_end; /* of vertices: of such an edge; none where other edges keep all corners together */
    uint64_t *local; /* triangles with a corner at an end, rising */
    uint64_t local_count;
    passage *passages;
    uint64_t passage_count;
    uint64_t *twins;     /* of edges: the one that it is paired with, or NONE */
    uint64_t *fans;      /* union-find of corners: the least of each is its root */
    uint8_t *is_touched; /* of roots: changed in this pass */
    crowd *crowds;
    uint64_t crowd_count;
    uint64_t *partners; /* of passages of one crowd */
} job;

static uint64_t next_corner(uint64_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

static uint64_t previous_corner(uint64_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

static uint32_t vertex_at(const job *j, uint64_t corner) { return j->triangles[3 * j->local[corner / 3] + corner % 3]; }

static void *array_of(uint64_t count, size_t bytes) {
    return count < PTRDIFF_MAX / bytes ? calloc((size_t)count + 1, bytes) : NULL;
}

/* ----------------------------------------------------------------------------------------------------------- pairing
 */

static int find_local(job *j, const collapsed_mesh *mesh) {
    uint64_t count = 0;
    for (int pass = 0; pass < 2; pass++) {
        count = 0;
        for (uint64_t t = 0; t < mesh->triangle_count; t++) {
            const uint32_t *v = mesh->triangles + 3 * t;
            if (!j->is_end[v[0]] && !j->is_end[v[1]] && !j->is_end[v[2]]) continue;
            if (pass) j->local[count] = t;
            count++;
        }
        if (!pass && !(j->local = array_of(count, sizeof *j->local))) return 0;
    }
    j->local_count = count;
    return 1;
}

static int compare_passages(const void *a, const void *b) {
    const passage *x = a, *y = b;
    if (x->edge != y->edge) return x->edge < y->edge ? -1 : 1;
    if ((x->number & 1) != (y->number & 1)) return x->number & 1 ? 1 : -1;
    return (x->number > y->number) - (x->number < y->number);
}

static void find_passages(job *j) {
    for (uint64_t c = 0; c < 3 * j->local_count; c++) {
        const uint32_t a = vertex_at(j, c), b = vertex_at(j, next_corner(c));
        if (!j->is_end[a] && !j->is_end[b]) continue;
        j->passages[j->passage_count++] =
            (passage){(uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a), c << 1 | (uint64_t)(a > b)};
    }
    qsort(j->passages, (size_t)j->passage_count, sizeof *j->passages, compare_passages);
}

static uint64_t edge_of(const passage *p) { return p->number >> 1; }

static int compare_edges(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* The end of the passages of one edge; *up: how many begin at its lower vertex. */
static uint64_t end_of_edge(const job *j, uint64_t first, uint64_t *up) {
    uint64_t end = first;
    for (*up = 0; end < j->passage_count && j->passages[end].edge == j->passages[first].edge; end++)
        *up += !(j->passages[end].number & 1);
    return end;
}

static int is_listed(const job *j, uint64_t edge) {
    return bsearch(&edge, j->edges, (size_t)j->edge_count, sizeof edge, compare_edges) != NULL;
}

/* Edges that are passed several times in one direction, and are not to be separated, keep the corners at their ends
 * together. */
static void leave_ends(job *j) {
    for (uint64_t first = 0, end, up; first < j->passage_count; first = end) {
        const uint64_t edge = j->passages[first].edge;
        end = end_of_edge(j, first, &up);
        if ((up < 2 && end - first - up < 2) || is_listed(j, edge)) continue;
        j->is_end[edge >> 32] = j->is_end[edge & UINT32_MAX] = 0;
    }
}

/* Pairs what can be paired, in any order. */
static void pair_passages(job *j) {
    for (uint64_t c = 0; c < 3 * j->local_count; c++) j->twins[c] = NONE;
    for (uint64_t first = 0, end, up; first < j->passage_count; first = end) {
        const uint64_t edge = j->passages[first].edge;
        end = end_of_edge(j, first, &up);
        for (uint64_t n = 0; n < up && first + up + n < end; n++) {
            const uint64_t a = edge_of(&j->passages[first + n]), b = edge_of(&j->passages[first + up + n]);
            j->twins[a] = b;
            j->twins[b] = a;
        }
        if (is_listed(j, edge) && j->is_end[edge >> 32] && j->is_end[edge & UINT32_MAX])
            j->crowds[j->crowd_count++] = (crowd){first, end - first};
    }
}

/* -------------------------------------------------------------------------------------------------------------- fans
 */

static uint64_t root_of(const job *j, uint64_t corner) {
    while (j->fans[corner] != corner) corner = j->fans[corner] = j->fans[j->fans[corner]];
    return corner;
}

static void join(const job *j, uint64_t a, uint64_t b) {
    a = root_of(j, a);
    b = root_of(j, b);
    j->fans[a > b ? a : b] = a > b ? b : a;
}

static void find_fans(const job *j) {
    for (uint64_t c = 0; c < 3 * j->local_count; c++) j->fans[c] = c;
    for (uint64_t c = 0; c < 3 * j->local_count; c++)
        if (j->twins[c] != NONE) join(j, c, next_corner(j->twins[c]));
}

static int is_up(const passage *p) { return !(p->number & 1); }

/* Whether two passages of the crowd, by their numbers in it, have the same fans at both ends. */
static int is_together(const job *j, const crowd *c, uint64_t a, uint64_t b) {
    uint64_t ends[2][2];
    for (int n = 0; n < 2; n++) {
        const passage *p = &j->passages[c->first + (n ? b : a)];
        ends[n][!is_up(p)] = root_of(j, edge_of(p));
        ends[n][is_up(p)] = root_of(j, next_corner(edge_of(p)));
    }
    return ends[0][0] == ends[1][0] && ends[0][1] == ends[1][1];
}

/* Whether a is the first of the passages together with it, and these are not one pair, nor one without a partner. */
static int is_conflict(const job *j, const crowd *c, uint64_t a) {
    uint64_t count = 0, last = a;
    for (uint64_t b = 0; b < c->count; b++) {
        if (!is_together(j, c, a, b)) continue;
        if (b < a) return 0;
        last = b;
        count++;
    }
    return count > 2 ||
           (count == 2 && j->twins[edge_of(&j->passages[c->first + a])] != edge_of(&j->passages[c->first + last]));
}

/* From a passage up around the lower vertex to the first passage down of those together with `a`: its number in the
 * crowd; NONE where a border is met. */
static uint64_t way_around(const job *j, const crowd *c, uint64_t a, uint64_t edge) {
    for (uint64_t n = 0; n < 3 * j->local_count && edge != NONE; n++) {
        const uint64_t end = previous_corner(edge);
        for (uint64_t b = a; b < c->count; b++)
            if (edge_of(&j->passages[c->first + b]) == end && is_together(j, c, a, b)) return b;
        edge = j->twins[end];
    }
    return NONE;
}

static void pair(job *j, const crowd *c, uint64_t up, uint64_t down) {
    const uint64_t a = edge_of(&j->passages[c->first + up]), b = edge_of(&j->passages[c->first + down]);
    j->twins[a] = b;
    j->twins[b] = a;
}

/* Pairs the passages together with `a` anew. Where the fan has a border, one way ends there, one passage is not met:
 * these two are a pair, or what is left of them is at the border. */
static void cut_fan(job *j, const crowd *c, uint64_t a) {
    uint64_t open_up = NONE, open_down = NONE;
    memset(j->partners, 0xff, (size_t)c->count * sizeof *j->partners); /* NONE */
    for (uint64_t b = a; b < c->count; b++) {                          /* all ways before any change */
        const passage *p = &j->passages[c->first + b];
        if (!is_up(p) || !is_together(j, c, a, b)) continue;
        const uint64_t met = way_around(j, c, a, edge_of(p));
        j->partners[b] = met;
        if (met == NONE)
            open_up = b;
        else
            j->partners[met] = b;
    }
    for (uint64_t b = a; b < c->count; b++) {
        const passage *p = &j->passages[c->first + b];
        if (!is_together(j, c, a, b)) continue;
        if (!is_up(p) && j->partners[b] == NONE) open_down = b;
        j->twins[edge_of(p)] = NONE;
    }
    for (uint64_t b = a; b < c->count; b++)
        if (is_up(&j->passages[c->first + b]) && j->partners[b] != NONE) pair(j, c, b, j->partners[b]);
    if (open_up != NONE && open_down != NONE) pair(j, c, open_up, open_down);
}

/* One pass over all crowds. Returns how many fans were cut; those that touch one that was cut wait for the next. */
static uint64_t cut_fans(job *j) {
    uint64_t cut_count = 0;
    find_fans(j);
    memset(j->is_touched, 0, (size_t)(3 * j->local_count));
    for (uint64_t n = 0; n < j->crowd_count; n++) {
        const crowd *c = &j->crowds[n];
        for (uint64_t a = 0; a < c->count; a++) {
            const uint64_t edge = edge_of(&j->passages[c->first + a]);
            const uint64_t from = root_of(j, edge), to = root_of(j, next_corner(edge));
            if (j->is_touched[from] || j->is_touched[to] || !is_conflict(j, c, a)) continue;
            cut_fan(j, c, a);
            j->is_touched[from] = j->is_touched[to] = 1;
            cut_count++;
        }
    }
    return cut_count;
}

/* ------------------------------------------------------------------------------------------------------------ result
 */

/* The vertices of the result: ids[v] that of the first fan of a vertex, numbers those of the corners' fans at theirs.
 * Returns how many there are. */
static uint64_t number_fans(const job *j, uint64_t vertex_count, uint64_t *ids, uint32_t *numbers) {
    uint64_t count = 0;
    for (uint64_t c = 0; c < 3 * j->local_count; c++)
        if (j->is_end[vertex_at(j, c)] && root_of(j, c) == c) numbers[c] = (uint32_t)ids[vertex_at(j, c)]++;
    for (uint64_t v = 0; v < vertex_count; v++) {
        const uint64_t fan_count = ids[v] ? ids[v] : 1;
        ids[v] = count;
        count += fan_count;
    }
    return count;
}

static int replace(job *j, collapsed_mesh *mesh) {
    uint64_t *ids = array_of(mesh->vertex_count, sizeof *ids), count = 0;
    uint32_t *numbers = array_of(3 * j->local_count, sizeof *numbers), *sources = NULL;
    int status = 0;
    if (ids && numbers) count = number_fans(j, mesh->vertex_count, ids, numbers);
    if (ids && numbers) sources = array_of(count, sizeof *sources);
    if (!sources || count > UINT32_MAX) {
        status = STATUS_FAILED;
        free(sources);
        goto cleanup;
    }
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        for (uint64_t n = ids[v]; n < (v + 1 < mesh->vertex_count ? ids[v + 1] : count); n++)
            sources[n] = mesh->sources[v];
    for (uint64_t t = 0, n = 0; t < mesh->triangle_count; t++) {
        const int is_local = n < j->local_count && j->local[n] == t;
        for (uint64_t c = 0; c < 3; c++) {
            const uint32_t v = mesh->triangles[3 * t + c];
            const uint32_t fan = is_local && j->is_end[v] ? numbers[root_of(j, 3 * n + c)] : 0;
            mesh->triangles[3 * t + c] = (uint32_t)ids[v] + fan;
        }
        n += (uint64_t)is_local;
    }
    free(mesh->sources);
    mesh->sources = sources;
    mesh->vertex_count = count;
cleanup:
    free(ids);
    free(numbers);
    return status;
}

int mesh_separate(collapsed_mesh *mesh, const uint64_t *edges, uint64_t edge_count) {
    job j = {.triangles = mesh->triangles,
             .edges = edges,
             .edge_count = edge_count,
             .is_end = array_of(mesh->vertex_count, 1)};
    int status = STATUS_FAILED;
    if (!j.is_end) goto cleanup;
    for (uint64_t n = 0; n < edge_count; n++) j.is_end[edges[n] >> 32] = j.is_end[edges[n] & UINT32_MAX] = 1;
    if (!find_local(&j, mesh)) goto cleanup;
    j.passages = array_of(3 * j.local_count, sizeof *j.passages);
    j.twins = array_of(3 * j.local_count, sizeof *j.twins);
    j.fans = array_of(3 * j.local_count, sizeof *j.fans);
    j.is_touched = array_of(3 * j.local_count, 1);
    j.crowds = array_of(edge_count, sizeof *j.crowds);
    j.partners = array_of(3 * j.local_count, sizeof *j.partners);
    if (!j.passages || !j.twins || !j.fans || !j.is_touched || !j.crowds || !j.partners) goto cleanup;
    find_passages(&j);
    leave_ends(&j);
    pair_passages(&j);
    for (uint64_t pass = 0; pass < j.passage_count && cut_fans(&j); pass++) {
    }
    status = replace(&j, mesh);
    if (!status) mesh->crowded_edges -= j.crowd_count;
cleanup:
    free(j.is_end);
    free(j.local);
    free(j.passages);
    free(j.twins);
    free(j.fans);
    free(j.is_touched);
    free(j.crowds);
    free(j.partners);
    return status ? fail(status, "no memory, or no numbers, for more vertices where edges have many triangles") : 0;
}
