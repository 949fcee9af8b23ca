/*
 * region.h - regions of structured grids: a box of samples, of which every step-th one is taken along each axis
 *
 * Indices count as those of the grid do, from dataset_block.first on; a range ends before its second index. Thinned by
 * steps of s, sample i has the index floor(i / s): regions that share a plane of samples give it the same one, and so
 * the same parity. Points stay where they are.
 *
 * Images are cut before their samples are read (source.h). Of other blocks coordinates and blanking are cut once they
 * are read, and a field when somebody wants it: region_field. Values of cells are averaged to points in a region that
 * is one cell wider on each side, region_around, so that the points of a region get what they have in the whole.
 */
#ifndef REGION_H
#define REGION_H

#include "dataset/layout.h"

/* Whether the request leaves out any samples, or wants to be compared with another dataset's sizes. */
int region_is_asked(const read_request *request);

/* Makes the image's block, which has its sizes and its matrix, the region that is asked for, and cuts the layout of its
 * samples. STATUS_USAGE where the part lies outside, or has fewer than two samples along an axis. */
int region_cut_image(const read_request *request, dataset *d, layout *l);

/* Makes every structured block the region that is asked for. Of several blocks those are dropped that have none; ranges
 * of indices go for all of them. Fails likewise. Numbers the blocks in any case. */
int region_cut_blocks(const read_request *request, dataset *d);

/* The field with its values in the block's region; *out = *f where it has these already. 0 or STATUS_FAILED. */
int region_field(dataset *d, const dataset_block *b, const dataset_field *f, dataset_field *out);

/* Likewise of a field of cells, in a region of the whole that is wider by a cell and is not thinned: that is *around,
 * of which only kind, sizes and blanking are filled. *inner: where the block's samples lie in it. */
int region_around(dataset *d, const dataset_block *b, const dataset_field *f, dataset_block *around, dataset_field *out,
                  sample_box *inner);

/* From values at the points of a block of such dims, so many each, to those at the points of the box; and from what is
 * blanked among its cells, or NULL, to the box's: each of its cells is blanked where one is that it consists of. */
int region_points(dataset *d, const int64_t dims[3], tc_type type, int components, const sample_box *box,
                  const void **values);
int region_blanked_cells(dataset *d, const int64_t dims[3], const sample_box *box, const uint8_t **cells);

/* The indices of the whole that a block is a region of, in the block's own index space: of all its samples that such
 * steps meet. */
void region_whole_extent(const dataset_block *b, int64_t first[3], int64_t dims[3]);

/* The range of a block's samples in the indices of the input, as --roi takes it. */
void region_range(const dataset_block *b, int axis, int64_t *begin, int64_t *end);

#endif
