/*
 * slice_preview.h - the picture of info: slices through the middle of a structured block
 *
 * Of uniform blocks each axis of the picture is the grid's axis that runs closest to x, y or z, in the direction in
 * which that rises. Curvilinear blocks are drawn by their indices, as if they were boxes of cubes.
 */
#ifndef SLICE_PREVIEW_H
#define SLICE_PREVIEW_H

#include "command_line/options.h"
#include "field/select.h"
#include "input/statistics.h"

/* Before any work, and once more when the input was read (d is NULL before): STATUS_USAGE where the file cannot be a
 * picture or is an input, STATUS_FAILED where it cannot be written. */
int slice_preview_check(const options *o, const dataset *d);

/* Draws the structured block with the most points. Grey values are those of the statistics, but for the least and
 * greatest few. Returns 0 or a status with its text. */
int slice_preview_write(const options *o, const dataset *d, const scalar *field, const statistics *s);

#endif
