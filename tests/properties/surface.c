#include "surface.h"

#include "samples.h"
#include "signs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef unsigned long long ull;

static char fault[256];

static bool sample_is_inside(const subject *s, int64_t n) {
    return sample_get(s->samples, s->type, n) >= s->how.isovalue;
}

void subject_expect(const subject *s, expected *e) {
    signs g;
    if (!kind_is_structured(s->kind)) {
        complex_expect(&s->cells, s->how.isovalue, e);
        return;
    }
    signs_make(&g, &s->grid, s->how.isovalue);
    signs_expect(&g, s->how.method, s->mirrored, e);
    signs_free(&g);
}

/* ------------------------------------------------------------------------------------------------------------- arcs */

/* An edge as the mesh passes it, or as a disk does. */
typedef struct side {
    uint32_t low, high;
    uint8_t of_mesh, falls;
} side;

static int side_compare(const void *a, const void *b) {
    const side *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    return p->high < q->high ? -1 : p->high > q->high;
}

static side side_make(uint32_t from, uint32_t to, bool of_mesh) {
    return from < to ? (side){from, to, of_mesh, 0} : (side){to, from, of_mesh, 1};
}

/* Whether both vertices lie in one of the planes in which a structured grid ends. */
static bool side_ends_grid(const subject *s, const expected *e, const side *edge) {
    const uint32_t corners[4] = {e->ends[edge->low][0], e->ends[edge->low][1], e->ends[edge->high][0],
                                 e->ends[edge->high][1]};
    unsigned planes = 63;
    for (int n = 0; n < 4; n++) {
        int64_t p[3];
        grid_place(&s->grid, corners[n], p);
        for (int axis = 0; axis < 3; axis++) {
            if (p[axis] != 0) planes &= ~(1u << axis);
            if (p[axis] != s->grid.dims[axis] - 1) planes &= ~(8u << axis);
        }
    }
    return planes != 0;
}

static const char *edge_fault(const subject *s, const expected *e, const side *sides, size_t count) {
    int mesh[2] = {0}, disks[2] = {0};
    for (size_t n = 0; n < count; n++) (sides[n].of_mesh ? mesh : disks)[sides[n].falls]++;
    const bool chord = disks[0] + disks[1] == 0;
    const char *what = NULL;
    if (chord && (mesh[0] != 1 || mesh[1] != 1)) what = "an edge within a cell is not passed once in each direction";
    if (!chord && (mesh[0] != disks[0] || mesh[1] != disks[1]))
        what = "an edge is not passed as the cells beside it do";
    if (!what && s->complete && kind_is_structured(s->kind) && mesh[0] + mesh[1] == 1 && !side_ends_grid(s, e, sides))
        what = "the surface ends where the grid does not";
    if (!what) return NULL;
    snprintf(fault, sizeof fault, "%s: %d and %d times for %d and %d, vertices %u and %u", what, mesh[0], mesh[1],
             disks[0], disks[1], sides->low, sides->high);
    return fault;
}

static const char *arcs_fault(const subject *s, const expected *e, const tc_mesh_data *m) {
    const size_t corners = 3 * (size_t)m->triangle_count, count = corners + e->arc_count;
    side *sides = malloc((count + 1) * sizeof *sides);
    const char *found = NULL;
    if (!sides) exit(EXIT_FAILURE);
    for (size_t n = 0; n < corners; n++)
        sides[n] = side_make(m->triangles[n], m->triangles[n % 3 == 2 ? n - 2 : n + 1], true);
    for (size_t n = 0; n < e->arc_count; n++) sides[corners + n] = side_make(e->arcs[n].from, e->arcs[n].to, false);
    qsort(sides, count, sizeof *sides, side_compare);
    for (size_t n = 0, end; n < count && !found; n = end) {
        for (end = n + 1; end < count && !side_compare(&sides[n], &sides[end]);) end++;
        found = edge_fault(s, e, sides + n, end - n);
    }
    free(sides);
    return found;
}

/* The loops that pass three vertices: how many, and the last of them. */
static uint32_t loops_through(const expected *e, const uint32_t *heads, const uint32_t *links, const uint32_t v[3],
                              uint32_t *last) {
    uint32_t count = 0;
    for (uint32_t n = heads[v[0]]; n != UINT32_MAX; n = links[n]) {
        unsigned passed = 0;
        for (uint32_t m = e->arcs[n].next; m != n; m = e->arcs[m].next)
            passed |= (unsigned)(e->arcs[m].from == v[1]) | (unsigned)(e->arcs[m].from == v[2]) << 1;
        if (passed == 3) count++, *last = e->arcs[n].loop;
    }
    return count;
}

/* Every triangle lies within a loop, and no loop has more than its disk needs. */
static const char *cells_fault(const expected *e, const tc_mesh_data *m) {
    uint32_t *heads = malloc((e->vertex_count + 2 * (size_t)e->arc_count + 1) * sizeof *heads);
    const char *found = NULL;
    if (!heads) exit(EXIT_FAILURE);
    uint32_t *links = heads + e->vertex_count, *room = links + e->arc_count, loop = 0;
    for (uint32_t n = 0; n < e->vertex_count; n++) heads[n] = UINT32_MAX;
    for (uint32_t n = 0; n < e->loop_count; n++) room[n] = UINT32_MAX - 1; /* -2 */
    for (uint32_t n = 0; n < e->arc_count; n++) {
        links[n] = heads[e->arcs[n].from];
        heads[e->arcs[n].from] = n;
        room[e->arcs[n].loop]++;
    }
    for (uint64_t t = 0; t < m->triangle_count && !found; t++) {
        const uint32_t *v = m->triangles + 3 * t;
        uint32_t loops = 0;
        for (int n = 0; n < 3; n++)
            if (v[n] >= e->vertex_count) found = "a triangle has a corner that is no vertex";
        if (!found) loops = loops_through(e, heads, links, v, &loop);
        if (!found && loops == 0) found = "a triangle lies in no cell";
        if (loops == 1 && room[loop]-- == 0) found = "a cell has more triangles than it needs";
    }
    free(heads);
    return found;
}

/* ----------------------------------------------------------------------------------------------------------- places */

static float crossing_f32(float a, float b, float isovalue) {
    if (isinf(b - a)) a *= 0.5f, b *= 0.5f, isovalue *= 0.5f;
    return (isovalue - a) / (b - a);
}

static float crossing_f64(double a, double b, double isovalue) {
    if (isinf(b - a)) a *= 0.5, b *= 0.5, isovalue *= 0.5;
    return (float)((isovalue - a) / (b - a));
}

static float crossing_of(const subject *s, const uint32_t ends[2]) {
    const double a = sample_get(s->samples, s->type, ends[0]), b = sample_get(s->samples, s->type, ends[1]);
    const bool wide = s->type == TC_U32 || s->type == TC_I32 || s->type == TC_F64;
    return wide ? crossing_f64(a, b, s->how.isovalue) : crossing_f32((float)a, (float)b, (float)s->how.isovalue);
}

/* Where indices and positions of a uniform grid count from: the rule that tetracubes.h gives, from its words. */
typedef struct origins {
    double base[3], world[3], offset[3]; /* offset: of the first index moved to, minus the world's origin */
} origins;

static double origin_of(double low, double high, double cell) {
    const double size = high - low, reach = fmax(fabs(low), fabs(high));
    if (!(size > 0) || reach <= 8 * size || reach <= 512 * cell) return 0;
    const double step = exp2(floor(log2(size)) + 1);
    return step * nearbyint((low + size / 2) / step);
}

static double affine(const double m[4], double x, double y, double z) { return m[0] * x + m[1] * y + m[2] * z + m[3]; }

static origins origins_of(const tc_grid_options *g) {
    origins o;
    double first[3], last[3];
    for (int axis = 0; axis < 3; axis++) {
        const double begin = (double)g->first_index[axis], end = (double)(g->first_index[axis] + g->dims[axis] - 1);
        o.base[axis] = origin_of(begin, end, 1);
        first[axis] = begin - o.base[axis], last[axis] = end - o.base[axis];
    }
    for (int row = 0; row < 3; row++) {
        const double *m = g->matrix[row];
        const double moved[4] = {m[0], m[1], m[2], affine(m, o.base[0], o.base[1], o.base[2])};
        double low = INFINITY, high = -INFINITY;
        for (int corner = 0; corner < 8; corner++) {
            const double at = affine(moved, corner & 1 ? last[0] : first[0], corner & 2 ? last[1] : first[1],
                                     corner & 4 ? last[2] : first[2]);
            low = fmin(low, at), high = fmax(high, at);
        }
        o.world[row] = origin_of(low, high, fmax(fabs(m[0]), fmax(fabs(m[1]), fabs(m[2]))));
        o.offset[row] = moved[3] - o.world[row];
    }
    return o;
}

/* The contract's arithmetic. */
static void position_make(const subject *s, const origins *o, const uint32_t ends[2], float out[3]) {
    const float t = crossing_of(s, ends);
    if (!kind_is_structured(s->kind) || s->grid.points || s->grid.axes[0]) {
        double p[3], q[3];
        subject_place(s, ends[0], p);
        subject_place(s, ends[1], q);
        for (int row = 0; row < 3; row++) {
            const float a = (float)(p[row] - o->world[row]), b = (float)(q[row] - o->world[row]);
            out[row] = t == 1 ? b : a + t * (b - a);
        }
        return;
    }
    int64_t a[3], b[3];
    float at[3];
    grid_place(&s->grid, ends[0], a);
    grid_place(&s->grid, ends[1], b);
    for (int axis = 0; axis < 3; axis++)
        at[axis] =
            (float)(s->grid.first_index[axis] + a[axis] - (int64_t)o->base[axis]) + t * (float)(b[axis] - a[axis]);
    for (int row = 0; row < 3; row++) {
        const double *m = s->grid.matrix[row];
        out[row] = (((float)m[0] * at[0] + (float)m[1] * at[1]) + (float)m[2] * at[2]) + (float)o->offset[row];
    }
}

static const char *positions_fault(const subject *s, const expected *e, const tc_mesh_data *m) {
    const bool is_uniform = kind_is_structured(s->kind) && !s->grid.points && !s->grid.axes[0];
    origins o = {{0}, {0}, {0}};
    if (is_uniform) o = origins_of(&s->grid);
    for (int row = 0; row < 3; row++) {
        if (!is_uniform) o.world[row] = m->origin[row]; /* test_far looks at how that is chosen */
        if (m->origin[row] == o.world[row]) continue;
        snprintf(fault, sizeof fault, "origin %d is %.17g, not %.17g", row, m->origin[row], o.world[row]);
        return fault;
    }
    for (uint32_t n = 0; n < e->vertex_count; n++) {
        const float *is = m->positions + 3 * (size_t)n;
        float wanted[3];
        position_make(s, &o, e->ends[n], wanted);
        if (is[0] == wanted[0] && is[1] == wanted[1] && is[2] == wanted[2]) continue;
        snprintf(fault, sizeof fault, "vertex %u, between samples %u and %u, at %.9g, %.9g, %.9g, not %.9g, %.9g, %.9g",
                 n, e->ends[n][0], e->ends[n][1], (double)is[0], (double)is[1], (double)is[2], (double)wanted[0],
                 (double)wanted[1], (double)wanted[2]);
        return fault;
    }
    return NULL;
}

/* How far a triangle's normal, of the length of twice its area, points from the outside end of a crossed edge to the
 * inside one; *room: what rounding of positions may make of 0. */
static double facing_back(const subject *s, const float *const p[3], const uint32_t ends[2], double *room) {
    const bool first_inside = sample_is_inside(s, ends[0]);
    double u[3], v[3], from[3], to[3], sum = 0, size = 0, extent = 0, length = 0;
    subject_place(s, ends[first_inside], from);
    subject_place(s, ends[!first_inside], to);
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)p[1][axis] - (double)p[0][axis];
        v[axis] = (double)p[2][axis] - (double)p[0][axis];
        extent = fmax(extent, fmax(fabs(u[axis]), fabs(v[axis])));
        length = fmax(length, fabs(to[axis] - from[axis]));
        for (int n = 0; n < 3; n++) size = fmax(size, fabs((double)p[n][axis]));
    }
    for (int axis = 0; axis < 3; axis++) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        sum += (to[axis] - from[axis]) * (u[b] * v[c] - u[c] * v[b]);
    }
    *room = 64 * 0x1p-24 * (size + extent) * (extent + 0x1p-20 * size) * length;
    return sum;
}

static const char *facing_fault(const subject *s, const expected *e, const tc_mesh_data *m) {
    if (s->folded || s->how.method == TC_METHOD_HYBRID) return NULL; /* disks are not flat, or cells have two signs */
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *v = m->triangles + 3 * t;
        const float *p[3];
        for (int n = 0; n < 3; n++) p[n] = m->positions + 3 * (size_t)v[n];
        for (int n = 0; n < 3; n++) {
            double room;
            if (facing_back(s, p, e->ends[v[n]], &room) <= room) continue;
            snprintf(fault, sizeof fault, "triangle %llu faces the higher samples", (ull)t);
            return fault;
        }
    }
    return NULL;
}

/* ------------------------------------------------------------------------------------------------------------ whole */

/* What is taken as a grid has to be one. */
static const char *grid_fault(const subject *s, const expected *e) {
    if (!e->conforming) return "the grid's cells do not fit together";
    if (kind_is_structured(s->kind)) return NULL;
    const complex_facts f = complex_facts_of(&s->complex, s->list.points, s->list.point_count);
    if (f.bad_faces || f.bad_tetrahedra || f.not_positive) return "the complex is none";
    if (s->complex.blanked_cell_count != s->left_out_count)
        return "other cells are left out than those that are blanked";
    for (uint64_t n = 0; n < 4 * s->complex.tetrahedron_count && s->blanked_points; n++)
        if (s->blanked_points[s->complex.tetrahedra[n]]) return "a tetrahedron has a blanked point";
    if (s->left_out_count) return NULL;
    if (f.boundary_faces != s->boundary_faces) return "the complex does not end in the faces of the block";
    return fabs(f.volume - s->volume) > 1e-4 * s->volume ? "the complex does not fill the block" : NULL;
}

const char *surface_fault(const subject *s, const expected *e, const tc_mesh_data *mesh, unsigned checks) {
    const char *found = NULL;
    if (checks & CHECK_GRID) found = grid_fault(s, e);
    if (!found && (checks & CHECK_COUNTS)) found = counts_fault(e, mesh);
    if (!found && (checks & CHECK_TOPOLOGY)) found = topology_fault(e, s->complete, mesh);
    if (!found && (checks & CHECK_ARCS)) found = arcs_fault(s, e, mesh);
    if (!found && (checks & CHECK_CELLS)) found = cells_fault(e, mesh);
    if (!found && (checks & CHECK_PLACES)) found = positions_fault(s, e, mesh);
    if (!found && (checks & CHECK_FACING)) found = facing_fault(s, e, mesh);
    return found;
}
