/*
 * complex_count.cl - the first stage of kernel 1 of complexes: which items the surface passes through
 *
 * A first visit reads every item once and keeps the range of its cluster's samples; later visits read only the
 * clusters whose range holds the isovalue. The loops over the clusters of a tile are in complex_count_alone.cl and
 * complex_count_groups.cl.
 */
#ifndef COMPLEX_COUNT_CL
#define COMPLEX_COUNT_CL

#include "complex_tile.cl"

/* What kernel 1 works on. */
typedef struct cluster_arrays {
    complex_arrays in;
    global brick_range *ranges;
    global cluster_state *clusters;
    global uint *active, *head;
} cluster_arrays;

/* Active clusters that a work-item appends to the list at once: each append is an atomic that all work-items share. */
#define LIST_BATCH (WORK_ITEMS == 1 ? 64 : 1)

/* Of the clusters that a work-item has counted: sums, and the active clusters that are not in the list yet. */
typedef struct cluster_sums {
    uint crossed, active_count, active[LIST_BATCH];
} cluster_sums;

inline_always void clusters_append(cluster_arrays a, cluster_sums *sums) {
    uint first = atomic_add(&a.head[HEAD_ACTIVE_CLUSTERS], sums->active_count);
    for (uint n = 0; n < sums->active_count; n++) a.active[first + n] = sums->active[n];
    sums->active_count = 0;
}

inline_always void cluster_append(uint n, cluster_arrays a, cluster_sums *sums) {
    if (LIST_BATCH == 1) {
        a.active[atomic_inc(&a.head[HEAD_ACTIVE_CLUSTERS])] = n;
        return;
    }
    sums->active[sums->active_count++] = n;
    if (sums->active_count == LIST_BATCH) clusters_append(a, sums);
}

/* Whether the surface may pass through a cluster. The first visit stores the cluster's range. A recount during that
 * visit cannot use ranges, as another group may not have stored them yet: every valid cluster counts. */
inline_always bool cluster_mixed(tile_tools tools, uint n, cluster_arrays a, bool recount, cluster_sums *sums) {
    if (tools.c->ranges_known) return range_sign(&tools.c->test, a.ranges[n]) == SIGN_MIXED;
    if (recount) return cluster_valid(tools.c, n, a.in);
    uint invalid = 0;
    brick_range range = cluster_range(tools.c, n, a.in, &invalid);
    a.ranges[n] = range;
    if (invalid) atomic_or(&a.head[HEAD_INVALID], 1u);
    return !invalid && range_sign(&tools.c->test, range) == SIGN_MIXED;
}

/* Counts cluster n and adds it to the group's sums *running. none: this work-item has no cluster. */
inline_always void cluster_add(tile_tools tools, uint n, bool none, cluster_arrays a, bool recount, uint2 *running,
                               cluster_sums *sums) {
    cluster_report report = {0, 0, 0, 0};
    if (!none) report = cluster_count(tools.c, n, a.in);
    uint2 before = group_prefix((uint2)(report.active, report.triangles), running, tools.scan.sums);
    if (recount || none) return;
    cluster_state state = {report.patterns, before.x, before.y};
    a.clusters[n] = state;
    if (!report.active) return;
    cluster_append(n, a, sums);
    sums->crossed += report.edges;
}

#if WORK_ITEMS == 1
#include "complex_count_alone.cl"
#else
#include "complex_count_groups.cl"
#endif

#endif
