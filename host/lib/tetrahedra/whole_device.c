/*
 * Method hybrid on a device: the cells whole where the device has room, else slab by slab (whole_slabs.c), from then on
 * always. The arrays of tetrahedra, which the other method works on, are not on the device meanwhile.
 */
#include "tetrahedra/whole_run.h"

#include "failure.h"

#include <stdlib.h>

/* Sums of the scan, the slots of candidates among them, take 30 bits. */
static const uint64_t slots_most = UINT64_C(1) << 30;

/* ---------------------------------------------------------------------------------------------------------- arrays */

static tc_status codes_provide(tc_grid *grid, uint32_t first, uint32_t count) {
    struct whole_cells *w = grid->complex->whole;
    tc_context *context = grid->context;
    tc_status status = TC_OK;
    if (!w->one_code)
        status =
            buffer_provide(context, &w->codes_buffer, w->codes + first, count, 1, &w->code_offset, "codes of cells");
    if (!status && !w->cell_points)
        status = buffer_provide(context, &w->begins_buffer, w->begins + first, 8 * (uint64_t)count, 8, &w->begin_offset,
                                "places of cells");
    if (status || w->shapes_buffer.memory) return status;
    return buffer_upload(context, &w->shapes_buffer, w->shapes, sizeof w->shapes, "shapes of cells");
}

tc_status whole_part_provide(tc_grid *grid, const void *words, uint32_t first, uint32_t count) {
    struct whole_cells *w = grid->complex->whole;
    complex_part *part = &w->part;
    const uint64_t all = w->word_bytes, some = 4 * (uint64_t)w->cell_points * count;
    part->tetrahedron_count = count;
    tc_status status = buffer_provide(grid->context, &part->tetrahedra, words, words == w->words ? all : some, 4,
                                      &part->tetrahedron_offset, "cells");
    if (!status) status = codes_provide(grid, first, count);
    const uint64_t range_bytes = sizeof(brick_range) * (uint64_t)whole_cluster_count(count);
    return status ? status : buffer_reserve(grid->context, &part->ranges, range_bytes, "ranges");
}

void whole_part_release(tc_grid *grid) {
    struct whole_cells *w = grid->complex->whole;
    tc_context *context = grid->context;
    if (!w) return;
    buffer_release(context, &w->part.tetrahedra);
    buffer_release(context, &w->part.ranges);
    buffer_release(context, &w->part.samples);
    buffer_release(context, &w->part.points);
    buffer_release(context, &w->begins_buffer);
    buffer_release(context, &w->codes_buffer);
    buffer_release(context, &w->shapes_buffer);
    border_buffers_release(context, grid->complex->borders[1]);
    w->part.ranges_known = false;
}

/* Whether the arrays fit with what kernel 1 works on beside them. */
static bool whole_fits(const tc_grid *grid) {
    const tc_context *context = grid->context;
    const complex_grid *c = grid->complex;
    const struct whole_cells *w = c->whole;
    const uint64_t cells = w->cell_count, clusters = whole_cluster_count(cells), points = c->point_count;
    const uint64_t samples = tc_type_bytes(grid->type) * points, page = context->in_place ? PAGE_BYTES : 0;
    const uint64_t of_cells = w->word_bytes + (w->one_code ? 0 : cells) + (w->cell_points ? 0 : 8 * cells);
    const uint64_t of_clusters = (sizeof(brick_range) + sizeof(cluster_state) + 4) * clusters;
    const uint64_t tiles = clusters / complex_tile_clusters(grid) + 1;
    const uint64_t all = of_cells + samples + 12 * points + 5 * page + of_clusters + sizeof w->shapes +
                         4 * (HEAD_WORDS + TILE_WORDS * tiles);
    const uint64_t most = context->info.max_buffer_bytes;
    return cells << (w->has_prisms ? 5 : 4) <= slots_most && all <= context_budget(context) &&
           w->word_bytes + page <= most && 12 * points + page <= most && samples + page <= most;
}

/* Arrays of all cells and points. */
static tc_status all_provide(tc_grid *grid) {
    const complex_grid *c = grid->complex;
    struct whole_cells *w = c->whole;
    complex_part *part = &w->part;
    const size_t sample_bytes = tc_type_bytes(grid->type);
    if (part->tetrahedra.memory) return TC_OK;
    part->point_count = c->point_count;
    tc_status status = whole_part_provide(grid, w->words, 0, w->cell_count);
    if (!status)
        status = buffer_provide(grid->context, &part->points, c->points, 12ull * c->point_count, 4, &part->point_offset,
                                "points");
    if (!status)
        status = buffer_provide(grid->context, &part->samples, grid->samples, sample_bytes * c->point_count,
                                sample_bytes, &part->sample_offset, "samples");
    if (status) whole_part_release(grid);
    return status;
}

/* ---------------------------------------------------------------------------------------------------------- counts */

/* Cuts the cells into slabs, after the device has held them whole or has been found too small for that. */
static tc_status cells_cut(complex_run *r) {
    cl->Finish(r->context->queue);
    tc_status status = whole_cut_into_slabs(r->grid);
    if (status) return status;
    workspace_release(r->context);
    r->context->workspace_grid = NULL;
    return TC_OK;
}

/* All stages before emission; head has the counts then. */
static tc_status stages_run(complex_run *r, tc_grid *grid, double share, bool *differ) {
    tc_status status = all_provide(grid);
    if (!status) status = whole_classify(r);
    if (!status) status = context_progress(r->context, "classify", 0.6 * share);
    if (!status && r->job.active_count) status = whole_choose(r, differ);
    if (!status && r->job.active_count && !*differ) status = whole_number(r);
    return status;
}

static tc_status cells_count(complex_run *r, tc_grid *grid, const tc_extract_options *options, double share) {
    bool differ = false;
    tc_status status = whole_run_begin(r, grid, options);
    if (!status && !grid->complex->whole->is_cut && !whole_fits(grid)) {
        r->too_large = true;
        return (tc_status)fail(TC_ERROR_MEMORY, "the grid's cells do not fit the device");
    }
    if (!status) status = stages_run(r, grid, share, &differ);
    if (!status && differ) { /* the caller's cells are not what they seemed to be: all are compared now */
        status = whole_cells_gather(grid);
        if (!status && !whole_fits(grid)) r->too_large = true, status = TC_ERROR_MEMORY;
        if (!status) status = stages_run(r, grid, share, &differ);
    }
    return status ? status : context_progress(r->context, "classify", share);
}

static bool is_cut(const tc_grid *grid) { return grid->complex->whole && grid->complex->whole->is_cut; }

const complex_method method_cells = {.method = TC_METHOD_HYBRID,
                                     .is_cut = is_cut,
                                     .count = cells_count,
                                     .emit = whole_emit,
                                     .cut = cells_cut,
                                     .slabs_count = whole_slabs_count,
                                     .slabs_extract = whole_slabs_extract};
