/*
 * The cells that the tetrahedra of a complex were cut from. Whether they are those is found out cell by cell, when
 * method hybrid reads them: a cell is cut again and compared.
 */
#include "base/structs.h"
#include "failure.h"
#include "grid/complex.h"

#include <string.h>

tc_status complex_cells_take(const tc_tetrahedra_grid_options *o, complex_grid *c) {
    if (!o->source && !o->cells) return TC_OK;
    if (!o->source || (!o->cells && o->tetrahedron_count))
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "the grid of tetrahedra has one of source and cells: give both, or none");
    tc_status status = struct_copy_in(&c->source, sizeof c->source, o->source, "source of the grid of tetrahedra");
    if (status) return status;
    const tc_cells *s = &c->source;
    if (o->tetrahedron_count && (!s->types || !s->offsets || !s->connectivity))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the source of the grid of tetrahedra needs types, offsets and "
                                                  "connectivity");
    if ((uintptr_t)s->offsets % sizeof(int64_t) || (uintptr_t)s->connectivity % sizeof(int64_t) ||
        (uintptr_t)o->cells % sizeof(uint32_t))
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "cells, or offsets or connectivity of their source, are not aligned to their type");
    c->cells = o->cells;
    c->has_cells = true;
    return TC_OK;
}

static tc_status cell_fail(uint64_t cell, uint32_t tetrahedron) {
    return (tc_status)fail(TC_ERROR_DATA,
                           "tetrahedron %lu is not what cell %llu is cut into: give the cells, unchanged, that "
                           "tc_tetrahedralize made the tetrahedra of",
                           (unsigned long)tetrahedron, (unsigned long long)cell);
}

/* Fills the corners; false where the cell cannot have been cut. */
static bool corners_get(const complex_grid *c, uint64_t cell, const cell_type *type, whole_cell *out) {
    const int64_t *offsets = c->source.offsets, first = offsets[cell], end = offsets[cell + 1];
    if (first < 0 || end < first || end > offsets[c->source.cell_count] || end - first < type->corner_count)
        return false;
    out->corner_count = type->corner_count;
    for (int n = 0; n < out->corner_count; n++) {
        const int64_t point = c->source.connectivity[first + type->corners[n]];
        if (point < 0 || point >= (int64_t)c->point_count) return false;
        out->corners[n] = (uint32_t)point;
    }
    return out->corner_count > 0;
}

/* Whether a tetrahedron is the other, or the other turned over. */
static bool is_same(const uint32_t a[4], const uint32_t b[4], bool turned) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[turned ? 3 : 2] && a[3] == b[turned ? 2 : 3];
}

tc_status complex_cell_get(const complex_grid *c, uint32_t tetrahedron, whole_cell *out) {
    const uint64_t cell = c->cells[tetrahedron];
    uint32_t cut[CELL_TETRAHEDRA_MAX][4];
    if (cell >= c->source.cell_count) return cell_fail(cell, tetrahedron);
    const cell_type *type = cell_type_get(c->source.types[cell]);
    *out = (whole_cell){.shape = type->shape};
    if (type->shape == CELL_POLYHEDRON)
        return (tc_status)fail(TC_ERROR_DATA,
                               "cell %llu is a polyhedron, which method hybrid does not take: use "
                               "method tetra",
                               (unsigned long long)cell);
    if (!corners_get(c, cell, type, out)) return cell_fail(cell, tetrahedron);
    out->tetrahedron_count = (uint32_t)cell_split(out->shape, out->corners, cut);
    if (!out->tetrahedron_count || out->tetrahedron_count > c->tetrahedron_count - tetrahedron)
        return cell_fail(cell, tetrahedron);
    const uint32_t *given = c->tetrahedra + 4 * (uint64_t)tetrahedron;
    out->mirrored = !is_same(given, cut[0], false);
    for (uint32_t n = 0; n < out->tetrahedron_count; n++)
        if (c->cells[tetrahedron + n] != cell || !is_same(given + 4 * (uint64_t)n, cut[n], out->mirrored))
            return cell_fail(cell, tetrahedron + n);
    return TC_OK;
}
