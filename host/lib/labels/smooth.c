/*
 * Each sweep reads only old positions and writes new ones, so neither threads nor the order of vertices change a bit.
 * The box of a vertex lies along the grid's axes, around the position where it was made. Three arrays are enough: these
 * positions, a second one, and the mesh's own positions, to which the last sweep leads. Positions are read as four
 * components, of which the last means nothing.
 */
#include "labels/smooth.h"

#include "failure.h"
#include "labels/neighbours.h"
#include "opencl/context.h"
#include "parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

typedef float vector __attribute__((vector_size(16)));
typedef int32_t bits __attribute__((vector_size(16)));

enum { PAST = 4 }; /* floats behind an array, of which the last vertex's read takes one */

/* A vertex of the next layer of bricks lies far away in memory. Neighbours are prefetched NEIGHBOURS_AHEAD entries of
 * the lists before they are read, as many for each vertex as most have. */
enum { PREFETCHED = 6 };

static const float reach = 0.45f; /* cells, along each axis: surfaces on either side of a sample keep apart */
static const float pull = 0.75f;  /* of the way to the mean of the neighbours */

typedef struct smoothing {
    const label_volume *v;
    neighbour_lists lists;
    float matrix[3][3], inverse[3][3]; /* from index space, and into it */
    bool is_straight;                  /* the grid's axes are those of space */
    vector most;                       /* then: how far a vertex may move */
    float shares[UINT8_MAX + 1];       /* of each of n neighbours */
    float *mesh, *made, *second;       /* the mesh's own positions; where vertices were made */
    const float *from;
    float *to;
    _Atomic uint64_t next;
} smoothing;

static void invert(smoothing *s) {
    const float *m = s->v->grid->matrix;
    double a[3][3], determinant = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) s->matrix[r][c] = m[4 * r + c], a[r][c] = (double)m[4 * r + c];
    for (int c = 0; c < 3; c++)
        determinant += a[0][c] * (a[1][(c + 1) % 3] * a[2][(c + 2) % 3] - a[1][(c + 2) % 3] * a[2][(c + 1) % 3]);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            const int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            s->inverse[c][r] = (float)((a[r1][c1] * a[r2][c2] - a[r1][c2] * a[r2][c1]) / determinant);
        }
    s->is_straight = true;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) s->is_straight = s->is_straight && (r == c || s->matrix[r][c] == 0);
    for (int axis = 0; axis < 3; axis++) s->most[axis] = reach * fabsf(s->matrix[axis][axis]);
    for (int n = 1; n <= UINT8_MAX; n++) s->shares[n] = pull / (float)n;
}

static vector vector_load(const float *from, uint64_t vertex) {
    vector v;
    memcpy(&v, from + 3 * vertex, sizeof v);
    return v;
}

/* Vertices at the end of a mesh stay in the planes of the grid's border that they lie in. */
static uint8_t fixed_axes(const smoothing *s, const float made[3]) {
    const tc_grid *grid = s->v->grid;
    uint8_t fixed = 0;
    for (int axis = 0; axis < 3; axis++) {
        double index = 0;
        for (int r = 0; r < 3; r++)
            index += (double)s->inverse[axis][r] * ((double)made[r] - (double)grid->matrix[4 * r + 3]);
        index -= (double)(grid->first[axis] - s->v->before);
        if (fabs(index) < 0.1 || fabs(index - (double)(s->v->dims[axis] - 1)) < 0.1) fixed |= (uint8_t)(1 << axis);
    }
    return fixed;
}

/* From here on, on_border has the axes along which a vertex does not move. */
static void ranges_begin(void *shared) {
    smoothing *s = shared;
    for (uint64_t n; (n = atomic_fetch_add(&s->next, 1)) < s->lists.range_count;) {
        const neighbour_range *r = &s->lists.ranges[n];
        memcpy(s->made + 3 * (uint64_t)r->first, s->mesh + 3 * (uint64_t)r->first,
               (size_t)(r->end - r->first) * CHANNEL_BYTES);
        for (uint64_t v = r->first; v < r->end; v++)
            if (r->on_border[v - r->first]) r->on_border[v - r->first] = fixed_axes(s, s->mesh + 3 * v);
    }
}

/* A vertex that may have left its box, in space or along some axes. */
static vector constrain(const smoothing *s, uint8_t fixed, vector made, vector at) {
    const vector moved = at - made;
    float index[3];
    bool is_out = false;
    for (int axis = 0; axis < 3; axis++) {
        const float *m = s->inverse[axis], most = fixed >> axis & 1 ? 0 : reach;
        const float i = (m[0] * moved[0] + m[1] * moved[1]) + m[2] * moved[2];
        index[axis] = i > most ? most : i < -most ? -most : i;
        is_out |= index[axis] != i;
    }
    for (int r = 0; r < 3 && is_out; r++) {
        const float *m = s->matrix[r];
        at[r] = made[r] + ((m[0] * index[0] + m[1] * index[1]) + m[2] * index[2]);
    }
    return at;
}

static vector lesser(vector a, vector b) {
    const bits is = a < b;
    return (vector)(((bits)a & is) | ((bits)b & ~is));
}

static vector constrain_straight(vector most, vector made, vector at) {
    return made - lesser(-lesser(at - made, most), most);
}

/* What the loop reads of the structures lies in variables: compilers cannot know that positions do not overwrite it. */
static void range_move(const smoothing *s, const neighbour_range *r) {
    const float *from = s->from, *made = s->made, *shares = s->shares;
    const uint8_t *counts = r->counts, *fixed = r->on_border;
    const uint32_t *starts = r->starts, *vertices = r->vertices, first = r->first, size = r->end - first;
    const bool is_straight = s->is_straight;
    const vector most = s->most;
    float *to = s->to;
    for (uint32_t n = 0; n < size; n++) {
        const uint64_t vertex = first + (uint64_t)n;
        const uint32_t *neighbours = vertices + starts[n], count = counts[n];
        const vector old = vector_load(from, vertex), start = vector_load(made, vertex);
        vector sum = {0, 0, 0, 0};
        for (uint32_t m = 0; m < PREFETCHED; m++)
            __builtin_prefetch(from + 3 * (uint64_t)neighbours[NEIGHBOURS_AHEAD + m]);
        for (uint32_t m = 0; m < count; m++) sum += vector_load(from, neighbours[m]) - old;
        vector at = old + shares[count] * sum;
        at = is_straight && !fixed[n] ? constrain_straight(most, start, at) : constrain(s, fixed[n], start, at);
        memcpy(to + 3 * vertex, &at, n + 1 < size ? sizeof at : CHANNEL_BYTES); /* the next one is made after it */
    }
}

static void ranges_move(void *shared) {
    smoothing *s = shared;
    for (uint64_t n; (n = atomic_fetch_add(&s->next, 1)) < s->lists.range_count;) range_move(s, &s->lists.ranges[n]);
}

static void on_ranges(smoothing *s, void (*work)(void *shared)) {
    atomic_store(&s->next, 0);
    parallel_run(s->lists.range_count, work, s);
}

static tc_status sweep(smoothing *s, uint32_t sweeps) {
    tc_status status = TC_OK;
    on_ranges(s, ranges_begin);
    for (uint32_t n = 0; n < sweeps && !status; n++) {
        s->from = n ? s->to : s->made;
        s->to = (sweeps - n) & 1 ? s->mesh : s->second;
        on_ranges(s, ranges_move);
        status = context_progress(s->v->grid->context, "smooth", (double)(n + 1) / (double)sweeps);
    }
    return status;
}

tc_status labels_smooth(const label_volume *volume, uint32_t sweeps, tc_mesh *mesh) {
    tc_context *context = volume->grid->context;
    host_block *blocks = context->smoothing;
    const uint64_t vertices = mesh->vertex_count;
    if (!sweeps || !vertices) return TC_OK;
    smoothing *s = calloc(1, sizeof *s);
    tc_status status = TC_OK;
    if (!s || host_block_reserve(&blocks[0], 2 * (vertices * CHANNEL_BYTES + PAST * sizeof(float))))
        status = (tc_status)fail(TC_ERROR_MEMORY, "no memory to smooth the surfaces: ask for no smoothing");
    if (!status) status = neighbours_find(mesh, blocks[0].memory, &blocks[1], &blocks[2], &s->lists);
    if (!status) {
        s->v = volume;
        s->mesh = mesh->channels[CHANNEL_POSITIONS].memory;
        s->made = blocks[0].memory;
        s->second = s->made + 3 * vertices + PAST;
        invert(s);
        status = sweep(s, sweeps);
    }
    free(s);
    for (int n = 0; n < SMOOTHING_BLOCKS; n++) host_block_idle(&blocks[n]);
    return status;
}
