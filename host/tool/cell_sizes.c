#include "cell_sizes.h"

#include "exit_status.h"
#include "failure.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

enum { CELLS_PROBED = 4096, CORNERS_MOST = 8 };

static int64_t cell_count(const prepared_block *b) {
    const int64_t *d = b->source->dims;
    if (b->is_cut) return (int64_t)b->complex.tetrahedron_count;
    return b->is_skipped ? 0 : (d[0] - 1) * (d[1] - 1) * (d[2] - 1);
}

/* The point numbers of a cell; returns how many. */
static int cell_points(const prepared_block *b, int64_t cell, int64_t points[CORNERS_MOST]) {
    const int64_t *d = b->source->dims, cells[2] = {d[0] - 1, d[1] - 1};
    if (b->is_cut) {
        for (int n = 0; n < 4; n++) points[n] = b->complex.tetrahedra[4 * cell + n];
        return 4;
    }
    const int64_t x = cell % cells[0], y = cell / cells[0] % cells[1], z = cell / cells[0] / cells[1];
    for (int n = 0; n < CORNERS_MOST; n++) points[n] = x + (n & 1) + d[0] * (y + (n >> 1 & 1) + d[1] * (z + (n >> 2)));
    return CORNERS_MOST;
}

static void point_position(const dataset_block *b, int64_t point, double out[3]) {
    const int64_t at[3] = {point % b->dims[0], point / b->dims[0] % b->dims[1], point / b->dims[0] / b->dims[1]};
    for (int axis = 0; axis < 3; axis++) {
        const double *row = b->matrix[axis];
        out[axis] = b->kind == GRID_RECTILINEAR ? coordinate_at(b->axes[axis], at[axis]) : row[3];
        for (int along = 0; along < 3 && b->kind == GRID_UNIFORM; along++)
            out[axis] += row[along] * (double)(at[along] + b->first[along]);
    }
}

/* The box of a cell. Returns the number of its points. */
static int cell_box(const prepared_block *b, int64_t cell, int64_t points[CORNERS_MOST], double low[3],
                    double high[3]) {
    const dataset_block *from = b->source;
    const int count = cell_points(b, cell, points);
    for (int n = 0; n < count; n++) {
        double at[3];
        if (from->kind == GRID_CURVILINEAR || from->kind == GRID_UNSTRUCTURED)
            for (int axis = 0; axis < 3; axis++) at[axis] = coordinate_at(from->points, 3 * points[n] + axis);
        else
            point_position(from, points[n], at);
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = n ? fmin(low[axis], at[axis]) : at[axis];
            high[axis] = n ? fmax(high[axis], at[axis]) : at[axis];
        }
    }
    return count;
}

void cell_range_find(const prepared_block *b, int all, cell_range *out) {
    const int64_t count = cell_count(b), stride = all ? 1 : count / CELLS_PROBED + 1;
    for (int axis = 0; axis < 3; axis++) {
        out->low[axis] = out->least[axis] = INFINITY;
        out->high[axis] = -INFINITY;
    }
    for (int64_t cell = 0; cell < count;
         cell = cell < count - 1 && cell + stride >= count ? count - 1 : cell + stride) {
        int64_t points[CORNERS_MOST];
        double low[3], high[3];
        cell_box(b, cell, points, low, high);
        for (int axis = 0; axis < 3; axis++) {
            out->low[axis] = fmin(out->low[axis], low[axis]);
            out->high[axis] = fmax(out->high[axis], high[axis]);
            if (high[axis] > low[axis]) out->least[axis] = fmin(out->least[axis], high[axis] - low[axis]);
        }
    }
}

float *cell_sizes(const prepared_block *b) {
    const int64_t count = cell_count(b);
    float *sizes = calloc((size_t)b->source->point_count * 3 + 1, sizeof *sizes);
    if (!sizes) fail(STATUS_FAILED, "no memory for the sizes of cells at %" PRId64 " points", b->source->point_count);
    for (int64_t cell = 0; sizes && cell < count; cell++) {
        int64_t points[CORNERS_MOST];
        double low[3], high[3];
        const int corners = cell_box(b, cell, points, low, high);
        for (int n = 0; n < corners; n++)
            for (int axis = 0; axis < 3; axis++) {
                float *size = &sizes[3 * points[n] + axis];
                *size = fmaxf(*size, (float)(high[axis] - low[axis]));
            }
    }
    return sizes;
}
