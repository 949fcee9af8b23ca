#include "expected.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *memory_get(uint64_t count, size_t bytes) {
    void *memory = calloc((size_t)count + 1, bytes);
    if (memory) return memory;
    fprintf(stderr, "no memory for the surface to expect\n");
    exit(EXIT_FAILURE);
}

void expected_begin(expected *e, uint64_t most_bodies, int corner_count) {
    const uint64_t most = most_bodies * (corner_count == 4 ? 4 : 12); /* arcs, and crossed edges, of a body */
    uint32_t places = 16;
    while (places < 2 * most) places *= 2;
    *e = (expected){.place_mask = places - 1};
    e->ends = memory_get(most, sizeof *e->ends);
    e->arcs = memory_get(most, sizeof *e->arcs);
    e->keys = memory_get(places, sizeof *e->keys);
    e->vertices = memory_get(places, sizeof *e->vertices);
}

void expected_free(expected *e) {
    free(e->ends);
    free(e->arcs);
    free(e->keys);
    free(e->vertices);
    *e = (expected){0};
}

/* ------------------------------------------------------------------------------------------------------------ arcs */

static uint64_t key_of(uint32_t a, uint32_t b) { return ((uint64_t)(a < b ? a : b) << 32 | (a < b ? b : a)) + 1; }

/* Where the key is, or goes. */
static uint32_t place_of(const expected *e, uint64_t key) {
    uint32_t place = (uint32_t)(key * 0x9e3779b97f4a7c15u >> 32) & e->place_mask;
    while (e->keys[place] && e->keys[place] != key) place = (place + 1) & e->place_mask;
    return place;
}

uint32_t expected_vertex(const expected *e, uint32_t a, uint32_t b) {
    const uint32_t place = place_of(e, key_of(a, b));
    return e->keys[place] ? e->vertices[place] : UINT32_MAX;
}

static uint32_t vertex_between(expected *e, uint32_t a, uint32_t b) {
    const uint32_t low = a < b ? a : b, high = a < b ? b : a, place = place_of(e, key_of(a, b));
    if (!e->keys[place]) {
        e->keys[place] = key_of(a, b);
        e->vertices[place] = e->vertex_count;
        e->ends[e->vertex_count][0] = low, e->ends[e->vertex_count][1] = high;
        e->vertex_count++;
    }
    return e->vertices[place];
}

static void cross(const double u[3], const double v[3], double out[3]) {
    for (int n = 0; n < 3; n++) out[n] = u[(n + 1) % 3] * v[(n + 2) % 3] - u[(n + 2) % 3] * v[(n + 1) % 3];
}

static double dot(const double u[3], const double v[3]) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

/* The normal of a face that points away from the body. */
static void face_normal(const body *b, const int *ring, double out[3]) {
    double u[3], v[3], away[3] = {0};
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = b->at[ring[1]][axis] - b->at[ring[0]][axis];
        v[axis] = b->at[ring[2]][axis] - b->at[ring[0]][axis];
        for (int n = 0; n < b->corner_count; n++) away[axis] += b->at[ring[0]][axis] - b->at[n][axis];
    }
    cross(u, v, out);
    const double sign = dot(out, away) < 0 ? -1 : 1;
    for (int axis = 0; axis < 3; axis++) out[axis] *= sign;
}

/*
 * Seen from outside, where the surface's normal N points towards the reader, the body lies to the left of an arc:
 * N x arc = -normal of the face, hence arc = N x normal. N is replaced by the sum of the ways from inside to outside
 * along both edges.
 */
static void arc_add(expected *e, const body *b, const double normal[3], const int first[2], const int second[2],
                    bool mirrored) {
    const int *edges[2] = {first, second};
    double along[3] = {0}, outward[3] = {0}, wanted[3];
    for (int n = 0; n < 2; n++)
        for (int axis = 0; axis < 3; axis++) {
            const double p = b->at[edges[n][0]][axis], q = b->at[edges[n][1]][axis];
            along[axis] += n ? p + q : -(p + q);
            outward[axis] += b->inside[edges[n][0]] ? q - p : p - q;
        }
    cross(outward, normal, wanted);
    const bool turned = (dot(along, wanted) < 0) != mirrored;
    const uint32_t p = vertex_between(e, b->samples[first[0]], b->samples[first[1]]);
    const uint32_t q = vertex_between(e, b->samples[second[0]], b->samples[second[1]]);
    e->arcs[e->arc_count++] = (arc){turned ? q : p, turned ? p : q, UINT32_MAX, UINT32_MAX};
}

static void face_add(expected *e, const body *b, const int *ring, int size, bool mirrored) {
    int edges[4][2], count = 0;
    double normal[3];
    for (int n = 0; n < size; n++) {
        const int p = ring[n], q = ring[(n + 1) % size];
        if (b->inside[p] == b->inside[q]) continue;
        edges[count][0] = p, edges[count][1] = q;
        count++;
    }
    if (count == 0) return;
    face_normal(b, ring, normal);
    if (count == 2) arc_add(e, b, normal, edges[0], edges[1], mirrored);
    for (int n = 0; n < 4 && count == 4; n++) /* edges n and n + 1 meet in a corner */
        if (!b->even[edges[n][1]]) arc_add(e, b, normal, edges[n], edges[(n + 1) % 4], mirrored);
}

/* The arcs from `first` on are those of one body: every vertex begins one and ends one. */
static void loops_close(expected *e, uint32_t first) {
    for (uint32_t n = first; n < e->arc_count; n++)
        for (uint32_t m = first; m < e->arc_count; m++)
            if (e->arcs[m].from == e->arcs[n].to) e->arcs[n].next = m;
    for (uint32_t n = first; n < e->arc_count; n++) {
        if (e->arcs[n].loop != UINT32_MAX) continue;
        for (uint32_t m = n; m != UINT32_MAX && e->arcs[m].loop == UINT32_MAX; m = e->arcs[m].next)
            e->arcs[m].loop = e->loop_count;
        e->loop_count++;
    }
}

void expected_add(expected *e, const body *b, bool mirrored) {
    const uint32_t first = e->arc_count;
    int ring[4];
    for (int n = 0; n < b->corner_count; n++)
        for (int m = n + 1; m < b->corner_count && b->corner_count == 4; m++)
            if (b->inside[n] != b->inside[m]) vertex_between(e, b->samples[n], b->samples[m]);
    if (b->corner_count == 4)
        for (int n = 0; n < 4; n++) {
            for (int m = 0; m < 3; m++) ring[m] = (n + m + 1) % 4;
            face_add(e, b, ring, 3, mirrored);
        }
    else
        for (int n = 0; n < 6; n++) {
            const int u = 1 << (n / 2 + 1) % 3, v = 1 << (n / 2 + 2) % 3, start = n % 2 << n / 2;
            ring[0] = start, ring[1] = start | u, ring[2] = start | u | v, ring[3] = start | v;
            face_add(e, b, ring, 4, mirrored);
        }
    loops_close(e, first);
}

/* ----------------------------------------------------------------------------------------------------------- order */

typedef struct ranked {
    uint64_t key;
    uint32_t vertex;
} ranked;

static int ranked_compare(const void *a, const void *b) {
    const ranked *p = a, *q = b;
    return p->key < q->key ? -1 : p->key > q->key;
}

void expected_renumber(expected *e, const uint64_t *keys) {
    ranked *order = memory_get(e->vertex_count, sizeof *order);
    uint32_t *rank = memory_get(e->vertex_count, sizeof *rank);
    uint32_t(*ends)[2] = memory_get(e->vertex_count, sizeof *ends);
    for (uint32_t n = 0; n < e->vertex_count; n++) order[n] = (ranked){keys[n], n};
    qsort(order, e->vertex_count, sizeof *order, ranked_compare);
    for (uint32_t n = 0; n < e->vertex_count; n++) {
        rank[order[n].vertex] = n;
        memcpy(ends[n], e->ends[order[n].vertex], sizeof *ends);
    }
    for (uint32_t n = 0; n < e->arc_count; n++) {
        e->arcs[n].from = rank[e->arcs[n].from];
        e->arcs[n].to = rank[e->arcs[n].to];
    }
    for (uint32_t n = 0; n <= e->place_mask; n++)
        if (e->keys[n]) e->vertices[n] = rank[e->vertices[n]];
    free(order);
    free(rank);
    free(e->ends);
    e->ends = ends;
}

/* ---------------------------------------------------------------------------------------------------------- counts */

static uint32_t set_find(uint32_t *parents, uint32_t n) {
    while (parents[n] != n) n = parents[n] = parents[parents[n]];
    return n;
}

static void set_join(uint32_t *parents, uint32_t a, uint32_t b) {
    parents[set_find(parents, a)] = set_find(parents, b);
}

/* A corner of a loop goes by the arc that begins there. */
static void corners_join(uint32_t *parents, const arc *arcs, uint32_t a, uint32_t b) {
    set_join(parents, a, arcs[b].next);
    set_join(parents, arcs[a].next, b);
}

void expected_finish(expected *e) {
    ranked *order = memory_get(e->arc_count, sizeof *order);
    uint32_t *parents = memory_get(e->arc_count, sizeof *parents);
    uint64_t sides = 0;
    e->conforming = true;
    for (uint32_t n = 0; n < e->arc_count; n++) {
        const arc *a = &e->arcs[n];
        const uint64_t low = a->from < a->to ? a->from : a->to, high = a->from < a->to ? a->to : a->from;
        order[n] = (ranked){low << 32 | high, n};
        parents[n] = n;
        if (a->next == UINT32_MAX) e->conforming = false;
    }
    qsort(order, e->arc_count, sizeof *order, ranked_compare);
    for (uint32_t n = 0, same; n < e->arc_count && e->conforming; n += same, sides++) {
        for (same = 1; n + same < e->arc_count && order[n + same].key == order[n].key;) same++;
        const uint32_t a = order[n].vertex, b = order[same > 1 ? n + 1 : n].vertex;
        e->boundary_edges += same == 1;
        e->conforming = same == 1 || (same == 2 && e->arcs[a].from == e->arcs[b].to);
        if (same == 2) corners_join(parents, e->arcs, a, b);
    }
    for (uint32_t n = 0; n < e->arc_count; n++) e->fans += parents[n] == n;
    e->triangle_count = (uint64_t)e->arc_count - 2 * (uint64_t)e->loop_count;
    e->euler_characteristic = (int64_t)e->vertex_count - (int64_t)sides + (int64_t)e->loop_count;
    free(order);
    free(parents);
}
