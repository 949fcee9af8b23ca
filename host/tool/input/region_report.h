/* region_report.h - which region of a grid was taken, as JSON and as text */
#ifndef REGION_REPORT_H
#define REGION_REPORT_H

#include "dataset/dataset.h"

#include <jansson.h>

/* Adds roi, the ranges as --roi takes them, and step; null where the block is NULL or no part. */
void region_report_json(json_t *object, const dataset_block *b);

/* "10:60, 0:64, 0:32 of 64 x 64 x 32 samples, every 2, 2, 1", behind the label, on a line; nothing of what is no part.
 */
void region_report_text(const char *label, const dataset_block *b);

#endif
