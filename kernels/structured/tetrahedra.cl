/*
 * tetrahedra.cl - 64 cubes at a time, in LANES rows at once: which edges are crossed, how many triangles are emitted
 *
 * A cube row is 64 cubes along x between the rows of samples (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1), called
 * a, b, c, d here; suffix 1 is the row shifted to x + 1. In an even cube (bit set in `even`) the face diagonals join
 * corners 0 3, 0 5, 0 6 (000 to 110, 101, 011), in an odd one the other two corners of the faces; see
 * host/lib/tables/tables.h. Lanes follow each other in y.
 */
#ifndef TETRAHEDRA_CL
#define TETRAHEDRA_CL

#include "../base/methods.h"
#include "../base/words.cl"

/* Sign words of LANES rows, and the same shifted to x + 1. Samples that are vertices themselves (method snap) are in
 * the words `zero`, and count as outside in the others. */
typedef struct sample_rows {
    lanes at, next;
    lanes zero_at, zero_next;
} sample_rows;

typedef struct cube_rows {
    lanes a0, a1, b0, b1, c0, c1, d0, d1;
    lanes zero[8]; /* of the same */
    lanes even;
    ulong has_x; /* cubes with a sample at x + 1 */
    lanes has_y; /* all or none */
    ulong has_z;
} cube_rows;

inline_always sample_rows rows_shifted(lanes word, lanes next) {
    sample_rows r = {word, word >> 1 | next << 63, 0, 0};
    return r;
}

inline_always sample_rows rows_with_zeros(lanes word, lanes next, lanes zero, lanes zero_next) {
    sample_rows r = rows_shifted(word & ~zero, next & ~zero_next);
    r.zero_at = zero, r.zero_next = zero >> 1 | zero_next << 63;
    return r;
}

inline_always ulong word_shifted(ulong word, ulong next) { return word >> 1 | next << 63; }

inline_always ulong even_cubes(const slab *s, uint y, uint z) {
    return (s->parity + y + z) & 1 ? 0xaaaaaaaaaaaaaaaaul : 0x5555555555555555ul;
}

inline_always lanes even_rows(const slab *s, uint y, uint z) {
    return even_cubes(s, y, z) ^ lanes_select((LANE_NUMBERS & 1ul) != 0ul);
}

inline_always lanes choose(lanes which, lanes yes, lanes no) { return no ^ (which & (yes ^ no)); }

/* The cubes at w of the rows from y on in plane z. Samples outside the grid are 0. */
inline_always cube_rows cube_rows_of(const slab *s, uint y, uint z, uint w, sample_rows a, sample_rows b, sample_rows c,
                                     sample_rows d) {
    ulong valid = word_valid(s, w);
    cube_rows r = {a.at,
                   a.next,
                   b.at,
                   b.next,
                   c.at,
                   c.next,
                   d.at,
                   d.next,
                   {a.zero_at, a.zero_next, b.zero_at, b.zero_next, c.zero_at, c.zero_next, d.zero_at, d.zero_next}};
    r.even = even_rows(s, y, z);
    r.has_x = w + 1 < s->words_x ? valid : valid >> 1;
    r.has_y = lanes_select(LANE_NUMBERS + (y + 1) < (lanes)s->ny);
    r.has_z = z + 1 < s->nz ? ~0ul : 0;
    return r;
}

/* Cubes of which a corner is inside and another is not. */
inline_always lanes cubes_active(const cube_rows *r) {
    lanes any = r->a0 | r->a1 | r->b0 | r->b1 | r->c0 | r->c1 | r->d0 | r->d1;
    lanes all = r->a0 & r->a1 & r->b0 & r->b1 & r->c0 & r->c1 & r->d0 & r->d1;
    return any & ~all & r->has_x & r->has_y & r->has_z;
}

/* A constant or function of the method that the program is built for. */
#define OF_METHOD(what) PASTE(METHOD, _##what)

#define METHOD_CONSTANTS(name, types, most, usual)                                                                     \
    name##_vertex_types = (types), name##_triangles_most = (most), name##_triangles_usual = (usual),
enum { METHODS(METHOD_CONSTANTS) };

#define METHOD_TYPES OF_METHOD(vertex_types)
#define DIAGONALS    (METHOD_TYPES > 3) /* whether edges across faces have vertices */
#define ZEROS        (METHOD_TYPES > 6) /* whether the surface can go through samples, which are vertices then */

/* Vertices on edges have the first types. The last type is that of vertices at samples: at those that the surface goes
 * through, and, of closed surfaces, at inside samples of the border. */
#define AT_SAMPLE_TYPE (DIAGONALS ? 6 : 3)
#define VERTEX_TYPES   (AT_SAMPLE_TYPE + (ZEROS || CLOSED ? 1 : 0))

/* How many samples before its brick an edge may begin, along each axis: the vertex of a snapped sample lies on any of
 * the sample's edges. */
#define EDGES_BEFORE (ZEROS ? 1u : 0u)

/* The vertices that the samples of rows a own: on crossed edges whose ends are both in the grid, and at samples. */
typedef struct crossings {
    lanes type[7]; /* x, y, z, xy, xz, yz, sample; without diagonals, sample is the fourth */
} crossings;

/* Where the samples p and q of an edge are on different sides. */
inline_always lanes crossed(lanes p, lanes q, lanes zero_p, lanes zero_q) { return (p ^ q) & ~(zero_p | zero_q); }

inline_always crossings crossings_owned(const cube_rows *r) {
    const lanes *zero = r->zero;
    crossings edges;
    edges.type[0] = crossed(r->a0, r->a1, zero[0], zero[1]) & r->has_x;
    edges.type[1] = crossed(r->a0, r->b0, zero[0], zero[2]) & r->has_y;
    edges.type[2] = crossed(r->a0, r->c0, zero[0], zero[4]) & r->has_z;
    edges.type[3] = edges.type[4] = edges.type[5] = edges.type[6] = 0;
    if (!DIAGONALS) return edges;
    edges.type[3] = choose(r->even, crossed(r->a0, r->b1, zero[0], zero[3]), crossed(r->a1, r->b0, zero[1], zero[2])) &
                    r->has_x & r->has_y;
    edges.type[4] = choose(r->even, crossed(r->a0, r->c1, zero[0], zero[5]), crossed(r->a1, r->c0, zero[1], zero[4])) &
                    r->has_x & r->has_z;
    edges.type[5] = choose(r->even, crossed(r->a0, r->d0, zero[0], zero[6]), crossed(r->b0, r->c0, zero[2], zero[4])) &
                    r->has_y & r->has_z;
    if (ZEROS) edges.type[6] = zero[0];
    return edges;
}

inline_always lanes crossings_any(const crossings *edges) {
    return edges->type[0] | edges->type[1] | edges->type[2] | edges->type[3] | edges->type[4] | edges->type[5] |
           edges->type[6];
}

/* Adds a + b + c bit by bit: the sum bits in *sum, the carries returned. */
inline_always lanes add_carry(lanes a, lanes b, lanes c, lanes *sum) {
    *sum = a ^ b ^ c;
    return (a & b) | (c & (a ^ b));
}

/* Cubes in which a tetrahedron emits one triangle; *two: those in which it emits two. */
inline_always lanes tetrahedron_triangles(lanes a, lanes b, lanes c, lanes d, lanes cubes, lanes *two) {
    lanes odd = a ^ b ^ c ^ d;
    *two = (a | b | c | d) & ~(a & b & c & d) & ~odd & cubes;
    return odd & cubes;
}

/* Corners of the cubes of a row. In an odd cube, p[n] is corner n ^ 1: it is the mirror in x of an even one. */
typedef struct cube_corners {
    lanes p[8];
} cube_corners;

inline_always cube_corners corners_of(const cube_rows *r) {
    lanes e = r->even;
    cube_corners c = {{choose(e, r->a0, r->a1), choose(e, r->a1, r->a0), choose(e, r->b0, r->b1),
                       choose(e, r->b1, r->b0), choose(e, r->c0, r->c1), choose(e, r->c1, r->c0),
                       choose(e, r->d0, r->d1), choose(e, r->d1, r->d0)}};
    return c;
}

inline_always cube_corners zero_corners_of(const cube_rows *r) {
    cube_corners c;
#pragma unroll
    for (uint n = 0; n < 8; n++) c.p[n] = choose(r->even, r->zero[n], r->zero[n ^ 1]);
    return c;
}

/* Cubes in which each of the five tetrahedra emits one triangle, and two; [0] is the central one. */
typedef struct tetrahedra_counts {
    lanes one[5], two[5];
} tetrahedra_counts;

/* The four tetrahedra around the central one. */
inline_always void outer_count(const lanes p[8], lanes cubes, tetrahedra_counts *t) {
    t->one[1] = tetrahedron_triangles(p[1], p[0], p[3], p[5], cubes, &t->two[1]);
    t->one[2] = tetrahedron_triangles(p[2], p[0], p[3], p[6], cubes, &t->two[2]);
    t->one[3] = tetrahedron_triangles(p[4], p[0], p[5], p[6], cubes, &t->two[3]);
    t->one[4] = tetrahedron_triangles(p[7], p[3], p[5], p[6], cubes, &t->two[4]);
}

/* Triangles of the 64 cubes of each row: ones + 2 twos + 4 fours + 8 eights, added bit by bit, so that four words are
 * counted and not ten. A cube has at most ten triangles, so it is never in fours and eights both: one population count
 * serves them. */
inline_always lanes tetrahedra_sum(const tetrahedra_counts *t) {
    lanes ones, twos, fours;
    lanes carry0 = add_carry(t->one[0], t->one[1], t->one[2], &ones);
    lanes carry1 = add_carry(ones, t->one[3], t->one[4], &ones);
    lanes carry2 = add_carry(carry0, carry1, t->two[0], &twos);
    lanes carry3 = add_carry(twos, t->two[1], t->two[2], &twos);
    lanes carry4 = add_carry(twos, t->two[3], t->two[4], &twos);
    lanes eights = add_carry(carry2, carry3, carry4, &fours);
    return lanes_popcount(ones) +
           2 * (lanes_popcount(twos) + 2 * (lanes_popcount(fours | eights) + lanes_popcount(eights)));
}

inline_always lanes tetra_triangles(const cube_rows *r, lanes *active) {
    const lanes cubes = *active;
    cube_corners c = corners_of(r);
    tetrahedra_counts t;
    outer_count(c.p, cubes, &t);
    t.one[0] = tetrahedron_triangles(c.p[0], c.p[3], c.p[5], c.p[6], cubes, &t.two[0]);
    return tetrahedra_sum(&t);
}

/* Both methods fill loops, and a loop of n vertices takes n - 2 triangles. The tetrahedra's loops have vertices on face
 * diagonals besides: three where the central tetrahedron emits one triangle, four where it emits two. So hybrid
 * triangles = those of the four outer tetrahedra, + 1 - 3 or + 2 - 4 where the central one emits any. Below, 2 is added
 * where it emits none, and subtracted for every cube. */
inline_always lanes hybrid_triangles(const cube_rows *r, lanes *active) {
    const lanes cubes = *active;
    cube_corners c = corners_of(r);
    tetrahedra_counts t;
    outer_count(c.p, cubes, &t);
    lanes any = c.p[0] | c.p[3] | c.p[5] | c.p[6], all = c.p[0] & c.p[3] & c.p[5] & c.p[6];
    t.one[0] = 0;
    t.two[0] = (~any | all) & cubes;
    return tetrahedra_sum(&t) - 2 * lanes_popcount(cubes);
}

/* Cubes in which a tetrahedron with corners that are vertices (z) emits one triangle; *two: two. It needs a corner
 * inside, and one outside or three that are vertices; two triangles need two and two. */
inline_always lanes snapped_triangles(lanes a, lanes b, lanes c, lanes d, lanes za, lanes zb, lanes zc, lanes zd,
                                      lanes cubes, lanes *two) {
    lanes any = a | b | c | d, outside = ~((a | za) & (b | zb) & (c | zc) & (d | zd));
    lanes several = (a & b) | (c & d) | ((a | b) & (c | d));
    lanes emits = any & (outside | ~several) & cubes;
    *two = emits & outside & ~(za | zb | zc | zd) & ~(a ^ b ^ c ^ d);
    return emits & ~*two;
}

/* Clears the bits of cubes that emit no triangle. */
inline_always lanes snap_triangles(const cube_rows *r, lanes *active) {
    const lanes cubes = *active;
    const cube_corners c = corners_of(r), zeros = zero_corners_of(r);
    const lanes *p = c.p, *z = zeros.p;
    tetrahedra_counts t;
    t.one[0] = snapped_triangles(p[0], p[3], p[5], p[6], z[0], z[3], z[5], z[6], cubes, &t.two[0]);
    t.one[1] = snapped_triangles(p[1], p[0], p[3], p[5], z[1], z[0], z[3], z[5], cubes, &t.two[1]);
    t.one[2] = snapped_triangles(p[2], p[0], p[3], p[6], z[2], z[0], z[3], z[6], cubes, &t.two[2]);
    t.one[3] = snapped_triangles(p[4], p[0], p[5], p[6], z[4], z[0], z[5], z[6], cubes, &t.two[3]);
    t.one[4] = snapped_triangles(p[7], p[3], p[5], p[6], z[7], z[3], z[5], z[6], cubes, &t.two[4]);
    *active =
        t.one[0] | t.two[0] | t.one[1] | t.two[1] | t.one[2] | t.two[2] | t.one[3] | t.two[3] | t.one[4] | t.two[4];
    return tetrahedra_sum(&t);
}

inline_always lanes triangles_count(const cube_rows *r, lanes *active) { return OF_METHOD(triangles)(r, active); }

/* Where the vertices of a row's types start, from the row's first vertex on, packed into a word:
 *
 *     from bit   0: 14 bits  the row's first vertex in its brick, added later
 *               14:  7       type y        29: 8  xy        46: 9  yz
 *               21:  8       type z        37: 9  xz        55: 9  sample */
inline_always lanes offsets_pack(const crossings *edges, lanes *vertex_count) {
    lanes y = lanes_popcount(edges->type[0]);
    lanes z = y + lanes_popcount(edges->type[1]);
    lanes xy = z + lanes_popcount(edges->type[2]);
    lanes xz = xy + lanes_popcount(edges->type[3]);
    lanes yz = xz + lanes_popcount(edges->type[4]);
    lanes sample = yz + lanes_popcount(edges->type[5]);
    *vertex_count = VERTEX_TYPES > 6 ? sample + lanes_popcount(edges->type[6]) : sample;
    return y << 14 | z << 21 | xy << 29 | xz << 37 | yz << 46 | (VERTEX_TYPES > 6 ? sample << 55 : (lanes)0);
}

/* Shift and width of a type are a byte and four bits of two constants: no table, as `type` may be variable. The first
 * type starts at 0, which no bit of the word tells. */
inline_always uint offset_of_type(ulong packed, uint type) {
    const uint shift = (uint)(0x372e251d150e00ul >> (8 * type)) & 63, width = 0x9998870u >> (4 * type) & 15;
    return ((uint)packed & 0x3fff) + ((uint)(packed >> shift) & ((1u << width) - 1));
}

#endif
