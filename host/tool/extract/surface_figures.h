/* surface_figures.h - the figures of a surface: counts, times, bounds and hash, of one mesh or the sums of several */
#ifndef SURFACE_FIGURES_H
#define SURFACE_FIGURES_H

#include "final_surface.h"
#include "precision.h"

/* Adds the figures of a mesh, as it is written, to those of its surface. What only a report shows is left out where no
 * report is printed. */
void surface_add_mesh(const options *o, const surface_source *made, const final_surface *mesh, surface_report *s);

#endif
