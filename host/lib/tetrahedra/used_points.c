#include "tetrahedra/used_points.h"

#include "failure.h"
#include "parallel.h"

#include <stdatomic.h>
#include <stdlib.h>

enum { SHARE = 1 << 16 };

typedef struct search {
    const tc_grid *grid;
    const complex_grid *c;
    bool has_gaps;
    _Atomic uint64_t *used;
    _Atomic uint64_t next;
    atomic_bool failed; /* there is a point that the grid does not have */
} search;

uint64_t point_word_count(const complex_grid *c) { return (c->point_count + UINT64_C(63)) / 64; }

static bool is_present(const search *s, const uint32_t points[4]) {
    bool missing = false;
    for (int n = 0; n < 4 && s->has_gaps; n++) missing = missing || complex_point_missing(s->grid, points[n]);
    return !missing;
}

static void point_use(search *s, uint32_t point) {
    const uint64_t bit = UINT64_C(1) << point % 64;
    _Atomic uint64_t *word = &s->used[point / 64];
    if (!(atomic_load_explicit(word, memory_order_relaxed) & bit))
        atomic_fetch_or_explicit(word, bit, memory_order_relaxed);
}

static bool share_search(search *s, uint64_t share) {
    const uint64_t first = share * SHARE, count = s->c->tetrahedron_count;
    const uint64_t end = first + SHARE < count ? first + SHARE : count;
    for (uint64_t n = first; n < end; n++) {
        const uint32_t *points = s->c->tetrahedra + 4 * n;
        for (int m = 0; m < 4; m++)
            if (points[m] >= s->c->point_count) return false;
        if (!is_present(s, points)) continue;
        for (int m = 0; m < 4; m++) point_use(s, points[m]);
    }
    return true;
}

static void shares_search(void *shared) {
    search *s = shared;
    const uint64_t count = (s->c->tetrahedron_count + (uint64_t)SHARE - 1) / SHARE;
    uint64_t n;
    while ((n = atomic_fetch_add(&s->next, 1)) < count && !s->failed)
        if (!share_search(s, n)) s->failed = true;
}

tc_status used_points_provide(tc_grid *grid) {
    complex_grid *c = grid->complex;
    if (c->used_points) return TC_OK;
    search s = {.grid = grid, .c = c, .has_gaps = complex_has_gaps(grid)};
    uint64_t *words = calloc((size_t)point_word_count(c) + 1, sizeof *words);
    if (!words) return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the points that tetrahedra have");
    s.used = (_Atomic uint64_t *)words;
    parallel_run((c->tetrahedron_count + (uint64_t)SHARE - 1) / SHARE, shares_search, &s);
    if (s.failed) {
        free(words);
        return complex_point_fail(c);
    }
    c->used_points = words;
    return TC_OK;
}

static bool is_within(const tc_grid *grid, const tc_interval_volume_options *options, uint64_t point) {
    const double value = grid_value_at(grid, (int64_t)point);
    return value >= options->low && !(value >= options->high);
}

tc_status points_within_find(tc_grid *grid, const tc_interval_volume_options *options, points_within *out) {
    const uint64_t count = point_word_count(grid->complex);
    *out = (points_within){0};
    tc_status status = used_points_provide(grid);
    if (status) return status;
    out->words = malloc((size_t)count * sizeof *out->words + 1);
    out->before = malloc((size_t)count * sizeof *out->before + 1);
    if (!out->words || !out->before)
        return (tc_status)fail(TC_ERROR_MEMORY, "no memory for the points that lie within");
    for (uint64_t n = 0; n < count; n++) {
        out->before[n] = (uint32_t)out->count;
        out->words[n] = grid->complex->used_points[n];
        for (uint64_t rest = out->words[n]; rest; rest &= rest - 1)
            if (!is_within(grid, options, 64 * n + (uint64_t)__builtin_ctzll(rest))) out->words[n] &= ~(rest & -rest);
        out->count += (uint64_t)__builtin_popcountll(out->words[n]);
    }
    return TC_OK;
}

void points_within_release(points_within *p) {
    free(p->words);
    free(p->before);
    *p = (points_within){0};
}
