/* surface_check.h - --verify and --check of one surface */
#ifndef SURFACE_CHECK_H
#define SURFACE_CHECK_H

#include "engine.h"
#include "report.h"

/* Compares the engine's mesh with that of the reference; the verdict goes to s. Returns 0 or a status. */
int surface_verify(engine *reference, const tc_extract_options *how, const tc_mesh_data *m, surface_report *s);

/* Checks the mesh itself; *good: whether it is what its input lets it be. Returns 0 or a status. */
int surface_check(const block_list *blocks, const tc_mesh_data *m, surface_report *s, int *good);

#endif
