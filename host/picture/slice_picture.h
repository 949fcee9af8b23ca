/*
 * slice_picture.h - three slices through the middle of a volume, as one picture, with isolines
 *
 * From above (x right, y up) at the top left; below it from the front (x right, z up), and beside that from the right
 * (y right, z up), all at one scale, so that positions line up. Samples are grey, with linear interpolation between
 * them; where one of the four around a point is missing, the picture is pale yellow.
 */
#ifndef SLICE_PICTURE_H
#define SLICE_PICTURE_H

#include "picture.h"
#include "tetracubes.h"

/* A structured volume; x, y and z are those of the picture, whatever they are called in memory. */
typedef struct sliced_volume {
    tc_type type;
    const void *samples;
    const uint8_t *blanked; /* one per sample, nonzero: missing; NULL: none */
    int has_nodata;         /* samples equal to nodata are missing; those that are not finite are so in any case */
    double nodata;

    int64_t count[3], stride[3]; /* samples along each axis, and from one to the next in memory */
    int64_t first;               /* the sample that is first along all three */
    const double *positions[3];  /* of the samples along each axis, rising */
    double black, white;         /* values */
} sliced_volume;

/* Draws into a white picture; isolines have the colours of a short list in turn. Returns 0, or STATUS_FAILED without
 * memory. */
int slice_picture(const sliced_volume *v, const double *isovalues, size_t isovalue_count, picture *p);

#endif
