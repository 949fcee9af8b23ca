/*
 * blocks.h - a dataset's blocks as the library takes them
 *
 * Structured blocks are grids as they are; unstructured ones are cut into tetrahedra first, once for all engines.
 */
#ifndef BLOCKS_H
#define BLOCKS_H

#include "command_line/options.h"
#include "field/select.h"

typedef struct prepared_block {
    const dataset_block *source;
    const scalar_block *scalar; /* NULL: coordinates only */
    int is_cut;
    int is_skipped;        /* structured and flat, while other blocks are not */
    tc_tetrahedra complex; /* of those that are cut */
} prepared_block;

typedef struct block_list {
    prepared_block *blocks;
    int count;
    uint64_t cell_count;        /* of three dimensions */
    uint64_t tetrahedron_count; /* that they are cut into */
} block_list;

/* Cuts the unstructured blocks, or all where all is nonzero. s may be NULL. What is left out or changed is told on
 * standard error. To be released in any case; d and s are borrowed. */
int blocks_cut(const options *o, const dataset *d, const scalar *s, int all, block_list *out);
void blocks_release(block_list *list);

/* Describes block n, structured and not cut; whole is room for what *grid points to. */
void block_describe(const block_list *list, int n, tc_grid_options *grid, tc_grid_options *whole);

/* A grid of block n, its positions relative to the origin (NULL: one of its own); *grid NULL where there is nothing to
 * contour. */
int block_grid(const options *o, const block_list *list, int n, tc_context *context, const double *origin,
               tc_grid **grid);

/* Whether samples or cells of a structured block are missing: blanked, or a value that stands for none; with
 * reads_samples also not finite, for which floating samples are read until one is found. */
int blocks_have_missing(const block_list *list, int reads_samples);

/* Whether a vertex may rightly have several fans of triangles: beside missing cells, and where cells meet in a point or
 * an edge only. */
int blocks_may_touch(const block_list *list);

#endif
