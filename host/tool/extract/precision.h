/*
 * precision.h - whether numbers are fine enough for the shapes that they describe
 *
 * Far from the point that coordinates count from, steps of floating-point numbers grow. Where a cell is only a few
 * steps thick, its part of the surface is a caricature, and nothing else shows it.
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

/* The same of numbers of so many binary digits, 24 or 53, that a file's coordinates are, which count from zero.
 * STATUS_USAGE where coordinates are beyond float32 and the file has no other. */
int precision_count_file(const surface_source *s, const double zero[3], int digits, int check, coarse_count *sum);

/* Notices of what was counted over all meshes of the surface; is_chosen: coordinates count from --origin-at. */
void precision_tell_mesh(const surface_report *s);
void precision_tell_file(const surface_report *s, int is_chosen);

#endif
