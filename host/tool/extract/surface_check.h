/* surface_check.h - --verify and --check of one surface */
#ifndef SURFACE_CHECK_H
#define SURFACE_CHECK_H

#include "engine.h"
#include "report.h"

/* Compares the mesh of these blocks with that of the reference; the verdict goes to s. Returns 0 or a status. */
int surface_verify(engine *reference, block_range blocks, const tc_extract_options *how, const tc_mesh_data *m,
                   surface_report *s);

/* Checks a mesh itself, and adds to s what it is like. Returns 0 or a status. */
int surface_check(const tc_mesh_data *m, surface_report *s);

/* Judges the sums over all meshes of the surface. *good: no fault is left that the input does not explain. Returns 0 or
 * a status. */
int surface_judge(const block_list *blocks, const surface_report *s, int is_closed, int *good);

#endif
