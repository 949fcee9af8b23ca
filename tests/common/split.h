/*
 * split.h - the split of cubes into tetrahedra and what one tetrahedron may emit, from geometry alone
 *
 * Shares nothing with host/lib/tables/tables.c, and needs no table: the central tetrahedron of every cube has the
 * samples whose i + j + k is even, and each of the other four corners forms one with its three neighbours in the cube.
 * So face diagonals join even samples, wherever they lie. Corners are numbered x + 2 y + 4 z.
 */
#ifndef SPLIT_H
#define SPLIT_H

#include <stdbool.h>
#include <stdint.h>

static inline unsigned split_corner_is_odd(unsigned corner) { return (corner ^ corner >> 1 ^ corner >> 2) & 1; }

/* Corners of tetrahedron t of a cube whose i + j + k is odd or even: the central one, then by odd sample. */
static inline void split_tetrahedron(unsigned cube_is_odd, unsigned t, unsigned corners[4]) {
    unsigned n = 0, seen = 0;
    for (unsigned c = 0; c < 8; c++) {
        bool odd_sample = split_corner_is_odd(c) != cube_is_odd;
        if (t == 0 && !odd_sample) corners[n++] = c;
        if (t > 0 && odd_sample && ++seen == t)
            for (unsigned m = 0; m < 4; m++) corners[m] = m ? c ^ (1u << (m - 1)) : c;
    }
}

static inline unsigned split_inside_count(const unsigned corners[4], unsigned pattern) {
    unsigned count = 0;
    for (unsigned n = 0; n < 4; n++) count += pattern >> corners[n] & 1;
    return count;
}

/* Triangles that a tetrahedron with so many corners inside emits. */
static inline unsigned split_triangle_count(unsigned inside_count) {
    return inside_count == 2 ? 2 : inside_count % 4 ? 1 : 0;
}

/* A crossed edge by the two corners of the cube that it joins, in any order. */
typedef struct split_edge {
    unsigned a, b;
} split_edge;

static inline bool split_same(split_edge p, split_edge q) {
    return (p.a == q.a && p.b == q.b) || (p.a == q.b && p.b == q.a);
}

static inline int split_axis(unsigned corner, int axis) { return (int)(corner >> axis & 1); }

/* Twice the position of an edge's middle along an axis. */
static inline int split_middle(split_edge e, int axis) { return split_axis(e.a, axis) + split_axis(e.b, axis); }

/* Positive where the triangle, drawn through the middles of its edges, faces the outside corners; pattern has a bit per
 * corner that is inside. */
static inline int split_facing(const unsigned corners[4], unsigned pattern, const split_edge e[3]) {
    int u[3], v[3], out[3], inside_count = (int)split_inside_count(corners, pattern);
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = split_middle(e[1], axis) - split_middle(e[0], axis);
        v[axis] = split_middle(e[2], axis) - split_middle(e[0], axis);
        out[axis] = 0;
        for (int n = 0; n < 4; n++) /* mean of those outside less mean of those inside, times both counts */
            out[axis] += split_axis(corners[n], axis) * (pattern >> corners[n] & 1 ? inside_count - 4 : inside_count);
    }
    return out[0] * (u[1] * v[2] - u[2] * v[1]) + out[1] * (u[2] * v[0] - u[0] * v[2]) +
           out[2] * (u[0] * v[1] - u[1] * v[0]);
}

static inline bool split_edge_crosses(const unsigned corners[4], unsigned pattern, split_edge e) {
    unsigned ends = 0;
    for (unsigned n = 0; n < 4; n++) ends += corners[n] == e.a || corners[n] == e.b;
    return ends == 2 && e.a != e.b && ((pattern >> e.a ^ pattern >> e.b) & 1);
}

/* Two triangles make a quadrilateral where they share two opposite edges of the tetrahedron, passed in opposite
 * directions, and their third corners differ. */
static inline bool split_quadrilateral(split_edge t[2][3]) {
    for (int n = 0; n < 3; n++)
        for (int m = 0; m < 3; m++) {
            split_edge p = t[0][n], q = t[0][(n + 1) % 3];
            if (!split_same(p, t[1][(m + 1) % 3]) || !split_same(q, t[1][m])) continue;
            return p.a != q.a && p.a != q.b && p.b != q.a && p.b != q.b &&
                   !split_same(t[0][(n + 2) % 3], t[1][(m + 2) % 3]);
        }
    return false;
}

/* NULL where the triangles, of whom there are as many as split_triangle_count says, cut the inside corners from the
 * others and face outward (inward where mirrored); else what is wrong. */
static inline const char *split_fault(const unsigned corners[4], unsigned pattern, split_edge triangles[2][3],
                                      bool mirrored) {
    unsigned count = split_triangle_count(split_inside_count(corners, pattern));
    for (unsigned n = 0; n < count; n++) {
        split_edge *e = triangles[n];
        for (unsigned m = 0; m < 3; m++) {
            if (!split_edge_crosses(corners, pattern, e[m])) return "a corner is on no crossed edge of the tetrahedron";
            if (split_same(e[m], e[(m + 1) % 3])) return "a triangle has the same corner twice";
        }
        int facing = split_facing(corners, pattern, e);
        if (mirrored ? facing >= 0 : facing <= 0) return "a triangle faces the wrong side";
    }
    return count == 2 && !split_quadrilateral(triangles) ? "two triangles do not form a quadrilateral" : 0;
}

#endif
