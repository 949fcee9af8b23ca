/*
 * mesh.cl - kernel 2: what it reads of kernel 1's results, and the numbers of vertices
 *
 * The number of a vertex is a sum: the vertices of the slabs before its slab, of the bricks before its brick in the
 * slab, of the rows before its row in the brick, of the edge types before its type in the row, and of edges of its type
 * at lower x in the row.
 */
#ifndef MESH_CL
#define MESH_CL

#include "tetrahedra.cl"
#include "vertex.cl"

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

/* From where the edges of a brick's vertices are counted; below the grid's first sample it wraps. */
inline_always grid_index edges_origin(grid_index brick) {
    grid_index origin = {brick.x - EDGES_BEFORE, brick.y - EDGES_BEFORE, brick.z - EDGES_BEFORE};
    return origin;
}

/* The number of the first vertex of a brick, in this slab or the next. */
inline_always uint brick_first_vertex(const slab *s, uint z, uint brick, row_results k1) {
    return (z < s->z1 ? s->mesh.vertex_base : s->mesh.vertex_base_next) + k1.bricks[brick].vertices;
}

/* Where the numbers of the vertices that a row of 64 samples owns begin. */
typedef struct row_numbers {
    uint first;
    ulong packed;
} row_numbers;

inline_always row_numbers row_numbers_of(const slab *s, uint y, uint z, uint w, row_results k1) {
    uint brick = brick_index(s, y, z, w);
    row_numbers o = {brick_first_vertex(s, z, brick, k1), k1.offsets[BRICK_WORDS * brick + row_in_brick(s, y, z)]};
    return o;
}

inline_always uint number_of(row_numbers o, uint type) { return o.first + offset_of_type(o.packed, type); }

/* Where an edge of a type lies, from the sample that owns it. Diagonals depend on the parity of the cube. */
inline_always uint edge_code(uint type, bool odd) {
    switch (type) {
    case 0:
        return EDGE_CODE(0, 0, 0, 1, 0, 0);
    case 1:
        return EDGE_CODE(0, 0, 0, 0, 1, 0);
    case 2:
        return EDGE_CODE(0, 0, 0, 0, 0, 1);
    case 3:
        return odd ? EDGE_CODE(1, 0, 0, -1, 1, 0) : EDGE_CODE(0, 0, 0, 1, 1, 0);
    case 4:
        return odd ? EDGE_CODE(1, 0, 0, -1, 0, 1) : EDGE_CODE(0, 0, 0, 1, 0, 1);
    default:
        return odd ? EDGE_CODE(0, 1, 0, 0, -1, 1) : EDGE_CODE(0, 0, 0, 0, 1, 1);
    }
}

/* A vertex at a sample, of a closed surface: an edge without length. */
#define EDGE_AT_SAMPLE     EDGE_CODE(0, 0, 0, 0, 0, 0)
#define is_at_sample(edge) (CLOSED && ((edge) ^ EDGE_AT_SAMPLE) >> 14 == 0)

/* The entry of a cube in the table of cases: its parity, corners inside, and corners that are vertices. */
inline_always global const uchar *case_of(global const uchar *cases, uint odd, uint inside, uint zeros) {
    const uint count = CASE_COUNT(METHOD_TYPES);
    if (!ZEROS) return cases + CUBE_CASE_BYTES * (count * odd + inside);
    global const ushort *digits = (global const ushort *)(cases + CUBE_CASE_BYTES * 2 * count);
    return cases + CUBE_CASE_BYTES * (count * odd + 2 * digits[inside] + digits[zeros]);
}

#ifdef REAL

/* Distance of an edge's two samples in the sample buffer. */
inline_always long edge_step(const slab *s, uint edge) {
    long x = (long)(edge >> 14 & 3) - 1, y = (long)(edge >> 16 & 3) - 1, z = (long)(edge >> 18 & 3) - 1;
    return x + (y + z * s->ny) * s->nx;
}

#endif

#endif
