/*
 * label_emit.cl - kernel 2 of label maps: vertices and triangles of the bricks that emit something
 *
 * Groups take bricks by ticket; each team, of 32 work-items or one, a row of them at a time. One of the team makes the
 * words and numbers that the row's cubes need, then each work-item has cubes of its own. The number of a vertex is
 * where its row begins, what its type has before, and a population count.
 */
#ifndef LABEL_EMIT_CL
#define LABEL_EMIT_CL

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

/* The number of a row's first vertex of a type. */
inline_always uint label_number_of(const label_job *s, uint at, uint type, label_arrays in, global const uint *tiles) {
    if (at == NO_ROW) return 0;
    return s->vertex_base + tile_before(tiles, label_tile_of(s, at / BRICK_WORDS), TILE_VERTICES) +
           in.bases[at].vertices + in.offsets[(ulong)LABEL_OFFSETS * at + type];
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
    uint number = label_number_of(s, own, 0, in, tiles);
    for (uint n = 0; n < LABEL_ROW_TYPES; n++) {
        r->numbers[n] = number;
        number += (uint)popcount(r->words[n]);
    }
    r->next[1] = label_number_of(s, x1, 1, in, tiles), r->next[2] = label_number_of(s, x1, 2, in, tiles);
    for (uint n = 0; n < 3; n++) r->next[n ? 9 + n : 5] = label_number_of(s, x1, n ? 9 + n : 5, in, tiles);
    local ulong *w = r->words + LABEL_WORD_Y1;
    w[0] = e[EX_Y1], w[1] = e[EZ_Y1], w[2] = e[EXZ_Y1];
    w[3] = label_first_half(~even, e[EXZ_Y1], e[EX_Y1], e[EZ_Y1], e[EZ_XY1]);
    w[4] = label_second_half(~even, e[EXZ_Y1], e[EX_YZ1], e[EZ_Y1], e[EZ_XY1]);
    w[5] = e[EX_Z1], w[6] = e[EY_Z1], w[7] = e[EXY_Z1];
    w[8] = label_first_half(~even, e[EXY_Z1], e[EX_Z1], e[EY_Z1], e[EY_XZ1]);
    w[9] = label_second_half(~even, e[EXY_Z1], e[EX_YZ1], e[EY_Z1], e[EY_XZ1]);
    w[10] = e[EX_YZ1];
    for (uint n = 0; n < 5; n++) {
        r->numbers[LABEL_WORD_Y1 + n] = label_number_of(s, y1, LABEL_Y1_TYPE(n), in, tiles);
        r->next[LABEL_WORD_Y1 + n] = label_number_of(s, xy1, LABEL_Y1_TYPE(n), in, tiles);
        r->numbers[LABEL_WORD_Z1 + n] = label_number_of(s, z1, LABEL_Z1_TYPE(n), in, tiles);
        r->next[LABEL_WORD_Z1 + n] = label_number_of(s, xz1, LABEL_Z1_TYPE(n), in, tiles);
    }
#pragma unroll
    for (uint n = 0; n < 5; n++) r->cells[n] = label_cells_in(label_tetrahedra(even, e, n), cubes);
    r->numbers[LABEL_WORD_YZ1] = label_number_of(s, yz1, 0, in, tiles);
    r->next[LABEL_WORD_YZ1] = 0;
    r->triangles = own == NO_ROW ? 0
                                 : tile_before(tiles, label_tile_of(s, own / BRICK_WORDS), TILE_TRIANGLES) +
                                       in.bases[own].triangles;
    r->place = p;
}

/* --------------------------------------------------------------------------------------------------------- vertices */

inline_always void label_vertex_emit(const label_job *s, label_place p, uint x, uint type, uint number,
                                     global const uint *tables, label_mesh out) {
    const uint index = 64 * p.w + x, odd = (s->parity + index + p.y + p.z) & 1;
    global const uint *offset = tables + LABEL_PLACES + 3 * (odd * LABEL_ROW_TYPES + type);
    const float px = (float)(s->first[0] + (int)index) + as_float(offset[0]);
    const float py = (float)(s->first[1] + (int)p.y) + as_float(offset[1]);
    const float pz = (float)(s->first[2] + (int)p.z) + as_float(offset[2]);
    global float *to = out.positions + s->position_offset + 3ul * (number - s->vertex_base);
    for (uint row = 0; row < 3; row++) {
        const float m0 = s->matrix[4 * row], m1 = s->matrix[4 * row + 1], m2 = s->matrix[4 * row + 2];
        to[row] = ((m0 * px + m1 * py) + m2 * pz) + s->matrix[4 * row + 3];
    }
}

/* -------------------------------------------------------------------------------------------------------- triangles */

inline_always uint label_pick(uint4 labels, uint n) {
    return n == 0 ? labels.x : n == 1 ? labels.y : n == 2 ? labels.z : labels.w;
}

/* Bit n: the ends of edge n differ. */
inline_always uint label_pattern(uint4 l) {
    return (uint)(l.x != l.y) | (uint)(l.x != l.z) << 1 | (uint)(l.x != l.w) << 2 | (uint)(l.y != l.z) << 3 |
           (uint)(l.y != l.w) << 4 | (uint)(l.z != l.w) << 5;
}

/* The number of a vertex of the cube at x. */
inline_always uint label_vertex(local const label_row *r, uint x, uint vertex) {
    const uint word = vertex & 31, at = x + (vertex >> 5);
    if (at == 64) return r->next[word];
    return r->numbers[word] + (uint)popcount(r->words[word] & ((1ul << at) - 1));
}

/* The two triangles of an interface, or the one; returns how many. n: the first one's index. */
inline_always uint label_interface_emit(const label_job *s, local const label_row *r, uint x, uint interface, uint4 l,
                                        global const uint *map, uint n, label_mesh out) {
    const uint inner = label_pick(l, interface >> 16 & 3), outer = label_pick(l, interface >> 18 & 3);
    const uint count = interface >> 20;
    const bool turned = outer - 1 < inner - 1; /* the lower label comes first, and the background last */
    const uint v0 = label_vertex(r, x, map[interface & 15]);
    const uint v1 = label_vertex(r, x, map[interface >> 4 & 15]), v2 = label_vertex(r, x, map[interface >> 8 & 15]);
    const uint v3 = count > 1 ? label_vertex(r, x, map[interface >> 12 & 15]) : v2;
    /* a fan of v0, the others in this order or the reverse; mirrored: each triangle is turned over by itself */
    const uint a = turned ? v3 : v1, b = v2, c = turned ? v1 : v3;
    global uint *to = out.triangles + s->triangle_offset + 3ul * n, *sides = out.labels + s->label_offset + 2ul * n;
    const uint second = count > 1 ? b : turned ? v1 : v2;
    to[0] = v0, to[1] = s->mirrored ? second : a, to[2] = s->mirrored ? a : second;
    sides[0] = turned ? outer : inner, sides[1] = turned ? inner : outer;
    if (count > 1) {
        to[3] = v0, to[4] = s->mirrored ? c : b, to[5] = s->mirrored ? b : c;
        sides[2] = sides[0], sides[3] = sides[1];
    }
    return count;
}

/* Triangles of the cube at x; n: the first one's index. */
inline_always void label_cube_emit(const label_job *s, local const label_row *r, uint x, uint n,
                                   global const BITS *samples, global const uint *tables, label_mesh out) {
    const label_place p = r->place;
    const uint odd = (s->parity + 64 * p.w + x + p.y + p.z) & 1;
    global const BITS *first = samples + label_start(s, p.y, p.z, p.w) + x;
    for (uint t = 0; t < 5; t++) {
        global const uint *map = tables + LABEL_MAPS + (5 * odd + t) * LABEL_MAP_WORDS;
        const uint corners = map[LABEL_MAP_CORNERS];
        if (!(label_cells_any(r->cells[t]) >> x & 1)) continue;
        const ulong plane = (ulong)s->nx * s->ny;
#define LABEL_CORNER(n)                                                                                                \
    first[(corners >> 4 * (n)&1) + (corners >> (4 * (n) + 1) & 1) * s->nx + (corners >> (4 * (n) + 2) & 1) * plane]
        const uint4 l = (uint4)(LABEL_CORNER(0), LABEL_CORNER(1), LABEL_CORNER(2), LABEL_CORNER(3));
#undef LABEL_CORNER
        global const uint *interfaces = tables + LABEL_CASE_WORDS * label_pattern(l);
        const uint count = interfaces[0];
        for (uint m = 1; m <= count; m++) n += label_interface_emit(s, r, x, interfaces[m], l, map, n, out);
    }
}

/* Triangles of a row before those of the cube at x. */
inline_always uint label_triangles_before(local const label_row *r, uint x) {
    const ulong before = (1ul << x) - 1;
    uint sum = 0;
    for (uint t = 0; t < 5; t++) sum += label_cell_triangles(label_cells_in(r->cells[t], before));
    return sum;
}

/* ------------------------------------------------------------------------------------------------------------- rows */

inline_always ulong label_row_cubes(local const label_row *r) {
    ulong any = 0;
    for (uint t = 0; t < 5; t++) any |= label_cells_any(r->cells[t]);
    return any;
}

#if WORK_ITEMS == 1

inline_always void label_row_emit(const label_job *s, local const label_row *r, uint lane, global const BITS *samples,
                                  global const uint *tables, label_mesh out) {
    for (uint type = 0; type < LABEL_ROW_TYPES; type++) {
        uint number = r->numbers[type];
        for (ulong rest = r->words[type]; rest; rest &= rest - 1)
            label_vertex_emit(s, r->place, lowest_bit(rest), type, number++, tables, out);
    }
    for (ulong rest = label_row_cubes(r); rest; rest &= rest - 1) {
        const uint x = lowest_bit(rest);
        label_cube_emit(s, r, x, r->triangles + label_triangles_before(r, x), samples, tables, out);
    }
}

#else

inline_always void label_row_emit(const label_job *s, local const label_row *r, uint lane, global const BITS *samples,
                                  global const uint *tables, label_mesh out) {
    const ulong cubes = label_row_cubes(r);
    for (uint x = lane; x < 64; x += LABEL_TEAM) {
        for (uint type = 0; type < LABEL_ROW_TYPES; type++)
            if (r->words[type] >> x & 1)
                label_vertex_emit(s, r->place, x, type, label_vertex(r, x, LABEL_VERTEX(type, 0)), tables, out);
        if (cubes >> x & 1) label_cube_emit(s, r, x, r->triangles + label_triangles_before(r, x), samples, tables, out);
    }
}

#endif

kernel void label_emit(label_job s, global const BITS *samples, global ulong *words, global ushort *offsets,
                       global label_row_base *bases, global uint *rows, global const uint *active, global uint *state,
                       global const uint *tables, global float *positions, global uint *triangles,
                       global uint *labels) {
    local uint shared[4];
    local label_row made[LABEL_TEAMS];
    const label_arrays in = {words, offsets, bases, rows};
    const label_mesh out = {positions, triangles, labels};
    global const uint *tiles = state + LABEL_HEAD_WORDS;
    const uint count = state[LABEL_ACTIVE_BRICKS], team = (uint)get_local_id(0) / LABEL_TEAM;
    const uint lane = (uint)get_local_id(0) % LABEL_TEAM;
    uint number = 0;
    while (number < count) {
        number = ticket_take(&state[LABEL_EMIT_TICKET], shared);
        const uint brick = number < count ? active[number] : 0;
        for (uint first = 0; first < BRICK_WORDS; first += LABEL_TEAMS) {
            const uint row = first + team;
            const bool is_there = number < count && row < BRICK_WORDS && (rows[brick] >> row & 1);
            if (is_there && lane == 0) label_row_make(&s, label_place_of(&s, brick, row), in, tiles, &made[team]);
            group_barrier();
            if (is_there) label_row_emit(&s, &made[team], lane, samples, tables, out);
            group_barrier();
        }
    }
}

#endif
