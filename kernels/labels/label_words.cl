/*
 * label_words.cl - words of a label map: a bit for each of 64 samples along x, set where the ends of an edge differ
 *
 * Of a row of cubes there are 18 edges, in the order of cube_edges (host/lib/tables/tables.c): six that the row's
 * samples own, three of row y + 1, three of row z + 1, one of row y + 1, z + 1, and five that the next samples along x
 * own, which are words shifted by a bit. Edges that do not lie in the grid have no bits.
 */
#ifndef LABEL_WORDS_CL
#define LABEL_WORDS_CL

#include "label_job.h"
#include "../base/tiles.cl"

enum {
    EX,
    EY,
    EZ,
    EXY,
    EXZ,
    EYZ,
    EX_Y1,
    EZ_Y1,
    EXZ_Y1,
    EX_Z1,
    EY_Z1,
    EXY_Z1,
    EX_YZ1,
    EY_X1,
    EZ_X1,
    EYZ_X1,
    EZ_XY1,
    EY_XZ1
};
enum { LABEL_EDGES = 18 };

/* A row of 64 samples in the grid. */
typedef struct row_origin {
    uint y, z, w;
} row_origin;

/* Row n, 0 to 31, of a brick of the slab. */
inline_always row_origin row_origin_of(const label_job *s, uint brick, uint row) {
    row_origin p;
    p.w = brick % s->words_x;
    p.y = brick / s->words_x % s->bricks_y * BRICK_ROWS + row % BRICK_ROWS;
    p.z = s->z0 + brick / s->words_x / s->bricks_y * BRICK_PLANES + row / BRICK_ROWS;
    return p;
}

inline_always ulong label_start(const label_job *s, uint y, uint z, uint w) {
    return s->sample_offset + ((ulong)(z - s->sample_z) * s->ny + y) * s->nx + 64ul * w;
}

/* Bits of samples whose cube is even, in a row. */
inline_always ulong label_even(const label_job *s, uint y, uint z) {
    return (s->parity + y + z) & 1 ? 0xaaaaaaaaaaaaaaaaul : 0x5555555555555555ul;
}

inline_always ulong label_select(ulong even, ulong if_even, ulong if_odd) {
    return (if_even & even) | (if_odd & ~even);
}

/* Bits of the first `count` samples. */
inline_always ulong label_mask(uint count) { return count >= 64 ? ~0ul : (1ul << count) - 1; }

#if WORK_ITEMS == 1
#include "label_words_alone.cl"
#else
#include "label_words_groups.cl"
#endif

#endif
