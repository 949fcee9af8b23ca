#include "snapped.h"

#include "mesh_walk.h"
#include "split.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A sample of a link by its steps: x + 1 + 3 (y + 1) + 9 (z + 1). The sample itself is the middle. */
enum { STEPS = 27, LINK_TRIANGLES_MOST = 32, NODES_MOST = 64 };

/* What lies opposite to a sample. */
typedef struct sample_link {
    bool whole; /* all cubes of the grid around the sample are present */
    int triangle_count;
    uint8_t triangles[LINK_TRIANGLES_MOST][3];
    int64_t samples[STEPS]; /* their numbers; -1: not of the link */
    unsigned faces;         /* bit n: the sample is on a face of the grid across axis n */
} sample_link;

static int step_along(int step, int axis) { return step / (axis == 0 ? 1 : axis == 1 ? 3 : 9) % 3 - 1; }

static void link_add_cube(const signs *s, const int64_t p[3], unsigned middle, sample_link *l) {
    const int64_t cube[3] = {p[0] - (middle & 1), p[1] - (middle >> 1 & 1), p[2] - (middle >> 2)};
    for (int axis = 0; axis < 3; axis++)
        if (cube[axis] < 0 || cube[axis] + 1 >= s->grid->dims[axis]) return;
    l->whole = l->whole && signs_cube(s, cube);
    for (unsigned t = 0; t < 5; t++) {
        unsigned corners[4], others = 0;
        split_tetrahedron(signs_odd(s, cube), t, corners);
        if (corners[0] != middle && corners[1] != middle && corners[2] != middle && corners[3] != middle) continue;
        for (int n = 0; n < 4; n++) {
            int step = 13;
            if (corners[n] == middle) continue;
            for (int axis = 0, weight = 1; axis < 3; axis++, weight *= 3)
                step += weight * (split_axis(corners[n], axis) - split_axis(middle, axis));
            l->samples[step] = signs_corner(s, cube, corners[n]);
            l->triangles[l->triangle_count][others++] = (uint8_t)step;
        }
        l->triangle_count++;
    }
}

static void link_make(const signs *s, const int64_t p[3], sample_link *l) {
    l->whole = true;
    l->triangle_count = 0;
    l->faces = 0;
    for (int n = 0; n < STEPS; n++) l->samples[n] = -1;
    for (unsigned middle = 0; middle < 8; middle++) link_add_cube(s, p, middle, l);
    for (int axis = 0; axis < 3; axis++)
        l->faces |= (unsigned)(p[axis] == 0 || p[axis] + 1 == s->grid->dims[axis]) << axis;
}

/* ---------------------------------------------------------------------------------------------- the curve in a link */

/* Where the surface meets the link: nodes are samples on it and crossed edges, arcs join them across triangles. */
typedef struct curve {
    const sample_link *link;
    int8_t sides[STEPS];
    int count;
    uint8_t numbers[STEPS][STEPS]; /* node between two samples, low first, or at one; from 1 on */
    uint8_t degrees[NODES_MOST], parents[NODES_MOST];
    unsigned faces[NODES_MOST];          /* of those of the sample in the middle, which the node is in */
    int8_t between[STEPS][STEPS];        /* two samples on the surface: the side of the triangles that they share, */
    uint8_t between_count[STEPS][STEPS]; /* and their number */
    bool regular;                        /* so far */
} curve;

/* The faces of the middle one, in which a sample of its link lies too. */
static unsigned faces_of(const curve *c, int step) {
    unsigned faces = 0;
    for (int axis = 0; axis < 3; axis++) faces |= (unsigned)(step_along(step, axis) == 0) << axis;
    return faces & c->link->faces;
}

static int node_at(curve *c, int a, int b) {
    const int low = a < b ? a : b, high = a < b ? b : a;
    if (!c->numbers[low][high]) {
        c->numbers[low][high] = (uint8_t)++c->count;
        c->degrees[c->count] = 0;
        c->parents[c->count] = (uint8_t)c->count;
        c->faces[c->count] = faces_of(c, a) & faces_of(c, b);
    }
    return c->numbers[low][high];
}

static int root_of(const curve *c, int node) {
    while (c->parents[node] != node) node = c->parents[node];
    return node;
}

static void arc_add(curve *c, int a, int b) {
    c->degrees[a]++;
    c->degrees[b]++;
    c->parents[root_of(c, a)] = (uint8_t)root_of(c, b);
}

/* Two samples of a triangle on the surface: it runs along the edge between them. */
static void edge_on_surface(curve *c, int a, int b, int third) {
    const int low = a < b ? a : b, high = a < b ? b : a;
    if (c->between_count[low][high]++ == 0) {
        c->between[low][high] = c->sides[third];
        arc_add(c, node_at(c, a, a), node_at(c, b, b));
    } else if (c->between[low][high] == c->sides[third]) {
        c->regular = false; /* it touches, and does not separate */
    }
}

static void triangle_cut(curve *c, const uint8_t t[3]) {
    int nodes[3], node_count = 0, on[3], on_count = 0, third = -1;
    for (int n = 0; n < 3; n++) {
        const int a = t[n], b = t[(n + 1) % 3];
        if (c->sides[a] == SIDE_ON)
            on[on_count++] = a;
        else
            third = a;
        if (c->sides[a] * c->sides[b] < 0) nodes[node_count++] = node_at(c, a, b);
    }
    if (on_count == 3) c->regular = false;
    if (on_count == 2) edge_on_surface(c, on[0], on[1], third);
    if (on_count == 1 && node_count == 1) arc_add(c, nodes[0], node_at(c, on[0], on[0]));
    if (on_count == 0 && node_count == 2) arc_add(c, nodes[0], nodes[1]);
}

/* Each edge along which the surface runs lies between two triangles, not on the edge of the link. */
static bool edges_on_surface_are_inner(const curve *c) {
    for (int a = 0; a < STEPS; a++)
        for (int b = a + 1; b < STEPS; b++)
            if (c->between_count[a][b] == 1) return false;
    return true;
}

/* In each of its faces a sample needs two ends of the curve; one where it is in two faces, each of which has half. */
static bool ends_are_right(const curve *c) {
    const unsigned faces = c->link->faces;
    const int wanted = faces & (faces - 1) ? 1 : 2;
    for (int axis = 0; axis < 3; axis++) {
        int ends = 0;
        for (int n = 1; n <= c->count; n++) ends += (int)(c->faces[n] >> axis & 1);
        if ((faces >> axis & 1) && ends != wanted) return false;
    }
    return true;
}

static bool curve_is_simple(const curve *c) {
    for (int n = 1; n <= c->count; n++)
        if (c->degrees[n] != (c->faces[n] ? 1 : 2) || root_of(c, n) != root_of(c, 1)) return false;
    return c->count > 0;
}

/* On an edge of the box: the samples before and after it are on different sides. */
static bool box_edge_is_crossed(const curve *c) {
    int product = 1;
    for (int step = 0; step < STEPS; step++)
        if (c->link->samples[step] >= 0 && faces_of(c, step) == c->link->faces) product *= c->sides[step];
    return product < 0;
}

static bool link_is_regular(const sample_link *l, const int8_t *sides) {
    static _Thread_local curve c;
    const int face_count = __builtin_popcount(l->faces);
    if (!l->whole || face_count == 3) return false;
    memset(&c, 0, sizeof c);
    c.link = l;
    c.regular = true;
    for (int n = 0; n < STEPS; n++)
        if (l->samples[n] >= 0) c.sides[n] = sides[l->samples[n]];
    for (int n = 0; n < STEPS; n++)
        if (l->samples[n] >= 0 && c.sides[n] == SIDE_ON) node_at(&c, n, n);
    for (int n = 0; n < l->triangle_count; n++) triangle_cut(&c, l->triangles[n]);
    return c.regular && curve_is_simple(&c) && edges_on_surface_are_inner(&c) && ends_are_right(&c) &&
           (face_count < 2 || box_edge_is_crossed(&c));
}

bool sample_is_regular(const signs *s, const int8_t *sides, const int64_t p[3]) {
    sample_link l;
    link_make(s, p, &l);
    return link_is_regular(&l, sides);
}

/* --------------------------------------------------------------------------------------------------------- snapping */

typedef struct snapped {
    signs signs;
    double isovalue;
    long double threshold;
    const tc_mesh_data *mesh;
    bool mirrored, doubtful;
    int8_t *sides;
    uint32_t *ids; /* of vertices: [sample][axes spanned, 0: at the sample itself] */
    uint64_t vertex_count, triangle_count, active_count;
    char fault[256];
} snapped;

int sample_turn(const signs *s, const int64_t p[3]) {
    static const int turns[2][2] = {{0, 1}, {3, 2}};
    if (signs_odd(s, p)) return TURNS - 1;
    return turns[(s->grid->first_index[1] + p[1]) & 1][(s->grid->first_index[2] + p[2]) & 1];
}

/* A crossing on an edge of a sample: the other sample, and how far from the sample. */
typedef struct near_crossing {
    int64_t other;
    long double distance;
} near_crossing;

/* Those near enough along the edges that keep the sample in its faces. One just at the threshold is the inside
 * sample's. */
static int near_crossings(snapped *w, const int64_t p[3], const sample_link *l, near_crossing out[STEPS]) {
    const bool inside = w->signs.inside[signs_index(&w->signs, p)];
    int count = 0;
    for (int step = 0; step < STEPS; step++) {
        const int64_t other = l->samples[step];
        int64_t q[3];
        int spans = 0;
        bool keeps = true;
        if (other < 0 || w->signs.inside[other] == inside) continue;
        for (int axis = 0; axis < 3; axis++) {
            spans += step_along(step, axis) != 0;
            keeps = keeps && (step_along(step, axis) == 0 || !(l->faces >> axis & 1));
        }
        grid_place(w->signs.grid, other, q);
        if (!keeps) continue;
        const long double t = crossing_between(&w->signs, w->isovalue, p, q);
        w->doubtful = w->doubtful || (t != w->threshold && fabsl(t - w->threshold) <= 1e-6L * w->threshold);
        if (t < w->threshold || (inside && t == w->threshold)) out[count++] = (near_crossing){other, t * sqrtl(spans)};
    }
    return count;
}

static void sides_make(snapped *w) {
    const int64_t count = w->signs.grid->dims[0] * w->signs.grid->dims[1] * w->signs.grid->dims[2];
    for (int64_t n = 0; n < count; n++) w->sides[n] = w->signs.inside[n] ? SIDE_IN : SIDE_OUT;
    for (int turn = 0; turn < TURNS; turn++)
        for (int64_t n = 0; n < count; n++) {
            int64_t p[3];
            sample_link l;
            near_crossing crossings[STEPS];
            grid_place(w->signs.grid, n, p);
            if (sample_turn(&w->signs, p) != turn) continue;
            link_make(&w->signs, p, &l);
            if (l.whole && near_crossings(w, p, &l, crossings) && link_is_regular(&l, w->sides)) w->sides[n] = SIDE_ON;
        }
}

static const char *fault_of(snapped *w, const char *what, uint64_t number, const int64_t p[3]) {
    snprintf(w->fault, sizeof w->fault, "%s %llu at sample %lld, %lld, %lld", what, (unsigned long long)number,
             (long long)p[0], (long long)p[1], (long long)p[2]);
    return w->fault;
}

/* --------------------------------------------------------------------------------------------------------- vertices */

static bool vertex_lies_between(const snapped *w, uint64_t n, const int64_t p[3], const int64_t q[3]) {
    const bool ordered = signs_index(&w->signs, p) < signs_index(&w->signs, q);
    return vertex_is_right(&w->signs, w->isovalue, w->mesh, n, ordered ? p : q, ordered ? q : p);
}

/* At the nearest crossing; at any of those that are as near, but for rounding. */
static bool snapped_vertex_is_right(snapped *w, uint64_t n, const int64_t p[3]) {
    sample_link l;
    near_crossing crossings[STEPS];
    long double least = INFINITY;
    link_make(&w->signs, p, &l);
    const int count = near_crossings(w, p, &l, crossings);
    for (int m = 0; m < count; m++) least = fminl(least, crossings[m].distance);
    for (int m = 0; m < count; m++) {
        int64_t q[3];
        grid_place(w->signs.grid, crossings[m].other, q);
        if (crossings[m].distance <= least * (1 + 1e-6L) && vertex_lies_between(w, n, p, q)) return true;
    }
    return false;
}

/* The ends of the edge that spans these axes from p on; false where it is not in the grid or in no cube. */
static bool edge_find(const snapped *w, const int64_t p[3], unsigned spans, int64_t a[3], int64_t b[3]) {
    bool turned = (spans & (spans - 1)) && signs_odd(&w->signs, p), found = false;
    for (int axis = 0; axis < 3; axis++) {
        const bool spanned = spans >> axis & 1;
        if (p[axis] + spanned >= w->signs.grid->dims[axis]) return false;
        a[axis] = p[axis] + (spanned && turned); /* along the first axis */
        b[axis] = p[axis] + (spanned && !turned);
        if (spanned) turned = false;
    }
    for (unsigned back = 0; back < 8; back++)
        if (!(back & spans))
            found = found ||
                    signs_cube(&w->signs, (int64_t[3]){p[0] - (back & 1), p[1] - (back >> 1 & 1), p[2] - (back >> 2)});
    return found;
}

static const char *row_walk(snapped *w, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    static const unsigned order[7] = {1, 2, 4, 3, 5, 6, 0};
    for (int type = 0; type < 7; type++)
        for (int64_t x = x0; x < x1; x++) {
            const unsigned spans = order[type];
            const int64_t p[3] = {x, y, z}, n = signs_index(&w->signs, p);
            int64_t a[3], b[3];
            bool right;
            if (spans ? !edge_find(w, p, spans, a, b) ||
                            w->sides[signs_index(&w->signs, a)] * w->sides[signs_index(&w->signs, b)] >= 0
                      : w->sides[n] != SIDE_ON)
                continue;
            if (w->vertex_count == w->mesh->vertex_count) return fault_of(w, "missing vertex", w->vertex_count, p);
            right =
                spans ? vertex_lies_between(w, w->vertex_count, a, b) : snapped_vertex_is_right(w, w->vertex_count, p);
            if (!right)
                return fault_of(w, spans ? "wrong place of vertex" : "wrong place of snapped vertex", w->vertex_count,
                                p);
            w->ids[7 * n + spans] = (uint32_t)w->vertex_count++;
        }
    return NULL;
}

/* -------------------------------------------------------------------------------------------------------- triangles */

/* The vertex on an edge of a cube, or at a corner: both ends are then the same. */
static uint32_t id_between(const snapped *w, const int64_t cube[3], split_edge e) {
    const unsigned low = e.a & e.b, spans = e.a ^ e.b;
    return w->ids[7 * signs_corner(&w->signs, cube, low) + spans];
}

static int side_at(const snapped *w, const int64_t cube[3], unsigned corner) {
    return w->sides[signs_corner(&w->signs, cube, corner)];
}

/* The place of a vertex in a tetrahedron, which the surface has there; false where it has none. */
static bool place_find(const snapped *w, const int64_t cube[3], const unsigned corners[4], uint32_t id, split_edge *e) {
    for (int n = 0; n < 4; n++)
        for (int m = 0; m <= n; m++) {
            const int a = side_at(w, cube, corners[n]), b = side_at(w, cube, corners[m]);
            *e = (split_edge){corners[n], corners[m]};
            if ((n == m ? a == SIDE_ON : a * b < 0) && id_between(w, cube, *e) == id) return true;
        }
    return false;
}

static const char *tetrahedron_walk(snapped *w, const int64_t cube[3], const unsigned corners[4]) {
    unsigned counts[3] = {0, 0, 0}, inside = 0;
    for (int n = 0; n < 4; n++) {
        const int side = side_at(w, cube, corners[n]);
        counts[side - SIDE_OUT]++;
        inside |= (unsigned)(side == SIDE_IN) << corners[n];
    }
    const unsigned out = counts[0], on = counts[1], in = counts[2];
    unsigned count = in > 0 && out > 0;
    if (in == 2 && out == 2) count = 2;
    if (on == 3) count = in; /* its face, of the two tetrahedra that have it by the one inside */
    split_edge triangles[2][3];
    if (on == 4) return "a tetrahedron has four samples on the surface";
    for (unsigned n = 0; n < count; n++) {
        if (w->triangle_count == w->mesh->triangle_count) return "missing triangle";
        const uint32_t *ids = w->mesh->triangles + 3 * w->triangle_count++;
        for (int m = 0; m < 3; m++)
            if (!place_find(w, cube, corners, ids[m], &triangles[n][m])) return "a vertex of another place, triangle";
        if (split_same(triangles[n][0], triangles[n][1]) || split_same(triangles[n][1], triangles[n][2]) ||
            split_same(triangles[n][2], triangles[n][0]))
            return "the same vertex twice, triangle";
        const int facing = split_facing(corners, inside, triangles[n]);
        if (w->mirrored ? facing >= 0 : facing <= 0) return "the wrong side, triangle";
    }
    return count == 2 && !split_quadrilateral(triangles) ? "no quadrilateral, triangle" : NULL;
}

static const char *cube_walk(snapped *w, const int64_t cube[3]) {
    const uint64_t before = w->triangle_count;
    if (!signs_cube(&w->signs, cube)) return NULL;
    for (unsigned t = 0; t < 5; t++) {
        unsigned corners[4];
        split_tetrahedron(signs_odd(&w->signs, cube), t, corners);
        const char *fault = tetrahedron_walk(w, cube, corners);
        if (fault) return fault_of(w, fault, w->triangle_count - 1, cube);
    }
    w->active_count += w->triangle_count > before;
    return NULL;
}

static const char *cubes_walk(snapped *w, int64_t x0, int64_t x1, int64_t y, int64_t z) {
    const char *fault = NULL;
    for (int64_t x = x0; x < x1 && !fault; x++) fault = cube_walk(w, (int64_t[3]){x, y, z});
    return fault;
}

/* ------------------------------------------------------------------------------------------------------------ whole */

static int64_t least_of(int64_t a, int64_t b) { return a < b ? a : b; }

typedef const char *walk_row(snapped *w, int64_t x0, int64_t x1, int64_t y, int64_t z);

/* Bricks of 64 x 8 x 4 samples in x, y, z order, in them rows of 64. */
static const char *rows_walk(snapped *w, walk_row *row) {
    const int64_t *n = w->signs.grid->dims;
    const char *fault = NULL;
    for (int64_t z0 = 0; z0 < n[2]; z0 += 4)
        for (int64_t y0 = 0; y0 < n[1]; y0 += 8)
            for (int64_t x0 = 0; x0 < n[0]; x0 += 64)
                for (int64_t z = z0; z < least_of(z0 + 4, n[2]); z++)
                    for (int64_t y = y0; y < least_of(y0 + 8, n[1]) && !fault; y++)
                        fault = row(w, x0, least_of(x0 + 64, n[0]), y, z);
    return fault;
}

static const char *counts_differ(snapped *w) {
    if (w->vertex_count == w->mesh->vertex_count && w->triangle_count == w->mesh->triangle_count &&
        w->active_count == w->mesh->active_cell_count)
        return NULL;
    snprintf(w->fault, sizeof w->fault, "%llu vertices, %llu triangles, %llu active cells; should be %llu, %llu, %llu",
             (unsigned long long)w->mesh->vertex_count, (unsigned long long)w->mesh->triangle_count,
             (unsigned long long)w->mesh->active_cell_count, (unsigned long long)w->vertex_count,
             (unsigned long long)w->triangle_count, (unsigned long long)w->active_count);
    return w->fault;
}

const char *snapped_fault(const tc_grid_options *grid, double isovalue, double threshold, const tc_mesh_data *mesh,
                          bool *doubtful) {
    static _Thread_local char text[256];
    const size_t count = (size_t)(grid->dims[0] * grid->dims[1] * grid->dims[2]);
    const char *fault = NULL;
    snapped w = {.isovalue = isovalue, .threshold = (long double)(float)threshold, .mesh = mesh};
    signs_make(&w.signs, grid, isovalue);
    w.sides = malloc(count);
    w.ids = malloc(7 * count * sizeof *w.ids);
    if (!w.sides || !w.ids) exit(EXIT_FAILURE);
    memset(w.ids, 0xff, 7 * count * sizeof *w.ids);
    w.mirrored = grid_is_mirrored(&w.signs, mesh);
    sides_make(&w);
    *doubtful = w.doubtful;
    if (!w.doubtful) fault = rows_walk(&w, row_walk);
    if (!w.doubtful && !fault) fault = rows_walk(&w, cubes_walk);
    if (!w.doubtful && !fault) fault = counts_differ(&w);
    if (fault) snprintf(text, sizeof text, "%s", fault);
    free(w.sides);
    free(w.ids);
    signs_free(&w.signs);
    return fault ? text : NULL;
}
