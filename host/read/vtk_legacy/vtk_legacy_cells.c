/*
 * vtk_legacy_cells.c - the cells of unstructured grids in VTK legacy files; see vtk_legacy_cells.h
 *
 * Two layouts: a count before the points of each cell (to version 4.2), or OFFSETS, one more than cells, and
 * CONNECTIVITY. The word behind the counts tells which. Polyhedra have a stream of their faces in place of points
 * (cell_faces.h). Nothing is trusted before legacy_check_cells.
 */
#include "vtk_legacy/vtk_legacy_cells.h"

#include "dataset/cell_faces.h"
#include "exit_status.h"
#include "vtk_legacy/vtk_legacy_array.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* r->links holds `size` numbers, the count and the points of each cell in turn: separates them into offsets and links.
 */
static int split_counted(legacy *r, int64_t cell_count, int64_t size) {
    int64_t at = 0, used = 0;
    for (int64_t cell = 0; cell < cell_count; cell++) {
        int64_t count = at < size ? r->links[at] : -1;
        if (count < 0 || count > size - at - 1)
            return legacy_fail(r,
                               "has cell %" PRId64 " of %" PRId64
                               " with more points than the size of CELLS leaves, or fewer than 0; it is damaged",
                               cell, cell_count);
        r->offsets[cell] = used;
        memmove(r->links + used, r->links + at + 1, (size_t)count * sizeof *r->links);
        used += count;
        at += count + 1;
    }
    r->offsets[cell_count] = used;
    if (at == size) return 0;
    return legacy_fail(r, "has %" PRId64 " cells that take %" PRId64 " numbers, but says %" PRId64 " in CELLS",
                       cell_count, at, size);
}

static int read_counted(legacy *r, int64_t cell_count, int64_t size) {
    void *numbers = NULL;
    uint64_t unfit;
    int status;
    if (size < cell_count)
        return legacy_fail(r, "says that %" PRId64 " cells take %" PRId64 " numbers; each takes at least one",
                           cell_count, size);
    if ((status = legacy_array(r, "CELLS", TC_I32, size, 1, ELEMENT_I64, &numbers, &unfit))) return status;
    r->links = numbers;
    r->offset_count = cell_count + 1;
    r->link_count = size - cell_count;
    r->offsets = dataset_allocate(r->out, ((uint64_t)cell_count + 1) * sizeof *r->offsets);
    return r->offsets ? split_counted(r, cell_count, size) : STATUS_FAILED;
}

static int read_indices(legacy *r, const char *what, int64_t count, int64_t **out) {
    int type = 0, status = legacy_type(r, &type);
    void *values = NULL;
    uint64_t unfit = 0;
    if (status) return status;
    if (element_is_real(type) || type >= LEGACY_STRING)
        return legacy_fail(r, "has %s that are no integers; vtktypeint64 is usual", what);
    if ((status = legacy_array(r, what, type, count, 1, ELEMENT_I64, &values, &unfit))) return status;
    if (unfit) return legacy_fail(r, "has %s beyond 2^63; it is damaged", what);
    *out = values;
    return 0;
}

int legacy_cells(legacy *r) {
    int64_t count = 0, size = 0;
    int status;
    if ((status = legacy_integer(r, "the number of CELLS", 0, INT64_MAX / 16, &count)) ||
        (status = legacy_integer(r, "the size of CELLS", 0, INT64_MAX / 16, &size)))
        return status;
    if (!legacy_accept(r, "OFFSETS")) return read_counted(r, count, size);
    r->offset_count = count;
    r->link_count = size;
    if ((status = read_indices(r, "OFFSETS", count, &r->offsets))) return status;
    if (!legacy_accept(r, "CONNECTIVITY"))
        return legacy_fail(r, "has no CONNECTIVITY behind the OFFSETS of its cells; it is damaged");
    return read_indices(r, "CONNECTIVITY", size, &r->links);
}

int legacy_cell_types(legacy *r) {
    void *types = NULL;
    uint64_t unfit;
    int status;
    if ((status = legacy_integer(r, "the number of CELL_TYPES", 0, INT64_MAX / 16, &r->type_count)) ||
        (status = legacy_array(r, "CELL_TYPES", TC_I32, r->type_count, 1, TC_U8, &types, &unfit)))
        return status;
    r->block->cell_types = types;
    return unfit ? legacy_fail(r, "has types of cells beyond 0 to 255; it is damaged") : 0;
}

static int check_cell(const legacy *r, int64_t cell) {
    int64_t begin = r->offsets[cell], end = r->offsets[cell + 1];
    if (begin < 0 || end < begin || end > r->link_count)
        return legacy_fail(r, "has offsets of cell %" PRId64 " that do not rise or lead out of its CONNECTIVITY", cell);
    if (r->block->cell_types[cell] == CELL_POLYHEDRON) return 0;
    for (int64_t i = begin; i < end; i++)
        if (r->links[i] < 0 || r->links[i] >= r->block->point_count)
            return legacy_fail(r, "has cell %" PRId64 " with point %" PRId64 ", but points 0 to %" PRId64 " only", cell,
                               r->links[i], r->block->point_count - 1);
    return 0;
}

static int compare_points(const void *a, const void *b) {
    const int64_t *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

/* Writes each point of the cell's faces once, and returns how many: fewer than the stream of its faces had numbers. */
static int64_t put_face_points(const dataset_block *b, int64_t cell, int64_t *to) {
    int64_t begin = b->face_offsets[b->cell_faces[cell]], end = b->face_offsets[b->cell_faces[cell + 1]], used = 0;
    memcpy(to, b->face_points + begin, (size_t)(end - begin) * sizeof *to);
    qsort(to, (size_t)(end - begin), sizeof *to, compare_points);
    for (int64_t n = 0; n < end - begin; n++)
        if (!used || to[n] != to[used - 1]) to[used++] = to[n];
    return used;
}

/* Takes the streams of faces; then the points of these faces replace the streams in r->links. */
static int take_polyhedra(legacy *r) {
    dataset_block *b = r->block;
    int64_t used = 0;
    int status = cell_faces_take(r->out, b, r->path, r->links, (uint64_t)r->link_count, r->offsets + 1, 1);
    if (status) return status;
    for (int64_t cell = 0, begin = r->offsets[0]; cell < b->cell_count; cell++) {
        int64_t end = r->offsets[cell + 1], count = end - begin;
        if (b->cell_types[cell] == CELL_POLYHEDRON)
            count = put_face_points(b, cell, r->links + used);
        else
            memmove(r->links + used, r->links + begin, (size_t)count * sizeof *r->links);
        r->offsets[cell] = used;
        used += count;
        begin = end;
    }
    r->offsets[b->cell_count] = used;
    return 0;
}

int legacy_check_cells(legacy *r) {
    int64_t cell_count = r->offset_count > 0 ? r->offset_count - 1 : 0;
    int has_polyhedra = 0;
    if (r->type_count != cell_count)
        return legacy_fail(r, "has %" PRId64 " cells, but CELL_TYPES for %" PRId64, cell_count, r->type_count);
    if (!r->offset_count && !(r->offsets = dataset_allocate(r->out, sizeof *r->offsets))) return STATUS_FAILED;
    if (!r->offset_count) r->offsets[0] = 0;
    for (int64_t cell = 0; cell < cell_count; cell++) {
        int status = check_cell(r, cell);
        if (status) return status;
        has_polyhedra |= r->block->cell_types[cell] == CELL_POLYHEDRON;
    }
    if (r->offsets[0] != 0 || r->offsets[cell_count] != r->link_count)
        return legacy_fail(r, "has offsets of cells from %" PRId64 " to %" PRId64 " in a CONNECTIVITY of %" PRId64,
                           r->offsets[0], r->offsets[cell_count], r->link_count);
    r->block->cell_count = cell_count;
    r->block->cell_offsets = r->offsets;
    r->block->cell_points = r->links;
    return has_polyhedra ? take_polyhedra(r) : 0;
}
