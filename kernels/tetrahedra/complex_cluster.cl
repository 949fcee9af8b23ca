/*
 * complex_cluster.cl - a cluster of tetrahedra or cells: its range of samples, and where the surface passes through it
 *
 * The loops over the points of tetrahedra are in complex_cluster_alone.cl and complex_cluster_groups.cl, of cells in
 * whole_cluster.cl.
 */
#ifndef COMPLEX_CLUSTER_CL
#define COMPLEX_CLUSTER_CL

#include "complex_job.h"
#include "../base/ranges.cl"
#include "../base/words.cl"

enum { CLUSTER_POINTS = 4 * CLUSTER_TETRAHEDRA };

#if WHOLE
#define CLUSTER_ITEMS CLUSTER_CELLS
typedef active_cell active_item;
#else
#define CLUSTER_ITEMS CLUSTER_TETRAHEDRA
typedef active_tetrahedron active_item;
#endif

/* The arrays of a complex, from their first item on. */
typedef struct complex_arrays {
    global const BITS *samples;
    global const uint *tetrahedra;
#if WHOLE
    global const ulong *begins;
    global const uchar *codes, *shapes;
#endif
} complex_arrays;

typedef struct cluster_report {
    ulong patterns;
    uint active, triangles, edges;
} cluster_report;

inline_always uint cluster_size(const complex_job *c, uint n) {
    return min(c->item_count - n * CLUSTER_ITEMS, (uint)CLUSTER_ITEMS);
}

/* The lowest bit of each nibble: whether any bit of the nibble is set. */
inline_always ulong nibbles_any(ulong x) { return (x | x >> 1 | x >> 2 | x >> 3) & 0x1111111111111111ul; }

/* Whether some bits of the nibble are set and others are not. */
inline_always ulong nibbles_mixed(ulong x) { return nibbles_any(x) & nibbles_any(~x); }

/* What the surface makes of a cluster. Each of its points has a bit in `inside` and one in `missing`. A tetrahedron
 * with one point or three inside has one triangle and three crossed edges; with two inside, two and four. */
inline_always cluster_report report_of(ulong inside, ulong missing) {
    inside &= ~(nibbles_any(missing) * 15);
    ulong odd = inside ^ inside >> 1, mixed = nibbles_mixed(inside);
    odd = (odd ^ odd >> 2) & mixed;
    uint one = (uint)popcount(odd), all = (uint)popcount(mixed);
    cluster_report report = {inside, all, 2 * all - one, 4 * all - one};
    return report;
}

#if WHOLE
#include "whole_cluster.cl"
#else
#if WORK_ITEMS == 1
#include "complex_cluster_alone.cl"
#else
#include "complex_cluster_groups.cl"
#endif
#endif

#endif
