/*
 * mesh.cl - kernel 2: what it reads of kernel 1's results, and where things are in the mesh
 *
 * A vertex's number is what its slab and brick have before them, plus where its row's output begins, plus where its
 * edge type's does, plus the crossed edges of that type at lower x.
 */

inline_always uint lowest_bit(ulong word) { return (uint)popcount(~word & (word - 1)); } /* 64 for 0 */

typedef struct mesh_buffers {
    global float *positions;
    global float *normals;
    global uint *triangles;
} mesh_buffers;

/* Results of kernel 1. */
typedef struct row_results {
    global const ulong *words, *offsets, *cells;
    global const ushort *triangle_offsets;
    global const brick_state *bricks;
} row_results;

inline_always uint brick_vertices(const slab *s, uint z, uint number, row_results k1) {
    return (z < s->z1 ? s->vertex_base : s->vertex_base_next) + k1.bricks[number].vertices;
}

/* Where the numbers of the vertices that a row of 64 samples owns begin. */
typedef struct owner {
    uint first;
    ulong packed;
} owner;

inline_always owner owner_of(const slab *s, uint y, uint z, uint w, row_results k1) {
    uint number = brick_index(s, y, z, w);
    owner o = {brick_vertices(s, z, number, k1), k1.offsets[BRICK_WORDS * number + row_place(s, y, z)]};
    return o;
}

inline_always uint number_of(owner o, uint type) { return o.first + offset_of_type(o.packed, type); }

/* From which sample to which an edge of a type runs, seen from the sample that owns it: places in the buffer, and in
 * the brick as PLACE has it. Diagonals differ with the parity of the cube. */
#ifdef REAL
typedef struct edge_way {
    ulong from, to;
    uint place;
} edge_way;

inline_always edge_way edge_way_of(const slab *s, uint type, bool odd) {
    const ulong y = s->nx, z = (ulong)s->nx * s->ny;
    const edge_way ways[12] = {
        {0, 1, PLACE(0, 0, 0, 1, 0, 0)},     {0, 1, PLACE(0, 0, 0, 1, 0, 0)},     {0, y, PLACE(0, 0, 0, 0, 1, 0)},
        {0, y, PLACE(0, 0, 0, 0, 1, 0)},     {0, z, PLACE(0, 0, 0, 0, 0, 1)},     {0, z, PLACE(0, 0, 0, 0, 0, 1)},
        {0, y + 1, PLACE(0, 0, 0, 1, 1, 0)}, {1, y, PLACE(1, 0, 0, -1, 1, 0)},    {0, z + 1, PLACE(0, 0, 0, 1, 0, 1)},
        {1, z, PLACE(1, 0, 0, -1, 0, 1)},    {0, y + z, PLACE(0, 0, 0, 0, 1, 1)}, {y, z, PLACE(0, 1, 0, 0, -1, 1)}};
    return ways[2 * type + odd];
}
#endif

/* The signs of a cube's corners, corner n in bit n. */
inline_always uint pattern_at(ulong8 corners, uint bit) {
    char8 inside = convert_char8((corners & (ulong8)(1ul << bit)) != 0ul);
    return (uint)(((as_ulong(inside) & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56);
}
