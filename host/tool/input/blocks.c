#include "blocks.h"

#include "counted.h"
#include "dataset/cell_types.h"
#include "dataset/region.h"
#include "exit_status.h"
#include "failure.h"
#include "input.h"
#include "sample_types.h"
#include "terminal/notice.h"
#include "used_points.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Returns the status; the text of a failure then says which block it is of. */
static int block_status(int status, int n, int block_count) {
    char text[1000];
    if (!status || block_count == 1) return status;
    snprintf(text, sizeof text, "%s", failure_text());
    return fail(status, "%s (block %d)", text, n);
}

/* Where samples of a structured block lie, and what is blanked. */
static void describe_world(const dataset_block *from, tc_grid_options *grid) {
    tc_grid_options_init(grid);
    memcpy(grid->dims, from->dims, sizeof grid->dims);
    memcpy(grid->first_index, from->first, sizeof grid->first_index);
    if (from->kind == BLOCK_UNIFORM) memcpy(grid->matrix, from->matrix, sizeof grid->matrix);
    for (int axis = 0; axis < 3 && from->kind == BLOCK_RECTILINEAR; axis++) {
        grid->axes[axis] = from->axes[axis].f32;
        grid->axes_f64[axis] = from->axes[axis].f64;
    }
    if (from->kind == BLOCK_CURVILINEAR) {
        grid->points = from->points.f32;
        grid->points_f64 = from->points.f64;
    }
    grid->blanked_samples = from->blanked_points;
    grid->blanked_cells = from->blanked_cells;
}

/* The grid that a block is a part of: its samples count where the part's do, thinned likewise. Returns NULL where the
 * block is no part, or where the library takes no grid of that size. */
static const tc_grid_options *describe_whole(const dataset_block *b, tc_grid_options *whole) {
    enum { SAMPLES_MOST = 1 << 24 };
    if (!b->whole) return NULL;
    describe_world(b->whole, whole);
    if (b->kind == BLOCK_UNIFORM) region_whole_extent(b, whole->first_index, whole->dims);
    for (int axis = 0; axis < 3; axis++)
        if (whole->dims[axis] < 2 || whole->dims[axis] > SAMPLES_MOST) return NULL;
    return whole;
}

static void describe_grid(const prepared_block *b, tc_grid_options *grid, tc_grid_options *whole) {
    describe_world(b->source, grid);
    grid->whole = describe_whole(b->source, whole);
    if (!b->scalar) return;
    grid->type = b->scalar->type;
    grid->samples = b->scalar->samples;
    grid->has_nodata = b->scalar->has_nodata;
    grid->nodata = b->scalar->nodata;
    grid->blanked_samples = b->scalar->blanked_points;
    grid->blanked_cells = b->scalar->blanked_cells;
}

void block_describe(const block_list *list, int n, tc_grid_options *grid, tc_grid_options *whole) {
    describe_grid(&list->blocks[n], grid, whole);
}

static int cut_structured(const options *o, prepared_block *b) {
    tc_grid_options grid, whole;
    describe_grid(b, &grid, &whole);
    void *none_missing = NULL; /* the library wants samples, and looks only at which are missing */
    if (!b->scalar) {
        grid.type = TC_U8;
        grid.samples = none_missing = calloc((size_t)b->source->point_count + 1, 1);
        if (!none_missing)
            return fail(STATUS_FAILED, "no memory to cut a grid of %" PRId64 " points", b->source->point_count);
    }
    tc_status status = tc_tetrahedralize_grid(&grid, &b->complex);
    free(none_missing);
    return input_status(o, status);
}

/* Reports a failed cut; names the option that helps where only cells that cannot be cut are at fault. */
static int refuse_cells(const options *o, const tc_cells *cells, tc_status status) {
    tc_cells others = *cells;
    tc_tetrahedra complex = {.struct_size = sizeof complex};
    char text[900];
    snprintf(text, sizeof text, "%s", tc_message());
    others.skip_unsupported = 1;
    int is_help = status == TC_ERROR_DATA && !cells->skip_unsupported && !tc_tetrahedralize(&others, &complex);
    uint64_t count = complex.unsupported_cell_count;
    tc_tetrahedra_release(&complex);
    if (is_help)
        return fail(STATUS_INPUT, "%s: %s; --skip-unsupported leaves out the %" PRIu64 " cells that cannot be cut",
                    o->operands[0], text, count);
    return status == TC_ERROR_DATA ? fail(STATUS_INPUT, "%s: %s", o->operands[0], text) : input_status(o, status);
}

static tc_cells cells_of(const prepared_block *b) {
    const dataset_block *from = b->source;
    return (tc_cells){.struct_size = sizeof(tc_cells),
                      .point_count = (uint64_t)from->point_count,
                      .points = from->points.f32,
                      .points_f64 = from->points.f64,
                      .cell_count = (uint64_t)from->cell_count,
                      .types = from->cell_types,
                      .offsets = from->cell_offsets,
                      .connectivity = from->cell_points,
                      .blanked_points = b->scalar ? b->scalar->blanked_points : from->blanked_points,
                      .blanked_cells = b->scalar ? b->scalar->blanked_cells : from->blanked_cells,
                      .cell_faces = from->cell_faces,
                      .face_offsets = from->face_offsets,
                      .face_connectivity = from->face_points};
}

static int cut_unstructured(const options *o, prepared_block *b) {
    tc_cells cells = cells_of(b);
    cells.skip_unsupported = o->skip_unsupported;
    tc_status status = tc_tetrahedralize(&cells, &b->complex);
    return status ? refuse_cells(o, &cells, status) : 0;
}

/* Cubes of a structured block, none where it is flat; cells of three dimensions of an unstructured one. */
static uint64_t solid_cells(const prepared_block *b) {
    const int64_t *d = b->source->dims;
    if (b->source->kind == BLOCK_UNSTRUCTURED) return (uint64_t)b->source->cell_count - b->complex.flat_cell_count;
    return (uint64_t)(d[0] - 1) * (uint64_t)(d[1] - 1) * (uint64_t)(d[2] - 1);
}

static int is_flat(const dataset_block *b) {
    return b->kind != BLOCK_UNSTRUCTURED && (b->dims[0] < 2 || b->dims[1] < 2 || b->dims[2] < 2);
}

/* Flat blocks are skipped, as flat cells are. Where all blocks are flat, they go to the library, which refuses them
 * with its reason. */
static int all_are_flat(const dataset *d) {
    int flat = 1;
    for (int n = 0; n < d->block_count; n++) flat = flat && is_flat(&d->blocks[n]);
    return flat;
}

static void tell(uint64_t count, const char *one, const char *several, const char *what) {
    if (count) notice("%s %s", counted(count, one, several).text, what);
}

/* Whether the cell may be cut in more ways than one, linear or not. */
static int is_ambiguous(uint8_t type) {
    return cell_type_dimension(type) == 3 && !strstr(cell_type_name(type), "tetrahedron");
}

static int has_ambiguous_cells(const block_list *list) {
    for (int n = 0; n < list->count; n++) {
        const dataset_block *b = list->blocks[n].source;
        for (int64_t cell = 0; b->kind == BLOCK_UNSTRUCTURED && cell < b->cell_count; cell++)
            if (is_ambiguous(b->cell_types[cell])) return 1;
    }
    return 0;
}

/* Points of unstructured blocks that no cell has. It is only for a notice: 0 where memory runs out. */
static uint64_t count_unused_points(const block_list *list) {
    uint64_t unused = 0;
    for (int n = 0; n < list->count; n++) {
        const dataset_block *b = list->blocks[n].source;
        if (b->kind != BLOCK_UNSTRUCTURED) continue;
        uint8_t *used = calloc((size_t)b->point_count + 1, 1);
        if (!used) return 0;
        for (int64_t i = 0; i < b->cell_offsets[b->cell_count]; i++) used[b->cell_points[i]] = 1;
        for (int64_t i = 0; b->cell_faces && i < b->face_offsets[b->cell_faces[b->cell_count]]; i++)
            used[b->face_points[i]] = 1;
        unused += (uint64_t)b->point_count - count_set(used, b->point_count);
        free(used);
    }
    return unused;
}

static void tell_all(const block_list *list) {
    uint64_t flat_blocks = 0, flat = 0, curved = 0, inverted = 0, folded = 0, left_out = 0, unsupported = 0,
             surplus = 0, blanked_points = 0, blanked_cells = 0;
    int all_cut = 1, is_thinned = 0;
    for (int n = 0; n < list->count; n++) {
        const prepared_block *b = &list->blocks[n];
        for (int axis = 0; axis < 3; axis++) is_thinned |= b->source->region.step[axis] > 1;
        flat_blocks += (uint64_t)b->is_skipped;
        flat += b->complex.flat_cell_count;
        curved += b->complex.curved_cell_count;
        inverted += b->complex.inverted_cell_count;
        folded += b->complex.folded_cell_count;
        left_out += b->complex.blanked_cell_count;
        unsupported += b->complex.unsupported_cell_count;
        surplus += b->complex.surplus_cell_count;
        all_cut = all_cut && b->is_cut;
        if (b->is_cut) continue;
        blanked_points += count_set(b->source->blanked_points, b->source->point_count);
        blanked_cells += count_set(b->source->blanked_cells, b->source->cell_count);
    }
    tell(flat_blocks, "block", "blocks", "of one point along an axis: skipped");
    tell(flat, "cell", "cells", "of fewer than three dimensions: skipped");
    tell(curved, "cell is", "cells are", "quadratic or higher: taken as linear, by their corners");
    tell(unsupported, "cell is", "cells are",
         "left out: of a type that is not cut, or polyhedra whose faces are not closed");
    tell(surplus, "cell has", "cells have", "more points than cells of that type: the first ones are taken");
    tell(count_unused_points(list), "point is", "points are", "used by no cell");
    tell(left_out, "cell is", "cells are", "left out: blanked, or with a corner that is missing");
    tell(inverted, "cell", "cells", "of negative volume: turned over");
    tell(folded, "cell is", "cells are", "folded: tetrahedra overlap there");
    if (list->count > 1 && has_ambiguous_cells(list))
        notice("each piece is cut by its own point numbers: surfaces of neighbouring pieces may not meet");
    if (list->count > 1 && is_thinned)
        notice("--step takes every Nth sample of each block by itself: surfaces of neighbouring blocks may not meet");
    tell(blanked_points, "point is", "points are", "blanked: cells with a blanked point are left out");
    tell(blanked_cells, "blanked cell is", "blanked cells are", "left out");
    if (!list->tetrahedron_count && all_cut) notice("nothing to contour: no cell of three dimensions is left");
}

static int cut(const options *o, prepared_block *b) {
    if (!b->is_cut || b->is_skipped) return 0;
    return b->source->kind == BLOCK_UNSTRUCTURED ? cut_unstructured(o, b) : cut_structured(o, b);
}

int blocks_cut(const options *o, const dataset *d, const scalar *s, int all, block_list *out) {
    *out = (block_list){.blocks = calloc((size_t)d->block_count + 1, sizeof *out->blocks)};
    if (!out->blocks) return fail(STATUS_FAILED, "out of memory for %d blocks", d->block_count);
    const int flat = all_are_flat(d);
    for (int n = 0; n < d->block_count; n++) {
        prepared_block *b = &out->blocks[out->count++];
        b->source = &d->blocks[n];
        b->scalar = s ? &s->blocks[n] : NULL;
        b->is_cut = all || d->blocks[n].kind == BLOCK_UNSTRUCTURED;
        b->is_skipped = !flat && is_flat(b->source);
        b->complex.struct_size = sizeof b->complex;
        int status = block_status(cut(o, b), n, d->block_count);
        if (status) return status;
        uint64_t cells = solid_cells(b);
        out->cell_count += cells;
        out->tetrahedron_count += b->is_cut ? b->complex.tetrahedron_count : 5 * cells;
    }
    if (notice_wanted()) tell_all(out);
    return 0;
}

void blocks_release(block_list *list) {
    for (int n = 0; n < list->count; n++) tc_tetrahedra_release(&list->blocks[n].complex);
    free(list->blocks);
    *list = (block_list){0};
}

static tc_status complex_grid(const options *o, const prepared_block *b, tc_context *context, const double *origin,
                              tc_grid **grid) {
    tc_tetrahedra_grid_options from;
    const tc_cells cells = cells_of(b);
    if (!b->complex.tetrahedron_count) return TC_OK;
    tc_tetrahedra_grid_options_init(&from);
    if (o->method == TC_METHOD_HYBRID) from.source = &cells, from.cells = b->complex.cells;
    from.point_count = (uint64_t)b->source->point_count;
    from.points = b->source->points.f32;
    from.points_f64 = b->source->points.f64;
    if (origin) {
        from.has_origin = 1;
        memcpy(from.origin, origin, sizeof from.origin);
    }
    from.type = b->scalar->type;
    from.samples = b->scalar->samples;
    from.tetrahedron_count = b->complex.tetrahedron_count;
    from.tetrahedra = b->complex.tetrahedra;
    return tc_tetrahedra_grid_create(context, &from, grid);
}

int block_grid(const options *o, const block_list *list, int n, tc_context *context, const double *origin,
               tc_grid **grid) {
    const prepared_block *b = &list->blocks[n];
    tc_grid_options from, whole;
    *grid = NULL;
    if (b->is_skipped) return 0;
    if (b->is_cut) return block_status(input_status(o, complex_grid(o, b, context, origin, grid)), n, list->count);
    describe_grid(b, &from, &whole);
    if (origin) {
        from.has_origin = 1;
        memcpy(from.origin, origin, sizeof from.origin);
    }
    return block_status(input_status(o, tc_grid_create(context, &from, grid)), n, list->count);
}

static int has_nonfinite(const prepared_block *b) {
    const int64_t count = b->source->point_count;
    switch ((int)b->scalar->type) {
#define FIND_CASE(type, name, c_type, ...)                                                                             \
    case type:                                                                                                         \
        for (int64_t n = 0; n < count; n++)                                                                            \
            if (!isfinite(((const c_type *)b->scalar->samples)[n])) return 1;                                          \
        return 0;
        REAL_TYPES(FIND_CASE)
#undef FIND_CASE
    default:
        return 0;
    }
}

int blocks_have_missing(const block_list *list, int reads_samples) {
    for (int n = 0; n < list->count; n++) {
        const prepared_block *b = &list->blocks[n];
        if (!b->is_cut && (b->scalar->blanked_points || b->scalar->blanked_cells || b->scalar->has_nodata ||
                           (reads_samples && has_nonfinite(b))))
            return 1;
    }
    return 0;
}

int blocks_may_touch(const block_list *list) {
    for (int n = 0; n < list->count; n++)
        if (list->blocks[n].is_cut) return 1;
    return blocks_have_missing(list, 1);
}
