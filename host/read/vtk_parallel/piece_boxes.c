/* piece_boxes.c - which cells of a structured grid are whose; see piece_boxes.h */
#include "vtk_parallel/piece_boxes.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>
#include <stdlib.h>

static int64_t most(int64_t a, int64_t b) { return a > b ? a : b; }
static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

/* Cells between that many points; where the whole is flat, it counts as one cell deep. */
static int64_t cells_along(const index_extent *whole, int axis, int64_t points) {
    return whole->dims[axis] == 1 ? points : points - 1;
}

static cell_box box_of(const index_extent *whole, const index_extent *extent) {
    cell_box box;
    for (int a = 0; a < 3; a++) {
        box.low[a] = extent->first[a];
        box.high[a] = extent->first[a] + cells_along(whole, a, extent->dims[a]);
    }
    return box;
}

uint64_t box_volume(const cell_box *box) {
    uint64_t volume = 1;
    for (int a = 0; a < 3; a++)
        if (__builtin_mul_overflow(volume, (uint64_t)most(box->high[a] - box->low[a], 0), &volume)) return UINT64_MAX;
    return volume;
}

static int boxes_meet(const cell_box *b, const cell_box *c) {
    for (int a = 0; a < 3; a++)
        if (b->low[a] >= c->high[a] || c->low[a] >= b->high[a]) return 0;
    return 1;
}

static int check_extent(const piece_list *list, const grid_piece *piece) {
    const index_extent *e = &piece->extent, *whole = &list->index->whole;
    const dataset_block *b = piece->block;
    for (int a = 0; a < 3; a++) {
        const int64_t last = e->first[a] + e->dims[a] - 1;
        if (e->first[a] < whole->first[a] || last > whole->first[a] + whole->dims[a] - 1)
            return fail(STATUS_INPUT,
                        "%s: the extent of its piece %s, %" PRId64 " to %" PRId64
                        " along %c, is outside of WholeExtent",
                        list->index->path, piece->path, e->first[a], last, 'x' + a);
        if (b->first[a] > e->first[a] || b->first[a] + b->dims[a] - 1 < last)
            return fail(STATUS_INPUT,
                        "%s: has the points %" PRId64 " to %" PRId64 " along %c, but %s says that it has %" PRId64
                        " to %" PRId64,
                        piece->path, b->first[a], b->first[a] + b->dims[a] - 1, 'x' + a, list->index->path, e->first[a],
                        last);
    }
    return 0;
}

/* Where a file holds several pieces, its extent in the index is that of all of them. */
static void narrow_extent(const piece_list *list, grid_piece *piece) {
    if (list->parts[piece->part].block_count < 2) return;
    for (int a = 0; a < 3; a++) {
        piece->extent.first[a] = piece->block->first[a];
        piece->extent.dims[a] = piece->block->dims[a];
    }
}

/* Narrows the box to the cells that are no ghosts; they have to fill it. */
static int leave_out_ghosts(const piece_list *list, const grid_piece *piece, cell_box *box) {
    const dataset_block *b = piece->block;
    cell_box own = {{INT64_MAX, INT64_MAX, INT64_MAX}, {INT64_MIN, INT64_MIN, INT64_MIN}};
    int64_t at[3], cells[3];
    uint64_t count = 0;
    if (!b->blanked_cells || !box_volume(box)) return 0;
    for (int a = 0; a < 3; a++) cells[a] = most(b->dims[a] - 1, 1);
    for (at[2] = box->low[2]; at[2] < box->high[2]; at[2]++)
        for (at[1] = box->low[1]; at[1] < box->high[1]; at[1]++) {
            const uint8_t *row = b->blanked_cells + cells[0] * (at[1] - b->first[1] + cells[1] * (at[2] - b->first[2]));
            for (at[0] = box->low[0]; at[0] < box->high[0]; at[0]++) {
                if (row[at[0] - b->first[0]] & CELL_IS_DUPLICATE) continue;
                count++;
                for (int a = 0; a < 3; a++) {
                    own.low[a] = least(own.low[a], at[a]);
                    own.high[a] = most(own.high[a], at[a] + 1);
                }
            }
        }
    if (!count) own = (cell_box){{0}, {0}};
    *box = own;
    if (count == box_volume(box)) return 0;
    return fail(STATUS_INPUT,
                "%s: the cells that are no ghosts (vtkGhostType) fill no box, so that %s cannot be put together",
                piece->path, list->index->path);
}

/* Files of ghost levels that mark no ghosts: the levels lie where a piece does not end with the whole. */
static void leave_out_levels(const piece_list *list, const cell_box *whole, cell_box *boxes) {
    const int64_t levels = list->index->ghost_levels;
    for (size_t p = 0; p < list->count; p++)
        for (int a = 0; a < 3 && whole->high[a] - whole->low[a] > 1; a++) {
            if (boxes[p].low[a] > whole->low[a]) boxes[p].low[a] += levels;
            if (boxes[p].high[a] < whole->high[a]) boxes[p].high[a] -= levels;
        }
}

static int compare_low(const void *first, const void *second) {
    const cell_box *const *b = first, *const *c = second;
    return ((*b)->low[2] > (*c)->low[2]) - ((*b)->low[2] < (*c)->low[2]);
}

/* Whether two boxes have a cell in common: *first and *second are then their pieces. Returns -1 without memory. */
static int find_overlap(const cell_box *boxes, size_t count, size_t *first, size_t *second) {
    const cell_box **order = malloc((count + 1) * sizeof *order);
    int found = 0;
    if (!order) return -1;
    for (size_t n = 0; n < count; n++) order[n] = &boxes[n];
    qsort(order, count, sizeof *order, compare_low);
    for (size_t n = 0; n < count && !found; n++)
        for (size_t m = n + 1; m < count && order[m]->low[2] < order[n]->high[2] && !found; m++)
            if ((found = box_volume(order[n]) && box_volume(order[m]) && boxes_meet(order[n], order[m]))) {
                *first = (size_t)(least(order[n] - boxes, order[m] - boxes));
                *second = (size_t)(most(order[n] - boxes, order[m] - boxes));
            }
    free(order);
    return found;
}

/* STATUS_INPUT unless the boxes fill the whole, each cell once. */
static int check_boxes(const piece_list *list, const cell_box *whole, const cell_box *boxes) {
    uint64_t filled = 0, wanted = box_volume(whole);
    size_t first = 0, second = 0;
    const int overlaps = find_overlap(boxes, list->count, &first, &second);
    if (overlaps < 0) return fail(STATUS_FAILED, "%s: no memory for the list of its pieces", list->index->path);
    if (overlaps)
        return fail(STATUS_INPUT,
                    "%s: its pieces %s and %s overlap: cells of both have to be marked as ghosts in one of them "
                    "(vtkGhostType)",
                    list->index->path, list->pieces[first].path, list->pieces[second].path);
    for (size_t p = 0; p < list->count; p++) filled += box_volume(&boxes[p]);
    if (filled == wanted) return 0;
    return fail(STATUS_INPUT,
                "%s: its pieces leave a gap: they have %" PRIu64 " of the %" PRIu64 " cells of WholeExtent, without "
                "ghost cells; a piece is missing in the list",
                list->index->path, filled, wanted);
}

int piece_boxes_find(const piece_list *list, cell_box *boxes) {
    const index_extent *extent = &list->index->whole;
    const cell_box whole = box_of(extent, extent);
    for (size_t p = 0; p < list->count; p++) {
        grid_piece *piece = &list->pieces[p];
        narrow_extent(list, piece);
        int status = check_extent(list, piece);
        boxes[p] = box_of(extent, &piece->extent);
        if (!status) status = leave_out_ghosts(list, piece, &boxes[p]);
        if (status) return status;
    }
    int status = check_boxes(list, &whole, boxes);
    if (status != STATUS_INPUT || !list->index->ghost_levels) return status;
    leave_out_levels(list, &whole, boxes);
    return check_boxes(list, &whole, boxes);
}
