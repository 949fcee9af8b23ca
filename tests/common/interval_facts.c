#include "interval_facts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ----------------------------------------------------------------------------------------------------------- faces */

typedef struct keyed_face {
    uint32_t key[3]; /* its vertices, rising */
    outer_face face;
} keyed_face;

static int numbers_compare(const void *a, const void *b) {
    const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
    return (p > q) - (p < q);
}

static int keys_compare(const void *a, const void *b) {
    const keyed_face *p = a, *q = b;
    for (int n = 0; n < 3; n++)
        if (p->key[n] != q->key[n]) return p->key[n] < q->key[n] ? -1 : 1;
    return 0;
}

/* Whether b lists the vertices of a the other way round. */
static bool is_opposite(const outer_face *a, const outer_face *b) {
    for (int n = 0; n < 3; n++)
        if (a->v[0] == b->v[n]) return a->v[1] == b->v[(n + 2) % 3] && a->v[2] == b->v[(n + 1) % 3];
    return false;
}

static void faces_fill(const uint32_t *tetrahedra, uint64_t count, keyed_face *out) {
    static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    for (uint64_t n = 0; n < 4 * count; n++, out++) {
        for (int m = 0; m < 3; m++) out->key[m] = out->face.v[m] = tetrahedra[n / 4 * 4 + (uint64_t)faces[n % 4][m]];
        qsort(out->key, 3, sizeof *out->key, numbers_compare);
    }
}

static void faces_judge(const keyed_face *faces, uint64_t count, interval_facts *f) {
    for (uint64_t n = 0, end; n < count; n = end) {
        for (end = n + 1; end < count && keys_compare(&faces[n], &faces[end]) == 0;) end++;
        if (end == n + 1)
            f->outer[f->outer_count++] = faces[n].face;
        else if (end > n + 2 || !is_opposite(&faces[n].face, &faces[n + 1].face))
            f->bad_faces++;
    }
}

/* ---------------------------------------------------------------------------------------------------------- shapes */

static void difference(const float *points, uint32_t from, uint32_t to, double out[3]) {
    for (int n = 0; n < 3; n++)
        out[n] = (double)points[3 * (uint64_t)to + (uint64_t)n] - (double)points[3 * (uint64_t)from + (uint64_t)n];
}

static double triple(const double u[3], const double v[3], const double w[3]) {
    return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2];
}

static double tetrahedron_volume(const float *points, const uint32_t v[4]) {
    double d[3][3];
    for (int n = 0; n < 3; n++) difference(points, v[0], v[n + 1], d[n]);
    return triple(d[0], d[1], d[2]) / 6;
}

double face_area(const float *points, const uint32_t v[3]) {
    double a[3], b[3], c[3];
    difference(points, v[0], v[1], a);
    difference(points, v[0], v[2], b);
    for (int n = 0; n < 3; n++) c[n] = a[(n + 1) % 3] * b[(n + 2) % 3] - a[(n + 2) % 3] * b[(n + 1) % 3];
    return sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) / 2;
}

interval_facts interval_facts_of(const float *points, uint64_t point_count, const uint32_t *tetrahedra,
                                 uint64_t tetrahedron_count) {
    interval_facts f = {.least = INFINITY};
    keyed_face *faces = malloc((4 * tetrahedron_count + 1) * sizeof *faces);
    uint8_t *used = calloc(point_count + 1, 1);
    f.outer = malloc((4 * tetrahedron_count + 1) * sizeof *f.outer);
    if (!faces || !used || !f.outer) exit(EXIT_FAILURE);
    for (uint64_t n = 0; n < 4 * tetrahedron_count; n++) {
        bool bad = tetrahedra[n] >= point_count;
        for (uint64_t m = n / 4 * 4; m < n; m++) bad = bad || tetrahedra[m] == tetrahedra[n];
        if (tetrahedra[n] < point_count) used[tetrahedra[n]] = 1;
        f.bad_vertices += bad;
    }
    for (uint64_t n = 0; n < point_count; n++) f.unused_vertices += !used[n];
    for (uint64_t n = 0; n < tetrahedron_count && !f.bad_vertices; n++) {
        const double volume = tetrahedron_volume(points, tetrahedra + 4 * n);
        f.volume += volume;
        if (volume < f.least) f.least = volume;
    }
    faces_fill(tetrahedra, tetrahedron_count, faces);
    qsort(faces, 4 * tetrahedron_count, sizeof *faces, keys_compare);
    faces_judge(faces, 4 * tetrahedron_count, &f);
    free(faces);
    free(used);
    return f;
}

/* ----------------------------------------------------------------------------------------------------------- parts */

static int values_compare(const void *a, const void *b) {
    const double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

static double triangle_above(const double f[3], double level) {
    if (level <= f[1]) return 1 - (level - f[0]) * (level - f[0]) / ((f[1] - f[0]) * (f[2] - f[0]));
    return (f[2] - level) * (f[2] - level) / ((f[2] - f[0]) * (f[2] - f[1]));
}

/* Where two corners are above: the corners 2 and 3, the crossings on the way from them, in the unit tetrahedron. */
static double wedge_above(const double f[4], double level) {
    static const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double x[4][3], d[3][3], sum = 0;
    for (int n = 0; n < 4; n++) {
        const int high = 2 + n / 2, low = n % 2;
        const double t = (level - f[high]) / (f[low] - f[high]);
        for (int k = 0; k < 3; k++) x[n][k] = corners[high][k] + t * (corners[low][k] - corners[high][k]);
    }
    const double *parts[3][4] = {
        {corners[2], x[0], x[1], corners[3]}, {x[0], x[1], corners[3], x[3]}, {x[0], corners[3], x[2], x[3]}};
    for (int n = 0; n < 3; n++) {
        for (int m = 0; m < 3; m++)
            for (int k = 0; k < 3; k++) d[m][k] = parts[n][m + 1][k] - parts[n][0][k];
        sum += fabs(triple(d[0], d[1], d[2]));
    }
    return sum;
}

double part_above(const double *values, int count, double level) {
    double f[4];
    memcpy(f, values, (size_t)count * sizeof *f);
    qsort(f, (size_t)count, sizeof *f, values_compare);
    if (level <= f[0]) return 1;
    if (level > f[count - 1]) return 0;
    if (count == 3) return triangle_above(f, level);
    const double below = level - f[0], above = f[3] - level;
    if (level <= f[1]) return 1 - below / (f[1] - f[0]) * (below / (f[2] - f[0])) * (below / (f[3] - f[0]));
    if (level > f[2]) return above / (f[3] - f[0]) * (above / (f[3] - f[1])) * (above / (f[3] - f[2]));
    return wedge_above(f, level);
}

/* ---------------------------------------------------------------------------------------------------------- sheets */

static int edges_compare(const void *a, const void *b) {
    const uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
    return (p > q) - (p < q);
}

/* Directed edges in order, then without those that are passed both ways: the border. */
static uint64_t *border_of(const outer_face *faces, uint64_t count, bool turned, uint64_t *border_count) {
    uint64_t *edges = malloc((3 * count + 1) * sizeof *edges), *back = malloc((3 * count + 1) * sizeof *back);
    if (!edges || !back) exit(EXIT_FAILURE);
    for (uint64_t n = 0; n < 3 * count; n++) {
        const uint64_t a = faces[n / 3].v[n % 3], b = faces[n / 3].v[(n + 1) % 3];
        edges[n] = turned ? b << 32 | a : a << 32 | b, back[n] = turned ? a << 32 | b : b << 32 | a;
    }
    *border_count = 0;
    qsort(edges, 3 * count, sizeof *edges, edges_compare);
    qsort(back, 3 * count, sizeof *back, edges_compare);
    for (uint64_t n = 0, m = 0; n < 3 * count; n++) {
        while (m < 3 * count && back[m] < edges[n]) m++;
        if (m < 3 * count && back[m] == edges[n])
            m++;
        else
            edges[(*border_count)++] = edges[n];
    }
    free(back);
    return edges;
}

static uint32_t *vertices_of(const outer_face *faces, uint64_t count, uint64_t *vertex_count) {
    uint32_t *out = malloc((3 * count + 1) * sizeof *out);
    if (!out) exit(EXIT_FAILURE);
    memcpy(out, faces, 3 * count * sizeof *out);
    qsort(out, 3 * count, sizeof *out, numbers_compare);
    *vertex_count = 0;
    for (uint64_t n = 0; n < 3 * count; n++)
        if (!n || out[n] != out[n - 1]) out[(*vertex_count)++] = out[n];
    return out;
}

bool same_sheet(const outer_face *a, const outer_face *b, uint64_t count, bool turned) {
    uint64_t border[2], vertices[2];
    uint64_t *edges[2] = {border_of(a, count, false, &border[0]), border_of(b, count, turned, &border[1])};
    uint32_t *numbers[2] = {vertices_of(a, count, &vertices[0]), vertices_of(b, count, &vertices[1])};
    const bool same = border[0] == border[1] && vertices[0] == vertices[1] &&
                      !memcmp(edges[0], edges[1], border[0] * sizeof *edges[0]) &&
                      !memcmp(numbers[0], numbers[1], vertices[0] * sizeof *numbers[0]);
    for (int n = 0; n < 2; n++) free(edges[n]), free(numbers[n]);
    return same;
}
