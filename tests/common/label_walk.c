#include "label_walk.h"

#include "signs.h"
#include "split.h"
#include "topology.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LABELS_MOST = 32, TRIANGLES_OF_THREE = 5, TRIANGLES_OF_FOUR = 12 };

static void *allocate(size_t count, size_t bytes) {
    void *memory = calloc(count + 1, bytes);
    if (!memory) exit(EXIT_FAILURE);
    return memory;
}

static unsigned label_at(const tc_grid_options *grid, const int64_t p[3]) {
    return ((const uint8_t *)grid->samples)[(p[2] * grid->dims[1] + p[1]) * grid->dims[0] + p[0]];
}

/* A tetrahedron of a cube: its corners' places and labels. */
typedef struct cell {
    double at[4][3];
    unsigned labels[4];
} cell;

static void cell_make(const tc_grid_options *grid, const int64_t cube[3], unsigned t, cell *out) {
    unsigned corners[4];
    const int64_t *first = grid->first_index;
    const bool is_odd = (cube[0] + cube[1] + cube[2] + first[0] + first[1] + first[2]) & 1;
    split_tetrahedron(is_odd, t, corners);
    for (unsigned n = 0; n < 4; n++) {
        int64_t p[3];
        for (unsigned axis = 0; axis < 3; axis++) {
            p[axis] = cube[axis] + (corners[n] >> axis & 1);
            out->at[n][axis] = (double)p[axis];
        }
        out->labels[n] = label_at(grid, p);
    }
}

static double determinant(const double a[3], const double b[3], const double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static double volume_of(const double p[4][3]) {
    double e[3][3];
    for (int n = 0; n < 3; n++)
        for (int axis = 0; axis < 3; axis++) e[n][axis] = p[n + 1][axis] - p[0][axis];
    return determinant(e[0], e[1], e[2]);
}

/* Whether a point lies within the cell, not on its faces. */
static bool cell_holds(const cell *c, const double p[3]) {
    const double whole = volume_of(c->at);
    for (int n = 0; n < 4; n++) {
        double with[4][3];
        memcpy(with, c->at, sizeof with);
        memcpy(with[n], p, 3 * sizeof(double));
        if (volume_of((const double(*)[3])with) / whole < 1e-4) return false;
    }
    return true;
}

/* The corners, as bits, whose middle a point is; 0 where it is that of none that have labels of their own. */
static unsigned corners_of(const cell *c, const double p[3]) {
    for (unsigned set = 1; set < 16; set++) {
        double middle[3] = {0, 0, 0}, count = 0;
        bool is_mixed = true;
        for (unsigned n = 0; n < 4; n++) {
            if (!(set >> n & 1)) continue;
            count++;
            for (int axis = 0; axis < 3; axis++) middle[axis] += c->at[n][axis];
            for (unsigned m = 0; m < n; m++) is_mixed = is_mixed && !(set >> m & 1 && c->labels[m] == c->labels[n]);
        }
        double distance = 0;
        for (int axis = 0; axis < 3; axis++) distance += fabs(middle[axis] / count - p[axis]);
        if (count > 1 && is_mixed && distance < 1e-4) return set;
    }
    return 0;
}

static bool has_label(const cell *c, unsigned corners, unsigned label) {
    for (unsigned n = 0; n < 4; n++)
        if (corners >> n & 1 && c->labels[n] == label) return true;
    return false;
}

/* From the middle of one label's corners to that of the other's, along the triangle's normal. */
static double facing(const cell *c, const double p[3][3], unsigned inner, unsigned outer) {
    double u[3], v[3], across[3] = {0, 0, 0}, counts[2] = {0, 0};
    for (unsigned n = 0; n < 4; n++) counts[0] += c->labels[n] == inner, counts[1] += c->labels[n] == outer;
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = p[1][axis] - p[0][axis];
        v[axis] = p[2][axis] - p[0][axis];
        for (unsigned n = 0; n < 4; n++) {
            if (c->labels[n] == outer) across[axis] += c->at[n][axis] / counts[1];
            if (c->labels[n] == inner) across[axis] -= c->at[n][axis] / counts[0];
        }
    }
    return determinant(u, v, across);
}

static const char *triangle_fault(const cell *c, const double p[3][3], unsigned inner, unsigned outer) {
    for (int n = 0; n < 3; n++) {
        const unsigned corners = corners_of(c, p[n]);
        if (!corners) return "a vertex is no middle of corners that differ";
        if (!has_label(c, corners, inner) || !has_label(c, corners, outer)) return "a vertex is between other labels";
    }
    return facing(c, p, inner, outer) > 1e-9 ? NULL : "a triangle faces the wrong side";
}

static unsigned triangles_wanted(const cell *c) {
    unsigned labels = 0, seen = 0, of_first = 0;
    for (unsigned n = 0; n < 4; n++) {
        if (!(seen >> c->labels[n] & 1)) labels++;
        seen |= 1u << c->labels[n];
        of_first += c->labels[n] == c->labels[0];
    }
    if (labels < 3) return labels < 2 ? 0 : of_first == 2 ? 2 : 1;
    return labels == 3 ? TRIANGLES_OF_THREE : TRIANGLES_OF_FOUR;
}

static uint64_t cube_count(const tc_grid_options *grid) {
    return (uint64_t)((grid->dims[0] - 1) * (grid->dims[1] - 1) * (grid->dims[2] - 1));
}

static void cube_place(const tc_grid_options *grid, uint64_t n, int64_t p[3]) {
    const uint64_t nx = (uint64_t)grid->dims[0] - 1, ny = (uint64_t)grid->dims[1] - 1;
    p[0] = (int64_t)(n % nx), p[1] = (int64_t)(n / nx % ny), p[2] = (int64_t)(n / nx / ny);
}

/* The cell that a triangle lies in: 5 * cube + tetrahedron. UINT64_MAX where its middle is in none. */
static uint64_t cell_find(const tc_grid_options *grid, const double p[3][3], cell *out) {
    double middle[3];
    int64_t cube[3];
    for (int axis = 0; axis < 3; axis++) {
        middle[axis] = (p[0][axis] + p[1][axis] + p[2][axis]) / 3;
        cube[axis] = (int64_t)floor(middle[axis]);
        if (!(middle[axis] >= 0) || cube[axis] >= grid->dims[axis] - 1) return UINT64_MAX;
    }
    const int64_t n = (cube[2] * (grid->dims[1] - 1) + cube[1]) * (grid->dims[0] - 1) + cube[0];
    for (unsigned t = 0; t < 5; t++) {
        cell_make(grid, cube, t, out);
        if (cell_holds(out, middle)) return 5 * (uint64_t)n + t;
    }
    return UINT64_MAX;
}

const char *label_places_fault(const tc_grid_options *grid, const tc_mesh_data *mesh) {
    const uint64_t cells = 5 * cube_count(grid);
    uint8_t *counts = allocate(cells, 1);
    const char *fault = mesh->triangle_count && !mesh->boundary_labels ? "there are no labels" : NULL;
    uint64_t active = 0;
    for (uint64_t t = 0; t < mesh->triangle_count && !fault; t++) {
        const uint32_t *labels = mesh->boundary_labels + 2 * t;
        double p[3][3];
        cell c;
        for (int n = 0; n < 3; n++)
            for (int axis = 0; axis < 3; axis++) {
                const uint32_t vertex = mesh->triangles[3 * t + (uint64_t)n];
                if (vertex >= mesh->vertex_count) fault = "a triangle names no vertex";
                p[n][axis] = fault ? 0
                                   : (double)mesh->positions[3 * (uint64_t)vertex + (uint64_t)axis] -
                                         (double)grid->first_index[axis];
            }
        const uint64_t at = fault ? UINT64_MAX : cell_find(grid, (const double(*)[3])p, &c);
        if (!fault && at == UINT64_MAX) fault = "a triangle is in no tetrahedron";
        if (!fault && (labels[0] == 0 || (labels[1] && labels[1] <= labels[0])))
            fault = "labels are in the wrong order";
        if (!fault) fault = triangle_fault(&c, (const double(*)[3])p, labels[0], labels[1]);
        if (!fault) counts[at]++;
    }
    for (uint64_t n = 0; n < cells && !fault; n++) {
        int64_t cube[3];
        cell c;
        cube_place(grid, n / 5, cube);
        cell_make(grid, cube, (unsigned)(n % 5), &c);
        if (counts[n] != triangles_wanted(&c)) fault = "a tetrahedron has another number of triangles";
        if (n % 5 == 0) active += counts[n] || counts[n + 1] || counts[n + 2] || counts[n + 3] || counts[n + 4];
    }
    if (!fault && active != mesh->active_cell_count) fault = "active cells are counted wrongly";
    free(counts);
    return fault;
}

/* ------------------------------------------------------------------------------------------------------- junctions */

typedef struct side {
    uint32_t low, high, labels; /* labels: a bit each */
} side;

static int side_order(const void *a, const void *b) {
    const side *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    return p->high < q->high ? -1 : p->high > q->high;
}

static bool on_border(const tc_grid_options *grid, const tc_mesh_data *mesh, const side *s) {
    for (unsigned axis = 0; axis < 3; axis++) {
        const float p = mesh->positions[3 * (uint64_t)s->low + axis], q = mesh->positions[3 * (uint64_t)s->high + axis];
        const float low = (float)grid->first_index[axis], high = low + (float)(grid->dims[axis] - 1);
        if (p == q && (p == low || p == high)) return true;
    }
    return false;
}

static const char *sides_fault(const tc_grid_options *grid, const tc_mesh_data *mesh, const side *sides, size_t count) {
    uint32_t all = 0;
    for (size_t n = 0; n < count; n++) all |= sides[n].labels;
    const int labels = __builtin_popcount(all);
    if (count == 1) return on_border(grid, mesh, sides) ? NULL : "there is a crack";
    if (count == 2) return labels == 2 ? NULL : "two triangles with other labels meet";
    if (count > 3) return "more than three triangles meet";
    if (labels != 3 || sides[0].labels == sides[1].labels || sides[1].labels == sides[2].labels ||
        sides[0].labels == sides[2].labels)
        return "three triangles meet that are not those between three labels";
    return NULL;
}

const char *label_junctions_fault(const tc_grid_options *grid, const tc_mesh_data *mesh) {
    const size_t count = 3 * (size_t)mesh->triangle_count;
    const char *fault = NULL;
    side *sides = allocate(count, sizeof *sides);
    for (size_t n = 0; n < count; n++) {
        const uint32_t a = mesh->triangles[n], b = mesh->triangles[n % 3 == 2 ? n - 2 : n + 1];
        const uint32_t *labels = mesh->boundary_labels + 2 * (n / 3);
        sides[n] = (side){a < b ? a : b, a < b ? b : a, 1u << labels[0] | 1u << labels[1]};
    }
    qsort(sides, count, sizeof *sides, side_order);
    for (size_t n = 0, end; n < count && !fault; n = end) {
        for (end = n + 1; end < count && !side_order(&sides[n], &sides[end]);) end++;
        fault = sides_fault(grid, mesh, &sides[n], end - n);
    }
    free(sides);
    return fault;
}

/* ------------------------------------------------------------------------------------------------------ one label */

/* Borders of a label's surface have an edge more where three labels meet in a triangle of the grid's border. */
static uint64_t border_junctions(const tc_grid_options *grid, uint32_t label) {
    uint64_t count = 0;
    for (uint64_t n = 0; n < 5 * cube_count(grid); n++) {
        int64_t cube[3];
        cell c;
        cube_place(grid, n / 5, cube);
        cell_make(grid, cube, (unsigned)(n % 5), &c);
        for (unsigned away = 0; away < 4; away++) {
            const unsigned a = (away + 1) % 4, b = (away + 2) % 4, d = (away + 3) % 4;
            const unsigned *l = c.labels;
            if (l[a] == l[b] || l[b] == l[d] || l[d] == l[a]) continue;
            if (l[a] != label && l[b] != label && l[d] != label) continue;
            for (int axis = 0; axis < 3; axis++) {
                const double at = c.at[a][axis];
                if (at == c.at[b][axis] && at == c.at[d][axis] && (at == 0 || at == (double)(grid->dims[axis] - 1)))
                    count++;
            }
        }
    }
    return count;
}

/* The triangles of a label, turned so that it is inside, with the vertices that they use. */
static void label_mesh(const tc_mesh_data *mesh, uint32_t label, uint32_t *triangles, float *positions,
                       uint64_t *counts) {
    uint32_t *numbers = allocate(mesh->vertex_count, sizeof *numbers);
    counts[0] = counts[1] = 0;
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *labels = mesh->boundary_labels + 2 * t, *from = mesh->triangles + 3 * t;
        if (labels[0] != label && labels[1] != label) continue;
        for (uint64_t n = 0; n < 3; n++) {
            const uint32_t vertex = from[labels[0] == label ? n : 2 - n];
            if (!numbers[vertex]) {
                memcpy(positions + 3 * counts[0], mesh->positions + 3 * (uint64_t)vertex, 3 * sizeof(float));
                numbers[vertex] = (uint32_t)++counts[0];
            }
            triangles[3 * counts[1] + n] = numbers[vertex] - 1;
        }
        counts[1]++;
    }
    free(numbers);
}

static const char *compare(const topology *t, const expected *e, uint64_t vertices, uint64_t junctions,
                           uint32_t label) {
    static char text[160];
    const char *what = NULL;
    if (t->bad_triangles)
        what = "a triangle with a vertex twice";
    else if (t->bad_edges)
        what = "edges that are not of an oriented manifold";
    else if (t->fans != vertices)
        what = "vertices with several fans";
    else if (t->euler_characteristic != e->euler_characteristic)
        what = "another Euler characteristic";
    else if (t->boundary_edges != e->boundary_edges + junctions)
        what = "another border";
    if (what) snprintf(text, sizeof text, "label %u has %s", (unsigned)label, what);
    return what ? text : NULL;
}

const char *label_topology_fault(const tc_grid_options *grid, const tc_mesh_data *mesh, uint32_t label) {
    const size_t samples = (size_t)(grid->dims[0] * grid->dims[1] * grid->dims[2]);
    uint8_t *binary = allocate(samples, 1);
    uint32_t *triangles = allocate(3 * mesh->triangle_count, sizeof *triangles);
    float *positions = allocate(3 * mesh->vertex_count, sizeof *positions);
    uint64_t counts[2];
    tc_grid_options of_label = *grid;
    signs s;
    expected e;
    topology t;
    for (size_t n = 0; n < samples; n++) binary[n] = ((const uint8_t *)grid->samples)[n] == label;
    of_label.samples = binary;
    signs_make(&s, &of_label, 0.5);
    signs_expect(&s, TC_METHOD_TETRA, false, &e);
    label_mesh(mesh, label, triangles, positions, counts);
    topology_of(positions, counts[0], triangles, counts[1], &t);
    const char *fault = compare(&t, &e, counts[0], border_junctions(grid, label), label);
    signs_free(&s);
    expected_free(&e);
    free(binary);
    free(triangles);
    free(positions);
    return fault;
}

const char *label_walk_fault(const tc_grid_options *grid, const tc_mesh_data *mesh) {
    const char *fault = label_places_fault(grid, mesh);
    const size_t samples = (size_t)(grid->dims[0] * grid->dims[1] * grid->dims[2]);
    uint32_t seen = 0;
    for (size_t n = 0; n < samples; n++) seen |= 1u << ((const uint8_t *)grid->samples)[n];
    if (!fault) fault = label_junctions_fault(grid, mesh);
    for (uint32_t label = 0; label < LABELS_MOST && !fault; label++)
        if (seen >> label & 1) fault = label_topology_fault(grid, mesh, label);
    return fault;
}
