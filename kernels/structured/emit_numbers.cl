/*
 * emit_numbers.cl - where a work-item has bricks to itself: a brick's crossed edges and the numbers of their vertices
 *
 * 1. The sign words of the brick and its neighbours' next rows and planes give all crossed edges and active cubes.
 * 2. Crossed edges are listed, row by row, and numbered in a table with an entry for every edge that a cube of the
 * brick has: those that the brick owns and, numbered from kernel 1's results, those that its neighbours own. The table
 * is never cleared: only crossed edges are looked up.
 *
 * A row has about one crossed edge of each type. For every row and type EDGES_USUAL items are stored in the list
 * without a branch, which would be hard to predict; where a row has fewer, the next items overwrite the surplus.
 */
#ifndef EMIT_NUMBERS_CL
#define EMIT_NUMBERS_CL

#include "border.cl"
#include "case_slots.h"
#include "mesh.cl"
#include "../snap/snapped.cl"
#include "tetrahedra.cl"

#define NUMBER_STEP     NUMBER_TYPES(VERTEX_TYPES)
#define AT_SAMPLE_TWICE (NUMBER_STEP == 8 && VERTEX_TYPES > AT_SAMPLE_TYPE)
#define LIST_EDGES      (BRICK_WORDS * 64 * (CLOSED ? 7 : VERTEX_TYPES)) /* or cubes, and their faces on the border */
#define LIST_MORE       16                                               /* items that may be stored past its end */
#define BATCH_EDGES     512
#define BATCH_CUBES     128
#define CASE_ITEMS      (3 * OF_METHOD(triangles_most)) /* indices that a cube has at the most */

/* Where the table of numbers has that of a vertex of a cube, from the cube's first sample on. */
#define NUMBER_AT(x, y, z, type)                                                                                       \
    (NUMBER_STEP * NUMBER_INDEX(x, y, z) + (type) -                                                                    \
     (AT_SAMPLE_TWICE && (x) && (type) == AT_SAMPLE_TYPE ? NUMBER_STEP - 1 : 0))

/* Sign words: rows[0][z] of the brick's eight rows in plane z, rows[1][z] of the rows of the next brick in y. The last
 * z is the plane behind the brick. */
typedef struct brick_signs {
    sample_rows rows[2][NUMBER_PLANES];
} brick_signs;

/* What a work-item needs of private memory for a brick. */
typedef struct brick_work {
    ulong crossed[BRICK_PLANES][VERTEX_TYPES][BRICK_ROWS];
    ulong active[BRICK_PLANES][BRICK_ROWS];
    ulong corners[NUMBER_PLANES][2 * (NUMBER_ROWS + 1)]; /* of each row its word and the shifted one */
    ulong zero_corners[ZEROS ? NUMBER_PLANES : 1][2 * (NUMBER_ROWS + 1)];
    uint number[NUMBER_PLANES * NUMBER_ROWS * NUMBER_COLUMNS * NUMBER_STEP + NUMBER_PADDING];
    uint list[LIST_EDGES + LIST_MORE]; /* edges as EDGE_CODE has them; cubes: see cubes_list */
#ifdef MASK_REGISTERS
    bytes64 patterns[BRICK_WORDS + 1]; /* of cubes, row by row */
    bytes64 zero_patterns[ZEROS ? BRICK_WORDS + 1 : 1];
#endif
    ushort slot_index[CASE_SLOTS]; /* where a slot's number is in that table, from the cube's first sample on */
    uint triangles[BATCH_CUBES * CASE_ITEMS + NUMBER_PADDING];
#ifdef REAL
    ulong row_start[8 * 16]; /* the index of a row's first sample, by bits 7 to 13 of EDGE_CODE */
    long step[64];           /* by its bits 14 to 19 */
    snapped_list snapped;
    uint link_codes[LINK_EVEN];
    BITS a[BATCH_EDGES], b[BATCH_EDGES];
    float positions[3 * BATCH_EDGES];
#endif
} brick_work;

inline_always void brick_work_begin(const slab *s, brick_work *work) {
#define SLOT(slot, x, y, z, type) work->slot_index[slot] = NUMBER_AT(x, y, z, type);
    if (NUMBER_STEP == 8) {
        SLOTS_OF_EIGHT(SLOT)
    } else {
        SLOTS_OF_FOUR(SLOT)
    }
#undef SLOT
#ifdef REAL
    for (uint n = 0; n < 64; n++) work->step[n] = edge_step(s, n << 14);
    for (uint n = 0; n < LINK_EVEN && ZEROS; n++) work->link_codes[n] = link_code(n);
#endif
}

/* ------------------------------------------------------------------------------------------------------------ signs */

/* The words of a brick that is this one or the next, along x, y and z (next_x, next_y, next_z: 0 or 1); outside the
 * grid all are 0. */
inline_always global const ulong *words_of_brick(const slab *s, grid_index origin, uint brick, uint next_x, uint next_y,
                                                 uint next_z, row_results k1) {
    bool exists = origin.x + 64 * next_x < s->nx && origin.y + BRICK_ROWS * next_y < s->ny &&
                  origin.z + BRICK_PLANES * next_z < s->nz;
    if (!exists) return brick_words(0, SIGN_OUTSIDE, k1.words);
    brick += (next_z * s->bricks_y + next_y) * s->words_x + next_x;
    return brick_words(brick, k1.bricks[brick].sign, k1.words);
}

inline_always sample_rows plane_load(const slab *s, uint z, ulong valid, global const ulong *at,
                                     global const ulong *next) {
    if (ZEROS)
        return rows_with_zeros(vload8(z, at) & valid, vload8(z, next), vload8(z, zeros_of(s, at)),
                               vload8(z, zeros_of(s, next)));
    return rows_shifted(vload8(z, at) & valid, vload8(z, next));
}

inline_always void signs_load(const slab *s, grid_index origin, uint brick, row_results k1, brick_signs *signs) {
    ulong valid = word_valid(s, origin.x / 64);
    for (uint next_y = 0; next_y < 2; next_y++) {
        global const ulong *at = words_of_brick(s, origin, brick, 0, next_y, 0, k1);
        global const ulong *next = words_of_brick(s, origin, brick, 1, next_y, 0, k1);
        for (uint z = 0; z < BRICK_PLANES; z++) signs->rows[next_y][z] = plane_load(s, z, valid, at, next);
        at = words_of_brick(s, origin, brick, 0, next_y, 1, k1),
        next = words_of_brick(s, origin, brick, 1, next_y, 1, k1);
        signs->rows[next_y][BRICK_PLANES] = plane_load(s, 0, valid, at, next);
    }
}

/* Rows 1 to 8 of plane z, where the brick has rows 0 to 7. */
inline_always sample_rows signs_next_y(const brick_signs *signs, uint z) {
    const sample_rows *here = &signs->rows[0][z], *next_y = &signs->rows[1][z];
    sample_rows r = {lanes_next_row(here->at, next_y->at.s0), lanes_next_row(here->next, next_y->next.s0), 0, 0};
    if (ZEROS) {
        r.zero_at = lanes_next_row(here->zero_at, next_y->zero_at.s0);
        r.zero_next = lanes_next_row(here->zero_next, next_y->zero_next.s0);
    }
    return r;
}

/* Stores the words from which cubes_list takes the patterns of cubes. */
inline_always void corners_store(const brick_signs *signs, brick_work *work) {
    for (uint z = 0; z < NUMBER_PLANES; z++) {
        ulong16 both;
        both.even = signs->rows[0][z].at, both.odd = signs->rows[0][z].next;
        vstore16(both, 0, work->corners[z]);
        work->corners[z][2 * BRICK_ROWS] = signs->rows[1][z].at.s0;
        work->corners[z][2 * BRICK_ROWS + 1] = signs->rows[1][z].next.s0;
        if (!ZEROS) continue;
        both.even = signs->rows[0][z].zero_at, both.odd = signs->rows[0][z].zero_next;
        vstore16(both, 0, work->zero_corners[z]);
        work->zero_corners[z][2 * BRICK_ROWS] = signs->rows[1][z].zero_at.s0;
        work->zero_corners[z][2 * BRICK_ROWS + 1] = signs->rows[1][z].zero_next.s0;
    }
}

/* Crossed edges and active cubes of the brick itself. at_border: whether samples of the brick, or of its
 * cubes, may be on the border. */
inline_always void crossed_store(const slab *s, grid_index origin, const brick_signs *signs, bool at_border,
                                 row_results k1, brick_work *work) {
    for (uint n = 0; n < BRICK_PLANES; n++) {
        cube_rows r = cube_rows_of(s, origin.y, origin.z + n, origin.x / 64, signs->rows[0][n], signs_next_y(signs, n),
                                   signs->rows[0][n + 1], signs_next_y(signs, n + 1));
        crossings edges = vertices_owned(s, &r, origin.y, origin.z + n, origin.x / 64, at_border, k1.cells);
        lanes active = cubes_active(&r);
#if MISSING
        active &= cells_rows(s, k1.cells, origin.y, origin.z + n, origin.x / 64);
#endif
        if (ZEROS) triangles_count(&r, &active); /* leaves those that emit */
        for (uint type = 0; type < VERTEX_TYPES; type++) vstore8(edges.type[type], 0, work->crossed[n][type]);
        vstore8(active, 0, work->active[n]);
    }
}

/* --------------------------------------------------------------------------------------------------- vertex numbers */

/* Whether the first cube of a row of the brick is odd. */
inline_always uint row_odd(const slab *s, uint y, uint z) { return (s->parity ^ y ^ z) & 1; }

/* Stores the number of a vertex of a row. With eight numbers for a sample, that of a vertex at a sample is stored
 * twice: also as the last number of the sample before it in x (case_slots.h). */
inline_always void number_store(uint *row, uint bit, uint type, uint number) {
    row[NUMBER_STEP * bit + type] = number;
    if (AT_SAMPLE_TWICE && type == AT_SAMPLE_TYPE) row[bit ? NUMBER_STEP * bit - 1 : AT_SAMPLE_TYPE] = number;
}

/* Numbers the vertices of a type in a row of another brick. Where there are none, column 64 gets a meaningless number.
 */
inline_always void neighbour_row_number(uint *number, uint type, ulong crossed, uint first) {
    do {
        number_store(number, lowest_bit(crossed), type, first++);
        crossed &= crossed - 1;
    } while (crossed);
}

/* Lists and numbers the samples of a row at which a vertex lies; row: the code of the first one, in
 * EDGE_CODE. Snapped samples on no border of the grid get their edges later. */
inline_always uint at_samples_list(const slab *s, grid_index origin, uint y, uint z, ulong at_samples, uint row,
                                   uint first, uint count, uint *number, grid_arrays in, brick_work *work) {
#ifdef REAL
    const ulong zeros = !ZEROS ? 0 : CLOSED ? work->zero_corners[z][2 * y] & at_samples : at_samples;
    const ulong inner = samples_inner(s, origin.y + y, origin.z + z, origin.x / 64);
#endif
    for (; at_samples; at_samples &= at_samples - 1, count++) {
        const uint bit = lowest_bit(at_samples);
        number_store(number, bit, AT_SAMPLE_TYPE, first + count);
#ifdef REAL
        work->list[count] = row + bit;
        if (CLOSED && !(zeros >> bit & 1))
            work->list[count] += EDGE_AT_SAMPLE;
        else if (inner >> bit & 1)
            snapped_enter(&work->snapped, (bit ^ row_odd(s, y, z)) & 1, count);
        else
            work->list[count] +=
                work->link_codes[snapped_to(s, origin.x + bit, origin.y + y, origin.z + z, in.samples)];
#endif
    }
    return count;
}

/* Edges of a row and type that are listed without a branch. */
#define EDGES_USUAL 2

inline_always void edge_list(const uint codes[2], uint bit, uint *number, uint first, uint count, brick_work *work) {
    work->list[count] = (bit & 1 ? codes[1] : codes[0]) + bit;
    number[NUMBER_STEP * bit] = first + count;
}

/* Lists and numbers the vertices that the brick owns; returns their count. */
inline_always uint edges_list(const slab *s, grid_index origin, uint mask, uint first, grid_arrays in,
                              brick_work *work) {
    uint count = 0;
#ifdef REAL
    work->snapped.count[0] = work->snapped.count[1] = 0;
#endif
    for (; mask; mask &= mask - 1) {
        uint brick_row = lowest_bit(mask), y = brick_row % BRICK_ROWS, z = brick_row / BRICK_ROWS;
        uint row = (y + EDGES_BEFORE) << 7 | (z + EDGES_BEFORE) << 11 | EDGES_BEFORE;
        uint odd = row_odd(s, y, z), *number = work->number + NUMBER_STEP * NUMBER_INDEX(0, y, z);
        ulong any = !ZEROS; /* most rows with snapped samples have no other vertices */
        loop_unrolled for (uint type = 0; type < AT_SAMPLE_TYPE && ZEROS; type++) any |= work->crossed[z][type][y];
        loop_unrolled for (uint type = 0; type < AT_SAMPLE_TYPE && any; type++) {
            const uint codes[2] = {row + edge_code(type, odd), row + edge_code(type, !odd)};
            ulong crossed = work->crossed[z][type][y];
            const uint end = count + (uint)popcount(crossed);
            loop_unrolled for (uint n = 0; n < EDGES_USUAL; n++, crossed &= crossed - 1)
                edge_list(codes, lowest_bit(crossed), number + type, first, count++, work);
            for (; crossed; crossed &= crossed - 1)
                edge_list(codes, lowest_bit(crossed), number + type, first, count++, work);
            count = end;
        }
        if (VERTEX_TYPES > AT_SAMPLE_TYPE)
            count = at_samples_list(s, origin, y, z, work->crossed[z][VERTEX_TYPES - 1][y], row, first, count, number,
                                    in, work);
    }
    return count;
}

/* Numbers the crossings in the next plane that the brick's cubes have. */
inline_always void plane_number(const slab *s, grid_index origin, const brick_signs *signs, bool at_border,
                                row_results k1, brick_work *work) {
    const uint z = origin.z + BRICK_PLANES, w = origin.x / 64;
    const sample_rows none = rows_shifted((lanes)0, (lanes)0);
    if (z >= s->nz) return;
    cube_rows r =
        cube_rows_of(s, origin.y, z, w, signs->rows[0][BRICK_PLANES], signs_next_y(signs, BRICK_PLANES), none, none);
    crossings edges = vertices_owned(s, &r, origin.y, z, w, at_border, k1.cells);
    ulong crossed[4][BRICK_ROWS];
    vstore8(edges.type[0], 0, crossed[0]), vstore8(edges.type[1], 0, crossed[1]), vstore8(edges.type[3], 0, crossed[2]);
    vstore8(edges.type[AT_SAMPLE_TYPE], 0, crossed[3]);
    const lanes any = edges.type[0] | edges.type[1] | edges.type[3] | edges.type[AT_SAMPLE_TYPE];
    for (uint rows = lanes_nonzero(any); rows; rows &= rows - 1) {
        uint y = lowest_bit(rows), *number = work->number + NUMBER_STEP * NUMBER_INDEX(0, y, BRICK_PLANES);
        row_numbers o = row_numbers_of(s, origin.y + y, z, w, k1);
        neighbour_row_number(number, 0, crossed[0][y], number_of(o, 0));
        neighbour_row_number(number, 1, crossed[1][y], number_of(o, 1));
        if (DIAGONALS) neighbour_row_number(number, 3, crossed[2][y], number_of(o, 3));
        if (VERTEX_TYPES > AT_SAMPLE_TYPE)
            neighbour_row_number(number, AT_SAMPLE_TYPE, crossed[3][y], number_of(o, AT_SAMPLE_TYPE));
    }
}

/* Numbers the crossings in the next row of each plane. */
inline_always void next_rows_number(const slab *s, grid_index origin, const brick_signs *signs, bool at_border,
                                    row_results k1, brick_work *work) {
    const uint y = origin.y + BRICK_ROWS, w = origin.x / 64;
    const ulong valid = word_valid(s, w), has_x = w + 1 < s->words_x ? valid : valid >> 1;
    if (y >= s->ny) return;
    for (uint n = 0; n < NUMBER_PLANES && origin.z + n < s->nz; n++) {
        const bool last = n == BRICK_PLANES;
        const ulong even = even_cubes(s, y, origin.z + n), has_z = last || origin.z + n + 1 >= s->nz ? 0 : ~0ul;
        const sample_rows *here = &signs->rows[1][n], *at_z = last ? here : here + 1;
        const ulong a0 = here->at.s0, a1 = here->next.s0, c0 = at_z->at.s0, c1 = at_z->next.s0;
        const ulong zero = ZEROS ? here->zero_at.s0 : 0, zero_x = ZEROS ? here->zero_next.s0 : 0;
        const ulong zero_z = ZEROS ? at_z->zero_at.s0 : 0, zero_xz = ZEROS ? at_z->zero_next.s0 : 0;
        ulong x = (a0 ^ a1) & ~(zero | zero_x) & has_x, z = (a0 ^ c0) & ~(zero | zero_z) & has_z;
        ulong xz = (even & (a0 ^ c1) & ~(zero | zero_xz)) | (~even & (a1 ^ c0) & ~(zero_x | zero_z));
        xz = DIAGONALS ? xz & has_x & has_z : 0;
#if MISSING
        crossings edges = {{x, 0, z, 0, xz, 0, 0}};
        crossings_keep(s, k1.cells, y, origin.z + n, w, &edges);
        x = edges.type[0].s0, z = edges.type[2].s0, xz = edges.type[4].s0;
#endif
        ulong at_samples = zero;
#if CLOSED
        if (at_border) at_samples |= a0 & border_samples(s, k1.cells, y, origin.z + n, w).s0;
#endif
        if (!(x | z | xz | at_samples)) continue;
        row_numbers o = row_numbers_of(s, y, origin.z + n, w, k1);
        uint *number = work->number + NUMBER_STEP * NUMBER_INDEX(0, BRICK_ROWS, n);
        neighbour_row_number(number, 0, x, number_of(o, 0));
        neighbour_row_number(number, 2, z, number_of(o, 2));
        if (DIAGONALS) neighbour_row_number(number, 4, xz, number_of(o, 4));
        if (VERTEX_TYPES > AT_SAMPLE_TYPE)
            neighbour_row_number(number, AT_SAMPLE_TYPE, at_samples, number_of(o, AT_SAMPLE_TYPE));
    }
}

/* The first samples of the rows in the next brick in x, and whether they are vertices. */
inline_always lanes next_column(sample_rows rows) { return rows.next >> 63; }
inline_always lanes next_zeros(sample_rows rows) { return ZEROS ? rows.zero_next >> 63 : (lanes)0; }

/* Numbers the first vertex of one type of the rows from y on in plane z of word w. */
inline_always void column_store(const slab *s, uint y, uint z, uint w, uint type, uint rows, grid_index origin,
                                row_results k1, brick_work *work) {
    for (; rows; rows &= rows - 1) {
        uint row = y + lowest_bit(rows);
        uint *number = work->number + NUMBER_STEP * NUMBER_INDEX(0, row - origin.y, z - origin.z);
        number_store(number, 64, type, number_of(row_numbers_of(s, row, z, w, k1), type));
    }
}

/* Numbers the crossings in the next column, x = 64. Called last, as the functions above leave meaningless numbers there
 * for rows without crossings. */
inline_always void column_number(const slab *s, grid_index origin, const brick_signs *signs, bool at_border,
                                 row_results k1, brick_work *work) {
    const uint w = origin.x / 64 + 1;
    if (w >= s->words_x) return;
    for (uint n = 0; n < NUMBER_PLANES && origin.z + n < s->nz; n++) {
        const uint z = origin.z + n;
        const lanes has_y = lanes_select(LANE_NUMBERS + (origin.y + 1) < (lanes)s->ny);
        const lanes a = next_column(signs->rows[0][n]), b = next_column(signs_next_y(signs, n));
        const lanes za = next_zeros(signs->rows[0][n]), zb = next_zeros(signs_next_y(signs, n));
        crossings edges = {{0, 0, 0, 0, 0, 0, 0}}, next_y = {{0, 0, 0, 0, 0, 0, 0}};
        edges.type[1] = crossed(a, b, za, zb) & has_y;
        edges.type[6] = za, next_y.type[6] = next_zeros(signs->rows[1][n]);
        if (n < BRICK_PLANES && z + 1 < s->nz) {
            const lanes at_z = next_column(signs->rows[0][n + 1]), at_yz = next_column(signs_next_y(signs, n + 1));
            const lanes zc = next_zeros(signs->rows[0][n + 1]), zd = next_zeros(signs_next_y(signs, n + 1));
            edges.type[2] = crossed(a, at_z, za, zc);
            if (DIAGONALS)
                edges.type[5] =
                    choose(even_rows(s, origin.y, z), crossed(a, at_yz, za, zd), crossed(b, at_z, zb, zc)) & has_y;
            next_y.type[2] = crossed(next_column(signs->rows[1][n]), next_column(signs->rows[1][n + 1]), next_y.type[6],
                                     next_zeros(signs->rows[1][n + 1]));
        }
#if MISSING
        crossings_keep(s, k1.cells, origin.y, z, w, &edges);
        crossings_keep(s, k1.cells, origin.y + BRICK_ROWS, z, w, &next_y);
#endif
#if CLOSED
        edges.type[AT_SAMPLE_TYPE] = za, next_y.type[AT_SAMPLE_TYPE] = next_zeros(signs->rows[1][n]);
        if (at_border) {
            edges.type[AT_SAMPLE_TYPE] |= a & border_samples(s, k1.cells, origin.y, z, w);
            next_y.type[AT_SAMPLE_TYPE] |=
                next_column(signs->rows[1][n]) & border_samples(s, k1.cells, origin.y + BRICK_ROWS, z, w);
        }
#endif
        column_store(s, origin.y, z, w, 1, lanes_nonzero(edges.type[1]), origin, k1, work);
        column_store(s, origin.y, z, w, 2, lanes_nonzero(edges.type[2]), origin, k1, work);
        column_store(s, origin.y, z, w, 5, lanes_nonzero(edges.type[5]), origin, k1, work);
        if (VERTEX_TYPES > AT_SAMPLE_TYPE)
            column_store(s, origin.y, z, w, AT_SAMPLE_TYPE, lanes_nonzero(edges.type[AT_SAMPLE_TYPE]), origin, k1,
                         work);
        if (origin.y + BRICK_ROWS >= s->ny) continue;
        if (next_y.type[2].s0) column_store(s, origin.y + BRICK_ROWS, z, w, 2, 1, origin, k1, work);
        if (VERTEX_TYPES > AT_SAMPLE_TYPE && next_y.type[AT_SAMPLE_TYPE].s0)
            column_store(s, origin.y + BRICK_ROWS, z, w, AT_SAMPLE_TYPE, 1, origin, k1, work);
    }
}

#endif
