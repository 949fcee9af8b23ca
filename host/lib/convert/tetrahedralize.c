/*
 * Cells of any kind into a tetrahedral complex: each cell is looked up, checked, cut (cell_split.h) and turned so that
 * its volume is positive.
 */
#include "convert/tetrahedralize.h"

#include "tables/cell_split.h"
#include "failure.h"
#include "base/float_environment.h"
#include "convert/polyhedron.h"
#include "base/structs.h"

#include <math.h>
#include <string.h>

typedef enum cell_verdict { CELL_GOOD, CELL_SKIPPED, CELL_BAD } cell_verdict;

/* No cell reaches beyond the last offset, where the connectivity ends. */
static bool cell_offsets_rise(const tc_cells *cells, uint64_t c) {
    const int64_t from = cells->offsets[c], to = cells->offsets[c + 1];
    return from >= 0 && from <= to && to <= cells->offsets[cells->cell_count];
}

static bool points_in_range(const tc_cells *cells, const int64_t *points, int64_t count) {
    for (int64_t n = 0; n < count; n++)
        if (points[n] < 0 || (uint64_t)points[n] >= cells->point_count) return false;
    return true;
}

static bool cell_blanked(const tc_cells *cells, uint64_t c, const int64_t *points, int64_t count) {
    if (cells->blanked_cells && cells->blanked_cells[c]) return true;
    for (int64_t n = 0; n < count && cells->blanked_points; n++)
        if (cells->blanked_points[points[n]]) return true;
    return false;
}

static coordinate_array points_of(const tc_cells *cells) {
    return (coordinate_array){cells->points, cells->points_f64};
}

static bool point_usable(const tc_cells *cells, uint32_t point) {
    for (unsigned axis = 0; axis < 3; axis++)
        if (!(fabs(coordinate_get(points_of(cells), 3 * (uint64_t)point + axis)) < 0x1p127)) return false;
    return true;
}

/* The first of the cell's corners whose coordinates are not usable, or count. */
static int unusable_corner(const tc_cells *cells, const uint32_t corners[], int count) {
    for (int n = 0; n < count; n++)
        if (!point_usable(cells, corners[n])) return n;
    return count;
}

static cell_verdict unsupported_look(const tc_cells *cells, cell_tally *tally) {
    if (!cells->skip_unsupported) return CELL_BAD;
    tally->unsupported++;
    return CELL_SKIPPED;
}

/* The points of all faces of a polyhedron that has been checked, one face after the other. */
static const int64_t *polyhedron_points(const tc_cells *cells, uint64_t c, int64_t *count) {
    const int64_t *offsets = cells->face_offsets, *starts = cells->cell_faces;
    *count = offsets[starts[c + 1]] - offsets[starts[c]];
    return cells->face_connectivity + offsets[starts[c]];
}

/* The first point of a polyhedron that is not usable, or NULL. */
static const int64_t *polyhedron_unusable_point(const tc_cells *cells, uint64_t c) {
    int64_t count;
    const int64_t *points = polyhedron_points(cells, c, &count);
    for (int64_t n = 0; n < count; n++) {
        uint32_t point = (uint32_t)points[n];
        if (unusable_corner(cells, &point, 1) == 0) return points + n;
    }
    return NULL;
}

static cell_verdict polyhedron_judge(const tc_cells *cells, uint64_t c, cell_tally *tally) {
    int64_t count;
    int tetrahedra;
    if (polyhedron_look(cells, c)) return CELL_BAD;
    const int64_t *points = polyhedron_points(cells, c, &count);
    if (cell_blanked(cells, c, points, count)) {
        tally->blanked++;
        return CELL_SKIPPED;
    }
    if (polyhedron_unusable_point(cells, c)) return CELL_BAD;
    switch (polyhedron_cut(cells, c, NULL, &tetrahedra)) {
    case POLYHEDRON_GOOD:
        return CELL_GOOD;
    case POLYHEDRON_OPEN:
        return unsupported_look(cells, tally);
    default:
        return CELL_BAD;
    }
}

/* Checks one cell; fills `corners` where it is good. */
static cell_verdict cell_look(const tc_cells *cells, uint64_t c, cell_tally *tally, uint32_t corners[]) {
    const cell_type *type = cell_type_get(cells->types[c]);
    if (!cell_offsets_rise(cells, c)) return CELL_BAD;
    int64_t first = cells->offsets[c], count = cells->offsets[c + 1] - first;
    if (type->shape == CELL_FLAT) {
        tally->flat++;
        return CELL_SKIPPED;
    }
    if (type->shape == CELL_OTHER) return unsupported_look(cells, tally);
    if (type->shape == CELL_POLYHEDRON) return polyhedron_judge(cells, c, tally);
    if (count < type->corner_count || count < type->point_count) return CELL_BAD;
    const bool has_surplus = type->point_count && count > type->point_count;
    if (has_surplus) count = type->point_count;
    const int64_t *points = cells->connectivity + first;
    if (!points_in_range(cells, points, count)) return CELL_BAD;
    if (cell_blanked(cells, c, points, count)) {
        tally->blanked++;
        return CELL_SKIPPED;
    }
    for (int n = 0; n < type->corner_count; n++) corners[n] = (uint32_t)points[type->corners[n]];
    if (unusable_corner(cells, corners, type->corner_count) < type->corner_count) return CELL_BAD;
    tally->curved += type->curved;
    tally->surplus += has_surplus;
    return CELL_GOOD;
}

typedef struct signed_volumes {
    double positive, negative; /* sums, neither below 0 */
    bool has_positive, has_negative, is_turned;
} signed_volumes;

/* Measures a cell and turns it over where its volume is negative. */
static signed_volumes cell_turn(const tc_cells *cells, uint32_t tetrahedra[][4], int count) {
    signed_volumes v = {0};
    double sum = 0;
    for (int n = 0; n < count; n++) {
        double volume = tetrahedron_volume(points_of(cells), tetrahedra[n]);
        v.has_positive = v.has_positive || volume > 0;
        v.has_negative = v.has_negative || volume < 0;
        *(volume < 0 ? &v.negative : &v.positive) += fabs(volume);
        sum += volume;
    }
    for (int n = 0; n < count && sum < 0; n++) {
        uint32_t point = tetrahedra[n][2];
        tetrahedra[n][2] = tetrahedra[n][3];
        tetrahedra[n][3] = point;
    }
    v.is_turned = sum < 0;
    return v;
}

static void cell_orient(const tc_cells *cells, uint32_t tetrahedra[][4], int count, cell_tally *tally) {
    const signed_volumes v = cell_turn(cells, tetrahedra, count);
    tally->folded += v.has_positive && v.has_negative;
    tally->inverted += v.is_turned;
}

/* Faces of a polyhedron may be wound either way, so no polyhedron counts as inverted. */
static bool polyhedron_put(const tc_cells *cells, uint64_t c, tetrahedron_writer *writer) {
    const uint64_t first = writer->tally->tetrahedra;
    uint32_t(*out)[4] = writer->tetrahedra ? writer->tetrahedra + first : NULL;
    int count;
    if (polyhedron_cut(cells, c, out, &count)) return false;
    writer->tally->tetrahedra += (unsigned)count;
    if (!out) return true;
    const signed_volumes v = cell_turn(cells, out, count);
    writer->tally->folded += fmin(v.positive, v.negative) > 1e-5 * (v.positive + v.negative);
    for (int n = 0; n < count; n++) writer->cells[first + (unsigned)n] = (uint32_t)c;
    return true;
}

static bool cells_cut(const void *source, uint64_t first, uint64_t end, tetrahedron_writer *writer) {
    const tc_cells *cells = source;
    for (uint64_t c = first; c < end; c++) {
        uint32_t corners[CELL_CORNERS_MAX] = {0}, tetrahedra[CELL_TETRAHEDRA_MAX][4];
        cell_verdict verdict = cell_look(cells, c, writer->tally, corners);
        if (verdict == CELL_BAD) return false;
        if (verdict == CELL_SKIPPED) continue;
        cell_shape shape = cell_type_get(cells->types[c])->shape;
        if (shape == CELL_POLYHEDRON) {
            if (!polyhedron_put(cells, c, writer)) return false;
            continue;
        }
        int count = cell_split(shape, corners, tetrahedra);
        if (writer->tetrahedra) cell_orient(cells, tetrahedra, count, writer->tally);
        tetrahedra_put(writer, (const uint32_t(*)[4])tetrahedra, count, c);
    }
    return true;
}

/* ------------------------------------------------------------------------------------------------------------ check */

/* The error for a cell with a position that is not usable; its point numbers are valid. */
static tc_status position_refuse(const tc_cells *cells, uint64_t c, uint32_t point) {
    const cell_type *type = cell_type_get(cells->types[c]);
    double p[3];
    for (unsigned axis = 0; axis < 3; axis++) p[axis] = coordinate_get(points_of(cells), 3 * (uint64_t)point + axis);
    return (tc_status)fail(TC_ERROR_DATA,
                           "point %lu of cell %llu, a %s, is at %g, %g, %g: coordinates have to be finite and below "
                           "1.7e38 but for points that no cell uses; blank the point or the cell, if there is nothing "
                           "there",
                           (unsigned long)point, (unsigned long long)c, type->name, p[0], p[1], p[2]);
}

static tc_status polyhedron_refuse(const tc_cells *cells, uint64_t c) {
    static const char *const texts[] = {
        [POLYHEDRON_NO_FACES] = "has no faces",
        [POLYHEDRON_OFFSETS] = "has offsets of its faces that do not rise from 0 to the last one",
        [POLYHEDRON_TOO_LARGE] = "has faces of more than 4,194,304 corners together",
        [POLYHEDRON_POINT] = "has a face with a point that is not among those of the grid",
        [POLYHEDRON_OPEN] = "has faces that are not closed: an edge of one is not that of another"};
    int tetrahedra;
    polyhedron_verdict verdict = polyhedron_look(cells, c);
    const int64_t *unusable = verdict ? NULL : polyhedron_unusable_point(cells, c);
    if (unusable) return position_refuse(cells, c, (uint32_t)*unusable);
    if (!verdict) verdict = polyhedron_cut(cells, c, NULL, &tetrahedra);
    if (!verdict || verdict == POLYHEDRON_NO_MEMORY)
        return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory to cut cell %llu, a polyhedron",
                               (unsigned long long)c);
    return (tc_status)fail(TC_ERROR_DATA, "cell %llu, a polyhedron, %s", (unsigned long long)c, texts[verdict]);
}

/* corners: as cell_look left them. */
static tc_status cell_refuse(const tc_cells *cells, uint64_t c, const uint32_t corners[]) {
    const cell_type *type = cell_type_get(cells->types[c]);
    const char *name = type->name ? type->name : "unknown";
    unsigned long long number = c;
    if (!cell_offsets_rise(cells, c))
        return (tc_status)fail(TC_ERROR_DATA,
                               "the offsets of cell %llu, %lld to %lld, do not rise from 0 to the last one, %lld",
                               number, (long long)cells->offsets[c], (long long)cells->offsets[c + 1],
                               (long long)cells->offsets[cells->cell_count]);
    long long count = (long long)(cells->offsets[c + 1] - cells->offsets[c]);
    if (type->shape == CELL_OTHER)
        return (tc_status)fail(TC_ERROR_DATA,
                               "cell %llu is of type %d (%s): of cells with a volume, tetrahedra, voxels, hexahedra, "
                               "wedges, pyramids, their curved kin, prisms and polyhedra are cut",
                               number, cells->types[c], name);
    if (type->shape == CELL_POLYHEDRON) return polyhedron_refuse(cells, c);
    if (count < type->corner_count || count < type->point_count)
        return (tc_status)fail(TC_ERROR_DATA, "cell %llu, a %s, has %lld points, not %d", number, name, count,
                               type->point_count ? type->point_count : type->corner_count);
    if (type->point_count) count = type->point_count;
    if (points_in_range(cells, cells->connectivity + cells->offsets[c], count))
        return position_refuse(cells, c, corners[unusable_corner(cells, corners, type->corner_count)]);
    return (tc_status)fail(TC_ERROR_DATA, "cell %llu, a %s, has a point that is not among the %llu of the grid", number,
                           name, (unsigned long long)cells->point_count);
}

/* The error for the first bad cell from c on, where its block begins. If there is none, memory had run out. */
static tc_status bad_cell_refuse(const tc_cells *cells, uint64_t c) {
    uint32_t corners[CELL_CORNERS_MAX];
    cell_tally tally = {0};
    while (c < cells->cell_count && cell_look(cells, c, &tally, corners) != CELL_BAD) c++;
    if (c < cells->cell_count) return cell_refuse(cells, c, corners);
    return (tc_status)fail(TC_ERROR_MEMORY, "the host has no memory to cut polyhedra");
}

static tc_status faces_check(const tc_cells *cells) {
    const int64_t *starts = cells->cell_faces, *offsets = cells->face_offsets;
    if (!starts) return TC_OK;
    if ((uintptr_t)starts % sizeof *starts || (uintptr_t)offsets % sizeof *offsets ||
        (uintptr_t)cells->face_connectivity % sizeof(int64_t))
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "cell_faces, face_offsets or face_connectivity are not aligned to their type");
    if (starts[cells->cell_count] <= 0) return TC_OK;
    if (!offsets || offsets[0] < 0)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "faces need their face_offsets, which begin with 0 or more");
    if (offsets[starts[cells->cell_count]] > 0 && (!cells->face_connectivity || (!cells->points && !cells->points_f64)))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "faces need their face_connectivity and points");
    return TC_OK;
}

static tc_status cells_check(const tc_cells *cells) {
    if (cells->point_count > UINT32_MAX || cells->cell_count > UINT32_MAX)
        return (tc_status)fail(TC_ERROR_LIMIT, "%llu points and %llu cells: numbers of 32 bits reach %lu",
                               (unsigned long long)cells->point_count, (unsigned long long)cells->cell_count,
                               (unsigned long)UINT32_MAX);
    if (cells->cell_count && (!cells->types || !cells->offsets))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "cells need their types and offsets");
    if (cells->points && cells->points_f64)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "cells have points and points_f64; give one of them");
    if ((uintptr_t)cells->points % sizeof(float) || (uintptr_t)cells->points_f64 % sizeof(double) ||
        (uintptr_t)cells->offsets % sizeof(int64_t) || (uintptr_t)cells->connectivity % sizeof(int64_t))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "points, offsets or connectivity are not aligned to their type");
    if (cells->cell_count && cells->offsets[0] < 0)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the offsets of the cells begin below 0");
    if (cells->cell_count && cells->offsets[cells->cell_count] &&
        (!cells->connectivity || (!cells->points && !cells->points_f64)))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "cells need their connectivity and points");
    return TC_OK;
}

tc_status tc_tetrahedralize(const tc_cells *cells, tc_tetrahedra *complex) {
    FLOAT_ENVIRONMENT_DEFAULT;
    tc_cells c = {0};
    tc_tetrahedra made = {.struct_size = sizeof made};
    uint64_t bad_cell;
    tc_status status = complex_begin(complex, "tc_tetrahedralize: tetrahedra");
    if (!status) status = struct_copy_in(&c, sizeof c, cells, "tc_tetrahedralize: cells");
    if (!status) status = cells_check(&c);
    if (!status) status = faces_check(&c);
    if (status) return status;
    status = complex_make(cells_cut, &c, c.cell_count, &made, &bad_cell);
    if (!status) struct_copy_out(complex, &made);
    return status == TC_ERROR_DATA ? bad_cell_refuse(&c, bad_cell) : status;
}
