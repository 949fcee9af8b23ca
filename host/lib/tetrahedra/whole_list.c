/*
 * The list of cells that method hybrid keeps whole.
 *
 * The caller's own arrays are the list where the device works in the host's memory, each solid cell has tetrahedra, and
 * these come in the order of the cells: then only active cells have to be compared with their tetrahedra. Otherwise,
 * and for slabs, each cell is compared, and their corners are gathered in 32 bits.
 */
#include "tetrahedra/whole_run.h"

#include "failure.h"
#include "parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { SHARE = 1 << 17, PLAIN_CORNERS = 8, NO_TYPE = 0xff };

uint32_t whole_cluster_count(uint64_t cell_count) {
    return (uint32_t)((cell_count + CLUSTER_CELLS - 1) / CLUSTER_CELLS);
}

static bool is_kept(cell_shape shape) { return shape <= CELL_HEXAGONAL_PRISM; }

static bool is_little_endian(void) {
    const uint16_t one = 1;
    return *(const uint8_t *)&one == 1;
}

static void list_clear(struct whole_cells *w) {
    free(w->own_words);
    free(w->own_codes);
    w->own_words = NULL;
    w->own_codes = NULL;
}

/* ------------------------------------------------------------------------------------------------ the caller's list */

typedef struct survey {
    const complex_grid *c;
    uint8_t corners[256]; /* by type; NO_TYPE: a cell that is not taken */
    bool goes_evenly;     /* all cells may have the first one's type and number of points */
    _Atomic uint64_t next, runs, solid;
    atomic_bool unfit, uneven;
} survey;

/* Changes from a cell to the next in the tetrahedra; unfit where they go back. */
static void tetrahedra_survey(survey *s, uint64_t first, uint64_t end) {
    const uint32_t *cells = s->c->cells;
    uint32_t changes = 0, steps_back = 0;
    for (uint64_t n = first ? first : 1; n < end; n++) {
        changes += cells[n] != cells[n - 1];
        steps_back |= cells[n] < cells[n - 1];
    }
    s->runs += changes;
    if (steps_back) s->unfit = true;
}

static bool cells_go_evenly(const tc_cells *source, uint64_t first, uint64_t end) {
    const int64_t *offsets = source->offsets, step = offsets[1] - offsets[0];
    uint64_t others = 0;
    for (uint64_t n = first; n < end; n++) others |= (uint64_t)(offsets[n + 1] - offsets[n]) ^ (uint64_t)step;
    uint8_t differ = 0;
    for (uint64_t n = first; n < end; n++) differ |= source->types[n] ^ source->types[0];
    return !others && !differ;
}

static void cells_survey(survey *s, uint64_t first, uint64_t end) {
    const tc_cells *source = &s->c->source;
    const int64_t *offsets = source->offsets;
    uint64_t solid = 0;
    bool unfit = false;
    if (s->goes_evenly && cells_go_evenly(source, first, end)) {
        const uint8_t corners = s->corners[source->types[first]];
        unfit = corners == NO_TYPE || offsets[first] < 0 || offsets[first + 1] - offsets[first] < corners;
        solid = corners && corners != NO_TYPE ? end - first : 0;
    } else {
        s->uneven = true;
        for (uint64_t n = first; n < end; n++) {
            const uint8_t corners = s->corners[source->types[n]];
            unfit |= corners == NO_TYPE || offsets[n] < 0 || offsets[n + 1] < offsets[n] ||
                     offsets[n + 1] - offsets[n] < corners;
            solid += corners != 0;
        }
    }
    s->solid += solid;
    if (unfit) s->unfit = true;
}

static void shares_survey(void *shared) {
    survey *s = shared;
    const uint64_t tetrahedra = s->c->tetrahedron_count, cells = s->c->source.cell_count;
    const uint64_t first_of_cells = (tetrahedra + SHARE - 1) / SHARE,
                   count = first_of_cells + (cells + SHARE - 1) / SHARE;
    uint64_t n;
    while ((n = atomic_fetch_add(&s->next, 1)) < count && !s->unfit) {
        const bool in_cells = n >= first_of_cells;
        const uint64_t first = SHARE * (in_cells ? n - first_of_cells : n), all = in_cells ? cells : tetrahedra;
        const uint64_t end = all - first > SHARE ? first + SHARE : all;
        if (in_cells)
            cells_survey(s, first, end);
        else
            tetrahedra_survey(s, first, end);
    }
}

/* Which points of a cell of each type are its corners. */
static void types_note(survey *s, struct whole_cells *w) {
    memset(s->corners, NO_TYPE, sizeof s->corners);
    memset(w->shapes, 0, sizeof w->shapes);
    for (unsigned n = 0; n < SHAPE_CODES; n++) {
        const cell_type *type = cell_type_get(n);
        if (type->shape == CELL_FLAT) s->corners[n] = 0;
        if (!is_kept(type->shape)) continue;
        s->corners[n] = w->shapes[n][SHAPE_CORNERS] = type->corner_count;
        memcpy(&w->shapes[n][SHAPE_ORDER], type->corners, type->corner_count);
    }
}

static bool types_have_prisms(const tc_cells *source, bool uneven) {
    for (uint64_t n = 0; n < (uneven ? source->cell_count : 1); n++)
        if (cell_type_get(source->types[n])->corner_count > PLAIN_CORNERS) return true;
    return false;
}

/* Takes the caller's arrays; false where they will not do. */
static bool list_take(const complex_grid *c, struct whole_cells *w) {
    const tc_cells *source = &c->source;
    survey s = {.c = c, .goes_evenly = true};
    if (!is_little_endian() || source->cell_count > UINT32_MAX - CLUSTER_CELLS || !source->cell_count) return false;
    types_note(&s, w);
    parallel_run((c->tetrahedron_count + source->cell_count) / SHARE + 2, shares_survey, &s);
    if (s.unfit || s.runs + 1 != s.solid || source->offsets[0] < 0) return false;
    const bool uneven = s.uneven;
    w->cell_count = (uint32_t)source->cell_count;
    w->has_prisms = types_have_prisms(source, uneven);
    w->words = source->connectivity + source->offsets[0];
    w->word_bytes = 8 * (uint64_t)(source->offsets[source->cell_count] - source->offsets[0]);
    w->word_step = 2;
    w->cell_points = uneven ? 0 : (uint32_t)(source->offsets[1] - source->offsets[0]);
    if (uneven) w->words = source->connectivity, w->word_bytes += 8 * (uint64_t)source->offsets[0];
    w->begins = source->offsets;
    w->codes = source->types;
    w->one_code = uneven ? 0 : source->types[0];
    return true;
}

/* -------------------------------------------------------------------------------------------------- a gathered list */

typedef struct gathering {
    const complex_grid *c;
    struct whole_cells *w; /* NULL: count only */
    uint32_t *counts;      /* of the cells that begin in each share of tetrahedra; then of those before it */
    uint64_t share_count;
    _Atomic uint64_t next, wrong; /* wrong: the first tetrahedron that is not its cell's */
    atomic_bool has_prisms;
} gathering;

/* The first tetrahedron of a cell from n on. */
static uint64_t run_begin(const complex_grid *c, uint64_t n) {
    while (n && n < c->tetrahedron_count && c->cells[n] == c->cells[n - 1]) n++;
    return n < c->tetrahedron_count ? n : c->tetrahedron_count;
}

static void cell_gather(const whole_cell *cell, struct whole_cells *w, uint64_t number) {
    uint32_t *words = w->own_words + w->cell_points * number;
    for (uint32_t n = 0; n < w->cell_points; n++) words[n] = n < (uint32_t)cell->corner_count ? cell->corners[n] : 0;
    w->own_codes[number] = (uint8_t)((1 + cell->shape) | (cell->mirrored ? CODE_MIRRORED : 0));
}

static void wrong_note(gathering *g, uint64_t tetrahedron) {
    uint64_t first = g->wrong;
    while (tetrahedron < first && !atomic_compare_exchange_weak(&g->wrong, &first, tetrahedron)) continue;
}

static void share_gather(gathering *g, uint64_t share) {
    const uint64_t end = run_begin(g->c, (share + 1) * SHARE);
    uint32_t count = 0;
    whole_cell cell;
    for (uint64_t n = run_begin(g->c, share * SHARE); n < end; n += cell.tetrahedron_count, count++) {
        if (complex_cell_get(g->c, (uint32_t)n, &cell)) {
            wrong_note(g, n);
            return;
        }
        if (g->w) cell_gather(&cell, g->w, (uint64_t)g->counts[share] + count);
        if (cell.corner_count > PLAIN_CORNERS) g->has_prisms = true;
    }
    if (!g->w) g->counts[share] = count;
}

static void shares_gather(void *shared) {
    gathering *g = shared;
    uint64_t n;
    while ((n = atomic_fetch_add(&g->next, 1)) < g->share_count && g->wrong == UINT64_MAX) share_gather(g, n);
}

/* Goes over all cells; where one is wrong, records what. */
static tc_status cells_walk(gathering *g) {
    whole_cell cell;
    g->next = 0;
    parallel_run(g->share_count, shares_gather, g);
    if (g->wrong == UINT64_MAX) return TC_OK;
    g->next = 0; /* shares that were left out may have a tetrahedron before it */
    for (uint64_t n = 0; n < g->wrong; n += cell.tetrahedron_count) {
        tc_status status = complex_cell_get(g->c, (uint32_t)n, &cell);
        if (status) return status;
    }
    tc_status status = complex_cell_get(g->c, (uint32_t)g->wrong, &cell);
    return status ? status : (tc_status)fail(TC_ERROR_DATA, "cells have changed since the grid was made");
}

static void shapes_gathered(struct whole_cells *w) {
    static const uint8_t corners[CELL_HEXAGONAL_PRISM + 1] = {4, 8, 6, 5, 10, 12};
    memset(w->shapes, 0, sizeof w->shapes);
    for (int shape = 0; shape <= CELL_HEXAGONAL_PRISM; shape++) {
        w->shapes[1 + shape][SHAPE_CORNERS] = corners[shape];
        for (uint8_t n = 0; n < corners[shape]; n++) w->shapes[1 + shape][SHAPE_ORDER + n] = n;
    }
}

static tc_status list_allocate(gathering *g, struct whole_cells *w) {
    uint64_t cell_count = 0;
    for (uint64_t n = 0; n < g->share_count; n++) {
        const uint32_t count = g->counts[n];
        g->counts[n] = (uint32_t)cell_count;
        cell_count += count;
    }
    w->cell_count = (uint32_t)cell_count;
    w->has_prisms = g->has_prisms;
    w->cell_points = w->has_prisms ? WHOLE_CORNERS : PLAIN_CORNERS;
    w->own_words = malloc(4 * (size_t)w->cell_points * (size_t)cell_count + 1);
    w->own_codes = malloc((size_t)cell_count + 1);
    return w->own_words && w->own_codes
               ? TC_OK
               : (tc_status)fail(TC_ERROR_MEMORY, "no memory for %llu cells", (unsigned long long)cell_count);
}

static tc_status list_gather(const complex_grid *c, struct whole_cells *w) {
    gathering g = {.c = c, .share_count = (c->tetrahedron_count + (uint64_t)SHARE - 1) / SHARE, .wrong = UINT64_MAX};
    list_clear(w);
    g.counts = calloc((size_t)g.share_count + 1, sizeof *g.counts);
    if (!g.counts) return (tc_status)fail(TC_ERROR_MEMORY, "no memory to gather cells");
    tc_status status = cells_walk(&g);
    if (!status) status = list_allocate(&g, w);
    g.w = w;
    if (!status) status = cells_walk(&g);
    free(g.counts);
    if (status) return status;
    w->words = w->own_words;
    w->word_bytes = 4 * (uint64_t)w->cell_points * w->cell_count;
    w->word_step = 1;
    w->begins = NULL;
    w->codes = w->own_codes;
    w->one_code = w->own_codes[0];
    for (uint64_t n = 0; n < w->cell_count && w->one_code; n++)
        if (w->own_codes[n] != w->one_code) w->one_code = 0;
    w->is_gathered = true;
    shapes_gathered(w);
    return TC_OK;
}

/* ----------------------------------------------------------------------------------------------------------- either */

tc_status whole_cells_provide(tc_grid *grid) {
    complex_grid *c = grid->complex;
    if (c->whole) return TC_OK;
    struct whole_cells *w = calloc(1, sizeof *w);
    if (!w) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for a list of cells");
    tc_status status = grid->context->in_place && list_take(c, w) ? TC_OK : list_gather(c, w);
    if (!status)
        c->whole = w;
    else
        list_clear(w), free(w);
    return status;
}

tc_status whole_cells_gather(tc_grid *grid) {
    struct whole_cells *w = grid->complex->whole;
    if (w->is_gathered) return TC_OK;
    whole_part_release(grid);
    w->ranges_known = false;
    return list_gather(grid->complex, w);
}

void whole_cells_release(tc_grid *grid) {
    struct whole_cells *w = grid->complex->whole;
    if (!w) return;
    whole_part_release(grid);
    edge_numbers_release(&w->edges);
    list_clear(w);
    free(w->ranges);
    free(w);
    grid->complex->whole = NULL;
}
