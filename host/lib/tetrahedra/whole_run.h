/*
 * whole_run.h - the device path over cells that are kept whole (method hybrid): what its files share
 *
 * The stages are those of tetrahedra (complex_run.h), with two of the host's between kernels: after the list of active
 * cells it compares these with their tetrahedra and gives each its case; after joining it gives other cases to cells
 * with a face that is cut.
 */
#ifndef WHOLE_RUN_H
#define WHOLE_RUN_H

#include "tetrahedra/complex_run.h"
#include "tetrahedra/whole_cases.h"

/* ---------------------------------------------------------------------------------------- cells (whole_list.c) */

/* The cells of a complex in the order of their tetrahedra. Where the device works in the host's memory and the
 * tetrahedra are in the order of the cells, all of them there, the list is the caller's; else it is gathered. */
struct whole_cells {
    uint32_t cell_count;
    bool is_gathered, has_prisms;
    const void *words; /* point numbers: of 64 bits the caller's, of 32 bits gathered */
    uint64_t word_bytes;
    uint32_t word_step, cell_points;
    const int64_t *begins; /* where cells begin in words; not looked at where cell_points is not 0 */
    const uint8_t *codes;  /* one for each cell; not looked at where one_code is not 0 */
    uint8_t one_code;
    uint8_t shapes[SHAPE_CODES][SHAPE_BYTES];
    uint32_t *own_words;
    uint8_t *own_codes;

    /* On the device, in one piece or of a slab: */
    complex_part part;
    device_buffer begins_buffer, codes_buffer, shapes_buffer;
    uint64_t begin_offset, code_offset;
    bool is_cut;         /* into slabs, from now on always */
    brick_range *ranges; /* of all clusters, where it is cut */
    bool ranges_known;
    edge_numbers edges; /* of the vertices of the last surface, where it is cut and fields are carried */
};

/* Makes the list where there is none yet. TC_ERROR_DATA where tetrahedra are not what their cells are cut into. */
tc_status whole_cells_provide(tc_grid *grid);

/* Gathers the cells after all: the caller's are not what they seemed to be. */
tc_status whole_cells_gather(tc_grid *grid);

void whole_cells_release(tc_grid *grid);

uint32_t whole_cluster_count(uint64_t cell_count);

/* --------------------------------------------------------------------------------------- cases (whole_assign.c) */

/* Gives active cells their case, in place of pattern and code. *edges: how many edges of their own they have. Cells
 * that are the caller's are compared with their tetrahedra: *differ where one does not fit. points: none, or the grid's
 * numbers of the points of a slab, which take the place of the slab's. */
tc_status whole_assign(tc_context *context, const tc_grid *grid, active_cell *cells, uint32_t count,
                       const uint32_t *points, uint64_t *edges, bool *differ);

/* Gives other cases to cells that have diagonals which are edges, as `owned` says. */
tc_status whole_assign_cut(tc_context *context, active_cell *cells, uint64_t count);

/* ------------------------------------------------------------------------------------- memory (whole_device.c) */

/* Arrays of the cells [first, first + count), for kernel 1: the list's own, or these words. */
tc_status whole_part_provide(tc_grid *grid, const void *words, uint32_t first, uint32_t count);
void whole_part_release(tc_grid *grid);

/* ------------------------------------------------------------------------------------ stages (whole_surface.c) */

tc_status whole_run_begin(complex_run *r, tc_grid *grid, const tc_extract_options *options);

/* Finds and lists the active cells of the part. */
tc_status whole_classify(complex_run *r);

/* Gives the active cells their cases. */
tc_status whole_choose(complex_run *r, bool *differ);

/* Numbers vertices and triangles; emits them. */
tc_status whole_number(complex_run *r);
tc_status whole_emit(complex_run *r, const device_buffer *positions, const device_buffer *triangles);

/* Active cells on the host, to be changed and given back; give NULL to give nothing back. */
tc_status active_cells_take(complex_run *r, active_cell **cells);
tc_status active_cells_give(complex_run *r, active_cell *cells);

/* ------------------------------------------------------------------------------- slab by slab (whole_slabs.c) */

tc_status whole_cut_into_slabs(tc_grid *grid);
tc_status whole_slabs_count(tc_grid *grid, const tc_extract_options *options, double before, double share,
                            tc_counts *counts);
tc_status whole_slabs_extract(tc_grid *grid, const tc_extract_options *options, double before, tc_mesh *mesh);

#endif
