/*
 * mask.h - a volume that says which samples of the input are missing: those where it is 0, or has no value
 *
 * It has the blocks and sizes of the input, one value per sample, and any format that is read. A file of no known
 * format is taken as raw samples of one byte. Where it lies in space does not matter. Of a region of the input
 * (region.h) the same part of the mask is read.
 */
#ifndef MASK_H
#define MASK_H

#include "dataset/request.h"
#include "field/select.h"

/* Reads the request's mask, and adds what it leaves out to the blanked points of the field's samples. STATUS_USAGE
 * where it has other sizes, or not one value per sample; else fails as dataset_read does. A notice says how many
 * samples are left out. */
int mask_apply(const read_request *request, dataset *d, scalar *field);

#endif
