/*
 * Order of triangles: bricks of 64 x 8 x 4 samples in x, y, z order; within a brick rows of 64 samples in (y, z) order;
 * within a row by x, then tetrahedron. Expected numbers are made in long double, so that no halving is needed, and
 * compared within the error that float arithmetic may have.
 */
#include "mesh_walk.h"

#include "samples.h"
#include "signs.h"
#include "split.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct walk {
    const tc_grid_options *grid;
    double isovalue;
    const tc_mesh_data *mesh;
    signs signs;
    expected should;
    bool mirrored;
    uint64_t triangle_count;
    char fault[256];
} walk;

static int64_t index_of(const walk *w, const int64_t p[3]) { return signs_index(&w->signs, p); }

static const char *fault_of(walk *w, const char *what, uint64_t number, const int64_t p[3]) {
    snprintf(w->fault, sizeof w->fault, "%s %llu at sample %lld, %lld, %lld", what, (unsigned long long)number,
             (long long)p[0], (long long)p[1], (long long)p[2]);
    return w->fault;
}

/* -------------------------------------------------------------------------------------------------------- vertices */

static long double value_at(const walk *w, const int64_t p[3]) {
    return (long double)sample_get(w->grid->samples, w->grid->type, index_of(w, p));
}

/* Types of 16 bits and f32 are interpolated with the isovalue in float32. */
static long double crossing_of(const walk *w, const int64_t a[3], const int64_t b[3]) {
    bool wide = w->grid->type == TC_U32 || w->grid->type == TC_I32 || w->grid->type == TC_F64;
    long double isovalue = wide ? (long double)w->isovalue : (long double)(float)w->isovalue;
    return (isovalue - value_at(w, a)) / (value_at(w, b) - value_at(w, a));
}

static bool grid_has_axes(const tc_grid_options *g) { return g->axes[0] || g->axes_f64[0]; }

static bool grid_has_coordinates(const tc_grid_options *g) { return grid_has_axes(g) || g->points || g->points_f64; }

/* World coordinate of a sample, where the grid is not uniform, minus the mesh's origin. */
static long double coordinate_at(const walk *w, const int64_t p[3], int row) {
    const tc_grid_options *g = w->grid;
    const int64_t n = 3 * index_of(w, p) + row;
    const long double origin = (long double)w->mesh->origin[row];
    if (g->axes[0]) return (long double)g->axes[row][p[row]] - origin;
    if (g->axes_f64[0]) return (long double)g->axes_f64[row][p[row]] - origin;
    return (g->points ? (long double)g->points[n] : (long double)g->points_f64[n]) - origin;
}

static bool between_is_right(const walk *w, const int64_t a[3], const int64_t b[3], long double t, const float *is) {
    bool right = t >= 0 && t <= 1;
    for (int row = 0; row < 3; row++) {
        long double p = coordinate_at(w, a, row), q = coordinate_at(w, b, row);
        long double room = (fabsl(p) + fabsl(q)) * 0x1p-21L;
        right = right && fabsl(p + t * (q - p) - (long double)is[row]) <= room;
        if (t == 0 || t == 1) right = right && is[row] == (float)(t == 1 ? q : p);
    }
    return right;
}

/* Relative to an origin, errors are those of the grid's size, not of its distance from zero. */
static bool relative_is_right(const walk *w, const int64_t a[3], const int64_t b[3], long double t, const float *is,
                              int row) {
    const double *m = w->grid->matrix[row];
    long double sum = (long double)m[3] - (long double)w->mesh->origin[row], room = fabsl((long double)is[row]);
    for (int axis = 0; axis < 3; axis++) {
        long double scale = (long double)m[axis];
        long double p = (long double)(w->grid->first_index[axis] + a[axis]) + t * (long double)(b[axis] - a[axis]);
        sum += scale * p;
        /* Indices count from near the grid, too, where they are beyond both of these. */
        long double most = fmaxl(512, 8 * (long double)w->grid->dims[axis]) + (long double)w->grid->dims[axis];
        room += fabsl(scale) * (fminl(fabsl(p), most) + 1);
    }
    return fabsl(sum - (long double)is[row]) <= room * 0x1p-21L;
}

static bool position_is_right(const walk *w, const int64_t a[3], const int64_t b[3], long double t, const float *is) {
    const double *o = w->mesh->origin;
    const bool is_moved = o[0] != 0 || o[1] != 0 || o[2] != 0;
    bool right = t >= 0 && t <= 1;
    if (grid_has_coordinates(w->grid)) return between_is_right(w, a, b, t, is);
    for (int row = 0; row < 3 && is_moved; row++) right = right && relative_is_right(w, a, b, t, is, row);
    for (int row = 0; row < 3 && !is_moved; row++) {
        const double *m = w->grid->matrix[row];
        long double sum = (long double)(float)m[3], room = fabsl(sum);
        for (int axis = 0; axis < 3; axis++) {
            long double scale = (long double)(float)m[axis];
            long double p = (long double)(w->grid->first_index[axis] + a[axis]) + t * (long double)(b[axis] - a[axis]);
            sum += scale * p;
            room += fabsl(scale) * (fabsl(p) + 1);
        }
        right = right && fabsl(sum - (long double)is[row]) <= room * 0x1p-21L;
    }
    return right;
}

/* Derivative along an axis: central, one-sided at borders and beside missing samples, 0 between two. */
static long double derivative_at(const walk *w, const int64_t p[3], int axis, long double *size) {
    int64_t q[2][3];
    long double values[2], steps = 0;
    for (int n = 0; n < 2; n++) {
        memcpy(q[n], p, sizeof q[n]);
        q[n][axis] += 2 * n - 1;
        bool there = q[n][axis] >= 0 && q[n][axis] < w->grid->dims[axis] && w->signs.present[index_of(w, q[n])];
        values[n] = value_at(w, there ? q[n] : p);
        steps += there;
        *size = fmaxl(*size, fabsl(values[n]));
    }
    return steps > 0 ? (values[1] - values[0]) / steps : 0;
}

/* How positions change along an axis, by the same differences. */
static void spacing_at(const walk *w, const int64_t p[3], int axis, long double out[3]) {
    int64_t q[2][3];
    long double steps = 0;
    for (int n = 0; n < 2; n++) {
        memcpy(q[n], p, sizeof q[n]);
        q[n][axis] += 2 * n - 1;
        bool there = q[n][axis] >= 0 && q[n][axis] < w->grid->dims[axis] && w->signs.present[index_of(w, q[n])];
        if (!there) q[n][axis] = p[axis];
        steps += there;
    }
    for (int row = 0; row < 3; row++)
        out[row] = steps > 0 ? (coordinate_at(w, q[1], row) - coordinate_at(w, q[0], row)) / steps : 0;
}

/* The Jacobian at the crossing, by rows. */
static void jacobian_make(const walk *w, const int64_t a[3], const int64_t b[3], long double t, long double out[3][3]) {
    for (int axis = 0; axis < 3; axis++) {
        long double at_a[3], at_b[3];
        if (grid_has_coordinates(w->grid)) {
            spacing_at(w, a, axis, at_a);
            spacing_at(w, b, axis, at_b);
            for (int row = 0; row < 3; row++) out[row][axis] = at_a[row] + t * (at_b[row] - at_a[row]);
        } else {
            for (int row = 0; row < 3; row++) out[row][axis] = (long double)w->grid->matrix[row][axis];
        }
    }
}

/* Inverse transpose of the Jacobian, times its determinant, which is returned; *blurred: rounding may hide that the
 * determinant is 0 or of the other sign. */
static long double cofactors_make(long double m[3][3], long double out[3][3], bool *blurred) {
    long double room = 1e-3L, determinant = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            out[r][c] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
        }
    for (int c = 0; c < 3; c++) {
        room *= hypotl(hypotl(m[0][c], m[1][c]), m[2][c]);
        determinant += m[0][c] * out[0][c];
    }
    *blurred = fabsl(determinant) <= room;
    return determinant;
}

/* The normal has unit length, or is zero; its direction is compared where cancellation and subnormals leave enough
 * digits. */
static bool normal_is_right(const walk *w, const int64_t a[3], const int64_t b[3], long double t, const float *is) {
    long double gradient[3], cofactors[3][3], wanted[3], size = 0, largest = 0, length = 0, dot = 0, norm = 0;
    long double jacobian[3][3];
    bool blurred;
    for (int axis = 0; axis < 3; axis++) {
        long double ga = derivative_at(w, a, axis, &size), gb = derivative_at(w, b, axis, &size);
        gradient[axis] = ga + t * (gb - ga);
    }
    jacobian_make(w, a, b, t, jacobian);
    const bool turned = cofactors_make(jacobian, cofactors, &blurred) < 0;
    for (int row = 0; row < 3; row++) {
        wanted[row] = 0;
        for (int axis = 0; axis < 3; axis++) {
            long double term = (turned ? 1 : -1) * cofactors[row][axis];
            wanted[row] += term * gradient[axis];
            largest = fmaxl(largest, fabsl(term));
        }
        length = hypotl(length, wanted[row]);
        dot += wanted[row] * (long double)is[row];
        norm += (long double)is[row] * (long double)is[row];
    }
    long double blur = largest * (size * 1e-3L + (w->grid->type == TC_F64 ? 0x1p-1050L : 0x1p-128L));
    if (norm == 0) return blurred || length <= blur;
    return fabsl(norm - 1) <= 1e-5L && (blurred || length <= blur || dot >= length * (1 - 1e-4L));
}

/* Vertices are numbered as signs_expect does it. */
static const char *vertices_walk(walk *w) {
    for (uint32_t n = 0; n < w->should.vertex_count; n++) {
        int64_t a[3], b[3];
        grid_place(w->grid, w->should.ends[n][0], a);
        grid_place(w->grid, w->should.ends[n][1], b);
        const long double t = crossing_of(w, a, b);
        if (!position_is_right(w, a, b, t, w->mesh->positions + 3 * (size_t)n))
            return fault_of(w, "wrong position of vertex", n, a);
        if (w->mesh->normals && !normal_is_right(w, a, b, t, w->mesh->normals + 3 * (size_t)n))
            return fault_of(w, "wrong normal of vertex", n, a);
    }
    return NULL;
}

/* ------------------------------------------------------------------------------------------------------- triangles */

/* The vertex between two corners of a cube. */
static uint32_t id_between(const walk *w, const int64_t cube[3], unsigned c, unsigned d) {
    return expected_vertex(&w->should, (uint32_t)signs_corner(&w->signs, cube, c),
                           (uint32_t)signs_corner(&w->signs, cube, d));
}

/* The tetrahedron's crossed edge that a vertex lies on; one that joins a corner with itself where there is none. */
static split_edge edge_with_id(const walk *w, const int64_t cube[3], const unsigned corners[4], unsigned pattern,
                               uint32_t id) {
    for (unsigned n = 0; n < 4; n++)
        for (unsigned m = 0; m < n; m++) {
            split_edge e = {corners[n], corners[m]};
            if (split_edge_crosses(corners, pattern, e) && id_between(w, cube, e.a, e.b) == id) return e;
        }
    return (split_edge){corners[0], corners[0]};
}

static const char *tetrahedron_walk(walk *w, const int64_t cube[3], const unsigned corners[4], unsigned pattern) {
    unsigned count = split_triangle_count(split_inside_count(corners, pattern));
    split_edge triangles[2][3];
    for (unsigned n = 0; n < count; n++) {
        uint64_t number = w->triangle_count++;
        if (number >= w->mesh->triangle_count) return fault_of(w, "missing triangle", number, cube);
        for (unsigned m = 0; m < 3; m++)
            triangles[n][m] = edge_with_id(w, cube, corners, pattern, w->mesh->triangles[3 * number + m]);
    }
    const char *fault = split_fault(corners, pattern, triangles, w->mirrored);
    return fault ? fault_of(w, fault, w->triangle_count - 1, cube) : NULL;
}

static const char *cube_walk(walk *w, const int64_t cube[3]) {
    const char *fault = NULL;
    unsigned pattern = 0, corners[4];
    if (!signs_cube(&w->signs, cube)) return NULL;
    for (unsigned c = 0; c < 8; c++) pattern |= (unsigned)w->signs.inside[signs_corner(&w->signs, cube, c)] << c;
    for (unsigned t = 0; t < 5 && !fault; t++) {
        split_tetrahedron(signs_odd(&w->signs, cube), t, corners);
        fault = tetrahedron_walk(w, cube, corners, pattern);
    }
    return fault;
}

static int64_t least_of(int64_t a, int64_t b) { return a < b ? a : b; }

static const char *triangles_walk(walk *w) {
    const int64_t *n = w->grid->dims;
    const char *fault = NULL;
    for (int64_t z0 = 0; z0 < n[2]; z0 += 4)
        for (int64_t y0 = 0; y0 < n[1]; y0 += 8)
            for (int64_t x0 = 0; x0 < n[0]; x0 += 64)
                for (int64_t z = z0; z < least_of(z0 + 4, n[2]); z++)
                    for (int64_t y = y0; y < least_of(y0 + 8, n[1]); y++)
                        for (int64_t x = x0; x < least_of(x0 + 64, n[0]) && !fault; x++)
                            fault = cube_walk(w, (int64_t[3]){x, y, z});
    return fault;
}

/* ----------------------------------------------------------------------------------------------------------- whole */

static bool matrix_mirrors(const double m[3][4]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
           0;
}

static bool point_counts(const tc_grid_options *g, int64_t n) {
    bool counts = !(g->blanked_samples && g->blanked_samples[n]);
    for (int row = 0; row < 3; row++) {
        double at = g->points ? (double)g->points[3 * n + row] : g->points_f64[3 * n + row];
        counts = counts && fabs(at) < 0x1p127;
    }
    return counts;
}

/* The Jacobian in the middle of a cube; 0 where it does not count. */
static long double cube_jacobian(const walk *w, const int64_t p[3]) {
    const tc_grid_options *g = w->grid;
    long double m[3][3] = {{0}}, cofactors[3][3];
    bool blurred;
    const uint8_t *blanked = g->blanked_cells;
    if (blanked && blanked[(p[2] * (g->dims[1] - 1) + p[1]) * (g->dims[0] - 1) + p[0]]) return 0;
    for (unsigned c = 0; c < 8; c++) {
        int64_t q[3] = {p[0] + (c & 1), p[1] + (c >> 1 & 1), p[2] + (c >> 2)};
        if (!point_counts(g, index_of(w, q))) return 0;
        for (int axis = 0; axis < 3; axis++)
            for (int row = 0; row < 3; row++)
                m[row][axis] += (c >> axis & 1 ? 0.25L : -0.25L) * coordinate_at(w, q, row);
    }
    return cofactors_make(m, cofactors, &blurred);
}

static bool grid_mirrors(const walk *w) {
    const tc_grid_options *g = w->grid;
    const int64_t *n = g->dims;
    long double sum = 0;
    if (grid_has_axes(g)) {
        bool mirrors = false;
        for (int axis = 0; axis < 3; axis++) {
            const int64_t last[3] = {n[0] - 1, n[1] - 1, n[2] - 1};
            mirrors ^= coordinate_at(w, last, axis) < coordinate_at(w, (int64_t[3]){0, 0, 0}, axis);
        }
        return mirrors;
    }
    if (!grid_has_coordinates(g)) return matrix_mirrors(g->matrix);
    for (int64_t z = 0; z + 1 < n[2]; z++)
        for (int64_t y = 0; y + 1 < n[1]; y++)
            for (int64_t x = 0; x + 1 < n[0]; x++) sum += cube_jacobian(w, (int64_t[3]){x, y, z});
    return sum < 0;
}

static walk walk_of(const signs *s, double isovalue, const tc_mesh_data *mesh) {
    return (walk){.grid = s->grid, .isovalue = isovalue, .mesh = mesh, .signs = *s};
}

long double crossing_between(const signs *s, double isovalue, const int64_t a[3], const int64_t b[3]) {
    const walk w = walk_of(s, isovalue, NULL);
    return crossing_of(&w, a, b);
}

bool vertex_is_right(const signs *s, double isovalue, const tc_mesh_data *mesh, uint64_t n, const int64_t a[3],
                     const int64_t b[3]) {
    const walk w = walk_of(s, isovalue, mesh);
    const long double t = crossing_of(&w, a, b);
    return position_is_right(&w, a, b, t, mesh->positions + 3 * n) &&
           (!mesh->normals || normal_is_right(&w, a, b, t, mesh->normals + 3 * n));
}

bool grid_is_mirrored(const signs *s, const tc_mesh_data *mesh) {
    const walk w = walk_of(s, 0, mesh);
    return grid_mirrors(&w);
}

const char *mesh_fault(const tc_grid_options *grid, double isovalue, const tc_mesh_data *mesh) {
    static _Thread_local char text[256];
    walk w = {.grid = grid, .isovalue = isovalue, .mesh = mesh};
    signs_make(&w.signs, grid, isovalue);
    w.mirrored = grid_mirrors(&w);
    signs_expect(&w.signs, TC_METHOD_TETRA, w.mirrored, &w.should);
    const char *fault = counts_fault(&w.should, mesh);
    if (!fault) fault = vertices_walk(&w);
    if (!fault) fault = triangles_walk(&w);
    if (!fault) fault = topology_fault(&w.should, w.signs.complete, mesh);
    if (fault) snprintf(text, sizeof text, "%s", fault);
    expected_free(&w.should);
    signs_free(&w.signs);
    return fault ? text : NULL;
}

static uint64_t words_hash(uint64_t hash, const void *words, uint64_t count) {
    const unsigned char *bytes = words;
    for (uint64_t n = 0; n < count; n++) {
        uint32_t word;
        memcpy(&word, bytes + 4 * n, sizeof word);
        hash = (hash ^ word) * 0x100000001b3u;
    }
    return hash;
}

uint64_t mesh_bytes_hash(const tc_mesh_data *mesh) {
    uint64_t hash = words_hash(0xcbf29ce484222325u, mesh->positions, 3 * mesh->vertex_count);
    if (mesh->normals) hash = words_hash(hash, mesh->normals, 3 * mesh->vertex_count);
    hash = words_hash(hash, mesh->triangles, 3 * mesh->triangle_count);
    return mesh->boundary_labels ? words_hash(hash, mesh->boundary_labels, 2 * mesh->triangle_count) : hash;
}

uint64_t interval_bytes_hash(const tc_interval_volume_data *interval) {
    const uint64_t hash = words_hash(0xcbf29ce484222325u, interval->positions, 3 * interval->vertex_count);
    return words_hash(hash, interval->tetrahedra, 4 * interval->tetrahedron_count);
}
