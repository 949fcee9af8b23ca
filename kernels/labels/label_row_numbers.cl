/*
 * label_row_numbers.cl - a row of cubes as kernel 2 of label maps emits it: words and numbers that its cubes need
 *
 * The number of a vertex is where its row begins, what its type has before, and a population count.
 */
#ifndef LABEL_ROW_NUMBERS_CL
#define LABEL_ROW_NUMBERS_CL

#include "label_classify.cl"

#define LABEL_ROW_ITEMS    (WORK_ITEMS == 1 ? 1 : 32)
#define LABEL_ROWS_AT_ONCE (WORK_ITEMS / LABEL_ROW_ITEMS)

/* What is known of a row of cubes: label_job.h has the order of words. */
typedef struct label_row {
    ulong words[LABEL_ROW_WORDS];
    label_cells cells[5];
    uint numbers[LABEL_ROW_WORDS]; /* of the first vertex in the word */
    uint next[LABEL_WORD_YZ1];     /* of the vertex at 64, in the next brick */
    uint triangles;                /* index of the row's first */
    row_origin origin;
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

/* The tile of the row that is emitted. Rows are looked for there first, as most of its neighbours lie there too. */
typedef struct label_near {
    uint first, end; /* bricks */
    uint vertices, triangles;
} label_near;

inline_always label_near label_near_of(const label_job *s, uint brick, global const uint *tiles) {
    const uint tile = label_tile_of(s, brick);
    label_near near = {label_tile_first(s, tile), label_tile_end(s, tile),
                       s->vertex_base + tile_before(tiles, tile, TILE_SUM_X), tile_before(tiles, tile, TILE_SUM_Y)};
    return near;
}

/* The number of a row's first vertex. */
inline_always uint label_first_of(const label_job *s, uint at, label_near near, label_arrays in,
                                  global const uint *tiles) {
    if (at == NO_ROW) return 0;
    const uint brick = at / BRICK_WORDS;
    if (brick >= near.first && brick < near.end) return near.vertices + in.bases[at].vertices;
    return label_near_of(s, brick, tiles).vertices + in.bases[at].vertices;
}

/* Those of its first vertices of all shared types. */
inline_always void label_numbers_load(const label_job *s, uint at, label_near near, label_arrays in,
                                      global const uint *tiles, local uint *numbers) {
    uint8 low = 0;
    uint4 high = 0;
    if (at != NO_ROW) {
        const uint first = label_first_of(s, at, near, in, tiles);
        global const ushort *offsets = in.offsets + (ulong)LABEL_OFFSETS * at;
        low = convert_uint8(vload8(0, offsets)) + first, high = convert_uint4(vload4(2, offsets)) + first;
    }
    vstore8(low, 0, numbers);
    vstore4(high, 2, numbers);
}

/* near: the tile of the row's brick. */
inline_always void label_row_make(const label_job *s, row_origin p, label_near near, label_arrays in,
                                  global const uint *tiles, local label_row *r) {
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
    label_numbers_load(s, own, near, in, tiles, r->numbers);
    uint number = r->numbers[LABEL_SHARED_TYPES - 1] + (uint)popcount(t[LABEL_SHARED_TYPES - 1]);
#pragma unroll
    for (uint n = LABEL_SHARED_TYPES; n < LABEL_ROW_TYPES; n++) {
        r->numbers[n] = number;
        number += (uint)popcount(t[n]);
    }
    label_numbers_load(s, y1, near, in, tiles, r->numbers + LABEL_WORD_Y1);
    label_numbers_load(s, z1, near, in, tiles, r->numbers + LABEL_WORD_Z1);
    label_numbers_load(s, x1, near, in, tiles, r->next);
    label_numbers_load(s, xy1, near, in, tiles, r->next + LABEL_WORD_Y1);
    label_numbers_load(s, xz1, near, in, tiles, r->next + LABEL_WORD_Z1);
    r->numbers[LABEL_WORD_YZ1] = label_first_of(s, yz1, near, in, tiles);
    local ulong *w = r->words + LABEL_WORD_Y1;
    w[0] = e[EX_Y1], w[2] = e[EZ_Y1], w[4] = e[EXZ_Y1];
    w[8] = label_first_half(~even, e[EXZ_Y1], e[EX_Y1], e[EZ_Y1], e[EZ_XY1]);
    w[9] = label_second_half(~even, e[EXZ_Y1], e[EX_YZ1], e[EZ_Y1], e[EZ_XY1]);
    w = r->words + LABEL_WORD_Z1;
    w[0] = e[EX_Z1], w[1] = e[EY_Z1], w[3] = e[EXY_Z1];
    w[6] = label_first_half(~even, e[EXY_Z1], e[EX_Z1], e[EY_Z1], e[EY_XZ1]);
    w[7] = label_second_half(~even, e[EXY_Z1], e[EX_YZ1], e[EY_Z1], e[EY_XZ1]);
    r->words[LABEL_WORD_YZ1] = e[EX_YZ1];
#pragma unroll
    for (uint n = 0; n < 5; n++) r->cells[n] = label_cells_in(label_tetrahedra(even, e, n), cubes);
    r->triangles = own == NO_ROW ? 0 : near.triangles + in.bases[own].triangles;
    r->origin = p;
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

inline_always label_line label_line_of(const label_job *s, row_origin p, uint type, uint odd,
                                       global const uint *tables) {
    global const uint *offset = tables + LABEL_POSITIONS + 3 * (odd * LABEL_ROW_TYPES + type);
    label_line l;
    l.x = as_float(offset[0]);
    l.matrix = label_column(s, 0);
    l.y = label_column(s, 1) * ((float)(s->first[1] + (int)p.y) + as_float(offset[1]));
    l.z = label_column(s, 2) * ((float)(s->first[2] + (int)p.z) + as_float(offset[2]));
    l.origin = label_column(s, 3);
    return l;
}

/* index: of the sample, along x. */
inline_always void label_vertex_emit(const label_job *s, label_line l, uint index, uint number, label_mesh out) {
    const float4 at = ((l.matrix * ((float)(s->first[0] + (int)index) + l.x) + l.y) + l.z) + l.origin;
    vstore3(at.xyz, number - s->vertex_base, out.positions + s->position_offset);
}

#endif
