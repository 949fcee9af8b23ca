/*
 * surface_faults.c - corners are grouped by vertex, and those of one vertex sorted; see surface_faults.h
 *
 * Around a vertex. A corner is kept as (next, previous), the other two vertices of its triangle. The triangle across
 * the edge to `previous` has this vertex as its `next`. So a walk from corner to corner goes around the fan: from the
 * one whose `next` is at the border, to the one whose `previous` is, or back to where it began. Where all `next` differ
 * the border's two ends follow from sums: what is in only one of the two lists.
 */
#include "surface_faults.h"

#include "exit_status.h"
#include "failure.h"
#include "half_edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct corner {
    uint32_t next, previous;
} corner;

/* Corners by vertex: those of v are corners[starts[v]] to corners[starts[v + 1] - 1], sorted by `next`. */
typedef struct corner_lists {
    uint64_t *starts;
    corner *corners;
} corner_lists;

typedef struct fan {
    const corner *corners;
    uint64_t count;
    int is_single;                         /* all corners follow each other once around, or from border to border */
    uint32_t border_next, border_previous; /* NO_VERTEX where the walk comes back */
    uint32_t crowded;                      /* a vertex to which several triangles go in one direction, or NO_VERTEX */
} fan;

/* ---------------------------------------------------------------------------------------------------------- corners */

static int compare_corners(const void *a, const void *b) {
    const corner *x = a, *y = b;
    if (x->next != y->next) return x->next < y->next ? -1 : 1;
    return (x->previous > y->previous) - (x->previous < y->previous);
}

static void sort_corners(corner *corners, uint64_t count) {
    enum { INSERTION_SORT_MOST = 48 };
    if (count > INSERTION_SORT_MOST) {
        qsort(corners, (size_t)count, sizeof *corners, compare_corners);
        return;
    }
    for (uint64_t i = 1; i < count; i++) {
        const corner value = corners[i];
        uint64_t j = i;
        for (; j > 0 && compare_corners(&corners[j - 1], &value) > 0; j--) corners[j] = corners[j - 1];
        corners[j] = value;
    }
}

static void corner_lists_release(corner_lists *lists) {
    free(lists->starts);
    free(lists->corners);
    *lists = (corner_lists){0};
}

/* A counting sort by vertex. While it runs starts[v + 1] is v's cursor, which moves from the start to the end of v's
 * corners. */
static int corner_lists_make(uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                             corner_lists *lists) {
    lists->starts = array_allocate(vertex_count + 1, sizeof *lists->starts);
    lists->corners = array_allocate(3 * triangle_count, sizeof *lists->corners);
    if (!lists->starts || !lists->corners) {
        corner_lists_release(lists);
        return fail(STATUS_FAILED, "out of memory for the corners of %llu triangles",
                    (unsigned long long)triangle_count);
    }
    for (uint64_t c = 0; c < 3 * triangle_count; c++) lists->starts[(uint64_t)triangles[c] + 2]++;
    for (uint64_t v = 0; v < vertex_count; v++) lists->starts[v + 2] += lists->starts[v + 1];
    for (uint64_t c = 0; c < 3 * triangle_count; c++)
        lists->corners[lists->starts[(uint64_t)triangles[c] + 1]++] =
            (corner){triangles[next_corner(c)], triangles[previous_corner(c)]};
    for (uint64_t v = 0; v < vertex_count; v++)
        sort_corners(lists->corners + lists->starts[v], lists->starts[v + 1] - lists->starts[v]);
    return 0;
}

/* ------------------------------------------------------------------------------------------------------------- fans */

/* The corner with that `next`; NULL where there is none. */
static const corner *corner_to(const fan *f, uint32_t next) {
    uint64_t low = 0, high = f->count;
    while (low < high) {
        const uint64_t middle = low + (high - low) / 2;
        if (f->corners[middle].next < next)
            low = middle + 1;
        else
            high = middle;
    }
    return low < f->count && f->corners[low].next == next ? &f->corners[low] : NULL;
}

/* Whether the walk from a corner passes all of them and ends behind the border, or where it began. */
static int walk_passes_all(const fan *f, const corner *begin) {
    const corner *at = begin;
    for (uint64_t n = 1; n < f->count; n++)
        if (!(at = corner_to(f, at->previous)) || at == begin) return 0;
    at = corner_to(f, at->previous);
    return f->border_next == NO_VERTEX ? at == begin : !at;
}

static fan fan_of(const corner_lists *lists, uint64_t v) {
    fan f = {
        lists->corners + lists->starts[v], lists->starts[v + 1] - lists->starts[v], 0, NO_VERTEX, NO_VERTEX, NO_VERTEX};
    uint64_t ends = 0, sum = 0;
    for (uint64_t n = 0; n < f.count; n++) {
        if (n && f.corners[n].next == f.corners[n - 1].next) f.crowded = f.corners[n].next;
        sum += (uint64_t)f.corners[n].next - f.corners[n].previous;
        if (corner_to(&f, f.corners[n].previous)) continue;
        f.border_previous = f.corners[n].previous;
        ends++;
    }
    if (!f.count || f.crowded != NO_VERTEX || ends > 1) return f;
    if (ends) f.border_next = (uint32_t)(f.border_previous + sum);
    const corner *begin = ends ? corner_to(&f, f.border_next) : f.corners;
    f.is_single = begin && walk_passes_all(&f, begin) && (ends || f.count > 2);
    return f;
}

/* ------------------------------------------------------------------------------------------------------------ folds */

static void normal_of(const float *positions, uint32_t a, uint32_t b, uint32_t c, double normal[3]) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)positions[3 * (uint64_t)b + (uint64_t)k] - positions[3 * (uint64_t)a + (uint64_t)k];
        v[k] = (double)positions[3 * (uint64_t)c + (uint64_t)k] - positions[3 * (uint64_t)a + (uint64_t)k];
    }
    for (int k = 0; k < 3; k++) normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Of the triangle of a corner at v and the one across its edge to `previous`; looked at from the edge's lower vertex.
 * The checker of results (mesh_edges.h) counts from the cosine on: here a little less is a fold already, so that
 * rounding never makes a fold there alone. */
static int is_folded(const fan *f, const float *positions, uint32_t v, const corner *c, double fold_cosine) {
    static const double margin = 1e-9;
    const corner *across = c->previous > v ? corner_to(f, c->previous) : NULL;
    double one[3], other[3];
    if (!across) return 0;
    normal_of(positions, v, c->next, c->previous, one);
    normal_of(positions, v, across->next, across->previous, other);
    const double lengths = sqrt(dot(one, one) * dot(other, other));
    return lengths > 0 && dot(one, other) < (fold_cosine + margin) * lengths;
}

/* ------------------------------------------------------------------------------------------------------------ shape */

static uint32_t root_of(uint32_t *roots, uint32_t v) {
    while (roots[v] != v) v = roots[v] = roots[roots[v]];
    return v;
}

/* Each vertex gets the lowest one that triangles join it with. */
static void find_roots(uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count, uint32_t *roots) {
    for (uint64_t v = 0; v < vertex_count; v++) roots[v] = (uint32_t)v;
    for (uint64_t c = 0; c < 3 * triangle_count; c++) {
        const uint32_t a = root_of(roots, triangles[c]), b = root_of(roots, triangles[next_corner(c)]);
        roots[a > b ? a : b] = a > b ? b : a;
    }
    for (uint64_t v = 0; v < vertex_count; v++) roots[v] = root_of(roots, (uint32_t)v);
}

void surface_shape_release(surface_shape *s) {
    free(s->border_next);
    free(s->border_previous);
    free(s->roots);
    free(s->balances);
    free(s->triangle_counts);
    *s = (surface_shape){0};
}

static int shape_allocate(surface_shape *s) {
    s->border_next = array_allocate(s->vertex_count, sizeof *s->border_next);
    s->border_previous = array_allocate(s->vertex_count, sizeof *s->border_previous);
    s->roots = array_allocate(s->vertex_count, sizeof *s->roots);
    s->balances = array_allocate(s->vertex_count, sizeof *s->balances);
    s->triangle_counts = array_allocate(s->vertex_count, sizeof *s->triangle_counts);
    if (s->border_next && s->border_previous && s->roots && s->balances && s->triangle_counts) return 0;
    return fail(STATUS_FAILED, "out of memory for the shape of a surface with %llu vertices",
                (unsigned long long)s->vertex_count);
}

static void lock_own_faults(const surface_shape *s, const fan *f, uint32_t v, double fold_cosine, uint8_t *locked) {
    if (f->count && !f->is_single) locked[v] |= 1;
    if (f->crowded != NO_VERTEX) locked[f->crowded] |= 1;
    for (uint64_t n = 0; n < f->count; n++) {
        const corner *c = &f->corners[n];
        if (is_folded(f, s->positions, v, c, fold_cosine)) locked[v] |= 1, locked[c->previous] |= 1;
    }
}

int surface_shape_take(const float *positions, uint64_t vertex_count, const uint32_t *triangles,
                       uint64_t triangle_count, double fold_cosine, uint8_t *locked, surface_shape *s) {
    corner_lists lists = {0};
    *s = (surface_shape){.vertex_count = vertex_count, .positions = positions};
    int status = shape_allocate(s);
    if (!status) status = corner_lists_make(vertex_count, triangles, triangle_count, &lists);
    if (status) return status;
    find_roots(vertex_count, triangles, triangle_count, s->roots);
    for (uint64_t v = 0; v < vertex_count; v++) {
        const fan f = fan_of(&lists, v);
        s->border_next[v] = f.border_next;
        s->border_previous[v] = f.border_previous;
        if (f.count) s->balances[s->roots[v]] += 2;
        lock_own_faults(s, &f, (uint32_t)v, fold_cosine, locked);
    }
    for (uint64_t t = 0; t < triangle_count; t++) {
        s->balances[s->roots[triangles[3 * t]]]--;
        s->triangle_counts[s->roots[triangles[3 * t]]]++;
    }
    corner_lists_release(&lists);
    return 0;
}

/* ----------------------------------------------------------------------------------------------------------- faults */

typedef struct comparison {
    const surface_shape *before;
    double fold_cosine;
    const uint8_t *locked;
    uint8_t *marks;
    corner_lists lists;
    uint32_t *roots;   /* of the surface that is left */
    int64_t *balances; /* by roots of the surface before */
    uint32_t *parts;   /* likewise: components that it is now */
    uint8_t *has_vertex_faults;
} comparison;

/* A locked vertex has all its triangles as they were: what is wrong there was so before. */
static void mark(const comparison *c, uint32_t v) {
    if (!c->locked[v]) c->marks[v] = 1;
}

static void compare_vertex(const comparison *c, uint32_t v) {
    const surface_shape *s = c->before;
    const fan f = fan_of(&c->lists, v);
    if (!f.count && s->border_next[v] == NO_VERTEX) return; /* contracted */
    if (!f.is_single || f.border_next != s->border_next[v] || f.border_previous != s->border_previous[v]) {
        mark(c, v);
        if (f.crowded != NO_VERTEX) mark(c, f.crowded);
    }
    for (uint64_t n = 0; n < f.count; n++) {
        if (!is_folded(&f, s->positions, v, &f.corners[n], c->fold_cosine)) continue;
        mark(c, v);
        mark(c, f.corners[n].previous);
    }
}

/* Marks components that changed where no vertex tells. */
static void compare_components(const comparison *c, surface_faults *out) {
    const surface_shape *s = c->before;
    for (uint64_t v = 0; v < s->vertex_count; v++) {
        const uint32_t root = s->roots[v];
        if (!s->triangle_counts[root] || c->has_vertex_faults[root]) continue;
        if (c->parts[root] == 1 && c->balances[root] == s->balances[root]) continue;
        c->marks[v] = MARK_COMPONENT;
        if (v != root) continue;
        out->components++;
        if (s->triangle_counts[root] < out->smallest) out->smallest = s->triangle_counts[root];
    }
}

static void sum_components(const comparison *c, const uint32_t *triangles, uint64_t triangle_count) {
    const surface_shape *s = c->before;
    find_roots(s->vertex_count, triangles, triangle_count, c->roots);
    for (uint64_t v = 0; v < s->vertex_count; v++) {
        const int is_used = c->lists.starts[v + 1] > c->lists.starts[v];
        if (is_used) c->balances[s->roots[v]] += 2;
        if (is_used && c->roots[v] == v) c->parts[s->roots[v]]++;
        if (c->marks[v]) c->has_vertex_faults[s->roots[v]] = 1;
    }
    for (uint64_t t = 0; t < triangle_count; t++) c->balances[s->roots[triangles[3 * t]]]--;
}

int surface_faults_find(const surface_shape *before, const uint32_t *triangles, uint64_t triangle_count,
                        double fold_cosine, const uint8_t *locked, uint8_t *marks, surface_faults *out) {
    const uint64_t count = before->vertex_count;
    comparison c = {.before = before,
                    .fold_cosine = fold_cosine,
                    .locked = locked,
                    .marks = marks,
                    .roots = array_allocate(count, sizeof *c.roots),
                    .balances = array_allocate(count, sizeof *c.balances),
                    .parts = array_allocate(count, sizeof *c.parts),
                    .has_vertex_faults = array_allocate(count, 1)};
    int status = 0;
    *out = (surface_faults){.smallest = UINT64_MAX};
    if (!c.roots || !c.balances || !c.parts || !c.has_vertex_faults)
        status = fail(STATUS_FAILED, "out of memory to compare surfaces of %llu vertices", (unsigned long long)count);
    if (!status) status = corner_lists_make(count, triangles, triangle_count, &c.lists);
    if (!status) {
        for (uint64_t v = 0; v < count; v++) compare_vertex(&c, (uint32_t)v);
        for (uint64_t v = 0; v < count; v++) out->vertices += marks[v];
        sum_components(&c, triangles, triangle_count);
        compare_components(&c, out);
    }
    corner_lists_release(&c.lists);
    free(c.roots);
    free(c.balances);
    free(c.parts);
    free(c.has_vertex_faults);
    return status;
}
