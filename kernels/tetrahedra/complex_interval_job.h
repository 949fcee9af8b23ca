/*
 * complex_interval_job.h - what host and kernels share of an interval volume of a complex: read by both compilers
 *
 * The surfaces of both bounds have been classified and their vertices numbered by the kernels of complexes.
 */
#ifndef COMPLEX_INTERVAL_JOB_H
#define COMPLEX_INTERVAL_JOB_H

#include "complex_job.h"

/* Of a cluster: bit 4 n + m of `low` says that point m of tetrahedron n is not below, of `high` that it is above; of
 * tetrahedra with a missing sample all are 0. */
typedef struct volume_cluster {
    slab_u64 low, high;
    slab_u32 tetrahedra; /* of the volume, before it in its tile */
    slab_u32 reserved;
} volume_cluster;

/* Of 64 points that follow each other: which are vertices. */
typedef struct volume_points {
    slab_u64 within;
    slab_u32 before; /* vertices before them in their tile */
    slab_u32 reserved;
} volume_points;

/* The state buffer: its head, then the tiles of the scan. */
enum {
    VOLUME_TICKET_COUNT,
    VOLUME_TICKET_EMIT,
    VOLUME_SAMPLES, /* totals */
    VOLUME_TETRAHEDRA,
    VOLUME_HEAD_WORDS
};

/* Vertices of a case, as bytes: one of the tetrahedron's points; a slot of its crossed edges of the low bound, or of
 * the high bound. */
enum { VOLUME_POINT, VOLUME_LOW_SLOT = 4, VOLUME_HIGH_SLOT = 8 };

/* The table of cases. For each of 256 patterns, 16 times that of the points not below plus that of the points above:
 * how many tetrahedra there are, and the number of its case. For each of 64 sets of pairs of points of which the first
 * has the larger number (01 02 03 12 13 23, bit 0 first) the number of their order. Then an entry for each order and
 * case: how many tetrahedra, and their corners. */
enum {
    VOLUME_PATTERNS = 256,
    VOLUME_CASES = 81,
    VOLUME_ORDERS = 24,
    VOLUME_CASE_OF = VOLUME_PATTERNS,
    VOLUME_ORDER_OF = VOLUME_CASE_OF + VOLUME_PATTERNS,
    VOLUME_ENTRIES = VOLUME_ORDER_OF + 64,
    VOLUME_ENTRY_BYTES = 28,
    VOLUME_WITHIN = 0xf0, /* the pattern of a tetrahedron that lies within whole */
    VOLUME_TABLE_BYTES = VOLUME_ENTRIES + VOLUME_ORDERS * VOLUME_CASES * VOLUME_ENTRY_BYTES
};

typedef struct volume_job {
    slab_u32 has_low, has_high; /* without a bound all samples are on the inner side of it */
    slab_u32 word_count;        /* of points, 64 each; 0: vertices at points have the points' numbers */
    slab_u32 tile_shift;        /* a tile has 2^tile_shift clusters, and as many words of points */
    slab_u32 tile_count;
    slab_u32 low_first, high_first; /* numbers of the first vertices of both bounds */
    slab_u32 window;                /* number of the vertex that the buffer of positions starts with */
    slab_u32 point_last;            /* the greatest number of a vertex at a point */
    slab_u32 reserved;
} volume_job;

#ifndef __OPENCL_VERSION__
_Static_assert(sizeof(volume_job) == 10 * 4 && sizeof(volume_cluster) == 24 && sizeof(volume_points) == 16,
               "no padding, as for slab");
#endif

#endif
