#include "grid/origin.h"

#include "far.h"
#include "parallel.h"

#include <math.h>
#include <pthread.h>

enum { PROBED_CELLS = 4096, CHUNK = 1 << 14 };

const extent extent_empty = {
    {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}};

static void extent_join(extent *e, const extent *other) {
    for (int axis = 0; axis < 3; axis++) {
        if (other->low[axis] < e->low[axis]) e->low[axis] = other->low[axis];
        if (other->high[axis] > e->high[axis]) e->high[axis] = other->high[axis];
        if (other->cell[axis] < e->cell[axis]) e->cell[axis] = other->cell[axis];
    }
}

void extent_add(extent *e, const double corners[][3], int count) {
    extent cell = extent_empty;
    for (int n = 0; n < count; n++)
        for (int axis = 0; axis < 3; axis++) {
            double at = corners[n][axis];
            if (at < cell.low[axis]) cell.low[axis] = at;
            if (at > cell.high[axis]) cell.high[axis] = at;
        }
    for (int axis = 0; axis < 3; axis++)
        if (cell.high[axis] > cell.low[axis]) cell.cell[axis] = cell.high[axis] - cell.low[axis];
    extent_join(e, &cell);
}

static bool cells_far(const extent *e) {
    for (int axis = 0; axis < 3; axis++)
        if (far_reach(e->low[axis], e->high[axis], 0) > far_cells * e->cell[axis]) return true;
    return false;
}

void origin_choose(const extent *e, double origin[3]) {
    for (int axis = 0; axis < 3; axis++) {
        const double size = e->high[axis] - e->low[axis];
        int exponent;
        origin[axis] = 0;
        if (!lies_far(e->low[axis], e->high[axis], e->cell[axis], 0)) continue;
        frexp(size, &exponent);
        const double step = ldexp(1, exponent), middle = e->low[axis] + size / 2;
        if (step > 0) origin[axis] = step * rint(middle / step);
    }
}

/* ------------------------------------------------------------------------------------------------------ all cells */

typedef struct search {
    cell_corners *corners;
    const void *source;
    uint64_t cell_count, next;
    extent all;
    pthread_mutex_t lock;
} search;

static void cell_visit(const search *s, uint64_t cell, extent *e) {
    double corners[8][3];
    int count = s->corners(s->source, cell, corners);
    if (count) extent_add(e, (const double(*)[3])corners, count);
}

static void cells_visit(void *shared) {
    search *s = shared;
    extent own = extent_empty;
    uint64_t first;
    while ((first = __atomic_fetch_add(&s->next, CHUNK, __ATOMIC_RELAXED)) < s->cell_count)
        for (uint64_t cell = first; cell < first + CHUNK && cell < s->cell_count; cell++) cell_visit(s, cell, &own);
    pthread_mutex_lock(&s->lock);
    extent_join(&s->all, &own);
    pthread_mutex_unlock(&s->lock);
}

void origin_find(cell_corners *corners, const void *source, uint64_t cell_count, double origin[3]) {
    search s = {corners, source, cell_count, 0, extent_empty, PTHREAD_MUTEX_INITIALIZER};
    const uint64_t stride = cell_count / PROBED_CELLS + 1;
    extent probe = extent_empty;
    for (uint64_t cell = 0; cell < cell_count; cell += stride) cell_visit(&s, cell, &probe);
    const bool found = probe.low[0] <= probe.high[0];
    if (!found || cells_far(&probe)) parallel_run((cell_count + CHUNK - 1) / CHUNK, cells_visit, &s);
    origin_choose(&s.all, origin);
}

/* ------------------------------------------------------------------------------------------------------ conversion */

typedef struct conversion {
    coordinate_array from;
    uint64_t tuple_count, next;
    int components;
    const double *origin;
    float *to;
} conversion;

static void chunks_move(void *shared) {
    conversion *c = shared;
    const uint64_t components = (uint64_t)c->components;
    uint64_t first;
    while ((first = __atomic_fetch_add(&c->next, CHUNK, __ATOMIC_RELAXED)) < c->tuple_count) {
        const uint64_t end = c->tuple_count - first < CHUNK ? c->tuple_count : first + CHUNK;
        for (uint64_t tuple = first; tuple < end; tuple++)
            for (uint64_t k = 0, n = components * tuple; k < components; k++, n++)
                c->to[n] = (float)(coordinate_get(c->from, n) - c->origin[k]);
    }
}

void coordinates_move(coordinate_array from, uint64_t tuple_count, int components, const double *origin, float *to) {
    conversion c = {from, tuple_count, 0, components, origin, to};
    parallel_run((tuple_count + CHUNK - 1) / CHUNK, chunks_move, &c);
}
