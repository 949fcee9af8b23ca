/*
 * Each sweep makes new positions of all old ones, so neither threads nor the order of vertices change a bit. The box of
 * a vertex lies along the grid's axes, around the place where it was made.
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

static const float reach = 0.45f; /* cells, along each axis: surfaces on either side of a sample keep apart */

typedef struct smoothing {
    const label_volume *v;
    neighbour_lists lists;
    float matrix[3][3], inverse[3][3]; /* from index space, and into it */
    uint8_t *fixed;                    /* one per vertex: bit n, it does not move along axis n */
    const float *places;               /* where vertices were made */
    const float *from;
    float *to;
    _Atomic uint64_t next;
} smoothing;

static float *positions_allocate(uint64_t vertices) { return malloc((size_t)(3 * vertices + 1) * sizeof(float)); }

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
}

/* Vertices at the end of a mesh stay in the planes of the grid's border that they lie in. */
static uint8_t fixed_axes(const smoothing *s, const float place[3]) {
    const tc_grid *grid = s->v->grid;
    uint8_t fixed = 0;
    for (int axis = 0; axis < 3; axis++) {
        double index = 0;
        for (int r = 0; r < 3; r++)
            index += (double)s->inverse[axis][r] * ((double)place[r] - (double)grid->matrix[4 * r + 3]);
        index -= (double)(grid->first[axis] - s->v->before);
        if (fabs(index) < 0.1 || fabs(index - (double)(s->v->dims[axis] - 1)) < 0.1) fixed |= (uint8_t)(1 << axis);
    }
    return fixed;
}

static void ranges_fix(void *shared) {
    smoothing *s = shared;
    for (uint64_t n; (n = atomic_fetch_add(&s->next, 1)) < s->lists.range_count;) {
        const neighbour_range *r = &s->lists.ranges[n];
        for (uint32_t v = r->first; v < r->end; v++)
            s->fixed[v] = r->on_border[v - r->first] ? fixed_axes(s, s->places + 3 * (uint64_t)v) : 0;
    }
}

/* Keeps a vertex in its box. */
static void constrain(const smoothing *s, uint8_t fixed, const float place[3], float at[3]) {
    float moved[3], index[3];
    bool is_out = false;
    for (int axis = 0; axis < 3; axis++) moved[axis] = at[axis] - place[axis];
    for (int axis = 0; axis < 3; axis++) {
        const float *m = s->inverse[axis], most = fixed >> axis & 1 ? 0 : reach;
        const float i = (m[0] * moved[0] + m[1] * moved[1]) + m[2] * moved[2];
        index[axis] = i > most ? most : i < -most ? -most : i;
        is_out |= index[axis] != i;
    }
    for (int r = 0; r < 3 && is_out; r++) {
        const float *m = s->matrix[r];
        at[r] = place[r] + ((m[0] * index[0] + m[1] * index[1]) + m[2] * index[2]);
    }
}

static void vertex_move(const smoothing *s, const neighbour_range *r, uint32_t vertex) {
    const uint32_t n = vertex - r->first, begin = r->starts[n], end = r->starts[n + 1];
    const float *old = s->from + 3 * (uint64_t)vertex;
    float *at = s->to + 3 * (uint64_t)vertex, sum[3] = {0, 0, 0};
    for (uint32_t e = begin; e < end; e++) {
        const float *p = s->from + 3 * (uint64_t)r->vertices[e];
        for (int axis = 0; axis < 3; axis++) sum[axis] += p[axis] - old[axis];
    }
    const float half = end > begin ? 0.5f / (float)(end - begin) : 0;
    for (int axis = 0; axis < 3; axis++) at[axis] = old[axis] + half * sum[axis];
    constrain(s, s->fixed[vertex], s->places + 3 * (uint64_t)vertex, at);
}

static void ranges_move(void *shared) {
    smoothing *s = shared;
    for (uint64_t n; (n = atomic_fetch_add(&s->next, 1)) < s->lists.range_count;)
        for (uint32_t v = s->lists.ranges[n].first; v < s->lists.ranges[n].end; v++)
            vertex_move(s, &s->lists.ranges[n], v);
}

static void on_ranges(smoothing *s, void (*work)(void *shared)) {
    atomic_store(&s->next, 0);
    parallel_run(s->lists.range_count, work, s);
}

static tc_status sweep(smoothing *s, uint32_t sweeps, float *const places[2]) {
    tc_status status = TC_OK;
    on_ranges(s, ranges_fix);
    for (uint32_t n = 0; n < sweeps && !status; n++) {
        s->from = n ? places[n & 1] : s->places;
        s->to = places[~n & 1];
        on_ranges(s, ranges_move);
        status = context_progress(s->v->grid->context, "smooth", (double)(n + 1) / (double)sweeps);
    }
    return status;
}

tc_status labels_smooth(const label_volume *volume, uint32_t sweeps, tc_mesh *mesh) {
    smoothing s = {.v = volume};
    host_block *made = &mesh->channels[CHANNEL_POSITIONS];
    float *places[2] = {positions_allocate(mesh->vertex_count), positions_allocate(mesh->vertex_count)};
    s.places = made->memory;
    s.fixed = malloc((size_t)mesh->vertex_count + 1);
    tc_status status = TC_OK;
    if (!sweeps || !mesh->vertex_count) goto cleanup;
    if (!places[0] || !places[1] || !s.fixed)
        status = (tc_status)fail(TC_ERROR_MEMORY, "no memory to smooth the surfaces: ask for no smoothing");
    invert(&s);
    if (!status) status = neighbours_find(mesh, &s.lists);
    if (!status) status = sweep(&s, sweeps, places);
    if (!status) memcpy(made->memory, s.to, (size_t)mesh->vertex_count * CHANNEL_BYTES);
cleanup:
    neighbours_release(&s.lists);
    free(s.fixed);
    free(places[0]);
    free(places[1]);
    return status;
}
