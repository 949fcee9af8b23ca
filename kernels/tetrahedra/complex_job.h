/*
 * complex_job.h - what the host tells the kernels about a part of a tetrahedral complex, or of the cells that it was
 * cut from: read by both compilers
 *
 * The items of the kernels are tetrahedra, or where WHOLE is defined cells that are kept whole (method hybrid).
 */
#ifndef COMPLEX_JOB_H
#define COMPLEX_JOB_H

#include "../base/slab.h"

#ifndef WHOLE
#define WHOLE 0
#endif

/* A cluster is 16 consecutive tetrahedra, whose patterns fill 64 bits, or 8 cells. A range of samples is kept for each
 * cluster. */
enum { CLUSTER_TETRAHEDRA = 16, CLUSTER_CELLS = 8 };

/* What kernel 1 finds out about a cluster that the surface may pass through, by its range. */
typedef struct cluster_state {
    slab_u64 patterns; /* bit 4 n + m: point m of tetrahedron n is inside; 0 where one of its samples is missing. Of
                          cells bit n: cell n is active */
    slab_u32 active_before; /* active items before the cluster in its tile */
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

/* The same of a cell. Its candidates are its crossed edges, and the crossed diagonals of its quadrilaterals, which are
 * edges where another cell has them; in the order of their corners. Candidate n of active cell a has slot
 * (a << slot_shift) + n. */
enum { WHOLE_CORNERS = 12 };

typedef struct active_cell {
    slab_u32 points[WHOLE_CORNERS];
    /* bit n: corner n is inside; from bit 16 on the cell's code. From the host on: the number of the cell's case */
    slab_u32 pattern;
    /* the cell's index in the grid. From complex_number on: its first triangle, counted from its tile's first */
    slab_u32 triangle;
    slab_u32 vertex; /* as above */
    /* at first bit n: candidate n is a diagonal that another cell has as its edge; then as above */
    slab_u32 owned;
} active_cell;

/* The case of a cell begins at CASE_UNIT bytes times its number: how many candidates and triangles it has, a byte each;
 * pattern (2 bytes) and shape, for the host; from WHOLE_DIAGONALS on 4 bytes, the lowest first, of which bit n says
 * that candidate n is a diagonal; then a byte for each candidate, one end in the lower four bits, the other in the
 * upper ones; then three candidates for each triangle. Made by whole_cases.c. */
enum {
    WHOLE_CANDIDATES,
    WHOLE_TRIANGLES,
    WHOLE_PATTERN,
    WHOLE_DIAGONALS = 4,
    WHOLE_SHAPE = 8,
    WHOLE_ENDS,
    CASE_UNIT = 16
};

/* A row of the table of shapes: how many corners a cell with this code has, and where they are in its points. Code 0 is
 * that of a cell which is not there. */
enum { SHAPE_CORNERS, SHAPE_ORDER, SHAPE_BYTES = 16, SHAPE_CODES = 128, CODE_MIRRORED = 0x80 };

/* The table of the 16 cases. For each: the number of crossed edges and of triangles; the two ends of each edge; the
 * triangles' corners, as slots of edges. Derived from the tables of host/lib/tables/tables.h. */
enum { CASE_EDGES, CASE_TRIANGLES, CASE_ENDS, CASE_CORNERS = CASE_ENDS + 8, CASE_BYTES = CASE_CORNERS + 6 };

/* A face on the border of the complex, counter-clockwise seen from outside, by the indices of its points in the list of
 * the border's. A quadrilateral begins with its smallest point, which its diagonal goes through. Else the last point is
 * CAP_TRIANGLE; or CAP_HALF: the face is half a quadrilateral, and begins with the two points of its diagonal. */
typedef struct cap_face {
    slab_u32 points[4];
} cap_face;

#define CAP_TRIANGLE 0xffffffffu
#define CAP_HALF     0xfffffffeu

/* The head of the state buffer, before the tiles of kernel 1. */
enum {
    HEAD_TICKETS, /* one for each kernel */
    HEAD_ACTIVE_CLUSTERS = HEAD_TICKETS + 8,
    HEAD_CROSSED, /* crossed edges, counted in every tetrahedron that has them */
    HEAD_INVALID, /* not 0: a tetrahedron has a point number that is not below point_count */
    HEAD_FULL,    /* not 0: the table of edges is too small */
    HEAD_CUT,     /* cells with a diagonal that another cell has as its edge */
    HEAD_ACTIVE,  /* totals */
    HEAD_TRIANGLES,
    HEAD_VERTICES,
    HEAD_CAP_TRIANGLES, /* of the border, where the surface is closed */
    HEAD_CAP_VERTICES,
    HEAD_WORDS
};

enum { KERNEL_CLASSIFY, KERNEL_LIST, KERNEL_JOIN, KERNEL_NUMBER, KERNEL_EMIT, COMPLEX_KERNELS };
/* Of cells: KERNEL_CUT runs after joining, KERNEL_CLEAR before it. */
enum { KERNEL_CUT = COMPLEX_KERNELS, KERNEL_CLEAR, WHOLE_KERNELS };
/* Of closed surfaces: the last two. */
enum { KERNEL_CAPS_COUNT = WHOLE_KERNELS, KERNEL_CAPS_EMIT, ALL_COMPLEX_KERNELS };
/* Of interval volumes: all of theirs. */
enum {
    KERNEL_VOLUME_COUNT,
    KERNEL_VOLUME_LIST,
    KERNEL_VOLUME_JOIN,
    KERNEL_VOLUME_NUMBER,
    KERNEL_VOLUME_CROSSINGS,
    KERNEL_VOLUME_EMIT,
    VOLUME_KERNELS
};
/* Tickets have the numbers of kernels up to KERNEL_CUT; KERNEL_CLEAR takes none. */
enum { TICKET_CAPS_COUNT = KERNEL_CUT + 1, TICKET_CAPS_EMIT };

#define EDGE_NONE 0xffffffffu

typedef struct complex_job {
    isovalue_test test;
    slab_u64 sample_offset;      /* of the first sample in its buffer, in samples */
    slab_u64 point_offset;       /* in floats */
    slab_u64 tetrahedron_offset; /* in words of 32 bits; of cells that of their points */
    slab_u64 code_offset;        /* of the first cell's code */
    slab_u64 begin_offset;       /* of where the first cell begins, in its buffer */
    slab_u64 cap_point_offset;   /* of the border's points and faces, where the surface is closed */
    slab_u64 cap_face_offset;
    slab_u32 point_count, item_count, cluster_count, active_count;
    slab_u32 tile_clusters, tile_actives; /* per tile of kernel 1 and of the numbering */
    slab_u32 cluster_tiles, active_tiles;
    slab_u32 spin_limit;            /* of the scan */
    slab_u32 ranges_known;          /* of clusters */
    slab_u32 table_mask;            /* entries of the table of edges, a power of two, less 1 */
    slab_u32 probe_limit;           /* entries looked at before the table counts as full */
    slab_u32 word_step;             /* of cells: words from a point to the next, 2 where point numbers have 64 bits */
    slab_u32 cell_points;           /* from a cell to the next; 0: it is told where each begins */
    slab_u32 one_code;              /* of all cells; 0: each has its own */
    slab_u32 slot_shift;            /* 4; 5 where there are prisms */
    slab_u32 cap_points, cap_faces; /* how many */
    slab_u32 tile_caps, cap_tiles;  /* so many of each in a tile */
} complex_job;

#ifndef __OPENCL_VERSION__
_Static_assert(sizeof(complex_job) == 13 * 8 + 24 * 4, "no padding, as for slab");
#endif

#endif
