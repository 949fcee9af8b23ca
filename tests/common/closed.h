/*
 * closed.h - what must hold of closed surfaces: they have no border, begin with the open surface, and enclose the part
 * of the tetrahedra that is inside
 */
#ifndef CLOSED_H
#define CLOSED_H

#include "tetracubes.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

typedef struct edge {
    uint32_t from, to;
} edge;

static inline int edges_compare(const void *a, const void *b) {
    const edge *p = a, *q = b;
    if (p->from != q->from) return p->from < q->from ? -1 : 1;
    return p->to < q->to ? -1 : p->to > q->to;
}

static inline void edges_fill(const tc_mesh_data *m, uint64_t count, int turned, edge *out) {
    for (uint64_t n = 0; n < 3 * count; n++) {
        const uint32_t a = m->triangles[n], b = m->triangles[n % 3 == 2 ? n - 2 : n + 1];
        out[n] = turned ? (edge){b, a} : (edge){a, b};
    }
    qsort(out, 3 * count, sizeof *out, edges_compare);
}

/* Whether the first `count` triangles have no border. */
static inline int is_closed(const tc_mesh_data *m, uint64_t count) {
    edge *forth = malloc((3 * count + 1) * sizeof *forth), *back = malloc((3 * count + 1) * sizeof *back);
    int closed = forth && back;
    if (closed) edges_fill(m, count, 0, forth), edges_fill(m, count, 1, back);
    for (uint64_t n = 0; n < 3 * count && closed; n++) closed = edges_compare(&forth[n], &back[n]) == 0;
    free(forth);
    free(back);
    return closed;
}

static inline double volume_between(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3], w[3];
    for (int n = 0; n < 3; n++) u[n] = b[n] - a[n], v[n] = c[n] - a[n], w[n] = d[n] - a[n];
    return ((u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
            (u[0] * v[1] - u[1] * v[0]) * w[2]) /
           6;
}

static inline double enclosed(const tc_mesh_data *m) {
    static const double zero[3];
    double sum = 0, p[3][3];
    for (uint64_t n = 0; n < m->triangle_count; n++) {
        for (int k = 0; k < 9; k++)
            p[k / 3][k % 3] = m->positions[3 * m->triangles[3 * n + (uint64_t)k / 3] + (uint64_t)k % 3];
        sum += volume_between(zero, p[0], p[1], p[2]);
    }
    return sum;
}

static inline void cross(const double *p, const double *q, double f, double g, double iso, double out[3]) {
    for (int n = 0; n < 3; n++) out[n] = p[n] + (iso - f) / (g - f) * (q[n] - p[n]);
}

/* Of the inside part of a tetrahedron; the corners inside come first. */
static inline double part_inside(double p[4][3], const double f[4], int inside, double iso) {
    const double whole = fabs(volume_between(p[0], p[1], p[2], p[3]));
    double x[4][3];
    if (inside == 0 || inside == 4) return inside ? whole : 0;
    if (inside == 2) {
        for (int n = 0; n < 4; n++) cross(p[n / 2], p[2 + n % 2], f[n / 2], f[2 + n % 2], iso, x[n]);
        return fabs(volume_between(p[0], x[0], x[1], p[1])) + fabs(volume_between(x[0], x[1], p[1], x[3])) +
               fabs(volume_between(x[0], p[1], x[2], x[3]));
    }
    const int tip = inside == 1 ? 0 : 3;
    for (int n = 0, k = 0; n < 4; n++)
        if (n != tip) cross(p[tip], p[n], f[tip], f[n], iso, x[k++]);
    const double cut = fabs(volume_between(p[tip], x[0], x[1], x[2]));
    return inside == 1 ? cut : whole - cut;
}

/* Of the inside part of tetrahedra; those with a sample that is not finite are not there. points: x, y, z each. */
static inline double inside_of_tetrahedra(const tc_tetrahedra *t, const float *points, const float *samples,
                                          double iso) {
    double sum = 0;
    for (uint64_t n = 0; n < t->tetrahedron_count; n++) {
        double p[4][3], f[4];
        int at = 0, inside = 0;
        bool missing = false;
        for (uint64_t v = 0; v < 4; v++) missing = missing || !isfinite(samples[t->tetrahedra[4 * n + v]]);
        for (int side = missing ? -1 : 1; side >= 0; side--)
            for (int v = 0; v < 4; v++) {
                const uint32_t s = t->tetrahedra[4 * n + (uint64_t)v];
                if ((samples[s] >= iso) != side) continue;
                for (uint64_t axis = 0; axis < 3; axis++) p[at][axis] = points[3 * (uint64_t)s + axis];
                f[at++] = samples[s], inside += side;
            }
        sum += part_inside(p, f, inside, iso);
    }
    return sum;
}

/* The open surface comes first, with the same numbers. */
static inline int begins_with(const tc_mesh_data *whole, const tc_mesh_data *open) {
    int same = open->vertex_count <= whole->vertex_count && open->triangle_count <= whole->triangle_count;
    for (uint64_t n = 0; n < 3 * open->vertex_count && same; n++) same = open->positions[n] == whole->positions[n];
    for (uint64_t n = 0; n < 3 * open->triangle_count && same; n++) same = open->triangles[n] == whole->triangles[n];
    return same;
}

/* Points that are carried are where the vertices are, but for rounding. */
static inline int carried_are_positions(const float *carried, const tc_mesh_data *m) {
    int same = 1;
    for (uint64_t n = 0; n < 3 * m->vertex_count && same; n++)
        same = fabs((double)carried[n] - (double)m->positions[n]) < 1e-5;
    return same;
}

#endif
