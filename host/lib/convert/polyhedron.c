#include "convert/polyhedron.h"

#include <stdbool.h>
#include <stdlib.h>

enum { CORNERS_ON_STACK = 256, SHELL_SORT_MOST = 1024 };

/* An edge of one face. */
typedef struct side {
    uint32_t low, high; /* points, low < high */
    uint32_t face;      /* of the cell, from 0 */
    uint32_t falls;     /* whether the face passes it from high to low */
} side;

/* A face of the cell in a union-find of faces that share edges, while faces are turned. */
typedef struct turned_face {
    uint32_t parent;
    uint32_t flipped; /* relative to its parent; in the end, to the given winding */
} turned_face;

typedef struct polyhedron {
    const int64_t *offsets, *points; /* offsets: of the cell's faces, one more than these */
    uint32_t face_count, side_count;
    side *sides;
    turned_face *faces;
} polyhedron;

static bool rise(const int64_t *offsets, int64_t n, int64_t last) {
    return offsets[n] >= 0 && offsets[n] <= offsets[n + 1] && offsets[n + 1] <= last;
}

polyhedron_verdict polyhedron_look(const tc_cells *cells, uint64_t c) {
    if (!cells->cell_faces) return POLYHEDRON_NO_FACES;
    const int64_t *starts = cells->cell_faces, *offsets = cells->face_offsets, *points = cells->face_connectivity;
    const int64_t face_count = starts[cells->cell_count];
    if (!rise(starts, (int64_t)c, face_count)) return POLYHEDRON_OFFSETS;
    const int64_t first = starts[c], end = starts[c + 1];
    int64_t corners = 0;
    for (int64_t f = first; f < end; f++) {
        if (!rise(offsets, f, offsets[face_count])) return POLYHEDRON_OFFSETS;
        if ((corners += offsets[f + 1] - offsets[f]) > POLYHEDRON_CORNERS_MOST) return POLYHEDRON_TOO_LARGE;
        for (int64_t n = offsets[f]; n < offsets[f + 1]; n++)
            if (points[n] < 0 || (uint64_t)points[n] >= cells->point_count) return POLYHEDRON_POINT;
    }
    if (!corners) return POLYHEDRON_NO_FACES;
    return end - first > POLYHEDRON_CORNERS_MOST ? POLYHEDRON_TOO_LARGE : POLYHEDRON_GOOD;
}

/* ------------------------------------------------------------------------------------------------- turning of faces */

static int side_compare(const void *a, const void *b) {
    const side *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    return x->high < y->high ? -1 : x->high > y->high;
}

/* Sorts by points: Shell's sort with Ciura's gaps, as most polyhedra have fewer than a hundred sides. */
static void sides_sort(side *sides, uint32_t count) {
    static const uint32_t gaps[] = {301, 132, 57, 23, 10, 4, 1};
    if (count > SHELL_SORT_MOST) {
        qsort(sides, count, sizeof *sides, side_compare);
        return;
    }
    for (size_t g = 0; g < sizeof gaps / sizeof *gaps; g++)
        for (uint32_t n = gaps[g], m; n < count; n++) {
            side moved = sides[n];
            for (m = n; m >= gaps[g] && side_compare(&sides[m - gaps[g]], &moved) > 0; m -= gaps[g])
                sides[m] = sides[m - gaps[g]];
            sides[m] = moved;
        }
}

static void sides_list(polyhedron *p) {
    p->side_count = 0;
    for (uint32_t f = 0; f < p->face_count; f++) {
        const int64_t *face = p->points + p->offsets[f], count = p->offsets[f + 1] - p->offsets[f];
        for (int64_t n = 0; n < count; n++) {
            uint32_t from = (uint32_t)face[n], to = (uint32_t)face[n + 1 < count ? n + 1 : 0];
            if (from == to) continue;
            p->sides[p->side_count++] = (side){from < to ? from : to, from < to ? to : from, f, from > to};
        }
    }
    sides_sort(p->sides, p->side_count);
}

/* The end of the run of sides from n on that have the same points. */
static uint32_t run_end(const polyhedron *p, uint32_t n) {
    uint32_t end = n + 1;
    while (end < p->side_count && side_compare(&p->sides[n], &p->sides[end]) == 0) end++;
    return end;
}

/* Whether every edge is passed as often in one direction as in the other. */
static bool is_closed(const polyhedron *p) {
    for (uint32_t n = 0, end; n < p->side_count; n = end) {
        int64_t balance = 0;
        end = run_end(p, n);
        for (uint32_t m = n; m < end; m++) balance += (p->sides[m].falls ^ p->faces[p->sides[m].face].flipped) ? -1 : 1;
        if (balance) return false;
    }
    return true;
}

/* The root of f in the union-find, and whether f is turned against it; shortens the path. */
static uint32_t face_root(turned_face *faces, uint32_t f, uint32_t *flipped) {
    uint32_t root = f, sum = 0;
    for (; faces[root].parent != root; root = faces[root].parent) sum ^= faces[root].flipped;
    *flipped = sum;
    while (faces[f].parent != root && f != root) {
        uint32_t next = faces[f].parent, own = faces[f].flipped;
        faces[f] = (turned_face){root, sum};
        sum ^= own;
        f = next;
    }
    return root;
}

/* Turns faces so that two faces that share an edge with no third pass it in opposite directions. */
static void faces_turn(polyhedron *p) {
    uint32_t flipped;
    for (uint32_t n = 0, end; n < p->side_count; n = end) {
        end = run_end(p, n);
        const side *a = &p->sides[n], *b = a + 1;
        if (end - n != 2 || a->face == b->face) continue;
        uint32_t flipped_a, flipped_b;
        uint32_t root_a = face_root(p->faces, a->face, &flipped_a), root_b = face_root(p->faces, b->face, &flipped_b);
        if (root_a == root_b) continue;
        uint32_t against = a->falls == b->falls;
        p->faces[root_b] = (turned_face){root_a, against ^ flipped_a ^ flipped_b};
    }
    for (uint32_t f = 0; f < p->face_count; f++) {
        uint32_t root = face_root(p->faces, f, &flipped);
        p->faces[f] = (turned_face){root, flipped};
    }
}

/* ---------------------------------------------------------------------------------------------------------- cutting */

static uint32_t smallest_point(const polyhedron *p) {
    uint32_t smallest = UINT32_MAX;
    for (int64_t n = p->offsets[0]; n < p->offsets[p->face_count]; n++)
        if (p->points[n] < smallest) smallest = (uint32_t)p->points[n];
    return smallest;
}

/* The index in the face of its smallest point; -1 where the face contains the apex. */
static int64_t fan_centre(const int64_t *face, int64_t count, uint32_t apex) {
    int64_t first = 0;
    for (int64_t n = 0; n < count; n++) {
        if (face[n] == apex) return -1;
        if (face[n] < face[first]) first = n;
    }
    return first;
}

/* Returns the number of tetrahedra, written where out is not NULL. */
static int face_cone(const int64_t *face, int64_t count, bool flipped, uint32_t apex, uint32_t (*out)[4]) {
    const int64_t first = count < 3 ? -1 : fan_centre(face, count, apex);
    int made = 0;
    for (int64_t n = 1; first >= 0 && n + 1 < count; n++) {
        uint32_t a = (uint32_t)face[first], b = (uint32_t)face[(first + n) % count],
                 c = (uint32_t)face[(first + n + 1) % count];
        if (a == b || b == c || c == a) continue;
        if (out) out[made][0] = apex, out[made][1] = a, out[made][2] = flipped ? c : b, out[made][3] = flipped ? b : c;
        made++;
    }
    return made;
}

static int cone(const polyhedron *p, uint32_t (*out)[4]) {
    const uint32_t apex = smallest_point(p);
    int made = 0;
    for (uint32_t f = 0; f < p->face_count; f++)
        made += face_cone(p->points + p->offsets[f], p->offsets[f + 1] - p->offsets[f], p->faces[f].flipped & 1, apex,
                          out ? out + made : NULL);
    return made;
}

polyhedron_verdict polyhedron_cut(const tc_cells *cells, uint64_t c, uint32_t (*out)[4], int *tetrahedron_count) {
    side sides[CORNERS_ON_STACK];
    turned_face faces[CORNERS_ON_STACK];
    const int64_t first = cells->cell_faces[c], end = cells->cell_faces[c + 1];
    polyhedron p = {.offsets = cells->face_offsets + first, .points = cells->face_connectivity};
    p.face_count = (uint32_t)(end - first);
    const size_t corners = (size_t)(p.offsets[p.face_count] - p.offsets[0]);
    p.sides = corners <= CORNERS_ON_STACK ? sides : malloc(corners * sizeof *sides);
    p.faces = p.face_count <= CORNERS_ON_STACK ? faces : malloc(p.face_count * sizeof *faces);
    polyhedron_verdict verdict = p.sides && p.faces ? POLYHEDRON_GOOD : POLYHEDRON_NO_MEMORY;
    *tetrahedron_count = 0;
    if (!verdict) {
        for (uint32_t f = 0; f < p.face_count; f++) p.faces[f] = (turned_face){f, 0};
        sides_list(&p);
        bool closed = is_closed(&p);
        if (!closed) {
            faces_turn(&p);
            closed = is_closed(&p);
        }
        verdict = closed ? POLYHEDRON_GOOD : POLYHEDRON_OPEN;
        if (closed) *tetrahedron_count = cone(&p, out);
    }
    if (p.sides != sides) free(p.sides);
    if (p.faces != faces) free(p.faces);
    return verdict;
}
