/*
 * interval_job.h - what the host tells the kernels of interval volumes, beside the slab: read by both compilers
 *
 * The slab is a window: layers that are emitted, and one more, where their last cubes have vertices. Both bounds have
 * been classified over all of it.
 */
#ifndef INTERVAL_JOB_H
#define INTERVAL_JOB_H

#include "../base/slab.h"

/* Blocks of vertices. */
enum { INTERVAL_SAMPLES, INTERVAL_LOW_BOUND, INTERVAL_HIGH_BOUND, INTERVAL_BLOCKS };

/* Of a brick: after interval_count its own sums; then, by the host, those of the bricks before it in the slab. */
typedef struct interval_brick {
    slab_u32 tetrahedra, samples;
} interval_brick;

typedef struct interval_job {
    slab_u64 high_isovalue64; /* as in isovalue_test, which is that of the low bound */
    slab_f32 high_isovalue32;
    slab_u32 has_low, has_high;       /* without a bound all samples are on the inner side of it */
    slab_u32 own_bricks, all_bricks;  /* of the layers that are emitted, and of the window */
    slab_u32 brick_first, brick_last; /* those that a launch emits */
    slab_u32 first[INTERVAL_BLOCKS];  /* of each block the number of the slab's first vertex */
    slab_u32 window[INTERVAL_BLOCKS]; /* the number of the first vertex that lies in the buffer */
    slab_u32 offset[INTERVAL_BLOCKS]; /* floats from the start of the buffer to that vertex */
    slab_u32 tetrahedron_window;      /* the first tetrahedron that lies in the buffer, counted from the slab's first */
    slab_u32 tetrahedron_offset;      /* indices from the start of the buffer to it */
} interval_job;

/* A vertex of a tetrahedron that a cube has, as a byte: block, the row of samples that owns it (y + 2 z), its type of
 * edge, and whether the owner is at x + 1. Samples have type 0. */
#define INTERVAL_SLOT(block, row, type)         (((block)*4 + (row)) * 8 + (type))
#define INTERVAL_VERTEX(block, row, type, at_x) (2 * INTERVAL_SLOT(block, row, type) + (at_x))
enum { INTERVAL_SLOTS = INTERVAL_BLOCKS * 4 * 8 };

/* The table of cases. First, for each of 2 parities x 5 tetrahedra, 256 bytes: by pattern of the cube's corners, the
 * sum of 3^m over the corners m of the tetrahedron that are in the pattern. A case is the byte of the pattern "not
 * below" plus that of "above": a number to the base 3 whose digits are 0 below, 1 within, 2 above. Then, for
 * each of the ten, 81 entries: the number of tetrahedra, the number of vertices, up to eight vertices
 * (INTERVAL_VERTEX), and for each tetrahedron four indices into these. */
enum {
    INTERVAL_TETRAHEDRA = 10,
    INTERVAL_CASE_COUNT = 81,
    INTERVAL_ENTRY_VERTICES = 2,
    INTERVAL_VERTICES_MOST = 8,
    INTERVAL_ENTRY_CORNERS = INTERVAL_ENTRY_VERTICES + INTERVAL_VERTICES_MOST,
    INTERVAL_ENTRY_BYTES = INTERVAL_ENTRY_CORNERS + 6 * 4 + 2,
    INTERVAL_DIGIT_BYTES = INTERVAL_TETRAHEDRA * 256,
    INTERVAL_TABLE_BYTES = INTERVAL_DIGIT_BYTES + INTERVAL_TETRAHEDRA * INTERVAL_CASE_COUNT * INTERVAL_ENTRY_BYTES,
    INTERVAL_WITHIN = 40 /* the case of a tetrahedron that lies wholly within */
};

/* The table of counts: entry 5 n + m says how many tetrahedra come of one with n corners not below and m above. */
enum { INTERVAL_COUNTS = 25 };

#ifndef __OPENCL_VERSION__
_Static_assert(sizeof(interval_job) == 8 + 18 * 4, "no padding: see slab.h");
#endif

#endif
