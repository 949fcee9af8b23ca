/*
 * whole_cluster_groups.cl - clusters of cells where the work-items of a group take one each
 */
#ifndef WHOLE_CLUSTER_GROUPS_CL
#define WHOLE_CLUSTER_GROUPS_CL

#include "whole_cluster.cl"

inline_always bool cluster_valid(const complex_job *c, uint n, complex_arrays in) { return cells_valid(c, n, in); }

/* Checks the cluster's point numbers first. Where one is invalid, *invalid is set and the range is {0, 0}. */
inline_always brick_range cluster_range(const complex_job *c, uint n, complex_arrays in, uint *invalid) {
    brick_range range = {0, 0};
    if (cells_valid(c, n, in)) return cells_range(c, n, in);
    *invalid = 1;
    return range;
}

/* What the surface makes of a cluster, whose point numbers have to be valid. */
inline_always cluster_report cluster_count(const complex_job *c, uint n, complex_arrays in) {
    return cells_count(c, n, in);
}

#endif
