/*
 * mesh_distance.c - nearest triangles by a tree of boxes; see mesh_distance.h
 *
 * The triangles of the second surface are sorted along a Z-order curve through their centroids (Morton 1966). Leaves
 * are runs of LEAF_TRIANGLES of them; above, each node of a complete binary tree has the box of its two children. The
 * search begins with the triangle that was nearest to a sample before, which is near to the next one too, and leaves
 * out boxes that are not nearer. It ends as soon as the sample is known to be no further than the greatest distance so
 * far, which most are. Threads take chunks of vertices and triangles; the greatest distance depends on no order.
 */
#include "mesh_distance.h"

#include "exit_status.h"
#include "failure.h"
#include "parallel.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>

enum { LEAF_TRIANGLES = 4, CHUNK = 4096, DEPTH_MOST = 64, LATTICE_MOST = 64, CODE_BITS = 20 };

typedef struct box {
    float low[3], high[3];
} box;

typedef struct ordered {
    uint64_t code;
    uint32_t triangle;
} ordered;

typedef struct tree {
    const mesh_view *mesh;
    ordered *order;
    box *boxes; /* node n has the children 2 n and 2 n + 1; the leaves are leaf_count to 2 leaf_count - 1 */
    uint64_t leaf_count;
} tree;

typedef struct search {
    const tree *to;
    double point[3];
    double square;    /* of the least distance so far */
    uint64_t nearest; /* triangle */
} search;

typedef struct job {
    const mesh_view *from;
    tree to;
    double spacing;
    uint64_t next_chunk;
    pthread_mutex_t lock;
    double greatest; /* square */
} job;

/* ------------------------------------------------------------------------------------------------------- triangles */

static void corner_of(const mesh_view *m, uint64_t triangle, int corner, double p[3]) {
    const float *at = m->positions + 3 * (uint64_t)m->triangles[3 * triangle + (uint64_t)corner];
    for (int k = 0; k < 3; k++) p[k] = at[k];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void difference(const double a[3], const double b[3], double d[3]) {
    for (int k = 0; k < 3; k++) d[k] = a[k] - b[k];
}

/* The square of the distance from p to the segment a b. */
static double segment_square(const double p[3], const double a[3], const double b[3]) {
    double along[3], to[3];
    difference(b, a, along);
    difference(p, a, to);
    const double length = dot(along, along), reach = dot(to, along);
    const double t = reach <= 0 ? 0 : reach < length ? reach / length : 1;
    for (int k = 0; k < 3; k++) to[k] -= t * along[k];
    return dot(to, to);
}

/* The foot of p on the plane lies in the triangle where it is on the inner side of all edges; else the nearest point is
 * on one of these. */
static double triangle_square(const mesh_view *m, uint64_t triangle, const double p[3]) {
    double v[3][3], u[3], w[3], normal[3];
    for (int k = 0; k < 3; k++) corner_of(m, triangle, k, v[k]);
    difference(v[1], v[0], u);
    difference(v[2], v[0], w);
    for (int k = 0; k < 3; k++) normal[k] = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
    const double length = dot(normal, normal);
    int is_inside = length > 0;
    for (int k = 0; k < 3 && is_inside; k++) {
        double edge[3], to[3];
        difference(v[(k + 1) % 3], v[k], edge);
        difference(p, v[k], to);
        const double inner[3] = {normal[1] * edge[2] - normal[2] * edge[1], normal[2] * edge[0] - normal[0] * edge[2],
                                 normal[0] * edge[1] - normal[1] * edge[0]};
        is_inside = dot(inner, to) >= 0;
    }
    if (is_inside) {
        difference(p, v[0], u);
        const double height = dot(u, normal);
        return height * height / length;
    }
    double least = segment_square(p, v[2], v[0]);
    for (int k = 0; k < 2; k++) {
        const double square = segment_square(p, v[k], v[k + 1]);
        if (square < least) least = square;
    }
    return least;
}

/* ------------------------------------------------------------------------------------------------------------- tree */

static void box_clear(box *b) {
    for (int k = 0; k < 3; k++) {
        b->low[k] = FLT_MAX;
        b->high[k] = -FLT_MAX;
    }
}

static void box_add(box *b, const float low[3], const float high[3]) {
    for (int k = 0; k < 3; k++) {
        if (low[k] < b->low[k]) b->low[k] = low[k];
        if (high[k] > b->high[k]) b->high[k] = high[k];
    }
}

static double box_square(const box *b, const double p[3]) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        const double below = b->low[k] - p[k], above = p[k] - b->high[k];
        const double d = below > above ? below : above;
        sum += d > 0 ? d * d : 0;
    }
    return sum;
}

/* Two zero bits between the bits of a number. */
static uint64_t spread_bits(uint64_t x) {
    uint64_t spread = 0;
    for (int bit = 0; bit < CODE_BITS; bit++) spread |= (x >> bit & 1) << 3 * bit;
    return spread;
}

static int compare_codes(const void *a, const void *b) {
    const ordered *x = a, *y = b;
    if (x->code != y->code) return x->code < y->code ? -1 : 1;
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static void sort_triangles(tree *t) {
    const mesh_view *m = t->mesh;
    box all;
    box_clear(&all);
    for (uint64_t v = 0; v < m->vertex_count; v++) box_add(&all, m->positions + 3 * v, m->positions + 3 * v);
    for (uint64_t n = 0; n < m->triangle_count; n++) {
        uint64_t code = 0;
        for (int k = 0; k < 3; k++) {
            double sum = 0, p[3];
            for (int c = 0; c < 3; c++) {
                corner_of(m, n, c, p);
                sum += p[k];
            }
            const double size = (double)all.high[k] - all.low[k], part = size > 0 ? (sum / 3 - all.low[k]) / size : 0;
            code |= spread_bits((uint64_t)(fmin(1, fmax(0, part)) * ((1 << CODE_BITS) - 1))) << k;
        }
        t->order[n] = (ordered){code, (uint32_t)n};
    }
    qsort(t->order, (size_t)m->triangle_count, sizeof *t->order, compare_codes);
}

static void fill_boxes(tree *t) {
    const mesh_view *m = t->mesh;
    for (uint64_t leaf = 0; leaf < t->leaf_count; leaf++) {
        box *b = &t->boxes[t->leaf_count + leaf];
        box_clear(b);
        for (uint64_t n = LEAF_TRIANGLES * leaf; n < LEAF_TRIANGLES * (leaf + 1) && n < m->triangle_count; n++)
            for (uint64_t c = 0; c < 3; c++) {
                const float *p = m->positions + 3 * (uint64_t)m->triangles[3 * (uint64_t)t->order[n].triangle + c];
                box_add(b, p, p);
            }
    }
    for (uint64_t n = t->leaf_count - 1; n > 0; n--) {
        t->boxes[n] = t->boxes[2 * n];
        box_add(&t->boxes[n], t->boxes[2 * n + 1].low, t->boxes[2 * n + 1].high);
    }
}

static int tree_make(const mesh_view *mesh, tree *t) {
    *t = (tree){.mesh = mesh, .leaf_count = 1};
    while (t->leaf_count * LEAF_TRIANGLES < mesh->triangle_count) t->leaf_count *= 2;
    t->order = malloc((size_t)mesh->triangle_count * sizeof *t->order);
    t->boxes = malloc((size_t)(2 * t->leaf_count) * sizeof *t->boxes);
    if (!t->order || !t->boxes)
        return fail(STATUS_FAILED, "out of memory to measure the distance to %llu triangles",
                    (unsigned long long)mesh->triangle_count);
    sort_triangles(t);
    fill_boxes(t);
    return 0;
}

/* ----------------------------------------------------------------------------------------------------------- search */

static void try_triangle(search *s, uint64_t triangle) {
    const double square = triangle_square(s->to->mesh, triangle, s->point);
    if (!(square < s->square)) return;
    s->square = square;
    s->nearest = triangle;
}

static void try_leaf(search *s, uint64_t leaf) {
    const tree *t = s->to;
    for (uint64_t n = LEAF_TRIANGLES * leaf; n < LEAF_TRIANGLES * (leaf + 1) && n < t->mesh->triangle_count; n++)
        try_triangle(s, t->order[n].triangle);
}

/* Goes on with the nearer child; the other one waits. Ends where the distance is known, or known to be no more than the
 * root of `enough`. */
static void find_nearest(search *s, double enough) {
    const tree *t = s->to;
    uint64_t waiting[DEPTH_MOST];
    double squares[DEPTH_MOST];
    int count = 0;
    waiting[count] = 1;
    squares[count++] = box_square(&t->boxes[1], s->point);
    while (count && s->square > enough) {
        uint64_t node = waiting[--count];
        double square = squares[count];
        while (square < s->square && node < t->leaf_count) {
            const double left = box_square(&t->boxes[2 * node], s->point);
            const double right = box_square(&t->boxes[2 * node + 1], s->point);
            const int is_right = right < left;
            waiting[count] = 2 * node + !is_right;
            squares[count++] = is_right ? left : right;
            node = 2 * node + (uint64_t)is_right;
            square = is_right ? right : left;
        }
        if (square < s->square) try_leaf(s, node - t->leaf_count);
    }
}

static void measure_point(search *s, double *greatest) {
    s->square = INFINITY;
    try_triangle(s, s->nearest);
    find_nearest(s, *greatest);
    if (s->square > *greatest) *greatest = s->square;
}

static void measure_vertex(const job *j, uint64_t vertex, search *s, double *greatest) {
    for (int k = 0; k < 3; k++) s->point[k] = j->from->positions[3 * vertex + (uint64_t)k];
    measure_point(s, greatest);
}

/* The centroid, and points between it and the corners. */
static void measure_triangle(const job *j, uint64_t triangle, search *s, double *greatest) {
    double v[3][3], edge[3], longest = 0;
    for (int k = 0; k < 3; k++) corner_of(j->from, triangle, k, v[k]);
    for (int k = 0; k < 3; k++) {
        difference(v[k], v[(k + 1) % 3], edge);
        longest = fmax(longest, sqrt(dot(edge, edge)));
    }
    const double parts = j->spacing > 0 ? ceil(longest / j->spacing) : 1;
    const int steps = parts > LATTICE_MOST ? LATTICE_MOST : parts < 1 ? 1 : (int)parts;
    for (int a = 0; a <= steps; a++)
        for (int b = 0; a + b <= steps; b++) {
            if (a == steps || b == steps || !(a + b)) continue; /* a corner */
            for (int k = 0; k < 3; k++)
                s->point[k] = v[0][k] + (a * (v[1][k] - v[0][k]) + b * (v[2][k] - v[0][k])) / steps;
            measure_point(s, greatest);
        }
    for (int k = 0; k < 3; k++) s->point[k] = (v[0][k] + v[1][k] + v[2][k]) / 3;
    measure_point(s, greatest);
}

static uint64_t sample_groups(const job *j) { return j->from->vertex_count + j->from->triangle_count; }

static void measure_chunks(void *shared) {
    job *j = shared;
    search s = {.to = &j->to};
    double greatest = 0;
    uint64_t first;
    while ((first = __atomic_fetch_add(&j->next_chunk, 1, __ATOMIC_RELAXED) * CHUNK) < sample_groups(j))
        for (uint64_t n = first; n < first + CHUNK && n < sample_groups(j); n++)
            if (n < j->from->vertex_count)
                measure_vertex(j, n, &s, &greatest);
            else
                measure_triangle(j, n - j->from->vertex_count, &s, &greatest);
    pthread_mutex_lock(&j->lock);
    if (greatest > j->greatest) j->greatest = greatest;
    pthread_mutex_unlock(&j->lock);
}

int mesh_distance(const mesh_view *from, const mesh_view *to, double spacing, double *distance) {
    job j = {.from = from, .spacing = spacing};
    *distance = from->triangle_count && !to->triangle_count ? INFINITY : 0;
    if (!from->triangle_count || !to->triangle_count) return 0;
    pthread_mutex_init(&j.lock, NULL);
    const int status = tree_make(to, &j.to);
    if (!status) parallel_run((sample_groups(&j) + CHUNK - 1) / CHUNK, measure_chunks, &j);
    *distance = sqrt(j.greatest);
    free(j.to.order);
    free(j.to.boxes);
    pthread_mutex_destroy(&j.lock);
    return status;
}

double mesh_spacing(const mesh_view *m) {
    double area = 0;
    for (uint64_t n = 0; n < m->triangle_count; n++) {
        double v[3][3], u[3], w[3], sum = 0;
        for (int k = 0; k < 3; k++) corner_of(m, n, k, v[k]);
        difference(v[1], v[0], u);
        difference(v[2], v[0], w);
        for (int k = 0; k < 3; k++) {
            const double c = u[(k + 1) % 3] * w[(k + 2) % 3] - u[(k + 2) % 3] * w[(k + 1) % 3];
            sum += c * c;
        }
        area += sqrt(sum) / 2;
    }
    return m->triangle_count ? sqrt(area / (double)m->triangle_count) : 0;
}
