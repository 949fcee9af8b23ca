/*
 * complex_tile.cl - tiles of clusters in kernel 1, and of active tetrahedra in the numbering (tiles.cl)
 *
 * In kernel 1 the sum of `vertices` is that of active items.
 */
#ifndef COMPLEX_TILE_CL
#define COMPLEX_TILE_CL

#include "complex_cluster.cl"
#include "../base/tiles.cl"

typedef struct tile_tools {
    const complex_job *c;
    tile_scan scan;
} tile_tools;

/* Where a work-item has a tile to itself, it prefetches in two stages: an item's table entries FETCH_AHEAD items
 * before, what these entries name FETCH_AHEAD / 2 items before. */
enum { FETCH_AHEAD = 16 };

#endif
