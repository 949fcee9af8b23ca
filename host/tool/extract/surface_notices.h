/*
 * surface_notices.h - notices of a surface that is of little use although it was made as asked
 *
 * Samples are read only where there is something to tell.
 */
#ifndef SURFACE_NOTICES_H
#define SURFACE_NOTICES_H

#include "dataset/dataset.h"
#include "field/select.h"
#include "input/blocks.h"
#include "report.h"

/* An isovalue that was typed as a whole number and is rounded as a double: samples next to it may be on the wrong side.
 */
void surface_tell_isovalue(const typed_isovalue *iso);

/* An empty surface, with its reason: the range of the samples, where the isovalue is outside it. Returns 0 or
 * STATUS_FAILED. */
int surface_tell_empty(const dataset *d, const scalar *field, const surface_report *s);

/* Where more than a fifth of the triangles have no area: why, and what to do. Not where coordinates are coarse, which
 * is told already. s has its summary. Returns 0 or STATUS_FAILED. */
int surface_tell_degenerate(const dataset *d, const scalar *field, const surface_report *s);

/* Of closed surfaces that are not checked: that they may be no manifolds beside missing cells; once for all. Of
 * streamed ones samples are not read once more, so those that are not finite are not looked for. */
void surface_tell_closed(const block_list *blocks, const surface_report *s, size_t count);

#endif
