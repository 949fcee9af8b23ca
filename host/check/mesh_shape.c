/*
 * mesh_shape.c - the smallest angle of every triangle
 *
 * It lies opposite to the shortest side, so between the two others. Its tangent is the length of their cross product
 * over their dot product, which tells small angles well. Blocks of triangles are shared among threads; what they add
 * are counts, so that the order does not matter.
 */
#include "mesh_check.h"

#include "parallel.h"

#include <math.h>
#include <pthread.h>

#ifndef SHAPE_BLOCK
#define SHAPE_BLOCK 16384 /* triangles that a thread takes at once */
#endif

typedef struct job {
    const float *positions;
    const uint32_t *triangles;
    uint64_t vertex_count, triangle_count;

    pthread_mutex_t lock;
    uint64_t next; /* triangle that nobody has taken */
    mesh_shapes *total;
} job;

static double dot(const double u[3], const double v[3]) { return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]; }

/* In degrees, 0 where the area is; negative where there is none: a corner out of range, twice or not finite. */
static double smallest_angle(const job *j, const uint32_t v[3]) {
    double sides[3][3], squares[3], cross[3];
    int shortest = 0;
    if (v[0] >= j->vertex_count || v[1] >= j->vertex_count || v[2] >= j->vertex_count || v[0] == v[1] || v[1] == v[2] ||
        v[2] == v[0])
        return -1;
    for (int n = 0; n < 3; n++) {
        const float *from = j->positions + 3 * (uint64_t)v[n], *to = j->positions + 3 * (uint64_t)v[(n + 1) % 3];
        for (int axis = 0; axis < 3; axis++) sides[n][axis] = (double)to[axis] - (double)from[axis];
        squares[n] = dot(sides[n], sides[n]);
        if (squares[n] < squares[shortest]) shortest = n;
    }
    if (!isfinite(squares[0] + squares[1] + squares[2])) return -1;
    const double *a = sides[(shortest + 1) % 3], *b = sides[(shortest + 2) % 3];
    for (int axis = 0; axis < 3; axis++)
        cross[axis] = a[(axis + 1) % 3] * b[(axis + 2) % 3] - a[(axis + 2) % 3] * b[(axis + 1) % 3];
    const double area = sqrt(dot(cross, cross));
    /* one side runs to the corner, the other from it */
    return area > 0 ? atan2(area, -dot(a, b)) * (180 / 3.14159265358979323846) : 0;
}

static void add_triangles(const job *j, uint64_t first, uint64_t end, mesh_shapes *sum) {
    for (uint64_t n = first; n < end; n++) {
        const double angle = smallest_angle(j, j->triangles + 3 * n);
        if (angle < 0) continue;
        sum->triangles++;
        sum->below_10 += angle < 10;
        sum->below_20 += angle < 20;
        sum->by_tenth[(int)(10 * angle + 0.5)]++;
    }
}

static uint64_t take_block(job *j) {
    pthread_mutex_lock(&j->lock);
    const uint64_t first = j->next;
    j->next += SHAPE_BLOCK;
    pthread_mutex_unlock(&j->lock);
    return first;
}

static void add_blocks(void *shared) {
    job *j = shared;
    mesh_shapes sum = {0};
    for (uint64_t first; (first = take_block(j)) < j->triangle_count;) {
        const uint64_t rest = j->triangle_count - first;
        add_triangles(j, first, first + (rest < SHAPE_BLOCK ? rest : SHAPE_BLOCK), &sum);
    }
    pthread_mutex_lock(&j->lock);
    j->total->triangles += sum.triangles;
    j->total->below_10 += sum.below_10;
    j->total->below_20 += sum.below_20;
    for (int n = 0; n < SHAPE_ANGLES; n++) j->total->by_tenth[n] += sum.by_tenth[n];
    pthread_mutex_unlock(&j->lock);
}

void mesh_shapes_add(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                     mesh_shapes *sum) {
    job j = {.positions = positions,
             .triangles = triangles,
             .vertex_count = vertex_count,
             .triangle_count = triangle_count,
             .lock = PTHREAD_MUTEX_INITIALIZER,
             .total = sum};
    parallel_run(triangle_count / SHAPE_BLOCK + 1, add_blocks, &j);
}

double mesh_shapes_median(const mesh_shapes *shapes) {
    uint64_t seen = 0;
    for (int n = 0; n < SHAPE_ANGLES; n++)
        if ((seen += shapes->by_tenth[n]) * 2 >= shapes->triangles && seen) return n / 10.0;
    return 0;
}
