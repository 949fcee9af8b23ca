/*
 * Loops around the faces of a cell, and the disk of triangles in each: hybrid_tables.c for cells of any shape.
 *
 * Walking around a face counter-clockwise, seen from outside the cell, every side of the surface starts where the walk
 * enters the inside and ends where it leaves. On a quadrilateral with four crossings the diagonal joins two corners of
 * one sign, and each of the other two is cut off. Each crossed edge starts one side and ends one, in the other of its
 * two faces, so the sides form loops.
 *
 * A loop is cut by the chords whose squared lengths, between middles of edges, have the least sum; of equal ones the
 * first is taken. No chord may be one of the neighbour's too, as four triangles would meet in it. So chords lie in no
 * face, where that can be. Where it cannot, a chord in a face joins two edges on which the walk, counter-clockwise seen
 * from outside, leaves the side of the isovalue that the face's smallest point is on. Seen from the neighbour the walk
 * enters that side there, so it has no such chord. No shape has a loop that needs another (test_cell_cases).
 */
#include "tables/cell_cases.h"

#include "tables/loop.h"

#include <string.h>

_Static_assert((int)CELL_EDGES_MAX <= (int)LOOP_MOST, "a loop may have all edges of a cell");

enum { CHORD_OWN = 1 << 10, CHORD_SHARED = 1 << 20, NO_EDGE = CELL_EDGES_MAX };

/* Corners of shapes whose edges have about the same length. */
static const uint8_t corner_positions[CELL_OTHER][CELL_CORNERS_MAX][3] = {
    [CELL_TETRAHEDRON] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}},
    [CELL_HEXAHEDRON] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {0, 0, 4}, {4, 0, 4}, {4, 4, 4}, {0, 4, 4}},
    [CELL_WEDGE] = {{0, 0, 0}, {4, 0, 0}, {2, 4, 0}, {0, 0, 4}, {4, 0, 4}, {2, 4, 4}},
    [CELL_PYRAMID] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 4}},
    [CELL_PENTAGONAL_PRISM] =
        {{1, 0, 0}, {5, 0, 0}, {6, 4, 0}, {3, 6, 0}, {0, 4, 0}, {1, 0, 4}, {5, 0, 4}, {6, 4, 4}, {3, 6, 4}, {0, 4, 4}},
    [CELL_HEXAGONAL_PRISM] =
        {{2, 0, 0},
         {6, 0, 0},
         {8, 4, 0},
         {6, 8, 0},
         {2, 8, 0},
         {0, 4, 0},
         {2, 0, 4},
         {6, 0, 4},
         {8, 4, 4},
         {6, 8, 4},
         {2, 8, 4},
         {0, 4, 4}},
};

/* ----------------------------------------------------------------------------------------------------------- frames */

static uint8_t edge_index(const cell_frame *f, uint8_t a, uint8_t b) {
    const uint8_t low = a < b ? a : b, high = a < b ? b : a;
    uint8_t n = 0;
    while (n < f->edge_count && (f->edges[n][0] != low || f->edges[n][1] != high)) n++;
    return n;
}

/* The parts of a face by which loops go: itself, or the triangles of its fan. */
static int part_count(const cell_frame *f, int face) { return f->is_cut[face] ? f->faces[face].corner_count - 2 : 1; }

static cell_face face_part(const cell_frame *f, int face, int n) {
    const uint8_t *corners = f->faces[face].corners;
    return f->is_cut[face] ? (cell_face){3, {corners[0], corners[n + 1], corners[n + 2]}} : f->faces[face];
}

static cell_face face_mirror(const cell_face *f) {
    cell_face out = *f;
    for (int n = 1; n < f->corner_count; n++) out.corners[n] = f->corners[f->corner_count - n];
    return out;
}

/* Leaves out corners whose point stands before; false where no face is left. */
static bool face_contract(const uint32_t *points, cell_face *f) {
    const cell_face all = *f;
    f->corner_count = 0;
    for (int n = 0; n < all.corner_count; n++) {
        uint8_t corner = 0;
        while (points[corner] != points[all.corners[n]]) corner++;
        if (!f->corner_count || f->corners[f->corner_count - 1] != corner) f->corners[f->corner_count++] = corner;
    }
    if (f->corner_count > 1 && f->corners[f->corner_count - 1] == f->corners[0]) f->corner_count--;
    return f->corner_count > 2;
}

void cell_frame_begin(cell_shape shape, const uint32_t points[CELL_CORNERS_MAX], bool mirrored, cell_frame *out) {
    *out = (cell_frame){.shape = shape};
    cell_face faces[CELL_FACES_MAX];
    const int count = cell_faces(shape, points, faces);
    for (int n = 0; n < count; n++) {
        if (!face_contract(points, &faces[n])) continue;
        out->is_cut[out->face_count] = faces[n].corner_count > 4;
        out->faces[out->face_count++] = mirrored ? face_mirror(&faces[n]) : faces[n];
    }
}

void cell_frame_end(cell_frame *frame) {
    uint16_t highs[CELL_CORNERS_MAX] = {0}; /* by the lower corner of an edge, a bit for the other */
    for (int n = 0; n < frame->face_count; n++)
        for (int part = 0; part < part_count(frame, n); part++) {
            const cell_face f = face_part(frame, n, part);
            for (int m = 0; m < f.corner_count; m++) {
                const uint8_t a = f.corners[m], b = f.corners[(m + 1) % f.corner_count];
                highs[a < b ? a : b] |= (uint16_t)(1u << (a < b ? b : a));
            }
        }
    for (uint8_t a = 0; a < CELL_CORNERS_MAX; a++)
        for (uint8_t b = a; b < CELL_CORNERS_MAX; b++)
            if (highs[a] >> b & 1) memcpy(frame->edges[frame->edge_count++], (uint8_t[2]){a, b}, 2);
}

/* ------------------------------------------------------------------------------------------------------------ loops */

typedef struct derivation {
    const cell_frame *frame;
    unsigned pattern;
    uint8_t next[CELL_EDGES_MAX];                   /* the edge that follows in the loop */
    int32_t chords[CELL_EDGES_MAX][CELL_EDGES_MAX]; /* added to a chord's squared length */
} derivation;

/* 1 where an edge goes from a corner outside to one inside, -1 the other way. */
static int step_between(const derivation *d, uint8_t a, uint8_t b) {
    return (int)(d->pattern >> b & 1) - (int)(d->pattern >> a & 1);
}

/* Enters the sides of the surface in a face, or in a triangle of its fan. */
static void sides_enter(derivation *d, const cell_face *f) {
    const int count = f->corner_count;
    uint8_t around[4] = {0};
    int steps[4] = {0}, crossed = 0;
    for (int n = 0; n < count; n++) {
        const uint8_t a = f->corners[n], b = f->corners[(n + 1) % count];
        around[n] = edge_index(d->frame, a, b);
        steps[n] = step_between(d, a, b);
        crossed += steps[n] != 0;
    }
    for (int n = 0; n < count; n++) {
        if (steps[n] != 1) continue;
        int end = (n + 1) % count;                           /* cuts off the corner inside */
        if (crossed == 4 && end % 2 == 0) end = (n + 3) % 4; /* unless the diagonal joins it to another */
        while (steps[end] != -1) end = (end + 1) % count;
        d->next[around[n]] = around[end];
    }
}

/* What chords in a face cost, between edges around it and those that cut it. */
static void chords_mark(derivation *d, const cell_face *f, bool is_cut) {
    const int count = f->corner_count, smallest = (int)(d->pattern >> f->corners[0] & 1);
    uint8_t edges[2 * CELL_FACE_CORNERS_MAX] = {0};
    int edge_count = 0, leaves[2 * CELL_FACE_CORNERS_MAX] = {0};
    for (int n = 0; n < count; n++) {
        const uint8_t a = f->corners[n], b = f->corners[(n + 1) % count];
        leaves[edge_count] = step_between(d, a, b) == (smallest ? -1 : 1);
        edges[edge_count++] = edge_index(d->frame, a, b);
    }
    for (int n = 2; n + 1 < count && is_cut; n++)
        edges[edge_count++] = edge_index(d->frame, f->corners[0], f->corners[n]);
    for (int n = 0; n < edge_count; n++)
        for (int m = 0; m < edge_count; m++)
            d->chords[edges[n]][edges[m]] = leaves[n] && leaves[m] ? CHORD_OWN : CHORD_SHARED;
}

static int32_t cell_chord_cost(const void *context, uint8_t a, uint8_t b) {
    const derivation *d = context;
    const uint8_t *p = d->frame->edges[a], *q = d->frame->edges[b];
    int32_t cost = d->chords[a][b];
    for (int axis = 0; axis < 3; axis++) {
        const uint8_t(*at)[3] = corner_positions[d->frame->shape];
        const int difference = at[p[0]][axis] + at[p[1]][axis] - at[q[0]][axis] - at[q[1]][axis];
        cost += difference * difference;
    }
    return cost;
}

void cell_case_derive(const cell_frame *frame, unsigned pattern, cell_case *out) {
    derivation d = {.frame = frame, .pattern = pattern};
    memset(d.next, NO_EDGE, sizeof d.next);
    *out = (cell_case){0};
    for (int n = 0; n < frame->face_count; n++) {
        chords_mark(&d, &frame->faces[n], frame->is_cut[n]);
        for (int part = 0; part < part_count(frame, n); part++) {
            const cell_face f = face_part(frame, n, part);
            sides_enter(&d, &f);
        }
    }
    for (int start = 0; start < frame->edge_count; start++) {
        uint8_t loop[CELL_EDGES_MAX];
        int loop_count = 0;
        for (uint8_t edge = (uint8_t)start; d.next[edge] != NO_EDGE;) {
            const uint8_t follower = d.next[edge];
            loop[loop_count++] = edge;
            d.next[edge] = NO_EDGE;
            edge = follower;
        }
        if (loop_count)
            out->triangle_count +=
                (int)loop_triangulate(loop, loop_count, cell_chord_cost, &d, out->triangles + out->triangle_count);
    }
}
