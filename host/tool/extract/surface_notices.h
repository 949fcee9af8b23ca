/*
 * surface_notices.h - what is told of a surface that was made as asked and is of little use all the same
 *
 * Nothing here reads the samples of a surface that is as it should be.
 */
#ifndef SURFACE_NOTICES_H
#define SURFACE_NOTICES_H

#include "dataset.h"
#include "report.h"
#include "select.h"

/* An isovalue typed as a whole number that no double is: samples next to it may be on the wrong side. */
void surface_tell_isovalue(const typed_isovalue *iso);

/* An empty surface, with its reason: the range of the samples, where the isovalue is outside it. Returns 0 or
 * STATUS_FAILED. */
int surface_tell_empty(const dataset *d, const scalar *field, const surface_report *s);

/* More than a fifth of the triangles without area, why, and what to do; not where coordinates are coarse, which is told
 * already. s has its summary. Returns 0 or STATUS_FAILED. */
int surface_tell_degenerate(const dataset *d, const scalar *field, const surface_report *s);

#endif
