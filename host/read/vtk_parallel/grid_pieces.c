/*
 * grid_pieces.c - pieces of a structured grid, put where they belong in one; see index.h
 *
 * Each piece owns a box of cells: those of its extent that are no ghost cells. The boxes of all pieces fill the whole
 * extent, each cell once; so the whole has as many points as pieces were read with, or fewer. Points between boxes are
 * in several pieces.
 */
#include "dataset/world.h"
#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"
#include "vtk_parallel/piece_boxes.h"
#include "vtk_xml/vtk_xml.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct grid_join {
    const piece_list *list;
    dataset *out;
    dataset_block *whole;
    cell_box *boxes; /* of all pieces */
    unsigned char **values, *points, *axes[3];
    uint8_t *blanked_points, *blanked_cells, *known[3]; /* known: positions along the axes that a piece has told */
} grid_join;

static int64_t most(int64_t a, int64_t b) { return a > b ? a : b; }
static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

/* ------------------------------------------------------------------------------------------------------- the whole */

static int is_near(double matrix[3][4], double own[3][4], const dataset_block *b) {
    for (int corner = 0; corner < 2; corner++)
        for (int r = 0; r < 3; r++) {
            double apart = own[r][3] - matrix[r][3], step = 0;
            for (int a = 0; a < 3; a++) {
                apart += (own[r][a] - matrix[r][a]) * (double)(b->first[a] + (corner ? b->dims[a] - 1 : 0));
                step = fmax(step, fabs(matrix[0][a]) + fabs(matrix[1][a]) + fabs(matrix[2][a]));
            }
            if (!(fabs(apart) <= step / 100)) return 0;
        }
    return 1;
}

/* Where an image lies, which its pieces tell, too. */
static int set_matrix(grid_join *j) {
    const vtk_index *x = j->list->index;
    read_request plain = *j->list->request;
    double matrix[3][4], own[3][4];
    plain.has_spacing = plain.has_origin = 0;
    memcpy(matrix, j->list->pieces->block->matrix, sizeof matrix);
    int status = x->has_world ? vtk_xml_matrix(&plain, x->origin, x->spacing, x->direction, matrix) : 0;
    for (size_t p = 0; p < j->list->count && !status; p++) {
        const grid_piece *piece = &j->list->pieces[p];
        memcpy(own, piece->block->matrix, sizeof own);
        if (!is_near(matrix, own, piece->block))
            status = fail(STATUS_INPUT, "%s: has another Origin, Spacing or Direction than %s", piece->path,
                          x->has_world ? x->path : j->list->pieces->path);
    }
    if (!status) status = world_complete(j->list->request, x->path, matrix);
    memcpy(j->whole->matrix, matrix, sizeof matrix);
    return status;
}

static int make_axes(grid_join *j) {
    for (int a = 0; a < 3; a++) {
        const uint64_t count = (uint64_t)j->whole->dims[a];
        const coordinates first = j->list->pieces->block->axes[a];
        int status = pieces_add_coordinates(j->out, first, count, &j->whole->axes[a], &j->axes[a]);
        if (status) return status;
        if (!(j->known[a] = calloc(count, 1)))
            return fail(STATUS_FAILED, "%s: no memory for its coordinates", j->list->index->path);
    }
    return 0;
}

static int make_blanking(grid_join *j) {
    int points = 0, cells = 0;
    for (size_t p = 0; p < j->list->count; p++) {
        points |= j->list->pieces[p].block->blanked_points != NULL;
        cells |= j->list->pieces[p].block->blanked_cells != NULL;
    }
    const uint64_t point_count = (uint64_t)j->whole->point_count, cell_count = (uint64_t)j->whole->cell_count;
    if (points && !(j->blanked_points = dataset_allocate(j->out, point_count))) return STATUS_FAILED;
    if (cells && !(j->blanked_cells = dataset_allocate(j->out, cell_count))) return STATUS_FAILED;
    if (points) memset(j->blanked_points, 0, (size_t)point_count);
    if (cells) memset(j->blanked_cells, 0, (size_t)cell_count);
    return 0;
}

static int make_whole(grid_join *j) {
    const index_extent *extent = &j->list->index->whole;
    dataset_block *b;
    if (dataset_block_add(j->out, &b)) return STATUS_FAILED;
    j->whole = b;
    b->kind = j->list->index->kind;
    b->point_count = b->cell_count = 1;
    for (int a = 0; a < 3; a++) {
        b->first[a] = extent->first[a];
        b->dims[a] = extent->dims[a];
        if (__builtin_mul_overflow(b->point_count, b->dims[a], &b->point_count) || b->point_count > INT64_MAX / 64)
            return fail(STATUS_INPUT, "%s: its WholeExtent has too many points", j->list->index->path);
        b->cell_count *= most(b->dims[a] - 1, 1);
    }
    int status = 0;
    if (b->kind == BLOCK_UNIFORM) status = set_matrix(j);
    if (b->kind == BLOCK_RECTILINEAR) status = make_axes(j);
    if (b->kind == BLOCK_CURVILINEAR)
        status = pieces_add_coordinates(j->out, j->list->pieces->block->points, 3 * (uint64_t)b->point_count,
                                        &b->points, &j->points);
    if (!status) status = pieces_add_fields(j->list, j->out, b, &j->values);
    return status ? status : make_blanking(j);
}

/* ----------------------------------------------------------------------------------------------------------- copies */

/* Rows of a box of points or cells, in the whole and in a piece. */
typedef struct box_rows {
    int64_t low[3], count[3], whole_first[3], whole_dims[3], piece_first[3], piece_dims[3];
} box_rows;

static box_rows rows_of(const dataset_block *whole, const dataset_block *piece, const int64_t low[3],
                        const int64_t count[3], int on_cells) {
    box_rows r;
    for (int a = 0; a < 3; a++) {
        r.low[a] = low[a];
        r.count[a] = count[a];
        r.whole_first[a] = whole->first[a];
        r.piece_first[a] = piece->first[a];
        r.whole_dims[a] = on_cells ? most(whole->dims[a] - 1, 1) : whole->dims[a];
        r.piece_dims[a] = on_cells ? most(piece->dims[a] - 1, 1) : piece->dims[a];
    }
    return r;
}

static size_t row_at(const int64_t first[3], const int64_t dims[3], const int64_t low[3], int64_t y, int64_t z) {
    return (size_t)(low[0] - first[0] + dims[0] * (low[1] + y - first[1] + dims[1] * (low[2] + z - first[2])));
}

/* Copies tuples of so many bytes from the piece to the whole; is_same instead returns 0 where they differ. */
static int go_over(const box_rows *r, unsigned char *whole, const unsigned char *piece, size_t bytes, int is_same) {
    const size_t row = (size_t)r->count[0] * bytes;
    for (int64_t z = 0; z < r->count[2]; z++)
        for (int64_t y = 0; y < r->count[1]; y++) {
            unsigned char *to = whole + bytes * row_at(r->whole_first, r->whole_dims, r->low, y, z);
            const unsigned char *from = piece + bytes * row_at(r->piece_first, r->piece_dims, r->low, y, z);
            if (!is_same)
                memcpy(to, from, row);
            else if (memcmp(to, from, row) != 0)
                return 0;
        }
    return 1;
}

/* The points of a box of cells: up to that of the whole's end where the whole is flat. */
static void points_of(const dataset_block *whole, const cell_box *box, int64_t low[3], int64_t high[3]) {
    for (int a = 0; a < 3; a++) {
        low[a] = box->low[a];
        high[a] = least(box->high[a], whole->first[a] + whole->dims[a] - 1);
    }
}

static void tell_difference(grid_join *j, const char *what) {
    dataset_notice(j->out, "pieces differ in %s where they meet; the later one's is taken", what);
}

/* Compares what is in the whole with the piece, in the points that it shares with an earlier one. */
static void compare_points(grid_join *j, const dataset_block *b, const box_rows *r, int *told) {
    const int behind = j->whole->field_count; /* of the fields: coordinates */
    if (j->points && !told[behind] &&
        !go_over(r, j->points, coordinate_values(b->points), 3 * coordinate_bytes(b->points), 1)) {
        told[behind] = 1;
        tell_difference(j, "coordinates");
    }
    for (int n = 0; n < j->whole->field_count; n++) {
        const dataset_field *f = &j->whole->fields[n];
        if (f->on_cells || told[n]) continue;
        const dataset_field *own = piece_field(b, j->whole, n);
        if (go_over(r, j->values[n], own->values, (size_t)f->components * sample_bytes(f->type), 1)) continue;
        char name[80];
        snprintf(name, sizeof name, "'%.60s'", f->name);
        told[n] = 1;
        tell_difference(j, name);
    }
}

static void compare_with_earlier(grid_join *j, size_t piece, int *told) {
    int64_t low[3], high[3], other_low[3], other_high[3], count[3];
    points_of(j->whole, &j->boxes[piece], low, high);
    for (size_t p = 0; p < piece; p++) {
        int meets = box_volume(&j->boxes[p]) != 0;
        points_of(j->whole, &j->boxes[p], other_low, other_high);
        for (int a = 0; a < 3 && meets; a++) {
            other_low[a] = most(other_low[a], low[a]);
            count[a] = least(other_high[a], high[a]) - other_low[a] + 1;
            meets = count[a] > 0;
        }
        if (!meets) continue;
        const box_rows r = rows_of(j->whole, j->list->pieces[piece].block, other_low, count, 0);
        compare_points(j, j->list->pieces[piece].block, &r, told);
    }
}

static int copy_axes(grid_join *j, const grid_piece *piece, const int64_t low[3], const int64_t count[3], int *told) {
    for (int a = 0; a < 3; a++) {
        const coordinates own = piece->block->axes[a];
        int status = piece_coordinates_fit(j->list, piece, own, j->whole->axes[a]);
        if (status) return status;
        const size_t bytes = coordinate_bytes(own);
        for (int64_t n = low[a]; n < low[a] + count[a]; n++) {
            unsigned char *to = j->axes[a] + bytes * (size_t)(n - j->whole->first[a]);
            const unsigned char *from = coordinate_values(own) + bytes * (size_t)(n - piece->block->first[a]);
            uint8_t *known = &j->known[a][n - j->whole->first[a]];
            if (*known && memcmp(to, from, bytes) != 0 && !*told) {
                *told = 1;
                tell_difference(j, "coordinates");
            }
            memcpy(to, from, bytes);
            *known = 1;
        }
    }
    return 0;
}

static void copy_points(grid_join *j, const dataset_block *b, const box_rows *r) {
    if (j->points) go_over(r, j->points, coordinate_values(b->points), 3 * coordinate_bytes(b->points), 0);
    if (b->blanked_points) go_over(r, j->blanked_points, b->blanked_points, 1, 0);
}

static int copy_piece(grid_join *j, size_t p, int *told) {
    const grid_piece *piece = &j->list->pieces[p];
    const dataset_block *b = piece->block;
    int64_t low[3], high[3], count[3], cells[3];
    if (!box_volume(&j->boxes[p])) return 0;
    points_of(j->whole, &j->boxes[p], low, high);
    for (int a = 0; a < 3; a++) {
        count[a] = high[a] - low[a] + 1;
        cells[a] = j->boxes[p].high[a] - j->boxes[p].low[a];
    }
    const box_rows of_points = rows_of(j->whole, b, low, count, 0);
    const box_rows of_cells = rows_of(j->whole, b, j->boxes[p].low, cells, 1);
    int status = 0;
    copy_points(j, b, &of_points);
    if (j->whole->kind == BLOCK_RECTILINEAR) status = copy_axes(j, piece, low, count, &told[j->whole->field_count]);
    if (!status && b->blanked_cells) go_over(&of_cells, j->blanked_cells, b->blanked_cells, 1, 0);
    for (int n = 0; n < j->whole->field_count && !status; n++) {
        const dataset_field *f = &j->whole->fields[n], *own = piece_field(b, j->whole, n);
        go_over(f->on_cells ? &of_cells : &of_points, j->values[n], own->values,
                (size_t)f->components * sample_bytes(f->type), 0);
    }
    return status;
}

/* What a file holds is freed when all of its pieces are copied: at no time are there two of all. */
static int copy_pieces(grid_join *j) {
    int status = 0, *told = calloc((size_t)j->whole->field_count + 1, sizeof *told);
    if (!told) return fail(STATUS_FAILED, "%s: no memory for the list of its arrays", j->list->index->path);
    for (size_t p = 0; p < j->list->count && !status; p++) {
        const size_t part = j->list->pieces[p].part;
        if (j->whole->kind == BLOCK_CURVILINEAR)
            status =
                piece_coordinates_fit(j->list, &j->list->pieces[p], j->list->pieces[p].block->points, j->whole->points);
        if (!status) compare_with_earlier(j, p, told);
        if (!status) status = copy_piece(j, p, told);
        if (p + 1 == j->list->count || j->list->pieces[p + 1].part != part) dataset_release(&j->list->parts[part]);
    }
    free(told);
    return status;
}

static const uint8_t *blanked_if_any(const uint8_t *blanked, int64_t count) {
    for (int64_t n = 0; blanked && n < count; n++)
        if (blanked[n]) return blanked;
    return NULL;
}

int grid_pieces_join(const piece_list *list, dataset *out) {
    grid_join j = {.list = list, .out = out};
    if (!(j.boxes = calloc(list->count, sizeof *j.boxes)))
        return fail(STATUS_FAILED, "%s: no memory for the list of its pieces", list->index->path);
    int status = piece_boxes_find(list, j.boxes);
    if (!status) status = make_whole(&j);
    if (!status) status = copy_pieces(&j);
    if (!status) {
        j.whole->blanked_points = blanked_if_any(j.blanked_points, j.whole->point_count);
        j.whole->blanked_cells = blanked_if_any(j.blanked_cells, j.whole->cell_count);
    }
    free(j.boxes);
    for (int a = 0; a < 3; a++) free(j.known[a]);
    return status;
}
