#include "grid/grid.h"

#include "base/structs.h"
#include "opencl/context.h"
#include "grid/coordinates.h"
#include "tables/tables.h"
#include "failure.h"
#include "kernels/base/slab.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Indices up to here are exact in float32, in which vertices are placed. Where a grid begins farther from 0, indices
 * count from a number near its first; so only the number of samples along an axis is limited by this. */
static const int64_t index_limit = 1 << 24;

size_t tc_type_bytes(tc_type type) { return sample_bytes(type); }

const char *tc_type_name(tc_type type) {
#define TYPE_NAME(type, name, ...) [type] = #name,
    static const char *const names[SAMPLE_TYPE_COUNT] = {SAMPLE_TYPES(TYPE_NAME)};
#undef TYPE_NAME
    return (unsigned)type < SAMPLE_TYPE_COUNT ? names[type] : NULL;
}

void tc_grid_options_init(tc_grid_options *options) {
    if (!options) return;
    *options = (tc_grid_options){.struct_size = sizeof *options, .type = TC_U8};
    for (int r = 0; r < 3; r++) options->matrix[r][r] = 1;
}

const void *grid_array_data(const tc_grid *grid, int array) {
    const void *const data[ARRAY_COUNT] = {grid->samples, grid->points, grid->blanked_samples, grid->blanked_cells};
    return data[array];
}

size_t grid_array_item_bytes(const tc_grid *grid, int array) {
    const size_t bytes[ARRAY_COUNT] = {tc_type_bytes(grid->type), sizeof(float), 1, 1};
    return bytes[array];
}

uint64_t grid_array_plane_bytes(const tc_grid *grid, int array) {
    uint64_t plane = (uint64_t)(grid->dims[0] * grid->dims[1]);
    if (array == ARRAY_BLANKED_CELLS) return (uint64_t)((grid->dims[0] - 1) * (grid->dims[1] - 1));
    return plane * (array == ARRAY_POINTS ? 3 : 1) * grid_array_item_bytes(grid, array);
}

uint64_t grid_layer_bricks(const tc_grid *grid) {
    return (uint64_t)((grid->dims[0] + 63) / 64) * (uint64_t)((grid->dims[1] + BRICK_ROWS - 1) / BRICK_ROWS);
}

tc_status seam_numbers_check(const tc_grid *grid, uint64_t vertex_count) {
    const uint64_t brick_vertices = 64 * BRICK_WORDS * VERTEX_TYPES_MOST, bricks = grid_layer_bricks(grid);
    const uint64_t behind = grid->seams.next ? grid->seams.next[bricks - 1] + brick_vertices : 0;
    if (vertex_count + behind <= UINT32_MAX) return TC_OK;
    return (tc_status)fail(
        TC_ERROR_LIMIT,
        "the piece's surface has %llu vertices, and as many as %llu behind it: indices of 32 bits reach "
        "%lu; make smaller pieces",
        (unsigned long long)vertex_count, (unsigned long long)behind, (unsigned long)UINT32_MAX);
}

unsigned grid_parity(const tc_grid *grid) { return (unsigned)(grid->first[0] + grid->first[1] + grid->first[2]) & 1; }

tc_status grid_sizes_check(const tc_grid_options *o) {
    if (tc_type_bytes(o->type) == 0) return (tc_status)fail(TC_ERROR_ARGUMENT, "%d is no sample type", (int)o->type);
    for (int axis = 0; axis < 3; axis++) {
        if (o->dims[axis] == 1)
            return (tc_status)fail(TC_ERROR_DATA, "the grid has one sample along %c: a surface needs two or more",
                                   'x' + axis);
        if (o->dims[axis] < 1)
            return (tc_status)fail(TC_ERROR_ARGUMENT, "%lld samples along %c: a grid needs two or more",
                                   (long long)o->dims[axis], 'x' + axis);
        if (o->dims[axis] > index_limit)
            return (tc_status)fail(TC_ERROR_DATA,
                                   "%lld samples along %c: they are limited to 2^24, as float32 holds indices of "
                                   "vertices; cut the grid in pieces",
                                   (long long)o->dims[axis], 'x' + axis);
        if (o->first_index[axis] < INT32_MIN || o->first_index[axis] > INT32_MAX - o->dims[axis] + 1)
            return (tc_status)fail(TC_ERROR_DATA, "%lld samples along %c from index %lld on: indices are of 32 bits",
                                   (long long)o->dims[axis], 'x' + axis, (long long)o->first_index[axis]);
    }
    int64_t count;
    if (__builtin_mul_overflow(o->dims[0] * o->dims[1], o->dims[2], &count) ||
        (uint64_t)count > PTRDIFF_MAX / tc_type_bytes(o->type))
        return (tc_status)fail(TC_ERROR_DATA, "%lld x %lld x %lld samples overflow the address space",
                               (long long)o->dims[0], (long long)o->dims[1], (long long)o->dims[2]);
    return TC_OK;
}

/* The cofactors of m are the inverse transposed times the determinant; its sign is taken out again. */
static void normal_matrix_derive(const double m[3][3], double determinant, float out[9]) {
    double c[9], largest = 0;
    for (int r = 0; r < 3; r++)
        for (int s = 0; s < 3; s++) {
            int r1 = (r + 1) % 3, r2 = (r + 2) % 3, s1 = (s + 1) % 3, s2 = (s + 2) % 3;
            double value = m[r1][s1] * m[r2][s2] - m[r1][s2] * m[r2][s1];
            c[3 * r + s] = determinant < 0 ? -value : value;
            largest = fmax(largest, fabs(value));
        }
    for (int n = 0; n < 9; n++) out[n] = (float)(c[n] / largest);
}

/* World coordinate r of an index, in double. */
static double world_at(const double matrix[3][4], const double index[3], int r) {
    return matrix[r][0] * index[0] + matrix[r][1] * index[1] + matrix[r][2] * index[2] + matrix[r][3];
}

/* The extent of a grid whose cells are parallelepipeds. */
static void uniform_extent(const double matrix[3][4], const tc_grid *grid, extent *e) {
    *e = extent_empty;
    for (int r = 0; r < 3; r++) {
        for (int corner = 0; corner < 8; corner++) {
            double index[3];
            for (int axis = 0; axis < 3; axis++)
                index[axis] = (double)(grid->first[axis] + (corner >> axis & 1 ? grid->dims[axis] - 1 : 0));
            const double at = world_at(matrix, index, r);
            e->low[r] = fmin(e->low[r], at);
            e->high[r] = fmax(e->high[r], at);
        }
        e->cell[r] = fmax(fabs(matrix[r][0]), fmax(fabs(matrix[r][1]), fabs(matrix[r][2])));
    }
}

/* For a grid so far from 0 that doubles cannot resolve its size: the origin is at the first index. */
static void uniform_origin(const double matrix[3][4], const extent *e, double origin[3]) {
    origin_choose(e, origin);
    for (int r = 0; r < 3; r++)
        if (e->cell[r] > 0 && e->cell[r] < fabs(matrix[r][3]) * 0x1p-48 && fabs(matrix[r][3]) <= (double)FLT_MAX)
            origin[r] = matrix[r][3];
}

/* Indices count from an even number near those of the whole grid where these are large, as float32 holds i + t, too:
 * cubes keep their parity. */
static void first_move(double matrix[3][4], tc_grid *whole, tc_grid *grid) {
    extent e = extent_empty;
    double base[3];
    for (int axis = 0; axis < 3; axis++) {
        e.low[axis] = (double)whole->first[axis];
        e.high[axis] = (double)(whole->first[axis] + whole->dims[axis] - 1);
        e.cell[axis] = 1;
    }
    origin_choose(&e, base);
    for (int axis = 0; axis < 3; axis++) /* large grids that are not far by that rule, but too far for float32 */
        if (fmax(fabs(e.low[axis] - base[axis]), fabs(e.high[axis] - base[axis])) > (double)index_limit)
            base[axis] = 2 * rint((e.low[axis] + e.high[axis]) / 4);
    for (int r = 0; r < 3; r++) matrix[r][3] = world_at((const double(*)[4])matrix, base, r);
    for (int axis = 0; axis < 3; axis++) {
        whole->first[axis] -= (int64_t)base[axis];
        grid->first[axis] -= (int64_t)base[axis];
    }
}

static tc_status matrix_refuse(const double matrix[3][4], int r, int c) {
    return (tc_status)fail(TC_ERROR_ARGUMENT, "spacing, origin or direction %g is beyond float32", matrix[r][c]);
}

/* The map as float32, relative to the origin; no corner of the grid may overflow. */
static tc_status matrix_round(const double matrix[3][4], tc_grid *grid) {
    for (int r = 0; r < 3; r++) {
        double reach = fabs(matrix[r][3] - grid->origin[r]);
        for (int c = 0; c < 4; c++) {
            grid->matrix[4 * r + c] = (float)(c < 3 ? matrix[r][c] : matrix[r][c] - grid->origin[r]);
            if (!isfinite(grid->matrix[4 * r + c])) return matrix_refuse(matrix, r, c);
        }
        for (int c = 0; c < 3; c++)
            reach +=
                fabs(matrix[r][c]) * fmax(fabs((double)grid->first[c]), fabs((double)(grid->first[c] + grid->dims[c])));
        if (reach > FLT_MAX)
            return (tc_status)fail(TC_ERROR_ARGUMENT,
                                   "spacing and origin put the grid's far corner at %g, beyond float32", reach);
    }
    return TC_OK;
}

static tc_status matrix_take(const double given[3][4], const double *origin, tc_grid *whole, tc_grid *grid) {
    double matrix[3][4], m[3][3], largest = 0;
    extent e;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++) {
            if (!isfinite(given[r][c])) return matrix_refuse(given, r, c);
            matrix[r][c] = given[r][c];
        }
    first_move(matrix, whole, grid);
    uniform_extent((const double(*)[4])matrix, whole, &e);
    if (origin)
        for (int axis = 0; axis < 3; axis++) grid->origin[axis] = origin[axis];
    else
        uniform_origin((const double(*)[4])matrix, &e, grid->origin);
    tc_status status = matrix_round((const double(*)[4])matrix, grid);
    if (status) return status;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) largest = fmax(largest, fabs((double)grid->matrix[4 * r + c]));
    if (largest == 0) largest = 1;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) m[r][c] = grid->matrix[4 * r + c] / largest;
    double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    if (determinant == 0)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "spacing and directions flatten the grid (their determinant is 0)");
    grid->mirrored = determinant < 0;
    normal_matrix_derive(m, determinant, grid->normal_matrix);
    return TC_OK;
}

/* How many of the three arrays of positions are given. */
static int arrays_given(const void *x, const void *y, const void *z) { return (x != NULL) + (y != NULL) + (z != NULL); }

static tc_status coordinates_check(const tc_grid_options *o) {
    const int axes = arrays_given(o->axes[0], o->axes[1], o->axes[2]);
    const int axes_f64 = arrays_given(o->axes_f64[0], o->axes_f64[1], o->axes_f64[2]);
    if (axes % 3 || axes_f64 % 3)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "a rectilinear grid needs positions along all three axes, not %d",
                               axes % 3 ? axes : axes_f64);
    if ((axes != 0) + (axes_f64 != 0) + (o->points != NULL) + (o->points_f64 != NULL) > 1)
        return (tc_status)fail(TC_ERROR_ARGUMENT,
                               "the grid has more than one of axes, axes_f64, points and points_f64; give one of them");
    uintptr_t unaligned = (uintptr_t)o->points % sizeof(float) | (uintptr_t)o->points_f64 % sizeof(double);
    for (int axis = 0; axis < 3; axis++)
        unaligned |= (uintptr_t)o->axes[axis] % sizeof(float) | (uintptr_t)o->axes_f64[axis] % sizeof(double);
    if (unaligned) return (tc_status)fail(TC_ERROR_ARGUMENT, "the grid's coordinates are not aligned to their type");
    if ((o->points || o->points_f64) &&
        o->dims[0] * o->dims[1] * o->dims[2] > (int64_t)(PTRDIFF_MAX / (3 * sizeof(double))))
        return (tc_status)fail(TC_ERROR_DATA, "%lld x %lld x %lld points overflow the address space",
                               (long long)o->dims[0], (long long)o->dims[1], (long long)o->dims[2]);
    return origin_check(o->has_origin, o->origin);
}

tc_status origin_check(int has_origin, const double origin[3]) {
    for (int axis = 0; axis < 3 && has_origin; axis++)
        if (!isfinite(origin[axis]))
            return (tc_status)fail(TC_ERROR_ARGUMENT, "the origin's %c is %g: it has to be finite", 'x' + axis,
                                   origin[axis]);
    return TC_OK;
}

/* Where samples lie. */
static tc_status positions_take(const tc_grid_options *o, tc_grid *grid) {
    for (int axis = 0; axis < 3; axis++) {
        grid->dims[axis] = o->dims[axis];
        grid->first[axis] = o->first_index[axis];
    }
    grid->blanked_samples = o->blanked_samples;
    grid->blanked_cells = o->blanked_cells;
    grid->kind = o->points || o->points_f64     ? GRID_CURVILINEAR
                 : o->axes[0] || o->axes_f64[0] ? GRID_RECTILINEAR
                                                : GRID_UNIFORM;
    grid->given_points = (coordinate_array){o->points, o->points_f64};
    for (int axis = 0; axis < 3; axis++) grid->given_axes[axis] = (coordinate_array){o->axes[axis], o->axes_f64[axis]};
    return coordinates_check(o);
}

/* The grid that *grid is a part of: itself, where no other is given. */
static tc_status whole_take(const tc_grid_options *given, const tc_grid *grid, tc_grid *whole) {
    tc_grid_options o;
    tc_grid_options_init(&o);
    *whole = (tc_grid){.kind = grid->kind};
    for (int axis = 0; axis < 3; axis++) {
        whole->dims[axis] = grid->dims[axis];
        whole->first[axis] = grid->first[axis];
    }
    if (!given) return TC_OK;
    tc_status status = struct_copy_in(&o, sizeof o, given, "whole grid");
    if (!status) status = grid_sizes_check(&o);
    if (!status) status = positions_take(&o, whole);
    if (status) return status;
    int is_within = 1;
    for (int axis = 0; axis < 3 && grid->kind == GRID_UNIFORM; axis++)
        is_within &= grid->first[axis] >= whole->first[axis] &&
                     grid->first[axis] + grid->dims[axis] <= whole->first[axis] + whole->dims[axis];
    if (whole->kind == grid->kind && is_within) return TC_OK;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "the grid is no part of its whole: %s",
                           is_within ? "their coordinates are of different kinds" : "indices lie outside");
}

/* The planes that a piece owns. Bricks are counted from the first plane of the grid, so that has to begin a layer of
 * the whole. */
static tc_status own_take(const tc_grid_options *o, const tc_grid *whole, tc_grid *grid) {
    const int64_t first = o->owned[0], end = o->owned[1], dims = o->dims[2];
    grid->own[0] = 0;
    grid->own[1] = dims;
    if (first == 0 && end == 0) return TC_OK;
    if (!o->whole)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "a grid that owns some of its planes is a piece: name its whole");
    const int64_t before = grid->first[2] - whole->first[2], behind = whole->dims[2] - before - dims;
    if (first < 0 || first >= end || end > dims || first % BRICK_PLANES || before % BRICK_PLANES || behind < 0 ||
        (end < dims && end % BRICK_PLANES))
        return (tc_status)fail(
            TC_ERROR_ARGUMENT,
            "a piece of planes %lld to %lld of its whole owns planes %lld to %lld of its own: pieces, "
            "and what they own, begin at multiples of %d and end there or with the whole",
            (long long)before, (long long)(before + dims - 1), (long long)first, (long long)end - 1, BRICK_PLANES);
    if ((before > 0 && first < PIECE_BEFORE) || (behind > 0 && dims - end < PIECE_BEHIND))
        return (tc_status)fail(
            TC_ERROR_ARGUMENT,
            "a piece needs at least %d planes before those that it owns, and %d behind, but where the "
            "whole begins and ends",
            PIECE_BEFORE, PIECE_BEHIND);
    grid->own[0] = first;
    grid->own[1] = end;
    grid->cut[0] = before > 0;
    grid->cut[1] = behind > 0;
    return TC_OK;
}

tc_status grid_describe(const tc_grid_options *o, tc_grid *grid) {
    tc_grid whole;
    tc_status status = grid_sizes_check(o);
    if (status) return status;
    if (!o->samples && !o->cl_samples) return (tc_status)fail(TC_ERROR_ARGUMENT, "the grid has no samples");
    if (o->samples && o->cl_samples)
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the grid has samples and cl_samples; give one of them");
    if ((uintptr_t)o->samples % tc_type_bytes(o->type))
        return (tc_status)fail(TC_ERROR_ARGUMENT, "the samples are not aligned to their type, %s",
                               tc_type_name(o->type));
    grid->type = o->type;
    grid->samples = o->samples;
    grid->cl_samples = o->cl_samples;
    grid->cl_samples_offset = o->cl_samples_offset;
    grid->has_nodata = o->has_nodata != 0;
    /* 0.1 is no float32; samples have the nearest float32. */
    grid->nodata = o->type == TC_F32 ? (double)(float)o->nodata : o->nodata;
    status = positions_take(o, grid);
    if (!status) status = whole_take(o->whole, grid, &whole);
    if (!status) status = own_take(o, &whole, grid);
    if (status) return status;
    const double *origin = o->has_origin ? o->origin : NULL;
    if (grid->kind == GRID_UNIFORM) return matrix_take(o->matrix, origin, &whole, grid);
    for (int axis = 0; axis < 3; axis++) grid->first[axis] &= 1; /* only the parity of cubes depends on it */
    if (o->whole && !origin) {
        coordinates_origin(&whole);
        origin = whole.origin;
    }
    return coordinates_take(grid, origin);
}

void grid_release(tc_grid *grid) {
    free(grid->own_coordinates);
    grid->own_coordinates = NULL;
}

tc_status tc_grid_origin(const tc_grid *grid, double origin[3]) {
    for (int axis = 0; axis < 3 && origin; axis++) origin[axis] = grid ? grid->origin[axis] : 0;
    if (grid && origin) return TC_OK;
    return (tc_status)fail(TC_ERROR_ARGUMENT, "tc_grid_origin needs a grid and a place for three numbers");
}
