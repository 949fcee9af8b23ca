/*
 * complex_count_groups.cl - clusters of a tile where the work-items of a group share it: each takes one at a time
 */
#ifndef COMPLEX_COUNT_GROUPS_CL
#define COMPLEX_COUNT_GROUPS_CL

#include "complex_count.cl"

/* Active tetrahedra and triangles of a tile, for the whole group; recount: nothing is stored. */
inline_always uint2 tile_count(tile_tools tools, uint tile_index, cluster_arrays a, bool recount, cluster_sums *sums) {
    uint2 running = 0;
    for (uint start = 0; start < tools.c->tile_clusters; start += WORK_ITEMS) {
        uint m = start + (uint)get_local_id(0), n = tile_index * tools.c->tile_clusters + m;
        bool mixed =
            m < tools.c->tile_clusters && n < tools.c->cluster_count && cluster_mixed(tools, n, a, recount, sums);
        cluster_add(tools, n, !mixed, a, recount, &running, sums);
    }
    return running;
}

#endif
