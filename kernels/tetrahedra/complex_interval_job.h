/*
 * complex_interval_job.h - what host and kernels share of an interval volume of a complex: read by both compilers
 *
 * A cut is a tetrahedron and a bound that passes through it. It has three or four crossed edges, in the order of the
 * tetrahedron's edges: crossed edge n of cut c has slot 4 c + n. Cuts go by tetrahedron, that of the low bound first.
 *
 * An edge in the list of edges is two points, one on either side of the bound: the lower first where the low bound
 * crosses it, the higher first where the high one does. Where a work-item has a tile to itself, the list has most edges
 * of the tile once, from the tile's first slot on, and slots name their edges: in 16 bits, so that a tile has no more
 * than VOLUME_TILE_MOST clusters. Else edge n is that of slot n, and those that do not exist are two zeros.
 */
#ifndef COMPLEX_INTERVAL_JOB_H
#define COMPLEX_INTERVAL_JOB_H

#include "complex_job.h"

/* Of a cluster: bit 4 n + m of `low` says that point m of tetrahedron n is not below, of `high` that it is above; of
 * tetrahedra with a missing sample all are 0. */
typedef struct volume_cluster {
    slab_u64 low, high;
    slab_u32 tetrahedra; /* of the volume, before it in its tile */
    slab_u32 cuts;       /* the same of cuts */
} volume_cluster;

/* Of 64 points that follow each other: which are vertices. */
typedef struct volume_points {
    slab_u64 within;
    slab_u32 before; /* vertices before them in their tile */
    slab_u32 reserved;
} volume_points;

/* The state buffer: its head, then the tiles of three scans, of the same tiles of clusters. */
enum {
    VOLUME_TICKETS,                                   /* one for each kernel */
    VOLUME_INVALID = VOLUME_TICKETS + VOLUME_KERNELS, /* not 0: a point number is not below point_count */
    VOLUME_FULL,                                      /* not 0: the table of edges is too small */
    VOLUME_SAMPLES,                                   /* totals */
    VOLUME_TETRAHEDRA,
    VOLUME_CUTS,
    VOLUME_FOURS, /* cuts with four crossed edges */
    VOLUME_LOW,   /* vertices on crossed edges */
    VOLUME_HIGH,
    VOLUME_HEAD_WORDS
};

/* What the scans sum up: vertices at points and tetrahedra of the volume; cuts and those with four edges; vertices on
 * crossed edges of either bound. Tiles of the last one have the number of edges in the list, too. */
enum { SCAN_VOLUME, SCAN_CUTS, SCAN_CROSSINGS, VOLUME_SCANS, TILE_EDGES = TILE_EXTRA };

enum { VOLUME_TILE_MOST = 65536 / (2 * 4 * CLUSTER_TETRAHEDRA) };

/* An edge in the list, and a slot: the index of its edge, counted from the tile's first one. */
enum { VOLUME_EDGE_BYTES = 8, VOLUME_SLOT_BYTES = 2 };

/* For each edge in the list: its entry in the table; then, with this bit, the first edge of the same points, which owns
 * the vertex. In the end that edge has the vertex's number instead of its first point, and a work-item
 * alone puts the number itself into the entry. */
#define EDGE_RESOLVED 0x80000000u

/* Vertices of a case, as bytes: one of the tetrahedron's points; a slot of its crossed edges of the low bound, or of
 * the high bound. */
enum { VOLUME_POINT, VOLUME_LOW_SLOT = 4, VOLUME_HIGH_SLOT = 8 };

/* The table of cases, in bytes. The pattern of a tetrahedron is 16 times that of the points not below, plus that of the
 * points above; the pattern of a bound has a bit for each point on its far side.
 *
 *     from 0                by the tetrahedron's pattern: how many tetrahedra it gives
 *     VOLUME_CASE_OF        by the same: its case, 0 to 80
 *     VOLUME_ORDER_OF       by which pairs of points (01 02 03 12 13 23, bit 0 first) have the larger number first:
 *                           which of the 24 orders of the points that is
 *     VOLUME_EDGES_OF       by a bound's pattern: its four crossed edges; VOLUME_NO_EDGE where there is no fourth
 *     VOLUME_LANES          by a bound's pattern: 16 lanes of cut_edges() (complex_interval_list.cl)
 *     VOLUME_ENTRIES        by order, then case: how many tetrahedra, then their corners */
enum {
    VOLUME_PATTERNS = 256,
    VOLUME_CASES = 81,
    VOLUME_ORDERS = 24,
    VOLUME_CASE_OF = VOLUME_PATTERNS,
    VOLUME_ORDER_OF = VOLUME_CASE_OF + VOLUME_PATTERNS,
    VOLUME_EDGES_OF = VOLUME_ORDER_OF + 64,
    VOLUME_LANES = VOLUME_EDGES_OF + 16 * 4,
    VOLUME_ENTRIES = VOLUME_LANES + 16 * 16,
    VOLUME_ENTRY_BYTES = 28,
    VOLUME_NO_EDGE = 7,
    VOLUME_WITHIN = 0xf0, /* the pattern of a tetrahedron that lies wholly within */
    VOLUME_TABLE_BYTES = VOLUME_ENTRIES + VOLUME_ORDERS * VOLUME_CASES * VOLUME_ENTRY_BYTES + 8 /* read, not used */
};

typedef struct volume_job {
    slab_u32 has_low, has_high; /* without a bound all samples are on the inner side of it */
    slab_u32 word_count;        /* of points, 64 each; 0: vertices at points have the points' numbers */
    slab_u32 tile_shift;        /* a tile has 2^tile_shift clusters, and as many words of points */
    slab_u32 tile_count;
    slab_u32 low_first, high_first; /* numbers of the first vertices of both bounds */
    slab_u32 window;                /* number of the vertex that the buffer of positions starts with */
    slab_u32 point_last;            /* the greatest number of a vertex at a point */
    slab_u32 table_mask;            /* entries of the table of edges, a power of two, less 1 */
    slab_u32 probe_limit;           /* entries looked at before the table counts as full */
    slab_u32 reserved;
} volume_job;

#ifndef __OPENCL_VERSION__
_Static_assert(sizeof(volume_job) == 12 * 4 && sizeof(volume_cluster) == 24 && sizeof(volume_points) == 16,
               "no padding, as for slab");
#endif

#endif
