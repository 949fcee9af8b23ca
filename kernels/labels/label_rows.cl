/*
 * label_rows.cl - what a row of 64 cubes of a label map has: words of its vertices by type, and of its triangles
 *
 * A face has a vertex where its three edges differ, a cell where its six do. The number of edges that differ is the
 * partition of a tetrahedron: three of 3 + 1, four of 2 + 2, five of 2 + 1 + 1, six of 1 + 1 + 1 + 1.
 */
#ifndef LABEL_ROWS_CL
#define LABEL_ROWS_CL

#include "label_words.cl"

/* Faces whose three edges differ: of the xy, xz and yz faces that begin at the samples, two triangles each. The first
 * one has the lower of the two corners that are not on the diagonal. */
inline_always ulong label_first_half(ulong even, ulong diagonal, ulong along, ulong across, ulong across_next) {
    return diagonal & along & label_select(even, across_next, across);
}

inline_always ulong label_second_half(ulong even, ulong diagonal, ulong along_next, ulong across, ulong across_next) {
    return diagonal & along_next & label_select(even, across, across_next);
}

/* The words of vertices that a row's samples own, by type. */
inline_always void label_types(ulong even, const ulong e[LABEL_EDGES], ulong t[LABEL_ROW_TYPES]) {
#pragma unroll
    for (uint n = 0; n < LABEL_WORDS; n++) t[n] = e[n];
    t[6] = label_first_half(even, e[EXY], e[EX], e[EY], e[EY_X1]);
    t[7] = label_second_half(even, e[EXY], e[EX_Y1], e[EY], e[EY_X1]);
    t[8] = label_first_half(even, e[EXZ], e[EX], e[EZ], e[EZ_X1]);
    t[9] = label_second_half(even, e[EXZ], e[EX_Z1], e[EZ], e[EZ_X1]);
    t[10] = label_first_half(even, e[EYZ], e[EY], e[EZ], e[EZ_Y1]);
    t[11] = label_second_half(even, e[EYZ], e[EY_Z1], e[EZ], e[EZ_Y1]);
    /* within the cube: the faces of the middle tetrahedron, by the corner that they lack; then the cells */
    const ulong a = e[EXY], b = e[EXZ], c = e[EYZ], a1 = e[EXY_Z1], b1 = e[EXZ_Y1], c1 = e[EYZ_X1];
    const ulong far = a1 & b1 & c1, near = a & b & c;
    const ulong odd0 = a1 & b1 & c, odd1 = a1 & b & c1, odd2 = a & b1 & c1;
    const ulong even1 = a & b1 & c, even2 = a1 & b & c, even3 = a & b & c1;
    t[12] = label_select(even, far, odd0);
    t[13] = label_select(even, even1, odd1);
    t[14] = label_select(even, even2, odd2);
    t[15] = label_select(even, even3, near);
    t[16] = near & far;
    t[17] = label_select(even, even3 & e[EX] & e[EY_X1] & e[EZ_X1], near & e[EX] & e[EY] & e[EZ]);
    t[18] = label_select(even, even1 & e[EY] & e[EX_Y1] & e[EZ_Y1], odd2 & e[EX_Y1] & e[EY_X1] & e[EZ_XY1]);
    t[19] = label_select(even, even2 & e[EZ] & e[EX_Z1] & e[EY_Z1], odd1 & e[EX_Z1] & e[EZ_X1] & e[EY_XZ1]);
    t[20] = label_select(even, far & e[EZ_XY1] & e[EY_XZ1] & e[EX_YZ1], odd0 & e[EY_Z1] & e[EZ_Y1] & e[EX_YZ1]);
}

/* The tetrahedra of 64 cubes at one position in the cube: those with three, four, five and six edges that differ. */
typedef struct label_cells {
    ulong three, four, five, six;
} label_cells;

/* Of six edges: three at a corner, and three around the face across from it. Their bits are added for all cubes at
 * once. Sums 1 and 2 do not occur, as equality is transitive, and six bits make no 7: so one bit and its neighbour tell
 * the sums 3 to 6 apart. */
inline_always label_cells label_cells_of(ulong a, ulong b, ulong c, ulong d, ulong f, ulong g) {
    const ulong low = a ^ b ^ c, low_carry = (a & b) | (c & (a ^ b));
    const ulong high = d ^ f ^ g, high_carry = (d & f) | (g & (d ^ f));
    const ulong ones = low ^ high, carry = low & high, twos = low_carry ^ high_carry ^ carry;
    const ulong fours = (low_carry & high_carry) | (carry & (low_carry ^ high_carry));
    label_cells cells = {ones & twos & ~fours, fours & ~ones & ~twos, fours & ones, fours & twos};
    return cells;
}

/* Tetrahedron t of the cubes: the middle one, then those at corners. */
inline_always label_cells label_tetrahedra(ulong even, const ulong e[LABEL_EDGES], uint t) {
    const ulong a = e[EXY], b = e[EXZ], c = e[EYZ], a1 = e[EXY_Z1], b1 = e[EXZ_Y1], c1 = e[EYZ_X1];
    if (t == 0) return label_cells_of(a, b, c, a1, b1, c1);
    if (t == 1)
        return label_cells_of(e[EX], label_select(even, e[EY_X1], e[EY]), label_select(even, e[EZ_X1], e[EZ]), a, b,
                              label_select(even, c1, c));
    if (t == 2)
        return label_cells_of(e[EX_Y1], label_select(even, e[EY], e[EY_X1]), label_select(even, e[EZ_Y1], e[EZ_XY1]), a,
                              b1, label_select(even, c, c1));
    if (t == 3)
        return label_cells_of(e[EX_Z1], label_select(even, e[EY_Z1], e[EY_XZ1]), label_select(even, e[EZ], e[EZ_X1]),
                              a1, b, label_select(even, c, c1));
    return label_cells_of(e[EX_YZ1], label_select(even, e[EY_XZ1], e[EY_Z1]), label_select(even, e[EZ_XY1], e[EZ_Y1]),
                          a1, b1, label_select(even, c1, c));
}

/* Triangles of these cubes. rusticl 25.0 sums wrongly where label_cells_in has selected the cubes of a copy. */
inline_always uint label_cell_triangles(label_cells c, ulong cubes) {
    return (uint)popcount(c.three & cubes) + 2 * (uint)popcount(c.four & cubes) + 5 * (uint)popcount(c.five & cubes) +
           12 * (uint)popcount(c.six & cubes);
}

/* Bits of cubes that lie in the grid, in a row. */
inline_always ulong label_cubes(const label_job *s, row_origin p) {
    return p.y + 1 < s->ny && p.z + 1 < s->nz ? label_mask(s->nx - 64 * p.w - 1) : 0;
}

inline_always label_cells label_cells_in(label_cells c, ulong cubes) {
    label_cells in = {c.three & cubes, c.four & cubes, c.five & cubes, c.six & cubes};
    return in;
}

inline_always ulong label_cells_any(label_cells c) { return c.three | c.four | c.five | c.six; }

inline_always ulong label_edges_any(const ulong e[LABEL_EDGES]) {
    ulong any = 0;
#pragma unroll
    for (uint n = 0; n < LABEL_EDGES; n++) any |= e[n];
    return any;
}

#endif
