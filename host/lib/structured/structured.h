/*
 * structured.h - the device path over structured grids: upload, classify, totals, allocate, emit
 */
#ifndef STRUCTURED_H
#define STRUCTURED_H

#include "grid/carry.h"
#include "grid/grid.h"
#include "opencl/kernel_kind.h"
#include "grid/mesh.h"

/* Plans slabs and tiles and, where the samples fit the device whole, makes them available to it. */
tc_status structured_grid_create(tc_grid *grid);
void structured_grid_destroy(tc_grid *grid);

/* Shapes tiles again where the context has changed to the other variant of the kernels. */
void structured_reshape(tc_grid *grid);

/* The kind of its kernels; emits: kernel 2 too. */
kernel_kind structured_kind(const tc_grid *grid, const tc_extract_options *options, bool emits);

/* As tc_count, tc_emit and tc_extract, with arguments already checked. share: of the whole call, for progress. */
tc_status structured_count(tc_grid *grid, const tc_extract_options *options, double share, tc_counts *counts);
tc_status structured_emit(tc_grid *grid, const tc_extract_options *options, const tc_device_mesh *mesh,
                          struct _cl_event **done);
tc_status structured_extract(tc_grid *grid, const tc_extract_options *options, tc_mesh *mesh);

/* The buffer of all samples, where it is on the device whole, else NULL; *offset: of the first one, in samples. */
struct _cl_mem *structured_samples(const tc_grid *grid, uint64_t *offset);

/* Results of kernel 1 are kept from now on. */
void structured_keep_results(tc_grid *grid);

/* True where the results of kernel 1 for this surface still exist, which structured_carry needs. */
bool structured_is_classified(const tc_grid *grid, const tc_extract_options *options);

/* Carries a field to the *vertex_count vertices; to none where the caller's room is for another number
 * (structured_carry.c). */
tc_status structured_carry(const tc_grid *grid, const tc_extract_options *options, const carry *c,
                           uint64_t *vertex_count);

#endif
