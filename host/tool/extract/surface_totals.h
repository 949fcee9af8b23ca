/* surface_totals.h - the figures of a surface: counts, times, bounds and hash, of one mesh or the sums of several */
#ifndef SURFACE_TOTALS_H
#define SURFACE_TOTALS_H

#include "result_mesh.h"
#include "precision.h"

/* Adds the figures of a mesh, as it is written, to those of its surface. What only a report shows is left out where no
 * report is printed. */
void surface_totals_add(const options *o, const surface_source *made, const result_mesh *mesh, surface_report *s);

#endif
