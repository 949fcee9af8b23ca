/*
 * coarse.h - whether numbers are fine enough for the shapes that they describe
 *
 * Far from the point that coordinates count from, steps of floating-point numbers grow. Where a cell is only a few
 * steps wide, its part of the surface is a caricature, and nothing else shows it.
 */
#ifndef COARSE_H
#define COARSE_H

#include "drop.h"

/* An engine's last surface and what it was made of. */
typedef struct coarse_surface {
    engine *engine;
    const block_list *blocks;
    const tc_extract_options *how;
    const tc_mesh_data *mesh;
    const typed_isovalue *iso;
} coarse_surface;

/* A notice where float32 is coarse for the mesh itself: parts of one block lie far from each other. With `check`,
 * *coarse_vertices receives how many vertices lie where a cell is fewer than COARSE_STEPS_LEAST steps wide along some
 * axis. Returns 0 or STATUS_FAILED. */
enum { COARSE_STEPS_LEAST = 8 };
int coarse_tell_mesh(const coarse_surface *s, int check, uint64_t *coarse_vertices);

/* A notice where numbers of so many binary digits, 24 or 53, are coarse for coordinates that count from this point in
 * the file. STATUS_USAGE where coordinates are beyond float32 and the file has no other. */
int coarse_check_file(const coarse_surface *s, const double zero[3], int digits);

#endif
