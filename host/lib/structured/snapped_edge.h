/*
 * snapped_edge.h - method snap: on which edge the vertex of a snapped sample lies, by the host
 */
#ifndef SNAPPED_EDGE_H
#define SNAPPED_EDGE_H

#include "grid/grid.h"
#include "kernels/snap/link.h"

/* What the samples of one surface have in common. */
typedef struct snapped_edges {
    const tc_grid *grid;
    double isovalue;
    float threshold;
    int64_t steps[LINK_EVEN]; /* to the samples of a link, in the sample array */
} snapped_edges;

snapped_edges snapped_edges_of(const tc_grid *grid, const tc_extract_options *options);

/* The samples at the ends of the edge, the lower number first: the edge with the nearest crossing, of those along which
 * the sample may move (nearest.cl). */
void snapped_edge_find(const snapped_edges *e, const int64_t p[3], int64_t *low, int64_t *high);

#endif
