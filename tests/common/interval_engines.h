/*
 * interval_engines.h - interval volumes by the reference and by contexts with kernels: the same bytes, in place,
 * copied, and with hardly enough memory
 */
#ifndef INTERVAL_ENGINES_H
#define INTERVAL_ENGINES_H

#include "engines.h"
#include "random.h"

#include <inttypes.h>

enum { REFERENCE, DEVICE, COPYING, CONTEXTS };

typedef struct engine {
    tc_context *context;
    tc_grid *grid;
    tc_interval_volume *interval;
    tc_interval_volume_data data;
} engine;

static engine engines[CONTEXTS];
static struct engine_tally { uint64_t volumes, slabs, bounded; } engine_tally;

/* The grid of a test's options in a context. */
typedef tc_status grid_maker(tc_context *context, const void *options, tc_grid **grid);

/* The reference, kernels that work in place, and kernels that copy, every sum of whose scan is made again; *copying:
 * the last one's options. */
static inline void engines_open(bool groups, tc_context_options *copying, tc_expert_options *expert) {
    options_init(copying, expert);
    engines[REFERENCE].context = reference_open();
    expert->work_items = groups ? 64 : 1;
    expert->tile_bricks = 3;
    engines[DEVICE].context = context_open(copying);
    expert->spin_limit = 1;
    expert->always_copy = 1;
    engines[COPYING].context = context_open(copying);
}

static inline void engines_close(void) {
    for (int n = 0; n < CONTEXTS; n++) {
        tc_interval_volume_destroy(engines[n].interval);
        tc_context_destroy(engines[n].context);
    }
}

/* Bounds about the values of random fields, with ties, none, or beyond what a type has. */
static inline void range_choose(tc_interval_volume_options *o) {
    static const double far[] = {-5, -1e30, -1e300, 300, 1e30, 1e300};
    tc_interval_volume_options_init(o);
    const uint32_t kind = random_below(8);
    if (kind) o->low = kind == 1 ? far[random_below(3)] : 58 + 0.5 * (double)random_below(8);
    if (kind != 2) o->high = kind == 3 ? far[3 + random_below(3)] : 60 + 0.5 * (double)(1 + random_below(8));
    if (!(o->low < o->high)) o->high = o->low + 0.5;
}

static inline bool interval_make(engine *e, const tc_interval_volume_options *how, const char *name) {
    e->data = (tc_interval_volume_data){.struct_size = sizeof e->data};
    tc_status status = tc_extract_interval_volume(e->grid, how, &e->interval);
    if (!status) status = tc_interval_volume_get(e->interval, &e->data);
    EXPECT(!status, "%s: %s", name, tc_message());
    return !status;
}

static inline void expect_count(engine *e, const tc_interval_volume_options *how, const tc_interval_volume_data *d,
                                const char *name) {
    tc_interval_volume_counts c = {.struct_size = sizeof c};
    EXPECT(!tc_count_interval_volume(e->grid, how, &c), "%s: %s", name, tc_message());
    EXPECT(c.sample_count == d->sample_count && c.low_count == d->low_count && c.high_count == d->high_count &&
               c.tetrahedron_count == d->tetrahedron_count,
           "%s: counted %" PRIu64 " + %" PRIu64 " + %" PRIu64 " vertices, %" PRIu64 " tetrahedra", name, c.sample_count,
           c.low_count, c.high_count, c.tetrahedron_count);
}

static inline void expect_same(const tc_interval_volume_data *a, const tc_interval_volume_data *b, const char *name,
                               const char *how) {
    EXPECT(a->sample_count == b->sample_count && a->low_count == b->low_count && a->high_count == b->high_count &&
               a->tetrahedron_count == b->tetrahedron_count,
           "%s, %s: sizes differ", name, how);
    if (a->vertex_count != b->vertex_count || a->tetrahedron_count != b->tetrahedron_count) return;
    for (uint64_t n = 0; n < 3 * a->vertex_count; n++)
        if (memcmp(&a->positions[n], &b->positions[n], sizeof(float))) {
            EXPECT(false, "%s, %s: vertex %" PRIu64 " of %" PRIu64 " differs", name, how, n / 3, a->vertex_count);
            break;
        }
    for (uint64_t n = 0; n < 4 * a->tetrahedron_count; n++)
        if (a->tetrahedra[n] != b->tetrahedra[n]) {
            EXPECT(false, "%s, %s: tetrahedron %" PRIu64 " of %" PRIu64 " differs", name, how, n / 4,
                   a->tetrahedron_count);
            break;
        }
}

static inline void grids_open(grid_maker *make, const void *options, const char *name) {
    for (int n = 0; n < CONTEXTS; n++)
        EXPECT(!make(engines[n].context, options, &engines[n].grid), "%s: %s", name, tc_message());
}

static inline void grids_close(void) {
    for (int n = 0; n < CONTEXTS; n++) {
        tc_grid_destroy(engines[n].grid);
        engines[n].grid = NULL;
    }
}

/* With hardly enough memory: the same bytes, by buffers that fit. What a refusal advises is enough, at the latest. */
static inline void expect_bounded(const tc_context_options *usual, grid_maker *make, const void *grid_options,
                                  const tc_interval_volume_options *how, const tc_interval_volume_data *expected,
                                  const char *name) {
    tc_context_options options = *usual;
    uint64_t budget = 40000;
    for (int attempt = 0; attempt < 20; attempt++) {
        engine e = {0};
        options.max_memory_bytes = budget;
        e.context = context_open(&options);
        tc_status status = make(e.context, grid_options, &e.grid);
        if (!status) status = tc_extract_interval_volume(e.grid, how, &e.interval);
        if (!status) {
            e.data.struct_size = sizeof e.data;
            tc_interval_volume_get(e.interval, &e.data);
            expect_same(expected, &e.data, name, "bounded");
            expect_within(e.context, budget, name);
            engine_tally.slabs += e.data.slab_count > 1, engine_tally.bounded++;
        } else {
            EXPECT(status == TC_ERROR_MEMORY, "%s, %" PRIu64 " bytes: %s", name, budget, tc_message());
            const uint64_t advised = bytes_advised(name);
            EXPECT(advised > budget, "%s: %" PRIu64 " bytes are too few, and %" PRIu64 " are advised", name, budget,
                   advised);
            budget += budget / 3 < advised - budget ? budget / 3 : advised - budget;
        }
        tc_interval_volume_destroy(e.interval);
        tc_grid_destroy(e.grid);
        tc_context_destroy(e.context);
        if (!status) return;
    }
    EXPECT(false, "%s: no budget is enough", name);
}

/* A volume that the reference has made, by the contexts with kernels; counted first, if asked for. */
static inline void expect_engines(const tc_interval_volume_options *how, bool count, const char *name) {
    const tc_interval_volume_data *expected = &engines[REFERENCE].data;
    if (count) expect_count(&engines[DEVICE], how, expected, name);
    for (int m = DEVICE; m < CONTEXTS; m++)
        if (interval_make(&engines[m], how, name))
            expect_same(expected, &engines[m].data, name, m == COPYING ? "copied" : "in place");
    engine_tally.volumes++;
}

#endif
