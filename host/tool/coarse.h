/*
 * coarse.h - whether numbers are fine enough for the triangles that they describe
 *
 * Far from the point that coordinates count from, steps of floating-point numbers grow. Where they are no small part of
 * a triangle's edge, its shape is lost, and nothing else shows it.
 */
#ifndef COARSE_H
#define COARSE_H

#include "options.h"
#include "tetracubes.h"

/* A notice where float32 does so to the mesh itself, which reaches so far from its origin: parts that lie far from each
 * other share one. */
void coarse_tell_mesh(const tc_mesh_data *mesh, const double bounds[2][3], const typed_isovalue *iso);

/* For --origin-at: a notice where the file's coordinates, relative to that point, do so; `digits` are the binary digits
 * of a number there, 24 or 53. STATUS_USAGE where they are beyond float32 and the file has no other. */
int coarse_check_file(const tc_mesh_data *mesh, const double origin_at[3], int digits);

#endif
