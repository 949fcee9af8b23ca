/*
 * emit_rows.cl - kernel 2 where the work-items of a group share bricks: each takes a row of 64 cubes
 *
 * For each brick the group makes a table in local memory. It holds the crossed edges of the brick's rows of samples and
 * of the rows after them in y and z, which its cubes name too, and the first vertex number of each row and type. The
 * number of a vertex is that first number plus the crossed edges of its type at lower x: a population count, made where
 * a triangle names the vertex. So nothing is stored per cube, and no private array has a variable index, which would
 * put it into memory.
 */
#ifndef EMIT_ROWS_CL
#define EMIT_ROWS_CL

#include "border.cl"
#include "mesh.cl"
#include "../snap/snapped.cl"
#include "tetrahedra.cl"
#include "vertex.cl"

#define TABLE_ROWS_Y (BRICK_ROWS + 1)
#define TABLE_ROWS   (TABLE_ROWS_Y * (BRICK_PLANES + 1))

/* The table of a brick; rows in y, then z. */
typedef struct row_table {
    ulong crossed[VERTEX_TYPES][TABLE_ROWS];
    ulong packed[TABLE_ROWS]; /* row_numbers */
    uint first[TABLE_ROWS];
} row_table;

inline_always row_numbers table_numbers(const local row_table *table, uint n) {
    row_numbers o = {table->first[n], table->packed[n]};
    return o;
}

/* What a group needs of local memory. */
typedef struct emit_memory {
    row_table tables[WORK_ITEMS / BRICK_WORDS];
} emit_memory;

/* A work-item needs no private memory here. */
typedef struct brick_work {
    uint none;
} brick_work;

inline_always void brick_work_begin(const slab *s, brick_work *work) { work->none = 0; }

/* No prefetch: while a work-item waits for memory, others of its group run. */
inline_always void next_prefetch(const slab *s, global const uint *active, uint count, row_results k1,
                                 global const BITS *samples) {}

/* The sign word of a row, and the same shifted; 0 outside the grid. */
inline_always sample_rows row_of(const slab *s, uint y, uint z, uint w, row_results k1) {
    if (y >= s->ny || z >= s->nz) return rows_shifted(0, 0);
    uint brick = brick_index(s, y, z, w), brick_row = row_in_brick(s, y, z);
    global const ulong *words = brick_words(brick, k1.bricks[brick].sign, k1.words);
    ulong at = words[brick_row] & word_valid(s, w), next = 0, zero = 0, zero_next = 0;
    if (ZEROS) zero = zeros_of(s, words)[brick_row];
    if (w + 1 < s->words_x) {
        words = brick_words(brick + 1, k1.bricks[brick + 1].sign, k1.words);
        next = words[brick_row];
        if (ZEROS) zero_next = zeros_of(s, words)[brick_row];
    }
    return ZEROS ? rows_with_zeros(at, next, zero, zero_next) : rows_shifted(at, next);
}

/* The cubes of a row. next_y, next_z: whether the rows after it in y and in z are loaded; else they are 0. */
inline_always cube_rows row_cubes(const slab *s, uint y, uint z, uint w, bool next_y, bool next_z, row_results k1) {
    sample_rows a = row_of(s, y, z, w, k1), b = rows_shifted(0, 0), c = b, d = b;
    if (next_y) b = row_of(s, y + 1, z, w, k1);
    if (next_z) c = row_of(s, y, z + 1, w, k1);
    if (next_y && next_z) d = row_of(s, y + 1, z + 1, w, k1);
    return cube_rows_of(s, y, z, w, a, b, c, d);
}

/* ------------------------------------------------------------------------------------------------------------ table */

/* Enters row n of a brick's table, where it is in the grid. In rows beyond the brick, only edges that its cubes have
 * are correct. */
inline_always void row_enter(const slab *s, grid_index origin, uint n, row_results k1, local row_table *table) {
    const uint y = origin.y + n % TABLE_ROWS_Y, z = origin.z + n / TABLE_ROWS_Y, w = origin.x / 64;
    if (y >= s->ny || z >= s->nz) return;
    cube_rows r = row_cubes(s, y, z, w, y < origin.y + BRICK_ROWS, z < origin.z + BRICK_PLANES, k1);
    crossings edges = vertices_owned(s, &r, y, z, w, true, k1.cells);
    const row_numbers o = row_numbers_of(s, y, z, w, k1);
#pragma unroll
    for (uint type = 0; type < VERTEX_TYPES; type++) table->crossed[type][n] = edges.type[type];
    table->first[n] = o.first, table->packed[n] = o.packed;
}

/* All rows of a brick, by the work-items that share it. */
inline_always void table_make(const slab *s, grid_index origin, row_results k1, local row_table *table) {
#pragma unroll 1
    for (uint first = 0; first < TABLE_ROWS; first += BRICK_WORDS) {
        uint n = first + (uint)get_local_id(0) % BRICK_WORDS;
        if (n < TABLE_ROWS) row_enter(s, origin, n, k1, table);
    }
}

/* --------------------------------------------------------------------------------------------------------- vertices */

#ifdef REAL

/* The edge of the vertex of a type at a bit of the row (y, z), whose first sample is at `row` in EDGE_CODE. */
inline_always uint edge_at(const slab *s, grid_index origin, uint y, uint z, uint type, uint bit, uint row, ulong even,
                           ulong zeros, grid_arrays in) {
    const bool is_zero = CLOSED ? zeros >> bit & 1 : 1;
    if (ZEROS && type == AT_SAMPLE_TYPE && is_zero)
        return row + bit + link_code(snapped_to(s, origin.x + bit, y, z, in.samples));
    return (CLOSED && type == AT_SAMPLE_TYPE ? EDGE_AT_SAMPLE : edge_code(type, !(even >> bit & 1))) + row + bit;
}

/* All vertices of row n of a table, in order. */
inline_always void row_vertices(const slab *s, grid_index origin, uint y, uint z, uint n, grid_arrays in,
                                row_results k1, const local row_table *table, mesh_buffers mesh) {
    const ulong even = even_cubes(s, y, z);
    const grid_index first = edges_origin(origin);
    const uint row = (y - first.y) << 7 | (z - first.z) << 11 | EDGES_BEFORE;
    const ulong zeros = ZEROS && CLOSED ? row_of(s, y, z, origin.x / 64, k1).zero_at : 0;
    ulong out = (uint)(number_of(table_numbers(table, n), 0) - s->mesh.vertex_window);
#pragma unroll 1
    for (uint type = 0; type < VERTEX_TYPES; type++) {
#pragma unroll 1
        for (ulong crossed = table->crossed[type][n]; crossed; crossed &= crossed - 1, out++) {
            uint bit = lowest_bit(crossed);
            uint edge = edge_at(s, origin, y, z, type, bit, row, even, zeros, in);
            ulong from =
                row_start(s, first.y + (edge >> 7 & 0xf), first.z + (edge >> 11 & 7)) + (uint)(first.x + (edge & 0x7f));
            long step = edge_step(s, edge);
            BITS a = in.samples[from], b = in.samples[from + step];
            float position[3], t = 0;
            if (!is_at_sample(edge)) t = crossing(SAMPLE_VALUE(a), SAMPLE_VALUE(b), ISOVALUE(&s->test));
#if GRID
            position_between(s, in, first, edge, from, step, t, position);
#else
            position_make(s, first, edge, t, position);
#endif
            for (uint m = 0; m < 3; m++) mesh.positions[3 * out + m] = position[m];
#if NORMALS
            normal_store(in, s, first, edge, t, mesh.normals + 3 * out);
#endif
        }
    }
}

#endif

/* -------------------------------------------------------------------------------------------------------- triangles */

/* The number of the vertex on an edge of the cube at a bit of row n, which is row (y, z) of word w. Edges at x = 64 are
 * owned by the first sample of the next word. */
inline_always uint vertex_number(const slab *s, uint y, uint z, uint w, uint n, uint bit, uint item, row_results k1,
                                 const local row_table *table) {
    const uint type = item & 7, x = bit + (item >> 3 & 1), next_y = item >> 4 & 1, next_z = item >> 5;
    if (x == 64) return number_of(row_numbers_of(s, y + next_y, z + next_z, w + 1, k1), type);
    n += next_y + TABLE_ROWS_Y * next_z;
    return number_of(table_numbers(table, n), type) + (uint)popcount(table->crossed[type][n] & ((1ul << x) - 1));
}

inline_always uint zeros_at(const cube_rows *r, uint bit) {
    uint zeros = 0;
#pragma unroll
    for (uint n = 0; n < 8 && ZEROS; n++) zeros |= (uint)(r->zero[n] >> bit & 1) << n;
    return zeros;
}

/* The signs of a cube's corners, corner n in bit n. */
inline_always uint pattern_at(const cube_rows *r, uint bit) {
    return (uint)(r->a0 >> bit & 1) | (uint)(r->a1 >> bit & 1) << 1 | (uint)(r->b0 >> bit & 1) << 2 |
           (uint)(r->b1 >> bit & 1) << 3 | (uint)(r->c0 >> bit & 1) << 4 | (uint)(r->c1 >> bit & 1) << 5 |
           (uint)(r->d0 >> bit & 1) << 6 | (uint)(r->d1 >> bit & 1) << 7;
}

/* Stores the triangles of an entry of the table of cases, from index `out` of the mesh on; returns how many. */
inline_always uint entry_store(const slab *s, uint y, uint z, uint w, uint n, uint bit, uint out,
                               global const uchar *entry, row_results k1, const local row_table *table,
                               mesh_buffers mesh) {
    const uint count = entry[0];
    for (uint m = 0; m < 3 * count; m++)
        mesh.triangles[3ul * out + m] = vertex_number(s, y, z, w, n, bit, entry[1 + m], k1, table);
    return count;
}

/* All triangles of row n of a table, in order, from index `out` of the mesh on: those of the surface, then those of the
 * border. */
inline_always void row_triangles(const slab *s, uint y, uint z, uint w, uint n, uint out, row_results k1,
                                 const local row_table *table, global const uchar *cases, mesh_buffers mesh) {
    const cube_rows r = row_cubes(s, y, z, w, true, true, k1);
    ulong active = cubes_active(&r);
#if MISSING
    active &= cells_at(s, k1.cells, y, z, w);
#endif
    for (; active; active &= active - 1) {
        uint bit = lowest_bit(active), odd = (uint)(~r.even >> bit & 1);
        global const uchar *entry = case_of(cases, odd, pattern_at(&r, bit), zeros_at(&r, bit));
        out += entry_store(s, y, z, w, n, bit, out, entry, k1, table, mesh);
    }
#if CLOSED
    const border_faces f = border_faces_of(s, k1.cells, y, z, w);
    for (ulong rest = border_faces_any(&f); rest; rest &= rest - 1) {
        const uint bit = lowest_bit(rest), odd = (uint)(~r.even >> bit & 1);
        const uint inside = pattern_at(&r, bit), zeros = zeros_at(&r, bit);
        uint faces = 0;
#pragma unroll
        for (uint face = 0; face < CAP_FACES; face++) faces |= (uint)(f.at[face] >> bit & 1) << face;
        for (; inside && faces; faces &= faces - 1) {
            global const uchar *entry = cases + CUBE_CASE_BYTES * border_case(odd, lowest_bit(faces), inside, zeros);
            out += entry_store(s, y, z, w, n, bit, out, entry, k1, table, mesh);
        }
    }
#endif
}

/* ------------------------------------------------------------------------------------------------------------ brick */

/* Emits a row of a brick. */
inline_always void row_emit(const slab *s, uint brick, uint brick_row, grid_arrays in, row_results k1,
                            global const uchar *cases, mesh_buffers mesh, const local row_table *table) {
    const grid_index origin = brick_origin(s, brick);
    const uint y = origin.y + brick_row % BRICK_ROWS, z = origin.z + brick_row / BRICK_ROWS;
    const uint n = brick_row % BRICK_ROWS + TABLE_ROWS_Y * (brick_row / BRICK_ROWS);
    const uint before = k1.bricks[brick].triangles + k1.triangle_offsets[BRICK_WORDS * brick + brick_row];
#ifdef REAL
    row_vertices(s, origin, y, z, n, in, k1, table, mesh);
#endif
    row_triangles(s, y, z, origin.x / 64, n, before - s->mesh.triangle_window, k1, table, cases, mesh);
}

/* Emits a brick, which 32 work-items share, where it is wanted. Called by the whole group. No variable lives
 * across its barriers, as some compilers make wrong code for that. */
inline_always void brick_emit(const slab *s, uint brick, bool wanted, grid_arrays in, row_results k1,
                              global const uchar *cases, mesh_buffers mesh, local emit_memory *memory,
                              brick_work *work) {
    local row_table *table = &memory->tables[get_local_id(0) / BRICK_WORDS];
    group_barrier();
    if (wanted) table_make(s, brick_origin(s, brick), k1, table);
    group_barrier();
    uint brick_row = (uint)get_local_id(0) % BRICK_WORDS;
    if (wanted && k1.bricks[brick].rows >> brick_row & 1) row_emit(s, brick, brick_row, in, k1, cases, mesh, table);
}

#endif
