/*
 * What the host does with active cells between kernels: it compares them with their tetrahedra, and chooses their
 * cases. Threads take shares of the list.
 */
#include "tetrahedra/whole_run.h"

#include "failure.h"
#include "parallel.h"

#include <stdatomic.h>

enum { SHARE = 1 << 11 };

typedef struct assignment {
    const complex_grid *c;
    const struct whole_cells *w;
    whole_cases *cases;
    active_cell *cells;
    const uint32_t *points; /* of a slab, or NULL */
    uint64_t count;
    _Atomic uint64_t next, edges;
    atomic_bool differ, no_memory;
} assignment;

/* The first tetrahedron whose cell's number is not below `cell`, searched from `near` on; numbers rise. */
static uint64_t tetrahedron_find(const complex_grid *c, uint32_t cell, uint64_t near) {
    uint64_t low = 0, high = c->tetrahedron_count, step = 1; /* those below low are before it, those from high on not */
    if (near >= high) near = high - 1;
    if (c->cells[near] < cell) {
        for (low = near + 1; low + step < high && c->cells[low + step] < cell; step *= 2) low += step + 1;
        if (low + step < high) high = low + step;
    } else {
        for (high = near; high >= step && c->cells[high - step] >= cell; step *= 2) high -= step;
        if (high >= step) low = high - step + 1;
    }
    while (low < high) {
        const uint64_t middle = low + (high - low) / 2;
        if (c->cells[middle] < cell)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* What a cell whose points compare so is cut into, by corners. */
typedef struct known_split {
    cell_shape shape;
    uint32_t order;
    int count; /* 0: none is known */
    uint8_t tetrahedra[CELL_TETRAHEDRA_MAX][4];
} known_split;

enum { KNOWN_SPLITS = 64 };

/* What a thread knows. */
typedef struct knowledge {
    uint64_t near; /* behind the tetrahedra of the last cell */
    uint32_t cell;
    known_split splits[KNOWN_SPLITS];
} knowledge;

static uint8_t corner_of(const uint32_t *points, uint32_t point) {
    uint8_t n = 0;
    while (points[n] != point) n++;
    return n;
}

static const known_split *split_get(knowledge *k, cell_shape shape, uint32_t order, const uint32_t *points) {
    uint32_t cut[CELL_TETRAHEDRA_MAX][4];
    known_split *s = &k->splits[(order ^ order >> 6 ^ order >> 12 ^ (uint32_t)shape) % KNOWN_SPLITS];
    if (order != NO_ORDER && s->count && s->shape == shape && s->order == order) return s;
    *s = (known_split){.shape = shape, .order = order, .count = cell_split(shape, points, cut)};
    for (int n = 0; n < 4 * s->count; n++) s->tetrahedra[n / 4][n % 4] = corner_of(points, cut[n / 4][n % 4]);
    return s;
}

/* Whether these are the tetrahedra of the cell, all in one orientation or all turned over. */
static bool tetrahedra_match(const known_split *s, const uint32_t *points, const uint32_t *given, bool *mirrored) {
    uint32_t straight = 0, turned = 0;
    for (int n = 0; n < s->count; n++, given += 4) {
        const uint8_t *t = s->tetrahedra[n];
        const uint32_t a = points[t[2]], b = points[t[3]];
        const uint32_t ends = (given[0] ^ points[t[0]]) | (given[1] ^ points[t[1]]);
        straight |= ends | (given[2] ^ a) | (given[3] ^ b);
        turned |= ends | (given[2] ^ b) | (given[3] ^ a);
    }
    *mirrored = straight;
    return !straight || !turned;
}

/* Of a cell of the caller's: its tetrahedra are these and no others. */
static bool cell_compare(const complex_grid *c, const active_cell *cell, knowledge *k, case_question *q) {
    const uint32_t number = cell->triangle;
    const uint64_t ahead = (uint64_t)(number - k->cell) * c->tetrahedron_count / c->source.cell_count;
    const uint64_t n = tetrahedron_find(c, number, k->near + (number > k->cell ? ahead : 0));
    const known_split *s = split_get(k, q->shape, q->order, q->points);
    if (!s->count || (uint64_t)s->count > c->tetrahedron_count - n) return false;
    uint32_t others = 0;
    for (int m = 0; m < s->count; m++) others |= c->cells[n + (uint64_t)m] ^ number;
    if (others || !tetrahedra_match(s, q->points, c->tetrahedra + 4 * n, &q->mirrored)) return false;
    k->near = n + (uint64_t)s->count;
    k->cell = number + 1;
    return k->near >= c->tetrahedron_count || c->cells[k->near] != number;
}

static cell_shape shape_of_code(const struct whole_cells *w, unsigned code) {
    return w->is_gathered ? (cell_shape)((code & (CODE_MIRRORED - 1)) - 1) : cell_type_get(code)->shape;
}

/* False: the cell is not what it seems to be, or there is no memory. */
static bool cell_assign(assignment *a, active_cell *cell, knowledge *k, uint64_t *edge_sum) {
    const unsigned code = cell->pattern >> 16;
    case_question q = {.shape = shape_of_code(a->w, code), .points = cell->points, .pattern = cell->pattern & 0xffff};
    uint32_t number = 0, edges = 0;
    for (int n = 0; n < WHOLE_CORNERS && a->points; n++) cell->points[n] = a->points[cell->points[n]];
    q.order = whole_order(q.shape, q.points);
    q.mirrored = code & CODE_MIRRORED;
    if (!a->w->is_gathered && !cell_compare(a->c, cell, k, &q)) {
        a->differ = true;
        return false;
    }
    if (!whole_case_find(a->cases, &q, &number, &edges)) {
        a->no_memory = true;
        return false;
    }
    cell->pattern = number;
    *edge_sum += edges;
    return true;
}

static void shares_assign(void *shared) {
    assignment *a = shared;
    knowledge k = {.near = 0};
    uint64_t n;
    while ((n = SHARE * atomic_fetch_add(&a->next, 1)) < a->count && !a->differ && !a->no_memory) {
        const uint64_t end = a->count - n > SHARE ? n + SHARE : a->count;
        uint64_t sum = 0;
        while (n < end && cell_assign(a, &a->cells[n], &k, &sum)) n++;
        a->edges += sum;
    }
}

static whole_cases *cases_of(tc_context *context) {
    if (!context->whole_cases) context->whole_cases = whole_cases_make();
    return context->whole_cases;
}

static tc_status memory_fail(void) { return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the cases of cells"); }

tc_status whole_assign(tc_context *context, const tc_grid *grid, active_cell *cells, uint32_t count,
                       const uint32_t *points, uint64_t *edges, bool *differ) {
    assignment a = {.c = grid->complex, .w = grid->complex->whole, .cases = cases_of(context), .cells = cells};
    a.points = points;
    a.count = count;
    if (a.cases) parallel_run((count + SHARE - 1) / SHARE, shares_assign, &a);
    *edges = a.edges;
    *differ = a.differ;
    return a.cases && !a.no_memory ? TC_OK : memory_fail();
}

/* -------------------------------------------------------------------------------------------------------- cut faces */

static void shares_cut(void *shared) {
    assignment *a = shared;
    uint64_t n;
    while ((n = SHARE * atomic_fetch_add(&a->next, 1)) < a->count && !a->no_memory) {
        const uint64_t end = a->count - n > SHARE ? n + SHARE : a->count;
        for (; n < end; n++) {
            active_cell *cell = &a->cells[n];
            if (cell->owned && !whole_case_cut(a->cases, cell->points, cell->owned, &cell->pattern))
                a->no_memory = true;
        }
    }
}

tc_status whole_assign_cut(tc_context *context, active_cell *cells, uint64_t count) {
    assignment a = {.cases = context->whole_cases, .cells = cells, .count = count};
    parallel_run((count + SHARE - 1) / SHARE, shares_cut, &a);
    return a.no_memory ? memory_fail() : TC_OK;
}
