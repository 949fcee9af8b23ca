#include "signs.h"

#include "samples.h"
#include "split.h"
#include "topology.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef unsigned long long ull;

static _Thread_local char fault[256];

static void *memory_get(uint64_t bytes) {
    void *memory = malloc((size_t)bytes + 1);
    if (memory) return memory;
    fprintf(stderr, "no memory for the signs of a grid\n");
    exit(EXIT_FAILURE);
}

/* ----------------------------------------------------------------------------------------------------------- signs */

void signs_make(signs *s, const tc_grid_options *g, double isovalue) {
    const int64_t count = g->dims[0] * g->dims[1] * g->dims[2];
    *s = (signs){g, memory_get((uint64_t)count), memory_get((uint64_t)count), !g->blanked_cells};
    for (int64_t n = 0; n < count; n++) {
        const double value = sample_get(g->samples, g->type, n);
        s->inside[n] = value >= isovalue;
        s->present[n] =
            isfinite(value) && !(g->has_nodata && value == g->nodata) && !(g->blanked_samples && g->blanked_samples[n]);
        s->complete = s->complete && s->present[n];
    }
}

void signs_free(signs *s) {
    free(s->inside);
    free(s->present);
    *s = (signs){0};
}

void grid_place(const tc_grid_options *g, int64_t n, int64_t p[3]) {
    p[0] = n % g->dims[0], p[1] = n / g->dims[0] % g->dims[1], p[2] = n / g->dims[0] / g->dims[1];
}

int64_t signs_index(const signs *s, const int64_t p[3]) {
    return (p[2] * s->grid->dims[1] + p[1]) * s->grid->dims[0] + p[0];
}

int64_t signs_corner(const signs *s, const int64_t p[3], unsigned corner) {
    return signs_index(s, (int64_t[3]){p[0] + (corner & 1), p[1] + (corner >> 1 & 1), p[2] + (corner >> 2)});
}

bool signs_odd(const signs *s, const int64_t p[3]) {
    int64_t sum = 0;
    for (int axis = 0; axis < 3; axis++) sum += s->grid->first_index[axis] + p[axis];
    return sum % 2 != 0;
}

bool signs_cube(const signs *s, const int64_t p[3]) {
    const int64_t *n = s->grid->dims;
    const uint8_t *blanked = s->grid->blanked_cells;
    for (int axis = 0; axis < 3; axis++)
        if (p[axis] < 0 || p[axis] + 1 >= n[axis]) return false;
    for (unsigned c = 0; c < 8; c++)
        if (!s->present[signs_corner(s, p, c)]) return false;
    return !(blanked && blanked[(p[2] * (n[1] - 1) + p[1]) * (n[0] - 1) + p[0]]);
}

/* --------------------------------------------------------------------------------------------------------- surfaces */

/* Whether a surface goes through the cube that begins at p. */
static bool cube_is_active(const signs *s, const int64_t p[3]) {
    int inside = 0;
    for (unsigned c = 0; c < 8; c++) inside += s->inside[signs_corner(s, p, c)];
    return inside % 8 != 0 && signs_cube(s, p);
}

static body cube_make(const signs *s, const int64_t p[3]) {
    body b = {.corner_count = 8};
    for (int c = 0; c < 8; c++) {
        const int64_t q[3] = {p[0] + (c & 1), p[1] + (c >> 1 & 1), p[2] + (c >> 2)}, n = signs_index(s, q);
        for (int axis = 0; axis < 3; axis++) b.at[c][axis] = (double)q[axis];
        b.samples[c] = (uint32_t)n;
        b.inside[c] = s->inside[n];
        b.even[c] = !signs_odd(s, q);
    }
    return b;
}

static void cube_add(const body *cube, tc_method method, bool mirrored, expected *e) {
    if (method == TC_METHOD_HYBRID) {
        expected_add(e, cube, mirrored);
        return;
    }
    for (unsigned t = 0; t < 5; t++) {
        body b = {.corner_count = 4};
        unsigned corners[4];
        split_tetrahedron(!cube->even[0], t, corners);
        for (int n = 0; n < 4; n++) {
            b.samples[n] = cube->samples[corners[n]];
            b.inside[n] = cube->inside[corners[n]];
            memcpy(b.at[n], cube->at[corners[n]], sizeof b.at[n]);
        }
        expected_add(e, &b, mirrored);
    }
}

/* Bricks of 64 x 8 x 4 samples, in them rows of 64, in those the axes x, y, z and diagonals xy, xz, yz, then x. */
static uint64_t place_in_order(const tc_grid_options *g, const uint32_t ends[2]) {
    static const unsigned ranks[8] = {[1] = 0, [2] = 1, [4] = 2, [3] = 3, [5] = 4, [6] = 5}; /* by the axes spanned */
    int64_t p[3], q[3];
    uint64_t at[3];
    unsigned spans = 0;
    grid_place(g, ends[0], p);
    grid_place(g, ends[1], q);
    for (int axis = 0; axis < 3; axis++) {
        at[axis] = (uint64_t)(p[axis] < q[axis] ? p[axis] : q[axis]);
        spans |= (unsigned)(p[axis] != q[axis]) << axis;
    }
    const uint64_t brick = (at[2] / 4 << 12 | at[1] / 8) << 12 | at[0] / 64;
    return ((brick << 2 | at[2] % 4) << 3 | at[1] % 8) << 9 | (uint64_t)ranks[spans] << 6 | at[0] % 64;
}

static void vertices_order(const tc_grid_options *g, expected *e) {
    uint64_t *keys = memory_get(e->vertex_count * sizeof *keys);
    for (uint32_t n = 0; n < e->vertex_count; n++) keys[n] = place_in_order(g, e->ends[n]);
    expected_renumber(e, keys);
    free(keys);
}

void signs_expect(const signs *s, tc_method method, bool mirrored, expected *e) {
    const int64_t *n = s->grid->dims;
    uint64_t active = 0;
    int64_t p[3];
    for (p[2] = 0; p[2] + 1 < n[2]; p[2]++)
        for (p[1] = 0; p[1] + 1 < n[1]; p[1]++)
            for (p[0] = 0; p[0] + 1 < n[0]; p[0]++) active += cube_is_active(s, p);
    expected_begin(e, method == TC_METHOD_HYBRID ? active : 5 * active, method == TC_METHOD_HYBRID ? 8 : 4);
    for (p[2] = 0; p[2] + 1 < n[2]; p[2]++)
        for (p[1] = 0; p[1] + 1 < n[1]; p[1]++)
            for (p[0] = 0; p[0] + 1 < n[0]; p[0]++) {
                if (!cube_is_active(s, p)) continue;
                const body cube = cube_make(s, p);
                cube_add(&cube, method, mirrored, e);
            }
    e->active_cells = active;
    vertices_order(s->grid, e);
    expected_finish(e);
}

void complex_expect(const tc_tetrahedra_grid_options *o, double isovalue, expected *e) {
    uint64_t active = 0;
    expected_begin(e, o->tetrahedron_count, 4);
    for (uint64_t n = 0; n < o->tetrahedron_count; n++) {
        body b = {.corner_count = 4};
        int inside = 0, present = 0;
        for (int v = 0; v < 4; v++) {
            const uint32_t sample = b.samples[v] = o->tetrahedra[4 * n + (uint64_t)v];
            const double value = sample_get(o->samples, o->type, sample);
            for (int axis = 0; axis < 3; axis++)
                b.at[v][axis] = (double)o->points[3 * (uint64_t)sample + (uint64_t)axis];
            b.inside[v] = value >= isovalue;
            inside += b.inside[v];
            present += isfinite(value) != 0;
        }
        if (present < 4 || inside % 4 == 0) continue;
        expected_add(e, &b, false);
        active++;
    }
    e->active_cells = active;
    expected_finish(e);
}

/* ------------------------------------------------------------------------------------------------------------ sums */

const char *counts_fault(const expected *e, const tc_mesh_data *m) {
    if (m->vertex_count == e->vertex_count && m->triangle_count == e->triangle_count &&
        m->active_cell_count == e->active_cells)
        return NULL;
    snprintf(fault, sizeof fault, "%llu vertices, %llu triangles, %llu active cells; should be %u, %llu, %llu",
             (ull)m->vertex_count, (ull)m->triangle_count, (ull)m->active_cell_count, e->vertex_count,
             (ull)e->triangle_count, (ull)e->active_cells);
    return fault;
}

const char *topology_fault(const expected *e, bool complete, const tc_mesh_data *m) {
    topology t;
    topology_of(m->positions, m->vertex_count, m->triangles, m->triangle_count, &t);
    if (!e->conforming) return "the grid's cells do not fit together";
    if (complete && e->fans != e->vertex_count) return "the grid's signs give a vertex of a complete grid two fans";
    if (!t.bad_edges && !t.bad_triangles && !t.orphans && t.boundary_edges == e->boundary_edges && t.fans == e->fans &&
        t.euler_characteristic == e->euler_characteristic)
        return NULL;
    snprintf(fault, sizeof fault,
             "%llu bad edges, %llu bad triangles, %llu orphans; boundary edges %llu for %llu, Euler characteristic "
             "%lld for %lld, fans %llu for %llu",
             (ull)t.bad_edges, (ull)t.bad_triangles, (ull)t.orphans, (ull)t.boundary_edges, (ull)e->boundary_edges,
             (long long)t.euler_characteristic, (long long)e->euler_characteristic, (ull)t.fans, (ull)e->fans);
    return fault;
}
