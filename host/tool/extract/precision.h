/*
 * precision.h - whether numbers are fine enough for the shapes that they describe
 *
 * Far from the point that coordinates count from, steps of floating-point numbers grow. Where a cell is only a few
 * steps thick, its part of the surface is a caricature, and nothing else shows it.
 */
#ifndef PRECISION_H
#define PRECISION_H

#include "final_surface.h"

/* An engine's last surface and what it was made of. */
typedef struct surface_source {
    engine *engine;
    const block_list *blocks;
    const tc_extract_options *how;
    const tc_mesh_data *mesh;
    const typed_isovalue *iso;
} surface_source;

enum { COARSE_STEPS_LEAST = 8 }; /* across a cell: with fewer the shape is lost */

typedef struct precision_verdict {
    uint64_t any;      /* vertices where it shows */
    uint64_t vertices; /* where cells are thinner than COARSE_STEPS_LEAST steps */
} precision_verdict;

/* A notice where float32 is coarse for the mesh itself; with `check` every cell is looked at, also where notices are
 * not wanted. Returns 0 or STATUS_FAILED. */
int precision_tell_mesh(const surface_source *s, int check, precision_verdict *verdict);

/* The same of numbers of so many binary digits, 24 or 53, that a file's coordinates are, which count from zero (NULL:
 * from each block's own origin); is_chosen: by --origin-at. STATUS_USAGE where coordinates are beyond float32 and the
 * file has no other. */
int precision_tell_file(const surface_source *s, const double *zero, int is_chosen, int digits, int check,
                        precision_verdict *verdict);

#endif
