/*
 * label_row.cl - a row of cubes as kernel 2 of label maps emits it: words and numbers that its cubes need
 *
 * The number of a vertex is where its row begins, what its type has before, and a population count.
 */
#ifndef LABEL_ROW_CL
#define LABEL_ROW_CL

#include "label_classify.cl"

#define LABEL_TEAM  (WORK_ITEMS == 1 ? 1 : 32)
#define LABEL_TEAMS (WORK_ITEMS / LABEL_TEAM)

/* What the team knows of its row: label_job.h has the order of words. */
typedef struct label_row {
    ulong words[LABEL_ROW_WORDS];
    label_cells cells[5];
    uint numbers[LABEL_ROW_WORDS]; /* of the first vertex in the word */
    uint next[LABEL_ROW_WORDS];    /* of the vertex at 64, in the next brick; of words that have such */
    uint triangles;                /* index of the row's first */
    label_place place;
} label_row;

typedef struct label_mesh {
    global float *positions;
    global uint *triangles, *labels;
} label_mesh;

/* A row's index in the arrays of kernel 1, or NO_ROW where it emits nothing, or is not there. */
#define NO_ROW 0xffffffffu

inline_always uint label_row_find(const label_job *s, uint y, uint z, uint w, global const uint *rows) {
    if (y >= s->ny || z >= s->z1 || w >= s->words_x) return NO_ROW;
    const uint brick = ((z - s->z0) / BRICK_PLANES * s->bricks_y + y / BRICK_ROWS) * s->words_x + w;
    const uint row = (z - s->z0) % BRICK_PLANES * BRICK_ROWS + y % BRICK_ROWS;
    return rows[brick] >> row & 1 ? BRICK_WORDS * brick + row : NO_ROW;
}

inline_always ulong label_word_of(uint at, uint type, label_arrays in) {
    return at == NO_ROW ? 0 : in.words[(ulong)LABEL_WORDS * at + type];
}

/* The number of a row's first vertex. */
inline_always uint label_first_of(const label_job *s, uint at, label_arrays in, global const uint *tiles) {
    if (at == NO_ROW) return 0;
    return s->vertex_base + tile_before(tiles, label_tile_of(s, at / BRICK_WORDS), TILE_VERTICES) +
           in.bases[at].vertices;
}

/* That of its first vertex of a type. */
inline_always uint label_number_of(uint first, uint at, uint type, label_arrays in) {
    return at == NO_ROW ? 0 : first + in.offsets[(ulong)LABEL_OFFSETS * at + type];
}

/* The types that cubes use of the rows y + 1 and z + 1. */
#define LABEL_Y1_TYPE(n) ((n) == 0 ? 0u : (n) == 1 ? 2u : (n) + 2 + ((n) > 2 ? 3u : 0u)) /* x z xz, xz's triangles */
#define LABEL_Z1_TYPE(n) ((n) == 0 ? 0u : (n) == 1 ? 1u : (n) + 1 + ((n) > 2 ? 2u : 0u)) /* x y xy, xy's triangles */

inline_always void label_row_make(const label_job *s, label_place p, label_arrays in, global const uint *tiles,
                                  local label_row *r) {
    const uint own = label_row_find(s, p.y, p.z, p.w, in.rows), y1 = label_row_find(s, p.y + 1, p.z, p.w, in.rows);
    const uint z1 = label_row_find(s, p.y, p.z + 1, p.w, in.rows),
               yz1 = label_row_find(s, p.y + 1, p.z + 1, p.w, in.rows);
    const uint x1 = label_row_find(s, p.y, p.z, p.w + 1, in.rows),
               xy1 = label_row_find(s, p.y + 1, p.z, p.w + 1, in.rows);
    const uint xz1 = label_row_find(s, p.y, p.z + 1, p.w + 1, in.rows);
    const ulong even = label_even(s, p.y, p.z), cubes = label_cubes(s, p);
    ulong e[LABEL_EDGES], t[LABEL_ROW_TYPES];
#pragma unroll
    for (uint n = 0; n < LABEL_WORDS; n++) e[n] = label_word_of(own, n, in);
    e[EX_Y1] = label_word_of(y1, 0, in), e[EZ_Y1] = label_word_of(y1, 2, in), e[EXZ_Y1] = label_word_of(y1, 4, in);
    e[EX_Z1] = label_word_of(z1, 0, in), e[EY_Z1] = label_word_of(z1, 1, in), e[EXY_Z1] = label_word_of(z1, 3, in);
    e[EX_YZ1] = label_word_of(yz1, 0, in);
    e[EY_X1] = e[EY] >> 1 | label_word_of(x1, 1, in) << 63;
    e[EZ_X1] = e[EZ] >> 1 | label_word_of(x1, 2, in) << 63;
    e[EYZ_X1] = e[EYZ] >> 1 | label_word_of(x1, 5, in) << 63;
    e[EZ_XY1] = e[EZ_Y1] >> 1 | label_word_of(xy1, 2, in) << 63;
    e[EY_XZ1] = e[EY_Z1] >> 1 | label_word_of(xz1, 1, in) << 63;
    label_types(even, e, t);
#pragma unroll
    for (uint n = 0; n < LABEL_ROW_TYPES; n++) r->words[n] = t[n]; /* a variable index would need a stack */
    uint number = label_first_of(s, own, in, tiles);
    for (uint n = 0; n < LABEL_ROW_TYPES; n++) {
        r->numbers[n] = number;
        number += (uint)popcount(r->words[n]);
    }
    const uint first_x1 = label_first_of(s, x1, in, tiles), first_xy1 = label_first_of(s, xy1, in, tiles);
    const uint first_xz1 = label_first_of(s, xz1, in, tiles), first_y1 = label_first_of(s, y1, in, tiles);
    const uint first_z1 = label_first_of(s, z1, in, tiles);
    r->next[1] = label_number_of(first_x1, x1, 1, in), r->next[2] = label_number_of(first_x1, x1, 2, in);
    for (uint n = 0; n < 3; n++) r->next[n ? 9 + n : 5] = label_number_of(first_x1, x1, n ? 9 + n : 5, in);
    local ulong *w = r->words + LABEL_WORD_Y1;
    w[0] = e[EX_Y1], w[1] = e[EZ_Y1], w[2] = e[EXZ_Y1];
    w[3] = label_first_half(~even, e[EXZ_Y1], e[EX_Y1], e[EZ_Y1], e[EZ_XY1]);
    w[4] = label_second_half(~even, e[EXZ_Y1], e[EX_YZ1], e[EZ_Y1], e[EZ_XY1]);
    w[5] = e[EX_Z1], w[6] = e[EY_Z1], w[7] = e[EXY_Z1];
    w[8] = label_first_half(~even, e[EXY_Z1], e[EX_Z1], e[EY_Z1], e[EY_XZ1]);
    w[9] = label_second_half(~even, e[EXY_Z1], e[EX_YZ1], e[EY_Z1], e[EY_XZ1]);
    w[10] = e[EX_YZ1];
    for (uint n = 0; n < 5; n++) {
        r->numbers[LABEL_WORD_Y1 + n] = label_number_of(first_y1, y1, LABEL_Y1_TYPE(n), in);
        r->next[LABEL_WORD_Y1 + n] = label_number_of(first_xy1, xy1, LABEL_Y1_TYPE(n), in);
        r->numbers[LABEL_WORD_Z1 + n] = label_number_of(first_z1, z1, LABEL_Z1_TYPE(n), in);
        r->next[LABEL_WORD_Z1 + n] = label_number_of(first_xz1, xz1, LABEL_Z1_TYPE(n), in);
    }
#pragma unroll
    for (uint n = 0; n < 5; n++) r->cells[n] = label_cells_in(label_tetrahedra(even, e, n), cubes);
    r->numbers[LABEL_WORD_YZ1] = label_first_of(s, yz1, in, tiles);
    r->next[LABEL_WORD_YZ1] = 0;
    r->triangles = own == NO_ROW ? 0
                                 : tile_before(tiles, label_tile_of(s, own / BRICK_WORDS), TILE_TRIANGLES) +
                                       in.bases[own].triangles;
    r->place = p;
}

/* --------------------------------------------------------------------------------------------------------- vertices */

/* Where vertices of a row lie that have one type, and one parity of their sample. */
typedef struct label_line {
    float4 matrix, y, z, origin; /* components of a position: what x is multiplied by, and what is added, in order */
    float x;                     /* of the vertex of the row's first sample */
} label_line;

inline_always float4 label_column(const label_job *s, uint column) {
    return (float4)(s->matrix[column], s->matrix[4 + column], s->matrix[8 + column], 0);
}

inline_always label_line label_line_of(const label_job *s, label_place p, uint type, uint odd,
                                       global const uint *tables) {
    global const uint *offset = tables + LABEL_PLACES + 3 * (odd * LABEL_ROW_TYPES + type);
    label_line l;
    l.x = as_float(offset[0]);
    l.matrix = label_column(s, 0);
    l.y = label_column(s, 1) * ((float)(s->first[1] + (int)p.y) + as_float(offset[1]));
    l.z = label_column(s, 2) * ((float)(s->first[2] + (int)p.z) + as_float(offset[2]));
    l.origin = label_column(s, 3);
    return l;
}

/* index: of the sample in the grid. */
inline_always void label_vertex_emit(const label_job *s, label_line l, uint index, uint number, label_mesh out) {
    const float4 at = ((l.matrix * ((float)(s->first[0] + (int)index) + l.x) + l.y) + l.z) + l.origin;
    vstore3(at.xyz, number - s->vertex_base, out.positions + s->position_offset);
}

#endif
