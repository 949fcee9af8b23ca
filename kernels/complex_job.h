/*
 * complex_job.h - what the host tells the kernels about a part of a tetrahedral complex: read by both compilers
 */
#ifndef COMPLEX_JOB_H
#define COMPLEX_JOB_H

#include "slab.h"

/* A cluster is 16 consecutive tetrahedra, whose patterns fill 64 bits. A range of samples is kept for each cluster. */
enum { CLUSTER_TETRAHEDRA = 16 };

/* What kernel 1 finds out about a cluster that the surface passes through. */
typedef struct cluster_state {
    slab_u64 patterns;      /* bit 4 n + m: point m of tetrahedron n is inside; 0 where n is not active */
    slab_u32 active_before; /* active tetrahedra before the cluster in its tile */
    slab_u32 triangles_before;
} cluster_state;

/* A tetrahedron that the surface passes through. It has three or four crossed edges, in the order of its edges.
 * Crossed edge n of active tetrahedron a has slot 4 a + n. */
typedef struct active_tetrahedron {
    slab_u32 points[4];
    slab_u32 pattern;  /* bit n: point n is inside */
    slab_u32 triangle; /* index of its first triangle */
    slab_u32 vertex;   /* index of the first vertex it owns, from its tile's first */
    slab_u32 owned;    /* bit n: it owns the vertex on edge n, as the first tetrahedron with that edge */
} active_tetrahedron;

/* The table of the 16 cases. For each: the number of crossed edges and of triangles; the two ends of each edge; the
 * triangles' corners, as slots of edges. Derived from the tables of host/lib/grid/tables.h. */
enum { CASE_EDGES, CASE_TRIANGLES, CASE_ENDS, CASE_CORNERS = CASE_ENDS + 8, CASE_BYTES = CASE_CORNERS + 6 };

/* The head of the state buffer, before the tiles of kernel 1. */
enum {
    HEAD_TICKETS, /* one for each kernel */
    HEAD_ACTIVE_CLUSTERS = HEAD_TICKETS + 5,
    HEAD_CROSSED, /* edges of active tetrahedra, counted once for each */
    HEAD_INVALID, /* not 0: a tetrahedron has a point number that is not below point_count */
    HEAD_FULL,    /* not 0: the table of edges is too small */
    HEAD_ACTIVE,  /* totals */
    HEAD_TRIANGLES,
    HEAD_VERTICES,
    HEAD_WORDS
};

enum { KERNEL_CLASSIFY, KERNEL_LIST, KERNEL_JOIN, KERNEL_NUMBER, KERNEL_EMIT, COMPLEX_KERNELS };

#define EDGE_NONE 0xffffffffu

typedef struct complex_job {
    isovalue_test test;
    slab_u64 sample_offset;      /* of the first sample in its buffer, in samples */
    slab_u64 point_offset;       /* in floats */
    slab_u64 tetrahedron_offset; /* in words of 32 bits */
    slab_u32 point_count, tetrahedron_count, cluster_count, active_count;
    slab_u32 tile_clusters, tile_actives; /* per tile of kernel 1 and of the numbering */
    slab_u32 cluster_tiles, active_tiles;
    slab_u32 spin_limit;   /* of the scan */
    slab_u32 ranges_known; /* of clusters */
    slab_u32 table_mask;   /* entries of the table of edges, a power of two, less 1 */
    slab_u32 probe_limit;  /* entries looked at before the table counts as full */
} complex_job;

#ifndef __OPENCL_VERSION__
_Static_assert(sizeof(complex_job) == 9 * 8 + 16 * 4, "no padding, as for slab");
#endif

#endif
