/*
 * complex_count_alone.cl - clusters of a tile where a work-item has it to itself: it prefetches for the next clusters
 */
#ifndef COMPLEX_COUNT_ALONE_CL
#define COMPLEX_COUNT_ALONE_CL

#include "complex_count.cl"

/* Bit n: range_sign() of ranges[n] is SIGN_MIXED, n from 0 to 15. */
inline_always uint ranges_mixed(const isovalue_test *test, global const brick_range *ranges) {
    uint16 first = vload16(0, (global const uint *)ranges), second = vload16(1, (global const uint *)ranges);
    uint16 low = (uint16)(first.even, second.even), high = (uint16)(first.odd, second.odd);
    int16 mixed = (low < test->key_inside) & (high >= test->key_outside);
#if FLOATING
    mixed |= (high >= KEY_INFINITY) | (low <= ~KEY_INFINITY);
#endif
    return mask_pack(convert_char16(mixed));
}

/* Bit m: cluster first + m is below `end`, and mixed by its known range. Prefetches the points of these clusters. */
inline_always ulong mixed_prefetch(tile_tools tools, uint first, uint end, cluster_arrays a) {
    ulong mixed = 0;
    if (first + 64 <= end)
        for (uint m = 0; m < 64; m += 16) mixed |= (ulong)ranges_mixed(&tools.c->test, a.ranges + first + m) << m;
    else
        for (uint m = 0; first + m < end; m++)
            mixed |= (ulong)(range_sign(&tools.c->test, a.ranges[first + m]) == SIGN_MIXED) << m;
    for (ulong rest = mixed; rest; rest &= rest - 1) points_prefetch(tools.c, first + lowest_bit(rest), a.in);
    return mixed;
}

/* Active items and triangles of a tile; recount: nothing is stored. */
inline_always uint2 tile_count(tile_tools tools, uint tile_index, cluster_arrays a, bool recount, cluster_sums *sums) {
    uint first = tile_index * tools.c->tile_clusters, end = min(first + tools.c->tile_clusters, tools.c->cluster_count);
    uint2 running = 0;
    if (!tools.c->ranges_known) {
        for (uint n = first; n < end; n++) {
            if (WHOLE && n + 8 < end) points_prefetch(tools.c, n + 8, a.in);
            if (cluster_mixed(tools, n, a, recount, sums)) cluster_add(tools, n, false, a, recount, &running, sums);
        }
        return running;
    }
    ulong next = mixed_prefetch(tools, first, end, a);
    for (uint start = first; start < end; start += 64) {
        ulong mixed = next;
        next = mixed_prefetch(tools, start + 64, end, a);
        for (; mixed; mixed &= mixed - 1) {
            if (mixed & (mixed - 1)) cluster_prefetch(tools.c, start + lowest_bit(mixed & (mixed - 1)), a.in);
            cluster_add(tools, start + lowest_bit(mixed), false, a, recount, &running, sums);
        }
    }
    return running;
}

#endif
