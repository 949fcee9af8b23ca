#include "cell_sizes.h"

#include "exit_status.h"
#include "failure.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

enum { CELLS_PROBED = 4096, CORNERS_MOST = 8, WORLD_STEPS = 1024 };

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

/* A point of a uniform or rectilinear block. Of a uniform one without the matrix's offset, which may be so large that a
 * double has no room for a cell beside it. */
static void point_position(const dataset_block *b, int64_t point, double out[3]) {
    const int64_t at[3] = {point % b->dims[0], point / b->dims[0] % b->dims[1], point / b->dims[0] / b->dims[1]};
    for (int axis = 0; axis < 3; axis++) {
        const double *row = b->matrix[axis];
        out[axis] = b->kind == BLOCK_RECTILINEAR ? coordinate_at(b->axes[axis], at[axis]) : 0;
        for (int along = 0; along < 3 && b->kind == BLOCK_UNIFORM; along++)
            out[axis] += row[along] * (double)(at[along] + b->first[along]);
    }
}

/* A cell by its points, and where they are. */
typedef struct cell_corners {
    int count;
    int64_t points[CORNERS_MOST];
    double base[3]; /* where they count from */
    double at[CORNERS_MOST][3];
} cell_corners;

static void find_corners(const prepared_block *b, int64_t cell, cell_corners *c) {
    const dataset_block *from = b->source;
    c->count = cell_points(b, cell, c->points);
    for (int axis = 0; axis < 3; axis++) c->base[axis] = from->kind == BLOCK_UNIFORM ? from->matrix[axis][3] : 0;
    for (int n = 0; n < c->count; n++)
        if (from->kind == BLOCK_CURVILINEAR || from->kind == BLOCK_UNSTRUCTURED)
            for (int axis = 0; axis < 3; axis++) c->at[n][axis] = coordinate_at(from->points, 3 * c->points[n] + axis);
        else
            point_position(from, c->points[n], c->at[n]);
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int n = 0; n < 3; n++) out[n] = a[(n + 1) % 3] * b[(n + 2) % 3] - a[(n + 2) % 3] * b[(n + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

enum { SIDES_MOST = 4 };

/* The unit normals of a cell's sides and the cell's thickness along them. Of a cube the three at its first corner, as
 * if it were a parallelepiped; of a tetrahedron all four. None of a flat cell. Returns how many. */
static int find_sides(const cell_corners *c, double normals[SIDES_MOST][3], double thickness[SIDES_MOST]) {
    double edges[3][3], across[2][3];
    int count = 0;
    for (int n = 0; n < 3; n++)
        for (int axis = 0; axis < 3; axis++)
            edges[n][axis] = c->at[c->count == 4 ? n + 1 : 1 << n][axis] - c->at[0][axis];
    for (int axis = 0; axis < 3; axis++) {
        across[0][axis] = edges[1][axis] - edges[0][axis];
        across[1][axis] = edges[2][axis] - edges[0][axis];
    }
    for (int side = 0; side < (c->count == 4 ? 4 : 3); side++) {
        double normal[3];
        if (side < 3)
            cross(edges[side], edges[(side + 1) % 3], normal);
        else
            cross(across[0], across[1], normal);
        const double length = sqrt(dot(normal, normal)), height = fabs(dot(normal, edges[(side + 2) % 3])) / length;
        if (!(height > 0) || !isfinite(height)) continue;
        for (int axis = 0; axis < 3; axis++) normals[count][axis] = normal[axis] / length;
        thickness[count++] = height;
    }
    return count;
}

static void add_cell(const cell_corners *c, cell_range *out) {
    double normals[SIDES_MOST][3], thickness[SIDES_MOST];
    const int sides = find_sides(c, normals, thickness);
    for (int n = 0; n < sides; n++) out->thickness = fmin(out->thickness, thickness[n]);
    for (int axis = 0; axis < 3; axis++) {
        double low = c->at[0][axis], high = low;
        for (int n = 1; n < c->count; n++) {
            low = fmin(low, c->at[n][axis]);
            high = fmax(high, c->at[n][axis]);
        }
        out->low[axis] = fmin(out->low[axis], c->base[axis] + low);
        out->high[axis] = fmax(out->high[axis], c->base[axis] + high);
        if (high > low) out->least[axis] = fmin(out->least[axis], high - low);
    }
}

/* Cells are alike in a uniform block, and in a rectilinear one along each axis: those along its edges are all. */
static void add_edges(const prepared_block *b, cell_range *out) {
    const int64_t *d = b->source->dims;
    int64_t stride = 1;
    for (int axis = 0; axis < 3; stride *= d[axis++] - 1)
        for (int64_t n = 0; n < d[axis] - 1; n += b->source->kind == BLOCK_UNIFORM && d[axis] > 2 ? d[axis] - 2 : 1) {
            cell_corners c;
            find_corners(b, n * stride, &c);
            add_cell(&c, out);
        }
}

void cell_range_find(const prepared_block *b, int all, cell_range *out) {
    const int64_t count = cell_count(b), stride = all ? 1 : count / CELLS_PROBED + 1;
    const int is_regular = !b->is_cut && b->source->kind != BLOCK_CURVILINEAR;
    for (int axis = 0; axis < 3; axis++) {
        out->low[axis] = out->least[axis] = INFINITY;
        out->high[axis] = -INFINITY;
    }
    out->thickness = INFINITY;
    if (is_regular && count) add_edges(b, out);
    for (int64_t cell = is_regular ? count - 1 : 0; cell >= 0 && cell < count;) {
        cell_corners c;
        find_corners(b, cell, &c);
        add_cell(&c, out);
        cell = cell < count - 1 && cell + stride >= count ? count - 1 : cell + stride; /* the last one too */
    }
}

double step_at(double value, int digits) {
    const int least = digits == FLT_MANT_DIG ? FLT_MIN_EXP - FLT_MANT_DIG : DBL_MIN_EXP - DBL_MANT_DIG;
    int exponent;
    frexp(value, &exponent);
    return ldexp(1, exponent - digits > least ? exponent - digits : least);
}

int blocks_suit_world(const block_list *list) {
    for (int n = 0; n < list->count; n++) {
        const dataset_block *from = list->blocks[n].source, *whole = from->whole;
        const int has_whole = whole && (from->kind == BLOCK_UNIFORM || from->kind == BLOCK_RECTILINEAR);
        const prepared_block all = {.source = whole};
        cell_range cells;
        double step = 0;
        cell_range_find(has_whole ? &all : &list->blocks[n], 0, &cells);
        for (int axis = 0; axis < 3; axis++)
            step += step_at(fmax(fabs(cells.low[axis]), fabs(cells.high[axis])), FLT_MANT_DIG);
        if (cells.low[0] <= cells.high[0] && !(cells.thickness >= WORLD_STEPS * step)) return 0;
    }
    return 1;
}

float *cell_steps(const prepared_block *b, const coordinate_numbers *numbers) {
    const int64_t count = cell_count(b);
    float *steps = calloc((size_t)b->source->point_count + 1, sizeof *steps);
    if (!steps) fail(STATUS_FAILED, "no memory for the sizes of cells at %" PRId64 " points", b->source->point_count);
    for (int64_t cell = 0; steps && cell < count; cell++) {
        double normals[SIDES_MOST][3], thickness[SIDES_MOST];
        cell_corners c;
        find_corners(b, cell, &c);
        const int sides = find_sides(&c, normals, thickness);
        for (int n = 0; n < c.count && sides; n++) {
            double fewest = (double)FLT_MAX, step[3];
            for (int axis = 0; axis < 3; axis++)
                step[axis] = step_at(c.at[n][axis] + (c.base[axis] - numbers->zero[axis]), numbers->digits);
            for (int side = 0; side < sides; side++) {
                const double *normal = normals[side];
                const double moved = fabs(normal[0]) * step[0] + fabs(normal[1]) * step[1] + fabs(normal[2]) * step[2];
                fewest = fmin(fewest, thickness[side] / moved);
            }
            steps[c.points[n]] = fmaxf(steps[c.points[n]], (float)fmax(fewest, (double)FLT_MIN));
        }
    }
    return steps;
}
