/*
 * mesh_separate.c - an edge for each sheet; see mesh_separate.h
 *
 * Method. The half-edges of an edge that run up, from its lower vertex to the higher one, are paired with those that
 * run down, at first in any order. Pairs join corners to fans, and every fan becomes a vertex of the result. Half-edges
 * of one edge that lie in the same fans at both ends would be one edge again; unless they are just one pair, they are
 * in conflict.
 *
 * A conflict is resolved by cutting the fan at the lower vertex along all of them: from each half-edge up a walk around
 * the vertex finds the next half-edge down, and these two become a pair. So each part of the fan closes on itself.
 * Fans are only split, never joined: this ends, with no conflict left.
 *
 * Only local triangles, those with a corner at an end of such an edge, are looked at.
 */
#include "mesh_separate.h"

#include "exit_status.h"
#include "failure.h"
#include "half_edges.h"

#include <string.h>

/* A half-edge of an edge. Its index is among those of the local triangles (half_edges.h). */
typedef struct use {
    uint64_t edge;
    uint64_t index;
    int is_down; /* from the higher vertex to the lower one */
} use;

/* An edge to be separated: its uses, those up before those down. */
typedef struct shared_edge {
    uint64_t first, count;
} shared_edge;

typedef struct job {
    const uint32_t *triangles;
    const uint64_t *edges; /* to be separated, ascending */
    uint64_t edge_count;
    uint8_t *is_end; /* of vertices: an end of such an edge, and of no edge that keeps all corners together */
    uint64_t *local; /* triangles, ascending */
    uint64_t local_count;
    use *uses; /* by edge; of one edge those up first */
    uint64_t use_count;
    uint64_t *twins;     /* of half-edges: the one that it is paired with, or NO_INDEX */
    uint64_t *fans;      /* union-find over corners */
    uint8_t *is_touched; /* of roots: whether this pass has cut the fan */
    shared_edge *shared;
    uint64_t shared_count;
    uint64_t *partners; /* of the uses of one shared edge: the use that it becomes a pair with */
} job;

static uint32_t vertex_at(const job *j, uint64_t corner) { return j->triangles[3 * j->local[corner / 3] + corner % 3]; }

/* ---------------------------------------------------------------------------------------------------------- pairing */

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
        if (!pass && !(j->local = array_allocate(count, sizeof *j->local))) return 0;
    }
    j->local_count = count;
    return 1;
}

static int compare_uses(const void *a, const void *b) {
    const use *x = a, *y = b;
    if (x->edge != y->edge) return x->edge < y->edge ? -1 : 1;
    if (x->is_down != y->is_down) return x->is_down - y->is_down;
    return (x->index > y->index) - (x->index < y->index);
}

static void find_uses(job *j) {
    for (uint64_t c = 0; c < 3 * j->local_count; c++) {
        const uint32_t a = vertex_at(j, c), b = vertex_at(j, next_corner(c));
        if (j->is_end[a] || j->is_end[b]) j->uses[j->use_count++] = (use){edge_between(a, b), c, a > b};
    }
    qsort(j->uses, (size_t)j->use_count, sizeof *j->uses, compare_uses);
}

/* The end of the uses of one edge; *up: how many of them run up. */
static uint64_t end_of_edge(const job *j, uint64_t first, uint64_t *up) {
    uint64_t end = first;
    for (*up = 0; end < j->use_count && j->uses[end].edge == j->uses[first].edge; end++) *up += !j->uses[end].is_down;
    return end;
}

static int is_listed(const job *j, uint64_t edge) {
    return bsearch(&edge, j->edges, (size_t)j->edge_count, sizeof edge, edge_compare) != NULL;
}

/* Edges with several half-edges in one direction that are not to be separated keep the corners at their ends together.
 */
static void leave_ends(job *j) {
    for (uint64_t first = 0, end, up; first < j->use_count; first = end) {
        const uint64_t edge = j->uses[first].edge;
        end = end_of_edge(j, first, &up);
        if ((up < 2 && end - first - up < 2) || is_listed(j, edge)) continue;
        j->is_end[edge_lower(edge)] = j->is_end[edge_higher(edge)] = 0;
    }
}

static void pair_half_edges(const job *j, uint64_t a, uint64_t b) {
    j->twins[a] = b;
    j->twins[b] = a;
}

/* Pairs what can be paired, in any order. */
static void pair_uses(job *j) {
    for (uint64_t c = 0; c < 3 * j->local_count; c++) j->twins[c] = NO_INDEX;
    for (uint64_t first = 0, end, up; first < j->use_count; first = end) {
        const uint64_t edge = j->uses[first].edge;
        end = end_of_edge(j, first, &up);
        for (uint64_t n = 0; n < up && first + up + n < end; n++)
            pair_half_edges(j, j->uses[first + n].index, j->uses[first + up + n].index);
        if (is_listed(j, edge) && j->is_end[edge_lower(edge)] && j->is_end[edge_higher(edge)])
            j->shared[j->shared_count++] = (shared_edge){first, end - first};
    }
}

/* ------------------------------------------------------------------------------------------------------------- fans */

static void find_fans(const job *j) {
    for (uint64_t c = 0; c < 3 * j->local_count; c++) j->fans[c] = c;
    for (uint64_t c = 0; c < 3 * j->local_count; c++)
        if (j->twins[c] != NO_INDEX) set_unite(j->fans, c, next_corner(j->twins[c]));
}

static const use *use_at(const job *j, const shared_edge *s, uint64_t n) { return &j->uses[s->first + n]; }

/* The fan that a use belongs to at the lower or the higher vertex of its edge. */
static uint64_t fan_at(const job *j, const use *u, int is_higher) {
    return set_root(j->fans, u->is_down == is_higher ? u->index : next_corner(u->index));
}

/* Whether uses a and b of the edge lie in the same fans at both ends. */
static int have_same_fans(const job *j, const shared_edge *s, uint64_t a, uint64_t b) {
    const use *x = use_at(j, s, a), *y = use_at(j, s, b);
    return fan_at(j, x, 0) == fan_at(j, y, 0) && fan_at(j, x, 1) == fan_at(j, y, 1);
}

/* Whether use a is the first of those with its fans, and these are neither one pair nor a single use. */
static int is_conflict(const job *j, const shared_edge *s, uint64_t a) {
    uint64_t count = 0, last = a;
    for (uint64_t b = 0; b < s->count; b++) {
        if (!have_same_fans(j, s, a, b)) continue;
        if (b < a) return 0;
        last = b;
        count++;
    }
    return count > 2 || (count == 2 && j->twins[use_at(j, s, a)->index] != use_at(j, s, last)->index);
}

/* Walks around the lower vertex, from a half-edge up to the first use down that has the fans of use a. Returns that
 * use; NO_INDEX where the walk ends at a border. */
static uint64_t walk_around(const job *j, const shared_edge *s, uint64_t a, uint64_t half_edge) {
    for (uint64_t n = 0; n < 3 * j->local_count && half_edge != NO_INDEX; n++) {
        const uint64_t end = previous_corner(half_edge);
        for (uint64_t b = a; b < s->count; b++)
            if (use_at(j, s, b)->index == end && have_same_fans(j, s, a, b)) return b;
        half_edge = j->twins[end];
    }
    return NO_INDEX;
}

/* Pairs the uses that have the fans of use a anew: all walks come before any change. Where the fan has a border, one
 * walk ends there and one use down is not found: these two are a pair, or the one that is left lies at the border. */
static void cut_fan(job *j, const shared_edge *s, uint64_t a) {
    uint64_t open_up = NO_INDEX, open_down = NO_INDEX;
    memset(j->partners, 0xff, (size_t)s->count * sizeof *j->partners); /* NO_INDEX */
    for (uint64_t b = a; b < s->count; b++) {
        if (use_at(j, s, b)->is_down || !have_same_fans(j, s, a, b)) continue;
        const uint64_t found = walk_around(j, s, a, use_at(j, s, b)->index);
        j->partners[b] = found;
        if (found == NO_INDEX)
            open_up = b;
        else
            j->partners[found] = b;
    }
    for (uint64_t b = a; b < s->count; b++) {
        if (!have_same_fans(j, s, a, b)) continue;
        if (use_at(j, s, b)->is_down && j->partners[b] == NO_INDEX) open_down = b;
        j->twins[use_at(j, s, b)->index] = NO_INDEX;
    }
    for (uint64_t b = a; b < s->count; b++)
        if (!use_at(j, s, b)->is_down && j->partners[b] != NO_INDEX)
            pair_half_edges(j, use_at(j, s, b)->index, use_at(j, s, j->partners[b])->index);
    if (open_up != NO_INDEX && open_down != NO_INDEX)
        pair_half_edges(j, use_at(j, s, open_up)->index, use_at(j, s, open_down)->index);
}

/* One pass over all shared edges. Returns how many fans were cut. A fan that this pass has cut waits for the next one.
 */
static uint64_t cut_fans(job *j) {
    uint64_t cut_count = 0;
    find_fans(j);
    memset(j->is_touched, 0, (size_t)(3 * j->local_count));
    for (uint64_t n = 0; n < j->shared_count; n++) {
        const shared_edge *s = &j->shared[n];
        for (uint64_t a = 0; a < s->count; a++) {
            const uint64_t half_edge = use_at(j, s, a)->index;
            const uint64_t from = set_root(j->fans, half_edge), to = set_root(j->fans, next_corner(half_edge));
            if (j->is_touched[from] || j->is_touched[to] || !is_conflict(j, s, a)) continue;
            cut_fan(j, s, a);
            j->is_touched[from] = j->is_touched[to] = 1;
            cut_count++;
        }
    }
    return cut_count;
}

/* ----------------------------------------------------------------------------------------------------------- result */

/* Gives the fans their indices as vertices: firsts[v] becomes that of the first fan of vertex v, and offsets[c], of
 * corners that are roots, what their fan adds to it. Returns how many vertices there are. */
static uint64_t index_fans(const job *j, uint64_t vertex_count, uint64_t *firsts, uint32_t *offsets) {
    uint64_t count = 0;
    for (uint64_t c = 0; c < 3 * j->local_count; c++)
        if (j->is_end[vertex_at(j, c)] && set_root(j->fans, c) == c) offsets[c] = (uint32_t)firsts[vertex_at(j, c)]++;
    for (uint64_t v = 0; v < vertex_count; v++) {
        const uint64_t fan_count = firsts[v] ? firsts[v] : 1;
        firsts[v] = count;
        count += fan_count;
    }
    return count;
}

static int replace(job *j, collapsed_mesh *mesh) {
    uint64_t *firsts = array_allocate(mesh->vertex_count, sizeof *firsts), count = 0;
    uint32_t *offsets = array_allocate(3 * j->local_count, sizeof *offsets), *sources = NULL;
    int status = 0;
    if (firsts && offsets) count = index_fans(j, mesh->vertex_count, firsts, offsets);
    if (firsts && offsets) sources = array_allocate(count, sizeof *sources);
    if (!sources || count > UINT32_MAX) {
        status = STATUS_FAILED;
        free(sources);
        goto cleanup;
    }
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        for (uint64_t n = firsts[v]; n < (v + 1 < mesh->vertex_count ? firsts[v + 1] : count); n++)
            sources[n] = mesh->sources[v];
    for (uint64_t t = 0, n = 0; t < mesh->triangle_count; t++) {
        const int is_local = n < j->local_count && j->local[n] == t;
        for (uint64_t c = 0; c < 3; c++) {
            const uint32_t v = mesh->triangles[3 * t + c];
            const uint32_t offset = is_local && j->is_end[v] ? offsets[set_root(j->fans, 3 * n + c)] : 0;
            mesh->triangles[3 * t + c] = (uint32_t)firsts[v] + offset;
        }
        n += (uint64_t)is_local;
    }
    free(mesh->sources);
    mesh->sources = sources;
    mesh->vertex_count = count;
cleanup:
    free(firsts);
    free(offsets);
    return status;
}

int mesh_separate(collapsed_mesh *mesh, const uint64_t *edges, uint64_t edge_count) {
    job j = {.triangles = mesh->triangles,
             .edges = edges,
             .edge_count = edge_count,
             .is_end = array_allocate(mesh->vertex_count, 1)};
    int status = STATUS_FAILED;
    if (!j.is_end) goto cleanup;
    for (uint64_t n = 0; n < edge_count; n++) j.is_end[edge_lower(edges[n])] = j.is_end[edge_higher(edges[n])] = 1;
    if (!find_local(&j, mesh)) goto cleanup;
    j.uses = array_allocate(3 * j.local_count, sizeof *j.uses);
    j.twins = array_allocate(3 * j.local_count, sizeof *j.twins);
    j.fans = array_allocate(3 * j.local_count, sizeof *j.fans);
    j.is_touched = array_allocate(3 * j.local_count, 1);
    j.shared = array_allocate(edge_count, sizeof *j.shared);
    j.partners = array_allocate(3 * j.local_count, sizeof *j.partners);
    if (!j.uses || !j.twins || !j.fans || !j.is_touched || !j.shared || !j.partners) goto cleanup;
    find_uses(&j);
    leave_ends(&j);
    pair_uses(&j);
    for (uint64_t pass = 0; pass < j.use_count && cut_fans(&j); pass++) {
    }
    status = replace(&j, mesh);
    if (!status) mesh->nonmanifold_edges -= j.shared_count;
cleanup:
    free(j.is_end);
    free(j.local);
    free(j.uses);
    free(j.twins);
    free(j.fans);
    free(j.is_touched);
    free(j.shared);
    free(j.partners);
    return status ? fail(status, "no memory, or no numbers, for more vertices where edges have many triangles") : 0;
}
