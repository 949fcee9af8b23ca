/*
 * cell_pieces.c - pieces of an unstructured grid, joined to one; see index.h
 *
 * Ghost cells are left out, and with them the points that only they use. The whole has the points in the order of their
 * global numbers, else in that of the pieces, and so its cells: where the file has numbers of both, the whole is the
 * grid that was divided. Faces of cells are cut by the numbers of points, so that pieces fit.
 */
#include "dataset/cell_types.h"
#include "exit_status.h"
#include "failure.h"
#include "sample_types.h"
#include "vtk_parallel/pieces.h"
#include "vtk_parallel/shared_points.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct cell_join {
    const piece_list *list;
    dataset *out;
    dataset_block *whole;
    int64_t *point_starts, *cell_starts; /* of each piece, among all points and cells; then their sums */
    uint8_t *is_left_out;                /* of each point */
    int64_t *cell_numbers;               /* of each cell: in the whole; -1: a ghost */
    shared_points *points;
    unsigned char **values, *coordinates;
    uint8_t *types, *blanked_points, *blanked_cells;
    int64_t *offsets, *corners, *cell_faces, *face_offsets, *face_points;
} cell_join;

static int no_memory(const cell_join *j) {
    return fail(STATUS_FAILED, "%s: no memory to join its pieces", j->list->index->path);
}

static int is_ghost(const dataset_block *b, int64_t cell) {
    return b->blanked_cells && (b->blanked_cells[cell] & CELL_IS_DUPLICATE);
}

/* ----------------------------------------------------------------------------------------------------------- counts */

static int make_lists(cell_join *j) {
    const size_t count = j->list->count;
    j->point_starts = calloc(count + 1, sizeof *j->point_starts);
    j->cell_starts = calloc(count + 1, sizeof *j->cell_starts);
    if (!j->point_starts || !j->cell_starts) return no_memory(j);
    for (size_t p = 0; p < count; p++) {
        j->point_starts[p + 1] = j->point_starts[p] + j->list->pieces[p].block->point_count;
        j->cell_starts[p + 1] = j->cell_starts[p] + j->list->pieces[p].block->cell_count;
    }
    j->is_left_out = calloc((size_t)j->point_starts[count] + 1, 1);
    j->cell_numbers = malloc(((size_t)j->cell_starts[count] + 1) * sizeof *j->cell_numbers);
    return j->is_left_out && j->cell_numbers ? 0 : no_memory(j);
}

/* Sets what is said of the points of a cell, its faces included. */
static void mark_points(const dataset_block *b, int64_t cell, uint8_t value, uint8_t *marks) {
    for (int64_t n = b->cell_offsets[cell]; n < b->cell_offsets[cell + 1]; n++) marks[b->cell_points[n]] = value;
    if (!b->cell_faces || b->cell_faces[cell] == b->cell_faces[cell + 1]) return;
    const int64_t end = b->face_offsets[b->cell_faces[cell + 1]];
    for (int64_t n = b->face_offsets[b->cell_faces[cell]]; n < end; n++) marks[b->face_points[n]] = value;
}

/* Points of ghost cells, unless other cells have them. Without ghosts every point stays. */
static void leave_out_points(cell_join *j) {
    for (size_t p = 0; p < j->list->count; p++) {
        const dataset_block *b = j->list->pieces[p].block;
        uint8_t *marks = j->is_left_out + j->point_starts[p];
        for (int ghosts = 1; ghosts >= 0 && b->blanked_cells; ghosts--)
            for (int64_t c = 0; c < b->cell_count; c++)
                if (is_ghost(b, c) == ghosts) mark_points(b, c, (uint8_t)ghosts, marks);
    }
}

/* ------------------------------------------------------------------------------------------------------------ cells */

static size_t piece_of_cell(const cell_join *j, int64_t cell) {
    size_t low = 0, high = j->list->count;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        if (j->cell_starts[middle] <= cell)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static int overlap(const cell_join *j, int64_t first, int64_t second) {
    return fail(STATUS_INPUT,
                "%s: its pieces %s and %s overlap: both have one cell (%" PRId64 " and %" PRId64
                "), which has to be marked as a ghost in one of them (vtkGhostType)",
                j->list->index->path, j->list->pieces[piece_of_cell(j, first)].path,
                j->list->pieces[piece_of_cell(j, second)].path, first - j->cell_starts[piece_of_cell(j, first)],
                second - j->cell_starts[piece_of_cell(j, second)]);
}

/* A sum over the whole's numbers of its points, whatever their order; 0 where a point is in one piece alone, so that
 * the cell is, too. */
static uint64_t corner_key(const cell_join *j, size_t piece, int64_t cell) {
    const dataset_block *b = j->list->pieces[piece].block;
    uint64_t key = 1;
    if (b->cell_offsets[cell] == b->cell_offsets[cell + 1] || cell_type_dimension(b->cell_types[cell]) < 3) return 0;
    for (int64_t n = b->cell_offsets[cell]; n < b->cell_offsets[cell + 1]; n++) {
        const int64_t point = j->point_starts[piece] + b->cell_points[n];
        if (!j->points->is_shared[point]) return 0;
        key += mixed((uint64_t)j->points->numbers[point] + UINT64_C(0x9e3779b97f4a7c15));
    }
    return key ? key : 1;
}

static int compare_numbers(const void *first, const void *second) {
    const int64_t a = *(const int64_t *)first, b = *(const int64_t *)second;
    return (a > b) - (a < b);
}

/* The numbers of a cell's points, sorted, to be freed. */
static int64_t *sorted_corners(const cell_join *j, int64_t cell, size_t *count) {
    const size_t piece = piece_of_cell(j, cell);
    const dataset_block *b = j->list->pieces[piece].block;
    const int64_t own = cell - j->cell_starts[piece];
    *count = (size_t)(b->cell_offsets[own + 1] - b->cell_offsets[own]);
    int64_t *numbers = malloc((*count + 1) * sizeof *numbers);
    for (size_t n = 0; n < *count && numbers; n++)
        numbers[n] = j->points->numbers[j->point_starts[piece] + b->cell_points[b->cell_offsets[own] + (int64_t)n]];
    if (numbers) qsort(numbers, *count, sizeof *numbers, compare_numbers);
    return numbers;
}

static int check_corners(const cell_join *j, int64_t first, int64_t second) {
    size_t count, other_count;
    int64_t *numbers = sorted_corners(j, first, &count), *other = sorted_corners(j, second, &other_count);
    const int has_memory = numbers && other;
    const int is_one = has_memory && count == other_count && memcmp(numbers, other, count * sizeof *numbers) == 0;
    free(numbers);
    free(other);
    return !has_memory ? no_memory(j) : is_one ? overlap(j, first, second) : 0;
}

/* STATUS_INPUT where two pieces have a cell of three dimensions between the same points. */
static int check_overlap(const cell_join *j, sort_entry *entries, sort_entry *spare) {
    size_t count = 0;
    int status = 0;
    for (size_t p = 0; p < j->list->count; p++)
        for (int64_t c = 0; c < j->list->pieces[p].block->cell_count; c++) {
            const uint64_t key = is_ghost(j->list->pieces[p].block, c) ? 0 : corner_key(j, p, c);
            if (key) entries[count++] = (sort_entry){key, j->cell_starts[p] + c};
        }
    entries_sort(entries, spare, count);
    for (size_t n = 1; n < count && !status; n++)
        if (entries[n].key == entries[n - 1].key &&
            piece_of_cell(j, entries[n].of) != piece_of_cell(j, entries[n - 1].of))
            status = check_corners(j, entries[n - 1].of, entries[n].of);
    return status;
}

/* In the order of their global numbers, where all pieces have these; else of the pieces. */
static int number_cells(cell_join *j, sort_entry *entries, sort_entry *spare, int64_t *kept) {
    const int by_number = pieces_have_numbers(j->list, 1);
    size_t count = 0;
    for (size_t p = 0; p < j->list->count; p++) {
        const grid_piece *piece = &j->list->pieces[p];
        const dataset_field *numbers = by_number ? piece_numbers(piece, 1) : NULL;
        for (int64_t c = 0; c < piece->block->cell_count; c++) {
            j->cell_numbers[j->cell_starts[p] + c] = -1;
            if (is_ghost(piece->block, c)) continue;
            entries[count++] = (sort_entry){numbers ? number_key(numbers, c) : 0, j->cell_starts[p] + c};
        }
    }
    entries_sort(entries, spare, count);
    for (size_t n = 0; n < count; n++) {
        if (by_number && n && entries[n].key == entries[n - 1].key) return overlap(j, entries[n - 1].of, entries[n].of);
        j->cell_numbers[entries[n].of] = (int64_t)n;
    }
    *kept = (int64_t)count;
    return 0;
}

static int find_cells(cell_join *j, int64_t *kept) {
    const size_t total = (size_t)j->cell_starts[j->list->count];
    sort_entry *entries = malloc((total + 1) * sizeof *entries), *spare = malloc((total + 1) * sizeof *spare);
    int status = entries && spare ? 0 : no_memory(j);
    if (!status) status = check_overlap(j, entries, spare);
    if (!status) status = number_cells(j, entries, spare, kept);
    free(entries);
    free(spare);
    return status;
}

/* ------------------------------------------------------------------------------------------------------- the whole */

/* What each cell takes of the arrays of corners and faces; the sums are where each begins. */
static void sum_up(int64_t *counts, int64_t count) {
    int64_t at = 0;
    for (int64_t n = 0; n <= count; n++) {
        const int64_t here = n < count ? counts[n] : 0;
        counts[n] = at;
        at += here;
    }
}

static int make_cells(cell_join *j) {
    dataset_block *b = j->whole;
    const uint64_t cells = (uint64_t)b->cell_count;
    int has_faces = 0;
    b->cell_types = j->types = dataset_allocate(j->out, cells);
    b->cell_offsets = j->offsets = dataset_allocate(j->out, (cells + 1) * sizeof *j->offsets);
    if (!j->types || !j->offsets) return STATUS_FAILED;
    for (size_t p = 0; p < j->list->count; p++) has_faces |= j->list->pieces[p].block->cell_faces != NULL;
    if (has_faces && !(b->cell_faces = j->cell_faces = dataset_allocate(j->out, (cells + 1) * sizeof *j->cell_faces)))
        return STATUS_FAILED;
    for (size_t p = 0; p < j->list->count; p++) {
        const dataset_block *from = j->list->pieces[p].block;
        for (int64_t c = 0; c < from->cell_count; c++) {
            const int64_t n = j->cell_numbers[j->cell_starts[p] + c];
            if (n < 0) continue;
            j->offsets[n] = from->cell_offsets[c + 1] - from->cell_offsets[c];
            if (has_faces) j->cell_faces[n] = from->cell_faces ? from->cell_faces[c + 1] - from->cell_faces[c] : 0;
        }
    }
    sum_up(j->offsets, b->cell_count);
    if (has_faces) sum_up(j->cell_faces, b->cell_count);
    b->cell_points = j->corners = dataset_allocate(j->out, (uint64_t)j->offsets[cells] * sizeof *j->corners);
    return j->corners ? 0 : STATUS_FAILED;
}

static int make_faces(cell_join *j) {
    dataset_block *b = j->whole;
    if (!j->cell_faces) return 0;
    const int64_t faces = j->cell_faces[b->cell_count];
    b->face_offsets = j->face_offsets = dataset_allocate(j->out, ((uint64_t)faces + 1) * sizeof *j->face_offsets);
    if (!j->face_offsets) return STATUS_FAILED;
    for (size_t p = 0; p < j->list->count; p++) {
        const dataset_block *from = j->list->pieces[p].block;
        for (int64_t c = 0; c < from->cell_count && from->cell_faces; c++) {
            const int64_t n = j->cell_numbers[j->cell_starts[p] + c];
            for (int64_t f = from->cell_faces[c]; n >= 0 && f < from->cell_faces[c + 1]; f++)
                j->face_offsets[j->cell_faces[n] + f - from->cell_faces[c]] =
                    from->face_offsets[f + 1] - from->face_offsets[f];
        }
    }
    sum_up(j->face_offsets, faces);
    b->face_points = j->face_points =
        dataset_allocate(j->out, (uint64_t)j->face_offsets[faces] * sizeof *j->face_points);
    return j->face_points ? 0 : STATUS_FAILED;
}

static int make_blanking(cell_join *j) {
    int points = 0, cells = 0;
    for (size_t p = 0; p < j->list->count; p++) {
        const dataset_block *b = j->list->pieces[p].block;
        points |= b->blanked_points != NULL;
        for (int64_t c = 0; c < b->cell_count && b->blanked_cells && !cells; c++)
            cells = b->blanked_cells[c] && !is_ghost(b, c);
    }
    if (points && !(j->blanked_points = dataset_allocate(j->out, (uint64_t)j->whole->point_count)))
        return STATUS_FAILED;
    if (cells && !(j->blanked_cells = dataset_allocate(j->out, (uint64_t)j->whole->cell_count))) return STATUS_FAILED;
    j->whole->blanked_points = j->blanked_points;
    j->whole->blanked_cells = j->blanked_cells;
    return 0;
}

static int make_whole(cell_join *j, int64_t cells) {
    const coordinates first = j->list->pieces->block->points;
    if (dataset_block_add(j->out, &j->whole)) return STATUS_FAILED;
    j->whole->kind = BLOCK_UNSTRUCTURED;
    j->whole->point_count = j->points->count;
    j->whole->cell_count = cells;
    for (size_t p = 0; p < j->list->count; p++) {
        int status = piece_coordinates_fit(j->list, &j->list->pieces[p], j->list->pieces[p].block->points, first);
        if (status) return status;
    }
    int status =
        pieces_add_coordinates(j->out, first, 3 * (uint64_t)j->points->count, &j->whole->points, &j->coordinates);
    if (!status) status = pieces_add_fields(j->list, j->out, j->whole, &j->values);
    if (!status) status = make_cells(j);
    if (!status) status = make_faces(j);
    return status ? status : make_blanking(j);
}

/* ----------------------------------------------------------------------------------------------------------- copies */

static void copy_points(cell_join *j, size_t p) {
    const dataset_block *b = j->list->pieces[p].block;
    const size_t bytes = 3 * coordinate_bytes(b->points);
    for (int64_t n = 0; n < b->point_count; n++) {
        const int64_t point = j->point_starts[p] + n, to = j->points->numbers[point];
        if (j->points->sources[point] != point) continue;
        memcpy(j->coordinates + bytes * (size_t)to, coordinate_values(b->points) + bytes * (size_t)n, bytes);
        if (j->blanked_points) j->blanked_points[to] = b->blanked_points ? b->blanked_points[n] : 0;
    }
}

static void copy_faces(cell_join *j, size_t p, int64_t cell, int64_t to) {
    const dataset_block *b = j->list->pieces[p].block;
    const int64_t begin = b->face_offsets[b->cell_faces[cell]], end = b->face_offsets[b->cell_faces[cell + 1]];
    int64_t *points = j->face_points + j->face_offsets[j->cell_faces[to]];
    for (int64_t n = begin; n < end; n++) *points++ = j->points->numbers[j->point_starts[p] + b->face_points[n]];
}

static void copy_cells(cell_join *j, size_t p) {
    const dataset_block *b = j->list->pieces[p].block;
    for (int64_t c = 0; c < b->cell_count; c++) {
        const int64_t to = j->cell_numbers[j->cell_starts[p] + c];
        if (to < 0) continue;
        int64_t *corners = j->corners + j->offsets[to];
        j->types[to] = b->cell_types[c];
        for (int64_t n = b->cell_offsets[c]; n < b->cell_offsets[c + 1]; n++)
            *corners++ = j->points->numbers[j->point_starts[p] + b->cell_points[n]];
        if (b->cell_faces && b->cell_faces[c] < b->cell_faces[c + 1]) copy_faces(j, p, c, to);
        if (j->blanked_cells) j->blanked_cells[to] = b->blanked_cells ? b->blanked_cells[c] : 0;
    }
}

static void copy_fields(cell_join *j, size_t p) {
    const dataset_block *b = j->list->pieces[p].block;
    for (int n = 0; n < j->whole->field_count; n++) {
        const dataset_field *f = &j->whole->fields[n];
        const unsigned char *from = piece_field(b, j->whole, n)->values;
        const size_t bytes = (size_t)f->components * sample_bytes(f->type);
        const int64_t count = f->on_cells ? b->cell_count : b->point_count;
        for (int64_t i = 0; i < count; i++) {
            const int64_t point = j->point_starts[p] + i;
            const int64_t to = f->on_cells                          ? j->cell_numbers[j->cell_starts[p] + i]
                               : j->points->sources[point] == point ? j->points->numbers[point]
                                                                    : -1;
            if (to >= 0) memcpy(j->values[n] + bytes * (size_t)to, from + bytes * (size_t)i, bytes);
        }
    }
}

/* What a file holds is freed when all of its pieces are copied: at no time are there two of all. */
static void copy_pieces(cell_join *j) {
    for (size_t p = 0; p < j->list->count; p++) {
        const size_t part = j->list->pieces[p].part;
        copy_points(j, p);
        copy_cells(j, p);
        copy_fields(j, p);
        if (p + 1 == j->list->count || j->list->pieces[p + 1].part != part) dataset_release(&j->list->parts[part]);
    }
}

static void tell(const cell_join *j) {
    if (j->points->differing)
        dataset_notice(j->out, "pieces differ at %" PRId64 " of the points that they share; the first one's is taken",
                       j->points->differing);
    if (j->points->unclear)
        dataset_notice(j->out,
                       "at %" PRId64 " places a piece has several points of the same values: they are not joined with "
                       "those of other pieces, and surfaces may not meet there; global numbers would tell",
                       j->points->unclear);
}

int cell_pieces_join(const piece_list *list, dataset *out) {
    shared_points points = {0};
    cell_join j = {.list = list, .out = out, .points = &points};
    int64_t cells = 0;
    int status = make_lists(&j);
    if (!status) {
        leave_out_points(&j);
        status = shared_points_find(list, j.point_starts, j.is_left_out, &points);
    }
    if (!status) status = find_cells(&j, &cells);
    if (!status) status = make_whole(&j, cells);
    if (!status) {
        copy_pieces(&j);
        tell(&j);
    }
    shared_points_release(&points);
    free(j.point_starts);
    free(j.cell_starts);
    free(j.is_left_out);
    free(j.cell_numbers);
    return status;
}
