/*
 * precision.h - whether float32, or the numbers in a file, are fine enough for the shape of the surface
 *
 * Steps between floating-point numbers grow with the distance from the point that coordinates count from. Where a cell
 * is only a few steps thick, the surface in it is distorted, and no other check finds that.
 */
#ifndef PRECISION_H
#define PRECISION_H

#include "engine.h"
#include "report.h"

/* An engine's last mesh and what it was made of. */
typedef struct surface_source {
    engine *engine;
    const block_list *blocks;
    block_range range; /* those that the mesh is of */
    const tc_extract_options *how;
    const tc_mesh_data *mesh;
} surface_source;

enum { COARSE_STEPS_LEAST = 8 }; /* across a cell: with fewer the shape is lost */

/* Adds the vertices where float32 is coarse for the mesh itself. With `check` every cell is looked at, also where
 * notices are not wanted. Returns 0 or STATUS_FAILED. */
int precision_count_mesh(const surface_source *s, int check, coarse_count *sum);

/* The same for the coordinates in a file, which count from `zero` and have so many binary digits: 24 or 53. Returns
 * STATUS_USAGE where coordinates are beyond float32 and the file has nothing larger. */
int precision_count_file(const surface_source *s, const double zero[3], int digits, int check, coarse_count *sum);

/* Notices of what was counted over all meshes of the surface. is_chosen: coordinates count from --origin-at. */
void precision_tell_mesh(const surface_report *s);
void precision_tell_file(const surface_report *s, int is_chosen);

#endif
