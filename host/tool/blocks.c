#include "blocks.h"

#include "commands.h"
#include "exit_status.h"
#include "failure.h"
#include "input.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void describe_grid(const prepared_block *b, tc_grid_options *grid) {
    const dataset_block *from = b->source;
    tc_grid_options_init(grid);
    memcpy(grid->dims, from->dims, sizeof grid->dims);
    memcpy(grid->first, from->first, sizeof grid->first);
    if (from->kind == GRID_UNIFORM) memcpy(grid->matrix, from->matrix, sizeof grid->matrix);
    if (from->kind == GRID_RECTILINEAR) memcpy(grid->axes, from->axes, sizeof grid->axes);
    if (from->kind == GRID_CURVILINEAR) grid->points = from->points;
    grid->blanked_samples = from->blanked_points;
    grid->blanked_cells = from->blanked_cells;
    if (!b->scalar) return;
    grid->type = b->scalar->type;
    grid->samples = b->scalar->samples;
    grid->has_nodata = b->scalar->has_nodata;
    grid->nodata = b->scalar->nodata;
    grid->blanked_samples = b->scalar->blanked_points;
    grid->blanked_cells = b->scalar->blanked_cells;
}

static tc_status cut_structured(prepared_block *b) {
    tc_grid_options grid;
    describe_grid(b, &grid);
    void *none_missing = NULL; /* the library wants samples, of which only those that are missing matter */
    if (!b->scalar) {
        grid.type = TC_U8;
        grid.samples = none_missing = calloc((size_t)b->source->point_count + 1, 1);
    }
    tc_status status = tc_tetrahedralize_grid(&grid, &b->complex);
    free(none_missing);
    return status;
}

static tc_status cut_unstructured(prepared_block *b) {
    const dataset_block *from = b->source;
    const tc_cells cells = {.struct_size = sizeof cells,
                            .point_count = (uint64_t)from->point_count,
                            .points = from->points,
                            .cell_count = (uint64_t)from->cell_count,
                            .types = from->cell_types,
                            .offsets = from->cell_offsets,
                            .connectivity = from->cell_points,
                            .blanked_points = b->scalar ? b->scalar->blanked_points : from->blanked_points,
                            .blanked_cells = b->scalar ? b->scalar->blanked_cells : from->blanked_cells};
    return tc_tetrahedralize(&cells, &b->complex);
}

/* Cubes of a structured block, none where it is flat; cells of three dimensions of an unstructured one. */
static uint64_t solid_cells(const prepared_block *b) {
    const int64_t *d = b->source->dims;
    if (b->source->kind == GRID_UNSTRUCTURED) return (uint64_t)b->source->cell_count - b->complex.flat_cell_count;
    return (uint64_t)(d[0] - 1) * (uint64_t)(d[1] - 1) * (uint64_t)(d[2] - 1);
}

static uint64_t count_set(const uint8_t *mask, int64_t count) {
    uint64_t set = 0;
    for (int64_t n = 0; mask && n < count; n++) set += mask[n] != 0;
    return set;
}

static void tell(uint64_t count, const char *what) {
    if (count) message("%" PRIu64 " %s", count, what);
}

static void tell_all(const block_list *list) {
    uint64_t flat = 0, curved = 0, inverted = 0, folded = 0, left_out = 0, blanked_points = 0, blanked_cells = 0;
    for (int n = 0; n < list->count; n++) {
        const prepared_block *b = &list->blocks[n];
        flat += b->complex.flat_cell_count;
        curved += b->complex.curved_cell_count;
        inverted += b->complex.inverted_cell_count;
        folded += b->complex.folded_cell_count;
        left_out += b->complex.blanked_cell_count;
        if (b->is_cut) continue;
        blanked_points += count_set(b->source->blanked_points, b->source->point_count);
        blanked_cells += count_set(b->source->blanked_cells, b->source->cell_count);
    }
    tell(flat, "cells of fewer than three dimensions are skipped");
    tell(curved, "quadratic or higher cells are taken as linear, by their corners");
    tell(left_out, "cells are left out: blanked, or with a corner that is missing");
    tell(inverted, "cells of negative volume are turned over");
    tell(folded, "cells are folded: their tetrahedra overlap");
    tell(blanked_points, "points are blanked: cells with one of them are left out");
    tell(blanked_cells, "blanked cells are left out");
    if (!list->tetrahedron_count) message("nothing to contour: no cell of three dimensions is left");
}

int blocks_cut(const options *o, const dataset *d, const scalar *s, int all, block_list *out) {
    *out = (block_list){.blocks = calloc((size_t)d->block_count + 1, sizeof *out->blocks)};
    if (!out->blocks) return fail(STATUS_FAILED, "out of memory for %d blocks", d->block_count);
    for (; out->count < d->block_count; out->count++) {
        prepared_block *b = &out->blocks[out->count];
        int is_structured = d->blocks[out->count].kind != GRID_UNSTRUCTURED;
        tc_status status = TC_OK;
        *b = (prepared_block){&d->blocks[out->count],
                              s ? &s->blocks[out->count] : NULL,
                              all || !is_structured,
                              {.struct_size = sizeof b->complex}};
        if (b->is_cut) status = is_structured ? cut_structured(b) : cut_unstructured(b);
        if (status) return input_status(o, status);
        uint64_t cells = solid_cells(b);
        out->cell_count += cells;
        out->tetrahedron_count += b->is_cut ? b->complex.tetrahedron_count : 5 * cells;
    }
    if (!o->quiet) tell_all(out);
    return 0;
}

void blocks_release(block_list *list) {
    for (int n = 0; n < list->count; n++) tc_complex_release(&list->blocks[n].complex);
    free(list->blocks);
    *list = (block_list){0};
}

static tc_status complex_grid(const prepared_block *b, tc_context *context, tc_grid **grid) {
    tc_complex_options from;
    if (!b->complex.tetrahedron_count) return TC_OK;
    tc_complex_options_init(&from);
    from.point_count = (uint64_t)b->source->point_count;
    from.points = b->source->points;
    from.type = b->scalar->type;
    from.samples = b->scalar->samples;
    from.tetrahedron_count = b->complex.tetrahedron_count;
    from.tetrahedra = b->complex.tetrahedra;
    return tc_complex_create(context, &from, grid);
}

int block_grid(const options *o, const prepared_block *b, tc_context *context, tc_grid **grid) {
    tc_grid_options from;
    *grid = NULL;
    if (b->is_cut) return input_status(o, complex_grid(b, context, grid));
    describe_grid(b, &from);
    return input_status(o, tc_grid_create(context, &from, grid));
}

static int has_nonfinite(const prepared_block *b) {
    int64_t count = b->source->point_count;
    for (int64_t n = 0; b->scalar->type == TC_F32 && n < count; n++)
        if (!isfinite(((const float *)b->scalar->samples)[n])) return 1;
    for (int64_t n = 0; b->scalar->type == TC_F64 && n < count; n++)
        if (!isfinite(((const double *)b->scalar->samples)[n])) return 1;
    return 0;
}

int blocks_may_touch(const block_list *list) {
    for (int n = 0; n < list->count; n++) {
        const prepared_block *b = &list->blocks[n];
        if (b->is_cut || b->scalar->blanked_points || b->scalar->blanked_cells || b->scalar->has_nodata ||
            has_nonfinite(b))
            return 1;
    }
    return 0;
}
