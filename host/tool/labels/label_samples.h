/*
 * label_samples.h - the labels of an input: its samples, or whole numbers that are stored as others
 */
#ifndef LABEL_SAMPLES_H
#define LABEL_SAMPLES_H

#include "dataset/dataset.h"
#include "field/select.h"

/* Makes labels of floating-point samples that all are whole numbers (as software that scales all volumes writes them),
 * in the dataset's memory; those that are missing become 0. STATUS_INPUT, with path, where they are no labels. */
int label_samples_make(const char *path, dataset *d, scalar *field);

#endif
