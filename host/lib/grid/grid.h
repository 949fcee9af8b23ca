/*
 * grid.h - a structured grid as both engines see it: checked sizes, parity, where its samples are in world space
 */
#ifndef GRID_H
#define GRID_H

#include "grid/origin.h"
#include "sample_types.h"
#include "tetracubes.h"
#include "opencl/tuning.h"
#include "kernels/base/slab.h"

#include <math.h>

#include <stdbool.h>

struct device_grid;
struct complex_grid;

/* Where positions come from; the kernels know it as GRID. */
typedef enum grid_kind { GRID_UNIFORM = 0, GRID_RECTILINEAR = 1, GRID_CURVILINEAR = 2 } grid_kind;

/* Planes of a piece beside those that it owns. Before: gradients and missing cells need one plane; a whole layer of
 * bricks is taken, so that bricks stay whole. Behind: two, for the vertices that its last triangles use. Whether a
 * sample is snapped depends on samples up to five steps away, also of the two planes behind. */
enum { PIECE_BEFORE = BRICK_PLANES, PIECE_BEHIND = 2, PIECE_SNAP = 2 * BRICK_PLANES };

/* The seams of a piece, during tc_count_piece and tc_extract_piece; else NULL. */
typedef struct piece_seams {
    uint32_t *own;        /* to be filled: vertices before each brick of its first layer */
    const uint32_t *next; /* the same of the piece behind */
} piece_seams;

struct tc_grid {
    tc_context *context;
    scan_parameters scan; /* the context's, except in a trial */
    int64_t dims[3];
    int64_t first[3];
    int64_t own[2]; /* the planes own[0] <= z < own[1] of the grid's own vertices and cells: all but of a piece */
    bool cut[2];    /* a piece: the whole goes on before it, and behind */
    piece_seams seams;
    tc_type type;
    const void *samples;        /* NULL where they are in cl_samples */
    struct _cl_mem *cl_samples; /* the caller's, retained by the device path */
    uint64_t cl_samples_offset;
    bool has_nodata;
    double nodata;
    grid_kind kind;
    float matrix[12];       /* uniform: rows of the index-to-world map: m0 m1 m2 o */
    float normal_matrix[9]; /* inverse transposed, scaled by a positive number: index gradients to world directions */
    double origin[3];       /* world coordinates minus this are what matrix, axes and points give */
    const float *axes[3];   /* rectilinear */
    const float *points;    /* curvilinear */
    coordinate_array given_axes[3], given_points;   /* as the caller gave them, while the grid is described */
    float *own_coordinates;                         /* memory of axes or points; NULL where it is the caller's */
    const uint8_t *blanked_samples, *blanked_cells; /* or NULL */
    bool mirrored;                                  /* negative determinant, or sum of the Jacobians */
    struct device_grid *device;                     /* NULL under the reference engine */
    struct complex_grid *complex;                   /* unstructured: its points are dims[0]; NULL: structured */
};

/* Whether sizes, indices and type are those of a grid. */
tc_status grid_sizes_check(const tc_grid_options *options);

/* Checks the options and fills *grid, which is zeroed, except for context, scan and device. Release it in any case. */
tc_status grid_describe(const tc_grid_options *options, tc_grid *grid);
void grid_release(tc_grid *grid);

/* TC_ERROR_ARGUMENT for an origin of the caller that is not finite. */
tc_status origin_check(int has_origin, const double origin[3]);

static inline int64_t grid_sample_count(const tc_grid *grid) { return grid->dims[0] * grid->dims[1] * grid->dims[2]; }

/* An array of a grid (context.h: ARRAY_...) in the host's memory, or NULL; bytes of one item, and of a plane. */
const void *grid_array_data(const tc_grid *grid, int array);
size_t grid_array_item_bytes(const tc_grid *grid, int array);
uint64_t grid_array_plane_bytes(const tc_grid *grid, int array);

/* Whether the grid is a piece that others follow: their first vertices are used by its last triangles. */
static inline bool grid_has_seam(const tc_grid *grid) { return !grid->complex && grid->own[1] < grid->dims[2]; }

/* TC_ERROR_LIMIT where the piece's own vertices and those behind its seam have no numbers of 32 bits together. */
tc_status seam_numbers_check(const tc_grid *grid, uint64_t vertex_count);

/* Bricks in a layer. */
uint64_t grid_layer_bricks(const tc_grid *grid);

/* 0 where the first sample's cube is even. */
unsigned grid_parity(const tc_grid *grid);

/* A sample in the host's memory. */
static inline double grid_value_at(const tc_grid *grid, int64_t n) {
    return value_at(grid->type, grid->samples, (uint64_t)n);
}

/* A sample that is blanked or has no value; where samples are in cl_samples only the first can be known. */
static inline bool grid_sample_missing(const tc_grid *grid, int64_t n) {
    if (grid->blanked_samples && grid->blanked_samples[n]) return true;
    if (!grid->samples) return false;
    double value = grid_value_at(grid, n);
    return !isfinite(value) || (grid->has_nodata && value == grid->nodata);
}

#endif
