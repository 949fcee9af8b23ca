/*
 * complex_interval_list.cl - kernel complex_interval_list: the list of crossed edges of both bounds
 *
 * It clears the table of edges, too, for the kernel that follows.
 */
#ifndef COMPLEX_INTERVAL_LIST_CL
#define COMPLEX_INTERVAL_LIST_CL

#include "complex_interval_count.cl"

/* What the kernel reads and writes. */
typedef struct volume_list {
    const complex_job *c;
    const volume_job *v;
    global const uint *tetrahedra;
    global const uchar *cases;
    global const volume_cluster *clusters;
    global uint2 *edges;
    global ushort *slots; /* where a work-item is alone */
    global uint *state;
} volume_list;

/* The first slot of a tile. */
inline_always uint tile_slots(uint tile_index, global uint *state, const volume_job *v) {
    return 4 * tile_before(scan_tiles(state, v, SCAN_CUTS), tile_index, TILE_SUM_X);
}

#if WORK_ITEMS == 1

/* A cache of the edges that a work-item has met lately: neighbours in the list share most edges. The upper bits of the
 * hash choose among RECENT_EDGES; one more is for edges that do not exist. */
enum { RECENT_BITS = 11, RECENT_EDGES = 1 << RECENT_BITS };

typedef struct list_work {
    ulong edges[RECENT_EDGES + 1];
    uint numbers[RECENT_EDGES + 1];
} list_work;

/* Numbers of a tile's first edge, of the next one, of the next slot. */
typedef struct list_state {
    uint first, next, slot;
} list_state;

/* Of 24 words: the 12 that `lanes` name, and four that mean nothing. */
inline_always uint16 words_chosen12(uint8 a, uint8 b, uint8 c, global const uchar *lanes) {
#ifdef WORD_SHUFFLES
    return words_shuffled((uint16)(a, b), (uint16)(c, c), vload16(0, lanes), true);
#else
    uint words[24], chosen[16];
    vstore8(a, 0, words), vstore8(b, 1, words), vstore8(c, 2, words);
    for (uint n = 0; n < 16; n++) chosen[n] = words[lanes[n]];
    return vload16(0, chosen);
#endif
}

/* The crossed edges of a cut as the list has them, and where the cache may have each. Where there is no fourth edge,
 * its two points are 0, which no edge has, and its index in the cache is RECENT_EDGES. */
inline_always uint16 cut_edges(uint4 p, uint pattern, bool is_high, global const uchar *cases) {
    const uint8 a = (uint8)(p.x, p.x, p.x, p.y, p.y, p.z, 0, 0), b = (uint8)(p.y, p.z, p.w, p.z, p.w, p.w, 0, 0);
    const uint8 low = min(a, b), high = max(a, b);
    uint8 hash = low * 0x9e3779b1u ^ high * 0x85ebca6bu;
    hash = (hash ^ hash >> 15) * 0x2c1b3c6du >> (32 - RECENT_BITS);
    hash.s7 = RECENT_EDGES;
    return words_chosen12(is_high ? high : low, is_high ? low : high, hash, cases + VOLUME_LANES + 16 * pattern);
}

/* Element n: the sum of the elements before it. */
inline_always uint4 sums_before(uint4 x) {
    const uint4 pairs = (uint4)(0, x.xyz) + (uint4)(0, 0, x.xy);
    return pairs + (uint4)(0, 0, 0, x.x);
}

/* The four slots of a cut. Without branches, as which edges are new is hard to predict. */
inline_always void cut_list(uint4 points, uint pattern, bool is_high, const volume_list *l, list_work *recent,
                            list_state *at) {
    global ulong *edges = (global ulong *)l->edges;
    const uint16 cut = cut_edges(points, pattern, is_high, l->cases);
    const ulong4 edge = as_ulong4(cut.lo);
    const uint4 entry = cut.s89ab;
    const uint x = entry.x, y = entry.y, z = entry.z, w = entry.w;
    const uint4 there = (uint4)(recent->numbers[x], recent->numbers[y], recent->numbers[z], recent->numbers[w]);
    const ulong4 other = (ulong4)(recent->edges[x], recent->edges[y], recent->edges[z], recent->edges[w]);
    const int4 known = ((there >= (uint4)at->first) & convert_int4(other == edge)) | (entry == (uint4)RECENT_EDGES);
    const uint4 is_new = as_uint4(known + 1), number = at->next + sums_before(is_new);
    const uint4 found = known ? there : number;
    recent->edges[x] = edge.x, recent->edges[y] = edge.y, recent->edges[z] = edge.z, recent->edges[w] = edge.w;
    recent->numbers[x] = found.x, recent->numbers[y] = found.y, recent->numbers[z] = found.z,
    recent->numbers[w] = found.w;
    edges[number.x] = edge.x, edges[number.y] = edge.y, edges[number.z] = edge.z, edges[number.w] = edge.w;
    vstore4(convert_ushort4(found - at->first), 0, l->slots + at->slot);
    at->next = number.w + is_new.w;
    at->slot += 4;
}

inline_always void cluster_list(uint n, const volume_list *l, list_work *recent, list_state *at) {
    const volume_cluster c = l->clusters[n];
    const ulong low = nibbles_mixed(c.low), high = nibbles_mixed(c.high);
    for (ulong rest = low | high; rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest);
        const uint4 points = vload4(bit / 4, l->tetrahedra + (ulong)CLUSTER_POINTS * n);
        if (low >> bit & 1) cut_list(points, (uint)(c.low >> bit) & 15, false, l, recent, at);
        if (high >> bit & 1) cut_list(points, (uint)(c.high >> bit) & 15, true, l, recent, at);
    }
}

/* Prefetches the tetrahedra of cluster n, if any is cut. */
inline_always void cuts_prefetch(uint n, const volume_list *l) {
    if (n >= l->c->cluster_count || !(nibbles_mixed(l->clusters[n].low) | nibbles_mixed(l->clusters[n].high))) return;
    for (uint m = 0; m < CLUSTER_POINTS; m += 16) line_prefetch(l->tetrahedra + (ulong)CLUSTER_POINTS * n + m);
}

inline_always void tile_list(uint tile_index, const volume_list *l, list_work *recent) {
    const uint items = 1u << l->v->tile_shift, end = min((tile_index + 1) * items, l->c->cluster_count);
    const uint first = tile_slots(tile_index, l->state, l->v);
    list_state at = {first, first, first};
    recent->numbers[RECENT_EDGES] = first;
    for (uint n = tile_index * items; n < end; n++) {
        cuts_prefetch(n + 4, l);
        cluster_list(n, l, recent, &at);
    }
    scan_tiles(l->state, l->v, SCAN_CROSSINGS)[TILE_WORDS * tile_index + TILE_EDGES] = at.next - first;
}

#else

typedef uint list_work;

/* Edge `number` of a tetrahedron, as the list has it. */
inline_always uint2 cut_edge(global const uint *points, uint number, bool is_high) {
    const uint a = points[0x211000 >> 4 * number & 3], b = points[0x332321 >> 4 * number & 3];
    const uint low = min(a, b), high = max(a, b);
    return is_high ? (uint2)(high, low) : (uint2)(low, high);
}

/* Tetrahedron m of cluster n. */
inline_always void own_list(uint n, uint m, uint first, const volume_list *l) {
    const volume_cluster c = l->clusters[n];
    const ulong low = nibbles_mixed(c.low), high = nibbles_mixed(c.high), before = (1ul << 4 * m) - 1;
    uint slot = first + 4 * (c.cuts + (uint)popcount(low & before) + (uint)popcount(high & before));
    global const uint *points = l->tetrahedra + (ulong)CLUSTER_POINTS * n + 4 * m;
    for (uint bound = 0; bound < 2; bound++) {
        if (!((bound ? high : low) >> 4 * m & 1)) continue;
        global const uchar *numbers = l->cases + VOLUME_EDGES_OF + 4 * ((bound ? c.high : c.low) >> 4 * m & 15);
        for (uint e = 0; e < 4; e++)
            l->edges[slot++] = numbers[e] == VOLUME_NO_EDGE ? (uint2)(0, 0) : cut_edge(points, numbers[e], bound == 1);
    }
}

inline_always void tile_list(uint tile_index, const volume_list *l, list_work *unused) {
    const uint items = 1u << l->v->tile_shift, first = tile_slots(tile_index, l->state, l->v);
    for (uint m = (uint)get_local_id(0); m < CLUSTER_TETRAHEDRA * items; m += WORK_ITEMS) {
        const uint n = tile_index * items + m / CLUSTER_TETRAHEDRA;
        if (n < l->c->cluster_count) own_list(n, m % CLUSTER_TETRAHEDRA, first, l);
    }
    if (get_local_id(0) == 0)
        scan_tiles(l->state, l->v, SCAN_CROSSINGS)[TILE_WORDS * tile_index + TILE_EDGES] =
            tile_slots(tile_index + 1, l->state, l->v) - first;
}

#endif

/* Each group clears its part of the table. */
inline_always void table_clear(global uint *table, uint count) {
    const uint part = count / (uint)get_num_groups(0) + 1, first = min(part * (uint)get_group_id(0), count);
    const uint end = first + min(part, count - first);
    for (uint n = first + (uint)get_local_id(0); n < end; n += WORK_ITEMS) table[n] = EDGE_NONE;
}

kernel void complex_interval_list(complex_job low, volume_job v, global const uint *tetrahedra,
                                  global const uchar *cases, global const volume_cluster *clusters, global uint2 *edges,
                                  global ushort *slots, global uint *table, global uint *state) {
    local uint shared[4];
    const volume_list l = {&low, &v, tetrahedra + low.tetrahedron_offset, cases, clusters, edges, slots, state};
    list_work work;
    uint tile_index = 0;
#if WORK_ITEMS == 1
    for (uint n = 0; n <= RECENT_EDGES; n++) work.edges[n] = 0, work.numbers[n] = 0;
#endif
    table_clear(table, v.table_mask + 1);
    while (tile_index < v.tile_count) {
        tile_index = ticket_take(&state[VOLUME_TICKETS + KERNEL_VOLUME_LIST], shared);
        if (tile_index < v.tile_count) tile_list(tile_index, &l, &work);
    }
}

#endif
