/* describe_blocks.h - what info says about every block of a dataset: kind, sizes, cells by type, bounds, fields with
 * ranges */
#ifndef DESCRIBE_BLOCKS_H
#define DESCRIBE_BLOCKS_H

#include "dataset/dataset.h"

#include <jansson.h>

/* An array with an object per block. */
json_t *describe_blocks_json(const dataset *d);

/* Lines on standard output. */
void describe_blocks_text(const dataset *d);

/* Of a uniform block: distance of neighbouring samples in world space, the length of a column of the matrix. */
double describe_spacing(const dataset_block *b, int axis);

/* Of a uniform block: spacing, world space and matrix, as lines. */
void describe_world_text(const dataset *d, const dataset_block *b);

/* Of an image with several values per sample: how many, what they are, the range of each, as lines. */
void describe_values_text(const dataset_block *b);

#endif
