/* describe.h - what info says about every block of a dataset: kind, sizes, cells by type, bounds, fields with ranges */
#ifndef DESCRIBE_H
#define DESCRIBE_H

#include "dataset.h"

#include <jansson.h>

/* An array with an object per block. */
json_t *describe_blocks_json(const dataset *d);

/* Lines on standard output. */
void describe_blocks_text(const dataset *d);

/* Significant digits that all numbers of the blocks need to read back exactly. */
int describe_digits(const dataset *d);

#endif
