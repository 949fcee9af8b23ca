/*
 * mesh_summary.c - bounds, degenerate triangles and the hash of a mesh: one pass over each array
 *
 * A triangle is degenerate when the cross product of two of its sides, float positions subtracted and multiplied in
 * double, is exactly zero. A side of length zero makes it so, hence two corners at one position are covered.
 *
 * Bounds take four vertices, three vectors of four numbers, at once. Vertices that are not finite are found by x - x,
 * which is then NaN, and a block with one is gone over again vertex by vertex. Blocks are shared among threads.
 */
#include "mesh_check.h"

#include "parallel.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#ifndef SUMMARY_BLOCK
#define SUMMARY_BLOCK 16384 /* vertices or triangles that a thread takes at once */
#endif

typedef float vector __attribute__((vector_size(16)));
typedef int32_t mask __attribute__((vector_size(16)));

typedef struct job {
    const float *positions;
    const uint32_t *triangles;
    uint64_t vertex_count, triangle_count;

    pthread_mutex_t lock;
    uint64_t next; /* block that nobody has taken: those of vertices come first */
    mesh_summary total;
} job;

/* ---------------------------------------------------------------------------------------------------------- bounds */

static const mesh_summary nothing = {.bounds = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}};

static int is_finite(const float p[3]) { return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]); }

static void extend_bounds(double bounds[2][3], double low, double high, int axis) {
    if (low < bounds[0][axis]) bounds[0][axis] = low;
    if (high > bounds[1][axis]) bounds[1][axis] = high;
}

static void add_vertices(const float *positions, uint64_t count, mesh_summary *sum) {
    for (const float *p = positions; p < positions + 3 * count; p += 3) {
        sum->nonfinite_vertices += (uint64_t)!is_finite(p);
        for (int axis = 0; axis < 3 && is_finite(p); axis++)
            extend_bounds(sum->bounds, (double)p[axis], (double)p[axis], axis);
    }
}

/* a where the mask is set, else b. */
static vector choose(mask where, vector a, vector b) { return (vector)(((mask)a & where) | ((mask)b & ~where)); }

/* The same for count vertices, a multiple of 4. Returns 0, and adds nothing, where one is not finite. */
static int add_finite_vertices(const float *positions, uint64_t count, mesh_summary *sum) {
    float low[12], high[12], spoilt[12];
    vector least[3], most[3], nan[3], at;
    for (int n = 0; n < 3; n++) {
        least[n] = (vector){INFINITY, INFINITY, INFINITY, INFINITY};
        most[n] = -least[n];
        nan[n] = (vector){0};
    }
    for (const float *p = positions; p < positions + 3 * count; p += 12)
        for (int n = 0; n < 3; n++) {
            memcpy(&at, p + 4 * n, sizeof at);
            least[n] = choose(at < least[n], at, least[n]);
            most[n] = choose(at > most[n], at, most[n]);
            /* NaN where it is not finite. NOLINTNEXTLINE(misc-redundant-expression) */
            nan[n] += at - at;
        }
    memcpy(low, least, sizeof low);
    memcpy(high, most, sizeof high);
    memcpy(spoilt, nan, sizeof spoilt);
    for (int n = 0; n < 12; n++)
        if (isnan(spoilt[n])) return 0;
    for (int n = 0; n < 12 && count > 0; n++) extend_bounds(sum->bounds, (double)low[n], (double)high[n], n % 3);
    return 1;
}

static void add_vertex_block(const float *positions, uint64_t count, mesh_summary *sum) {
    uint64_t fours = count / 4 * 4;
    if (!add_finite_vertices(positions, fours, sum)) add_vertices(positions, fours, sum);
    add_vertices(positions + 3 * fours, count - fours, sum);
}

/* ------------------------------------------------------------------------------------------------------- triangles */

static int is_degenerate(const float a[3], const float b[3], const float c[3]) {
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = (double)b[axis] - (double)a[axis];
        v[axis] = (double)c[axis] - (double)a[axis];
    }
    return u[1] * v[2] == u[2] * v[1] && u[2] * v[0] == u[0] * v[2] && u[0] * v[1] == u[1] * v[0];
}

static void add_triangle_block(const job *j, const uint32_t *triangles, uint64_t count, mesh_summary *sum) {
    for (const uint32_t *v = triangles; v < triangles + 3 * count; v += 3) {
        if (v[0] >= j->vertex_count || v[1] >= j->vertex_count || v[2] >= j->vertex_count) continue;
        const float *a = j->positions + 3 * (uint64_t)v[0], *b = j->positions + 3 * (uint64_t)v[1],
                    *c = j->positions + 3 * (uint64_t)v[2];
        sum->degenerate_triangles += (uint64_t)is_degenerate(a, b, c);
    }
}

/* ---------------------------------------------------------------------------------------------------------- blocks */

static uint64_t block_count(uint64_t count) { return count / SUMMARY_BLOCK + (count % SUMMARY_BLOCK > 0); }

static uint64_t block_size(uint64_t block, uint64_t count) {
    return count - block * SUMMARY_BLOCK < SUMMARY_BLOCK ? count - block * SUMMARY_BLOCK : SUMMARY_BLOCK;
}

static uint64_t take_block(job *j) {
    pthread_mutex_lock(&j->lock);
    uint64_t block = j->next++;
    pthread_mutex_unlock(&j->lock);
    return block;
}

static void add_sum(job *j, const mesh_summary *sum) {
    pthread_mutex_lock(&j->lock);
    for (int axis = 0; axis < 3; axis++)
        extend_bounds(j->total.bounds, sum->bounds[0][axis], sum->bounds[1][axis], axis);
    j->total.degenerate_triangles += sum->degenerate_triangles;
    j->total.nonfinite_vertices += sum->nonfinite_vertices;
    pthread_mutex_unlock(&j->lock);
}

static void add_blocks(void *shared) {
    job *j = shared;
    mesh_summary sum = nothing;
    uint64_t vertex_blocks = block_count(j->vertex_count), triangle_blocks = block_count(j->triangle_count), block;
    while ((block = take_block(j)) < vertex_blocks)
        add_vertex_block(j->positions + (uint64_t)3 * SUMMARY_BLOCK * block, block_size(block, j->vertex_count), &sum);
    for (; (block -= vertex_blocks) < triangle_blocks; block = take_block(j))
        add_triangle_block(j, j->triangles + (uint64_t)3 * SUMMARY_BLOCK * block, block_size(block, j->triangle_count),
                           &sum);
    add_sum(j, &sum);
}

void mesh_summarize(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                    mesh_summary *result) {
    job j = {.positions = positions,
             .triangles = triangles,
             .vertex_count = vertex_count,
             .triangle_count = triangle_count,
             .lock = PTHREAD_MUTEX_INITIALIZER,
             .total = nothing};
    parallel_run(block_count(vertex_count) + block_count(triangle_count), add_blocks, &j);
    *result = j.total;
    if (result->nonfinite_vertices == vertex_count) memset(result->bounds, 0, sizeof result->bounds);
}

uint64_t mesh_hash(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count) {
    return mesh_hash_add(0, positions, vertex_count, triangles, triangle_count);
}

uint64_t mesh_hash_add(uint64_t before, const float *positions, uint64_t vertex_count, const uint32_t *triangles,
                       uint64_t triangle_count) {
    XXH64_state_t state;
    XXH64_reset(&state, before);
    if (vertex_count > 0) XXH64_update(&state, positions, vertex_count * 3 * sizeof(float));
    if (triangle_count > 0) XXH64_update(&state, triangles, triangle_count * 3 * sizeof(uint32_t));
    return XXH64_digest(&state);
}
