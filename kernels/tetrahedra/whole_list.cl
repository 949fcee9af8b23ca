/*
 * whole_list.cl - the list of active cells, with their corners
 */
#ifndef WHOLE_LIST_CL
#define WHOLE_LIST_CL

#include "complex_classify.cl"

/* The active cells of one cluster, in order. */
inline_always void cluster_cells_list(const complex_job *c, uint n, complex_arrays in,
                                      global const cluster_state *clusters, global const uint *tiles,
                                      global active_cell *out) {
    const cluster_state cluster = clusters[n];
    out += tile_before(tiles, n / c->tile_clusters, TILE_SUM_X) + cluster.active_before;
    for (ulong rest = cluster.patterns; rest; rest &= rest - 1, out++) {
        const uint cell = n * CLUSTER_CELLS + lowest_bit(rest), code = cell_code(c, cell, in);
        global const uchar *shape = shape_of(code, in);
        global const uint *words = cell_points_at(c, cell, in);
        for (uint m = 0; m < WHOLE_CORNERS; m++)
            out->points[m] = m < shape[SHAPE_CORNERS] ? words[shape[SHAPE_ORDER + m] * c->word_step] : 0;
        out->pattern = cell_pattern(c, words, shape, in.samples) | code << 16;
        out->triangle = cell;
        out->vertex = out->owned = 0;
    }
}

/* Prefetches the points of the cells of cluster n. */
inline_always void cells_prefetch(const complex_job *c, uint n, complex_arrays in,
                                  global const cluster_state *clusters) {
    for (ulong rest = clusters[n].patterns; rest; rest &= rest - 1)
        line_prefetch(cell_points_at(c, n * CLUSTER_CELLS + lowest_bit(rest), in));
}

/* Lists the active cells. */
kernel void whole_list(complex_job c, global const BITS *samples, global const uint *words, global const ulong *begins,
                       global const uchar *codes, global const uchar *shapes, global const cluster_state *clusters,
                       global const uint *active, global uint *state, global active_cell *out) {
    local uint shared[4];
    const uint count = state[HEAD_ACTIVE_CLUSTERS], at_once = 64;
    const complex_arrays in = {samples + c.sample_offset, words + c.tetrahedron_offset, begins + c.begin_offset,
                               codes + c.code_offset, shapes};
    uint first = 0;
    while (first < count) {
        first = at_once * ticket_take(&state[HEAD_TICKETS + KERNEL_LIST], shared);
        for (uint start = 0; start < at_once; start += WORK_ITEMS) {
            uint n = start + (uint)get_local_id(0);
            if (WORK_ITEMS == 1 && first + n + 2 < count) cells_prefetch(&c, active[first + n + 2], in, clusters);
            if (WORK_ITEMS == 1 && first + n + 4 < count) line_prefetch(clusters + active[first + n + 4]);
            if (n < at_once && first + n < count)
                cluster_cells_list(&c, active[first + n], in, clusters, state + HEAD_WORDS, out);
        }
    }
}

/* Clears the table of edges, and the tiles of the numbering. */
kernel void whole_clear(complex_job c, global uint *table, global uint *tiles) {
    words_fill(table, c.table_mask + 1, EDGE_NONE);
    words_fill(tiles, TILE_WORDS * c.active_tiles, 0);
}

#endif
