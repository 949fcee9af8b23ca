/*
 * complex_interval_entry.cl - what kernel complex_interval_emit works on, and what the table has of a tetrahedron
 *
 * Numbers of vertices at points are found by point, those on crossed edges by slot.
 */
#ifndef COMPLEX_INTERVAL_ENTRY_CL
#define COMPLEX_INTERVAL_ENTRY_CL

#include "complex_interval_crossings.cl"

#ifdef REAL

/* What the kernel reads and writes. */
typedef struct volume_emit {
    const complex_job *c;
    const volume_job *v;
    global const uint *tetrahedra;
    global const uchar *cases;
    global const volume_cluster *clusters;
    global const uint *numbers;
    global const uint2 *edges;
    global const ushort *slots;
    global uint *entries; /* where a work-item is alone, it puts numbers of vertices in */
    global uint *state, *out;
} volume_emit;

/* The vertex at a point; of one that is no vertex, as tetrahedra have changed, any. */
inline_always uint point_number(uint point, const volume_emit *e) {
    return e->v->word_count ? min(e->numbers[point], e->v->point_last) : point;
}

/* Which pairs of a tetrahedron's points (01 02 03 12 13 23) have the larger number first. */
inline_always uint pairs_of(uint4 p) {
#if WORK_ITEMS == 1
    return mask8((uint8)(p.xxx, p.yy, p.z, 0, 0) > (uint8)(p.y, p.z, p.w, p.zw, p.w, 0, 0));
#else
    return (uint)(p.x > p.y) | (uint)(p.x > p.z) << 1 | (uint)(p.x > p.w) << 2 | (uint)(p.y > p.z) << 3 |
           (uint)(p.y > p.w) << 4 | (uint)(p.z > p.w) << 5;
#endif
}

/* What its case gives of a tetrahedron, of which a part lies within. */
inline_always global const uchar *entry_of(global const uint *points, uint pattern, global const uchar *cases) {
    const uint order = cases[VOLUME_ORDER_OF + pairs_of(vload4(0, points))];
    return cases + VOLUME_ENTRIES + VOLUME_ENTRY_BYTES * (VOLUME_CASES * order + cases[VOLUME_CASE_OF + pattern]);
}

/* Where a tile's tetrahedra begin. */
inline_always global uint *tile_out(uint tile_index, const volume_emit *e) {
    return e->out + 4ul * tile_before(scan_tiles(e->state, e->v, SCAN_VOLUME), tile_index, TILE_SUM_Y);
}

#endif

#endif
