/*
 * complex_run.h - the device path over complexes: what its files share
 *
 * Kernels run over a part of a complex, which is all of it where that fits the device, else one slab after the other.
 *
 * A slab has clusters that follow each other. It is cut so that whatever its surface is, everything on the device fits
 * the budget and each buffer the device. Its points are all those of the complex where these leave room enough, else
 * its own, numbered in the order of the complex's. Its surface is numbered on its own; the host joins the vertices over
 * slabs (edge_numbers.h).
 */
#ifndef COMPLEX_RUN_H
#define COMPLEX_RUN_H

#include "grid/complex.h"
#include "opencl/kernels.h"
#include "tetrahedra/border_list.h"
#include "tetrahedra/edge_numbers.h"

/* How a complex is cut, and what is known of its clusters; the host has the ranges that the device has of a slab. */
struct complex_slabs {
    uint32_t slab_clusters, slab_count;
    bool points_whole;   /* all points are on the device */
    brick_range *ranges; /* of all clusters, made at the first visit */
    bool ranges_known;
    edge_numbers edges; /* of the vertices of the last surface, where fields are carried */
};

/* ------------------------------------------------------------------------------------- memory (complex_plan.c) */

uint32_t complex_cluster_count(uint64_t tetrahedron_count);

/* Clusters per tile of kernel 1, active tetrahedra per tile of the numbering. */
uint32_t complex_tile_clusters(const tc_grid *grid);
uint32_t complex_tile_actives(const tc_grid *grid);

/* Of interval volumes: a tile has so many clusters, as a power of two. */
uint32_t complex_interval_tile_shift(const tc_grid *grid);

/* Whether kernel 1 can run over the complex whole. */
bool complex_fits(const tc_grid *grid);

/* Brings the arrays of a complex that is not cut to the device, where they are not there. */
tc_status complex_arrays_provide(tc_grid *grid);

/* Cuts the complex, which is not cut yet, into slabs: complex_cut for surfaces, complex_interval_cut for interval
 * volumes, whose slabs are others. TC_ERROR_MEMORY, with what
 * would be needed, where the least slab is too large: nothing has changed then. */
tc_status complex_cut(tc_grid *grid);
tc_status complex_interval_cut(tc_grid *grid);
void complex_slabs_release(struct complex_slabs *slabs); /* NULL: nothing */

/* Whether the sums of an interval volume of the complex in one piece fit the scan. */
bool complex_interval_sums_fit(const tc_grid *grid);

/* ---------------------------------------------------------------------------- arrays of a part (complex_part.c) */

/* Bring tetrahedra, or points with samples, from the host to the device, in place where possible. If points or samples
 * fail, neither is kept. */
tc_status part_tetrahedra_provide(tc_grid *grid, const uint32_t *tetrahedra, uint32_t count);
tc_status part_points_provide(tc_grid *grid, const float *points, const void *samples, uint32_t count);
void part_tetrahedra_release(tc_grid *grid); /* with their ranges */
void part_points_release(tc_grid *grid);

/* Points of a slab on their own. */
typedef struct local_points {
    uint64_t *used;    /* a bit per point of the complex */
    uint32_t *before;  /* per word of them, those in words before it */
    uint32_t *numbers; /* in the complex */
    float *points;
    void *samples;
    uint32_t *tetrahedra; /* of local points */
} local_points;

/* Allocates for slabs of tetrahedron_count tetrahedra. */
tc_status local_points_allocate(const tc_grid *grid, uint32_t tetrahedron_count, local_points *local);
void local_points_release(local_points *local);

/* Fills numbers, points, samples and tetrahedra. TC_ERROR_DATA for invalid point numbers. */
tc_status local_points_gather(const tc_grid *grid, const uint32_t *tetrahedra, uint32_t tetrahedron_count,
                              local_points *local, uint32_t *count);

/* ------------------------------------------------------------------- an isovalue's surface (complex_surface.c) */

typedef struct complex_run {
    tc_grid *grid;
    complex_grid *complex;
    complex_part *part;
    tc_context *context;
    complex_buffers *work;
    border_list *border; /* where the surface is closed */
    sized_kernel kernels[ALL_COMPLEX_KERNELS];
    isovalue_test test;
    complex_job job;
    uint32_t head[HEAD_WORDS];
    bool keeps_cells;
    bool interval;   /* for an interval volume */
    bool is_cut;     /* into slabs, which fit */
    bool too_large;  /* the surface of a complex that is not cut does not fit */
    double start_ms; /* kernels are built by then */
} complex_run;

/* What a method does with a complex on the device: `tetrahedra` with those that cells are cut into, `cells` with cells
 * that are kept whole (whole_run.h). */
typedef struct complex_method {
    tc_method method;
    bool (*is_cut)(const tc_grid *grid); /* it goes slab by slab, and does so from then on */

    /* All stages before emission, in one go; then r->head and r->job have the counts. */
    tc_status (*count)(complex_run *r, tc_grid *grid, const tc_extract_options *options, double share);
    tc_status (*emit)(complex_run *r, const device_buffer *positions, const device_buffer *triangles);

    /* Cuts the complex into slabs, after a run that was too large. */
    tc_status (*cut)(complex_run *r);
    tc_status (*slabs_count)(tc_grid *grid, const tc_extract_options *options, double before, double share,
                             tc_counts *counts);
    tc_status (*slabs_extract)(tc_grid *grid, const tc_extract_options *options, double before, tc_mesh *mesh);
} complex_method;

extern const complex_method method_cells; /* whole_device.c */

/* The job of kernel 1 over the run's part, as far as both methods have the same. */
complex_job complex_job_of(const complex_run *r, uint32_t cluster_count);

/* Kernels, and the workspace for this grid. */
tc_status complex_run_begin(complex_run *r, tc_grid *grid, const tc_extract_options *options);

/* The same of a run that says where it works, whether the complex is cut, and whether it is for an interval volume. */
tc_status complex_run_open(complex_run *r, const tc_extract_options *options);

/* Finds the active tetrahedra of the part; then numbers its vertices. head has the counts. */
tc_status surface_classify(complex_run *r);
tc_status surface_number(complex_run *r);

/* Emits what has been numbered, triangles among it. */
tc_status surface_emit(complex_run *r, const device_buffer *positions, const device_buffer *triangles);

/* Notes that the workspace, or the slabs, know this surface. */
void complex_classified_note(tc_grid *grid, const tc_extract_options *options, surface_size size);

/* What both methods begin a run with: kernels, and the workspace for this grid. */
tc_status complex_workspace_begin(complex_run *r, tc_grid *grid, const tc_extract_options *options);

/* Parts of a run: fills a buffer from byte `first` on; reads the head back; reserves the table of edges, whose size is
 * a power of two. */
tc_status surface_fill(const complex_run *r, const device_buffer *buffer, cl_uint value, uint64_t first,
                       uint64_t bytes);
tc_status surface_head_read(complex_run *r);
tc_status surface_table_reserve(complex_run *r, uint64_t entries);
tc_status surface_clusters_reserve(complex_run *r);

/* Reserves a buffer whose size depends on the surface. Where it does not fit and the complex is not cut into slabs yet:
 * TC_ERROR_MEMORY, and too_large is set. */
tc_status surface_reserve(complex_run *r, device_buffer *buffer, uint64_t bytes, const char *name);
bool surface_fits(complex_run *r, uint64_t bytes);

/* Reserves a buffer likewise, and copies a table to it. */
tc_status surface_table_provide(complex_run *r, device_buffer *buffer, const void *table, uint64_t bytes);

/* Bytes of the table that drives the kernels, from the 16 cases. */
void complex_cases(uint8_t cases[16][CASE_BYTES]);

/* ------------------------------------------------------------------------------------ one slab (complex_slab.c) */

uint32_t slab_first_cluster(const struct complex_slabs *slabs, uint32_t slab_index);
uint32_t slab_cluster_count(const complex_grid *c, const struct complex_slabs *slabs, uint32_t slab_index);

/* Begin and end a call that goes slab by slab; the second one in any case. */
tc_status complex_slabs_open(const tc_grid *grid, const struct complex_slabs *slabs, local_points *local);
void complex_slabs_close(tc_grid *grid, const struct complex_slabs *slabs, local_points *local);

/* Brings a slab to the device, with its ranges where they are known; keeps the ranges that kernel 1 has found. */
tc_status complex_slab_load(tc_grid *grid, struct complex_slabs *slabs, local_points *local, uint32_t slab_index,
                            bool ranges_known);
tc_status complex_slab_ranges_keep(tc_grid *grid, struct complex_slabs *slabs, uint32_t slab_index);

/* The crossed edges of all slabs so far, and the numbers that the vertices of each slab have in the mesh. */
typedef struct joined_edges {
    active_tetrahedron *active; /* of one slab */
    edge_numbers edges;
    uint32_t *numbers; /* of the vertices of each slab, one slab after the other */
    uint64_t number_count, number_capacity, active_capacity;
} joined_edges;

/* Adds those of a slab whose vertices are numbered. names: the grid's numbers of the slab's points; NULL: the same. */
tc_status complex_slab_edges_join(const complex_run *r, const uint32_t *names, joined_edges *j);
void joined_edges_release(joined_edges *j);

/* Makes room for the numbers of so many vertices more, and adds one, of the edge between two points of the slab. */
tc_status joined_edges_reserve(joined_edges *j, uint64_t vertices);
tc_status joined_edges_add(joined_edges *j, const uint32_t *names, uint32_t a, uint32_t b);

/* Copies the positions of a slab's vertices that are new, of which `done` have been copied before; how many it is then.
 */
uint64_t positions_append(const uint32_t *numbers, uint32_t count, const float *from, float *to, uint64_t done);

/* ------------------------------------------------------------------------------- slab by slab (complex_slabs.c) */

/* before, share: the parts of the whole call that are done before, and after the count, for progress. */
tc_status complex_slabs_count(tc_grid *grid, const tc_extract_options *options, double before, double share,
                              tc_counts *counts);
tc_status complex_slabs_extract(tc_grid *grid, const tc_extract_options *options, double before, tc_mesh *mesh);

#endif
