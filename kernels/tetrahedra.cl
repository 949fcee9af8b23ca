/*
 * tetrahedra.cl - 64 cubes at a time: which edges are crossed, how many triangles the tetrahedra emit
 *
 * A cube row is 64 cubes along x between the rows of samples (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1), called
 * a, b, c, d here; suffix 1 is the row shifted to x + 1. In an even cube (bit set in `even`) the face diagonals join
 * corners 0 3, 0 5, 0 6 (000 to 110, 101, 011), in an odd one the other two corners of the faces; see
 * host/lib/tables.h.
 */

typedef struct cube_row {
    ulong a0, a1, b0, b1, c0, c1, d0, d1;
    ulong even;
    ulong has_x;        /* cubes with a sample at x + 1 */
    ulong has_y, has_z; /* all or none */
} cube_row;

inline_always ulong word_shifted(ulong word, ulong next) { return word >> 1 | next << 63; }

inline_always ulong even_cubes(const slab *s, uint y, uint z) {
    return (s->parity + y + z) & 1 ? 0xaaaaaaaaaaaaaaaaul : 0x5555555555555555ul;
}

inline_always ulong choose(ulong which, ulong yes, ulong no) { return no ^ (which & (yes ^ no)); }

/* word[n]: a, b, c, d at w and at w + 1; 0 where outside the grid. */
inline_always cube_row cube_row_of(const slab *s, uint y, uint z, uint w, const ulong word[4][2]) {
    cube_row r;
    ulong valid = word_valid(s, w);
    r.a0 = word[0][0], r.a1 = word_shifted(word[0][0], word[0][1]);
    r.b0 = word[1][0], r.b1 = word_shifted(word[1][0], word[1][1]);
    r.c0 = word[2][0], r.c1 = word_shifted(word[2][0], word[2][1]);
    r.d0 = word[3][0], r.d1 = word_shifted(word[3][0], word[3][1]);
    r.even = even_cubes(s, y, z);
    r.has_x = w + 1 < s->words_x ? valid : valid >> 1;
    r.has_y = y + 1 < s->ny ? ~0ul : 0;
    r.has_z = z + 1 < s->nz ? ~0ul : 0;
    return r;
}

/* The same from rows of sign words; a row outside the grid may be any pointer. */
inline_always cube_row cube_row_load(const slab *s, uint y, uint z, uint w, global const ulong *a,
                                     global const ulong *b, global const ulong *c, global const ulong *d) {
    bool next = w + 1 < s->words_x, y1 = y + 1 < s->ny, z1 = z + 1 < s->nz;
    ulong word[4][2] = {{a[w], next ? a[w + 1] : 0},
                        {y1 ? b[w] : 0, y1 && next ? b[w + 1] : 0},
                        {z1 ? c[w] : 0, z1 && next ? c[w + 1] : 0},
                        {y1 && z1 ? d[w] : 0, y1 && z1 && next ? d[w + 1] : 0}};
    return cube_row_of(s, y, z, w, word);
}

inline_always ulong cubes_in_grid(const cube_row *r) { return r->has_x & r->has_y & r->has_z; }

/* Cubes whose corners differ. */
inline_always ulong cubes_active(const cube_row *r) {
    ulong any = r->a0 | r->a1 | r->b0 | r->b1 | r->c0 | r->c1 | r->d0 | r->d1;
    ulong all = r->a0 & r->a1 & r->b0 & r->b1 & r->c0 & r->c1 & r->d0 & r->d1;
    return any & ~all & cubes_in_grid(r);
}

/* Edges owned by the samples of row a whose ends differ, where both ends are in the grid. */
typedef struct crossings {
    ulong type[6]; /* x, y, z, xy, xz, yz */
} crossings;

inline_always crossings crossings_owned(const cube_row *r) {
    crossings k;
    k.type[0] = (r->a0 ^ r->a1) & r->has_x;
    k.type[1] = (r->a0 ^ r->b0) & r->has_y;
    k.type[2] = (r->a0 ^ r->c0) & r->has_z;
    k.type[3] = choose(r->even, r->a0 ^ r->b1, r->a1 ^ r->b0) & r->has_x & r->has_y;
    k.type[4] = choose(r->even, r->a0 ^ r->c1, r->a1 ^ r->c0) & r->has_x & r->has_z;
    k.type[5] = choose(r->even, r->a0 ^ r->d0, r->b0 ^ r->c0) & r->has_y & r->has_z;
    return k;
}

inline_always void tetrahedron_count(ulong a, ulong b, ulong c, ulong d, ulong cubes, uint *triangles) {
    ulong odd = a ^ b ^ c ^ d;
    ulong two = (a | b | c | d) & ~(a & b & c & d) & ~odd;
    *triangles += (uint)popcount(odd & cubes) + 2 * (uint)popcount(two & cubes);
}

/* Corner n of an even cube, corner n ^ 1 of an odd one. */
inline_always uint triangles_count(const cube_row *r, ulong cubes) {
    ulong e = r->even;
    ulong p0 = choose(e, r->a0, r->a1), p1 = choose(e, r->a1, r->a0);
    ulong p2 = choose(e, r->b0, r->b1), p3 = choose(e, r->b1, r->b0);
    ulong p4 = choose(e, r->c0, r->c1), p5 = choose(e, r->c1, r->c0);
    ulong p6 = choose(e, r->d0, r->d1), p7 = choose(e, r->d1, r->d0);
    uint triangles = 0;
    tetrahedron_count(p0, p3, p5, p6, cubes, &triangles);
    tetrahedron_count(p1, p0, p3, p5, cubes, &triangles);
    tetrahedron_count(p2, p0, p3, p6, cubes, &triangles);
    tetrahedron_count(p4, p0, p5, p6, cubes, &triangles);
    tetrahedron_count(p7, p3, p5, p6, cubes, &triangles);
    return triangles;
}

/* Where the vertices of a row's six edge types start, from the row's first vertex on; packed with the number of that
 * vertex in its brick: 14 bits, then 7, 8, 8, 9, 9 bits for types y, z, xy, xz, yz. */
inline_always ulong offsets_pack(const crossings *k, uint first, uint *vertex_count) {
    uint y = (uint)popcount(k->type[0]);
    uint z = y + (uint)popcount(k->type[1]);
    uint xy = z + (uint)popcount(k->type[2]);
    uint xz = xy + (uint)popcount(k->type[3]);
    uint yz = xz + (uint)popcount(k->type[4]);
    *vertex_count = yz + (uint)popcount(k->type[5]);
    return (ulong)first | (ulong)y << 14 | (ulong)z << 21 | (ulong)xy << 29 | (ulong)xz << 37 | (ulong)yz << 46;
}

inline_always uint offset_of_type(ulong packed, uint type) {
    uint first = (uint)packed & 0x3fff;
    switch (type) {
    case 0:
        return first;
    case 1:
        return first + ((uint)(packed >> 14) & 0x7f);
    case 2:
        return first + ((uint)(packed >> 21) & 0xff);
    case 3:
        return first + ((uint)(packed >> 29) & 0xff);
    case 4:
        return first + ((uint)(packed >> 37) & 0x1ff);
    default:
        return first + ((uint)(packed >> 46) & 0x1ff);
    }
}
