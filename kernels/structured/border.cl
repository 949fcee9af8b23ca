/*
 * border.cl - closed surfaces: what belongs to the border of the grid, or of its present cubes, in LANES rows at once
 *
 * A face that only one present cube has is on the border. Its inside part closes the surface: that of each of the two
 * triangles that the split's diagonal makes of it, or in the hybrid method of the face as a whole. Inside samples of
 * the border are vertices. host/lib/tables/cap_tables.c has the triangles, by which kernel 2 emits them.
 */
#ifndef BORDER_CL
#define BORDER_CL

#include "cells.cl"

#if CLOSED

/* Word w of a row in which only sample or cube `at` has its bit; 0 where it lies in another word, or has wrapped below
 * 0. */
inline_always ulong bit_at(uint at, uint w) { return at / 64 == w ? 1ul << at % 64 : 0; }

#if MISSING

/* Bit n: cube n and the cube at x - 1 are present. */
inline_always lanes cells_both(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
    const lanes word = cells_rows(s, cells, y, z, w);
    return word & (word << 1 | (w ? cells_rows(s, cells, y, z, w - 1) >> 63 : (lanes)0));
}

/* Samples of a row around which some cubes are present and some are not. */
inline_always lanes border_samples(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
    lanes any = 0, all = ~(lanes)0;
#pragma unroll 1
    for (uint n = 0; n < 4; n++) {
        any |= cells_before(s, cells, y - (n & 1), z - (n >> 1), w);
        all &= cells_both(s, cells, y - (n & 1), z - (n >> 1), w);
    }
    return any & ~all;
}

#else

/* Samples of a row that are on the grid's border. */
inline_always lanes border_samples(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
    const lanes row = LANE_NUMBERS + y;
    const lanes exists = lanes_select(row < (lanes)s->ny),
                ends_y = lanes_select(row == 0ul) | lanes_select(row + 1ul == (lanes)s->ny);
    const ulong ends_z = z == 0 || z + 1 == s->nz ? ~0ul : 0, ends_x = bit_at(0, w) | bit_at(s->nx - 1, w);
    return (ends_y | ends_z | ends_x) & exists & (z < s->nz ? word_valid(s, w) : 0);
}

#endif

/* Cubes of a row with a face on the border: at low x, high x, low y, high y, low z, high z. */
typedef struct border_faces {
    lanes at[6];
} border_faces;

inline_always border_faces border_faces_of(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
#if MISSING
    const lanes cubes = cells_rows(s, cells, y, z, w);
    const lanes before = w ? cells_rows(s, cells, y, z, w - 1) >> 63 : (lanes)0;
    const lanes after = w + 1 < s->words_x ? cells_rows(s, cells, y, z, w + 1) << 63 : (lanes)0;
    border_faces f = {{cubes & ~(cubes << 1 | before), cubes & ~(cubes >> 1 | after),
                       cubes & ~cells_rows(s, cells, y - 1, z, w), cubes & ~cells_rows(s, cells, y + 1, z, w),
                       cubes & ~cells_rows(s, cells, y, z - 1, w), cubes & ~cells_rows(s, cells, y, z + 1, w)}};
#else
    const lanes row = LANE_NUMBERS + y;
    const ulong valid = word_valid(s, w), has_x = w + 1 < s->words_x ? valid : valid >> 1;
    const lanes cubes = lanes_select(row + 1ul < (lanes)s->ny) & (z + 1 < s->nz ? has_x : 0);
    border_faces f = {{cubes & bit_at(0, w), cubes & bit_at(s->nx - 2, w), cubes & lanes_select(row == 0ul),
                       cubes & lanes_select(row + 2ul == (lanes)s->ny), z == 0 ? cubes : (lanes)0,
                       z + 2 == s->nz ? cubes : (lanes)0}};
#endif
    return f;
}

inline_always lanes border_faces_any(const border_faces *f) {
    return f->at[0] | f->at[1] | f->at[2] | f->at[3] | f->at[4] | f->at[5];
}

/* Whether `count` bricks in x may have samples on the border, or cubes with faces there. Of grids with missing samples
 * the cubes around one brick are looked at. */
inline_always bool bricks_at_border(const slab *s, global const ulong *cells, uint y, uint z, uint w, uint count) {
    if (y == 0 || z == 0 || w == 0 || y + BRICK_ROWS + 1 >= s->ny || z + BRICK_PLANES + 1 >= s->nz ||
        64 * (w + count) + 1 >= s->nx)
        return true;
#if MISSING
    ulong all = ~0ul;
    for (uint n = 0; n < (BRICK_ROWS + 2) * (BRICK_PLANES + 2); n++) {
        const uint row = y + n % (BRICK_ROWS + 2) - 1, plane = z + n / (BRICK_ROWS + 2) - 1;
        all &= cells_at(s, cells, row, plane, w) & (cells_at(s, cells, row, plane, w - 1) >> 63 | ~1ul) &
               (cells_at(s, cells, row, plane, w + 1) << 63 | ~0ul >> 1);
    }
    return ~all != 0;
#else
    return false;
#endif
}

/* ------------------------------------------------------------------------------------------------------- triangles */

/* The corners of 64 faces: a bit is set where that corner of the face is inside, or, in zero_*, snapped. The diagonal
 * joins p and q. */
typedef struct face_corners {
    lanes p, q, u, v, zero_p, zero_q, zero_u, zero_v;
} face_corners;

/* Where each half of the face is cut by itself: a half with one or three corners inside gives one triangle, with two it
 * gives two, or one where the third corner is a vertex. */
inline_always lanes face_halves_triangles(face_corners c, lanes faces) {
    const lanes two_of_u = ((c.p & c.q) | (c.p & c.u) | (c.q & c.u)) & ~(c.p & c.q & c.u);
    const lanes two_of_v = ((c.p & c.q) | (c.p & c.v) | (c.q & c.v)) & ~(c.p & c.q & c.v);
    const lanes outside_u = ~(c.zero_p | c.zero_q | c.zero_u), outside_v = ~(c.zero_p | c.zero_q | c.zero_v);
    return lanes_popcount((c.p | c.q | c.u) & faces) + lanes_popcount((c.p | c.q | c.v) & faces) +
           lanes_popcount(two_of_u & outside_u & faces) + lanes_popcount(two_of_v & outside_v & faces);
}

/* Where the face is cut as a whole: a polygon of its inside corners and crossed sides, or two where the diagonal
 * separates the two corners inside. */
inline_always lanes face_triangles(face_corners c, lanes faces) {
    const lanes corners = lanes_popcount(c.p & faces) + lanes_popcount(c.q & faces) + lanes_popcount(c.u & faces) +
                          lanes_popcount(c.v & faces);
    const lanes sides = lanes_popcount((c.p ^ c.u) & faces) + lanes_popcount((c.u ^ c.q) & faces) +
                        lanes_popcount((c.q ^ c.v) & faces) + lanes_popcount((c.v ^ c.p) & faces);
    const lanes polygons = lanes_popcount((c.p | c.q | c.u | c.v) & faces);
    const lanes parted = lanes_popcount(c.u & c.v & ~c.p & ~c.q & faces);
    return corners + sides - 2 * (polygons + parted);
}

/* Corner n of a face, 0 <= n < 4, as a corner of the cube. */
#define FACE_CORNER(face, n)                                                                                           \
    ((((face)&1) << (face) / 2) + ((n)&1) * ((face) < 2 ? 2 : 1) + ((n) >> 1) * ((face) < 4 ? 4 : 2))

/* Triangles in the border of the 64 cubes of each row. */
inline_always lanes border_triangles(const cube_rows *r, const border_faces *f) {
    const lanes p[8] = {r->a0, r->a1, r->b0, r->b1, r->c0, r->c1, r->d0, r->d1};
    lanes sum = 0;
#pragma unroll
    for (uint face = 0; face < 6; face++) {
        if (!lanes_any(f->at[face])) continue;
        const uint c0 = FACE_CORNER(face, 0), c1 = FACE_CORNER(face, 1), c2 = FACE_CORNER(face, 2);
        const uint c3 = FACE_CORNER(face, 3);
        const lanes e = face & 1 ? ~r->even : r->even; /* the diagonal joins corners 0 and 3 of the face */
        const lanes *zero = r->zero;
        const face_corners c = {choose(e, p[c0], p[c1]),       choose(e, p[c3], p[c2]),
                                choose(e, p[c1], p[c0]),       choose(e, p[c2], p[c3]),
                                choose(e, zero[c0], zero[c1]), choose(e, zero[c3], zero[c2]),
                                choose(e, zero[c1], zero[c0]), choose(e, zero[c2], zero[c3])};
        sum += DIAGONALS ? face_halves_triangles(c, f->at[face]) : face_triangles(c, f->at[face]);
    }
    return sum;
}

/* The index in the table of cases of a cube's face on the border, by the cube's parity, its corners inside, and its
 * corners that are snapped. */
inline_always uint border_case(uint odd, uint face, uint inside, uint zeros) {
    const uint low = face < 2 ? 2 : 1, high = face < 4 ? 4 : 2, first = (face & 1) << face / 2;
    uint digits = 0;
    inside >>= first, zeros >>= first;
    digits = (inside & 1) * 2 + (zeros & 1);
    digits += 3 * ((inside >> low & 1) * 2 + (zeros >> low & 1));
    digits += 9 * ((inside >> high & 1) * 2 + (zeros >> high & 1));
    digits += 27 * ((inside >> (low + high) & 1) * 2 + (zeros >> (low + high) & 1));
    return CAP_FIRST(METHOD_TYPES) + (odd * CAP_FACES + face) * CAP_FACE_CASES + digits;
}

/* Samples of rows a at which a vertex lies. */
inline_always lanes at_samples_owned(const slab *s, const cube_rows *r, uint y, uint z, uint w,
                                     global const ulong *cells) {
    return r->zero[0] | (r->a0 & border_samples(s, cells, y, z, w));
}

#endif

/* Vertices owned by the samples of rows a: those on edges that present cubes have, and those at
 * samples; at_border: whether any of these may be on the border. */
inline_always crossings vertices_owned(const slab *s, const cube_rows *r, uint y, uint z, uint w, bool at_border,
                                       global const ulong *cells) {
    crossings edges = crossings_owned(r);
#if MISSING
    crossings_keep(s, cells, y, z, w, &edges);
#endif
#if CLOSED
    edges.type[AT_SAMPLE_TYPE] = at_border ? at_samples_owned(s, r, y, z, w, cells) : r->zero[0];
#endif
    return edges;
}

#endif
