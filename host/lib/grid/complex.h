/*
 * complex.h - tetrahedral complexes as grids: what both engines know of one, and the calls that choose between them
 */
#ifndef COMPLEX_H
#define COMPLEX_H

#include "tables/cell_split.h"
#include "opencl/context.h"
#include "grid/carry.h"
#include "grid/grid.h"
#include "grid/inside.h"
#include "grid/interval.h"
#include "grid/mesh.h"

/* What the device has of a complex: all of it, or a slab. */
typedef struct complex_part {
    uint32_t point_count, tetrahedron_count;
    device_buffer samples, points, tetrahedra;
    uint64_t sample_offset, point_offset, tetrahedron_offset; /* of the first item in its buffer */
    device_buffer ranges;                                     /* of its clusters, made at the first visit */
    bool ranges_known;
} complex_part;

/* Counts of a surface in the workspace. */
typedef struct surface_size {
    uint64_t vertex_count;
    uint64_t cap_vertices; /* the last ones of these, at the border's points */
    uint32_t active_count, tile_actives;
} surface_size;

/* Type and samples are those of the tc_grid. */
typedef struct complex_grid {
    uint32_t point_count;
    uint32_t tetrahedron_count;
    const float *points; /* relative to the grid's origin */
    float *own_points;   /* memory of points; NULL where it is the caller's */
    const uint32_t *tetrahedra;

    /* The cells that were cut, where the caller gave them: */
    bool has_cells;
    tc_cells source;
    const uint32_t *cells; /* by tetrahedron */

    /* Under an OpenCL engine: */
    complex_part part;
    struct complex_slabs *slabs;          /* how it is cut; NULL: the device has it whole */
    struct complex_slabs *interval_slabs; /* the same for interval volumes */
    uint64_t *used_points;      /* a bit for each point that a present tetrahedron has; NULL: not asked for yet */
    double classified_isovalue; /* where context->classified_grid is this grid */
    tc_method classified_method;
    bool classified_closed;
    surface_size size;              /* of the surface there */
    struct whole_cells *whole;      /* cells as method hybrid takes them; NULL: not asked for yet */
    struct border_list *borders[2]; /* of tetrahedra, of whole cells; NULL: not asked for yet */
    bool carries;                   /* a field was carried to a surface of the complex */
} complex_grid;

/* The kind of its kernels: one program for each method, tried with emission or without. */
kernel_kind complex_kind(const tc_grid *grid, const tc_extract_options *options, bool emits);

/* The same of interval volumes. */
kernel_kind complex_interval_kind(const tc_grid *grid);

/* Whether there are kernels for the method; hybrid needs the cells. */
bool complex_has_kernels(const tc_grid *grid, const tc_extract_options *options);

/* As tc_count, tc_extract and tc_interpolate_field; the struct of options is complete. share: of the whole call, for
 * progress. */
tc_status complex_count(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts);
tc_status complex_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh);
tc_status complex_carry(tc_grid *grid, const tc_extract_options *options, const carry *c, uint64_t *vertex_count);

/* Checks the options and fills *grid but for context and device; to be released in any case (complex.c). */
tc_status complex_describe(const tc_tetrahedra_grid_options *options, tc_grid *grid);
void complex_release(tc_grid *grid);

/* A cell that method hybrid keeps whole. */
typedef struct whole_cell {
    cell_shape shape;
    int corner_count;
    uint32_t corners[CELL_CORNERS_MAX]; /* in the order of cell_split.h */
    bool mirrored;                      /* of negative volume: its tetrahedra have been turned over */
    uint32_t tetrahedron_count;
} whole_cell;

/* The cell of this tetrahedron and of those that follow, as far as they are the same cell's (complex_cells.c).
 * TC_ERROR_DATA where they are not what the cell is cut into, and for polyhedra. */
tc_status complex_cell_get(const complex_grid *c, uint32_t tetrahedron, whole_cell *out);

/* TC_ERROR_ARGUMENT for cells that cannot be those of the tetrahedra. */
tc_status complex_cells_take(const tc_tetrahedra_grid_options *options, complex_grid *c);

/* Whether the sample at a point is missing; whether any is. */
static inline bool complex_point_missing(const tc_grid *grid, uint32_t point) {
    if (grid->type == TC_F32) return !isfinite(((const float *)grid->samples)[point]);
    return grid->type == TC_F64 && !isfinite(((const double *)grid->samples)[point]);
}
bool complex_has_gaps(const tc_grid *grid);

/* Records the error for a tetrahedron with an invalid point number. */
tc_status complex_point_fail(const complex_grid *c);

/* The device path (complex_device.c); the sample type has values on both sides of the isovalue. */
tc_status complex_device_create(tc_grid *grid);
void complex_device_destroy(tc_grid *grid);
tc_status complex_device_count(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts);
tc_status complex_device_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh);

/* As complex_device_carry, by method hybrid. */
tc_status whole_device_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                             uint64_t *vertex_count);

/* True where this surface was the last to be counted or extracted, which complex_device_carry needs. That carries a
 * field to the *vertex_count vertices; to none where the caller's room is for another number (complex_carry.c). */
bool complex_is_classified(const tc_grid *grid, const tc_extract_options *options);
tc_status complex_device_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                               uint64_t *vertex_count);

/* Interval volumes on the device path (complex_interval.c): as tc_count_interval_volume and tc_extract_interval_volume,
 * with arguments checked and kernels vetted. A field carried to the vertices at points alone, as many as there is room
 * for; *count: how many there are. */
tc_status complex_interval_count(tc_grid *grid, const tc_interval_volume_options *options, interval_size *size,
                                 double *classify_ms);
tc_status complex_interval_extract(tc_grid *grid, const tc_interval_volume_options *options,
                                   tc_interval_volume *interval);
tc_status complex_interval_carry(tc_grid *grid, const tc_interval_volume_options *options, const carry *c,
                                 uint64_t *count);

/* Surfaces by the scalar reference (reference_complex.c). */
tc_status reference_complex_count(const tc_grid *grid, const tc_extract_options *options, tc_counts *counts);
tc_status reference_complex_extract(const tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh);
tc_status reference_complex_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                                  uint64_t *vertex_count);

#endif
