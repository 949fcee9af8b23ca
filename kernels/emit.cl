/*
 * emit.cl - kernel 2: vertices and triangles of the bricks that have any
 *
 * Runs over the list that kernel 1 left. A vertex's number is where its brick's output begins, plus where its row's does,
 * plus where its edge type's does, plus the crossed edges of that type at lower x: a population count. Triangles come
 * from the table of a cube (2 parities x 256 patterns), which the host derives from the 16 cases of a tetrahedron.
 * Every row of 64 cubes needs the sign words of four rows of samples, and the numbers of edges that these rows own.
 */

#define CUBE_EDGES   18
#define EDGES_AT_X   13 /* the first of cube_edges belong to samples at x, the others at x + 1 */
#define CASE_BYTES   32
#define RUN_BRICKS   8  /* active bricks that a group takes at once */

/* cube_edges of host/lib/tables.h as row (bit 0: y + 1, bit 1: z + 1) and edge type. */
constant uchar edge_row[CUBE_EDGES] = {0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 0, 0, 0, 1, 2};
constant uchar edge_type[CUBE_EDGES] = {0, 1, 2, 3, 4, 5, 0, 2, 4, 0, 1, 3, 0, 1, 2, 5, 2, 1};

uint lowest_bit(ulong word) { return (uint)popcount(~word & (word - 1)); }

typedef struct mesh_buffers {
    global float *positions;
    global float *normals;
    global uint *triangles;
} mesh_buffers;

/* Number of the first vertex of a type that row (y, z) of brick column w owns. */
uint type_base(const slab *s, uint y, uint z, uint w, uint type, global const ulong *offsets,
               global const uint2 *bases) {
    uint slab_base = z < s->z1 ? s->vertex_base : s->vertex_base_next;
    return slab_base + bases[brick_index(s, y, z, w)].x + offset_of_type(offsets[word_index(s, y, z, w)], type);
}

#ifdef REAL

void row_vertices(const slab *s, uint y, uint z, uint w, const crossings *k, uint first, global const BITS *samples,
                  mesh_buffers mesh) {
    ulong even = even_cubes(s, y, z), out = (uint)(first - s->vertex_window);
    for (uint type = 0; type < 6; type++)
        for (ulong left = k->type[type]; left; left &= left - 1, out++) {
            uint bit = lowest_bit(left);
            edge e = edge_of(type, !(even >> bit & 1), 64 * w + bit, y, z);
            REAL a = SAMPLE_VALUE(samples[row_start(s, e.a[1], e.a[2]) + e.a[0]]);
            REAL b = SAMPLE_VALUE(samples[row_start(s, e.b[1], e.b[2]) + e.b[0]]);
            float t = crossing(a, b, ISOVALUE(s));
            position_store(s, &e, t, mesh.positions + 3 * out);
#if NORMALS
            normal_store(samples, s, &e, t, mesh.normals + 3 * out);
#endif
        }
}

#endif

/* The crossings that cube_edges names in the rows y + 1, z + 1 and both, seen from their own samples: parity alternates
 * from row to row. */
void crossings_of_rows(const cube_row *r, const crossings *own, ulong out[4][6]) {
    for (uint type = 0; type < 6; type++) out[0][type] = own->type[type];
    out[1][0] = r->b0 ^ r->b1;
    out[1][2] = r->b0 ^ r->d0;
    out[1][4] = choose(r->even, r->b1 ^ r->d0, r->b0 ^ r->d1);
    out[2][0] = r->c0 ^ r->c1;
    out[2][1] = r->c0 ^ r->d0;
    out[2][3] = choose(r->even, r->c1 ^ r->d0, r->c0 ^ r->d1);
    out[3][0] = r->d0 ^ r->d1;
}

uint pattern_at(const cube_row *r, uint bit) {
    return (uint)(r->a0 >> bit & 1) | (uint)(r->a1 >> bit & 1) << 1 | (uint)(r->b0 >> bit & 1) << 2 |
           (uint)(r->b1 >> bit & 1) << 3 | (uint)(r->c0 >> bit & 1) << 4 | (uint)(r->c1 >> bit & 1) << 5 |
           (uint)(r->d0 >> bit & 1) << 6 | (uint)(r->d1 >> bit & 1) << 7;
}

void row_triangles(const slab *s, uint y, uint z, uint w, const cube_row *r, ulong active, ulong rows[4][6],
                   uint out, global const ulong *offsets, global const uint2 *bases, global const uchar *cases,
                   mesh_buffers mesh) {
    ulong crossed[CUBE_EDGES];
    uint base[CUBE_EDGES];
    for (uint n = 0; n < CUBE_EDGES; n++) {
        uint row = edge_row[n], type = edge_type[n];
        crossed[n] = rows[row][type];
        base[n] = type_base(s, y + (row & 1), z + (row >> 1), w, type, offsets, bases);
    }
    for (ulong left = active; left; left &= left - 1) {
        uint bit = lowest_bit(left), number[CUBE_EDGES];
        ulong lower = (1ul << bit) - 1;
        for (uint n = 0; n < EDGES_AT_X; n++) number[n] = base[n] + (uint)popcount(crossed[n] & lower);
        lower = lower << 1 | 1;
        for (uint n = EDGES_AT_X; n < CUBE_EDGES; n++) number[n] = base[n] + (uint)popcount(crossed[n] & lower);
        if (bit == 63) /* x + 1 is the first sample of the next word */
            for (uint n = EDGES_AT_X; n < CUBE_EDGES; n++)
                number[n] = type_base(s, y + (edge_row[n] & 1), z + (edge_row[n] >> 1), w + 1, edge_type[n], offsets,
                                      bases);
        uint odd = !(r->even >> bit & 1);
        global const uchar *entry = cases + CASE_BYTES * (256 * odd + pattern_at(r, bit));
        uint index_count = 3 * (uint)entry[0];
        global uint *index = mesh.triangles + 3ul * out;
        for (uint n = 0; n < index_count; n++) index[n] = number[entry[1 + n]];
        out += entry[0];
    }
}

void row_emit(const slab *s, uint y, uint z, uint w, global const BITS *samples, global const ulong *cells,
              global const ulong *words, global const ulong *offsets, global const ushort *triangle_offsets,
              global const uint2 *bases, global const uchar *cases, mesh_buffers mesh) {
    global const ulong *a = words + word_index(s, y, z, 0);
    ulong plane = (ulong)s->ny * s->words_x;
    cube_row r = cube_row_load(s, y, z, w, a, a + s->words_x, a + plane, a + plane + s->words_x);
    crossings own = crossings_owned(&r);
    ulong active = cubes_active(&r);
    ulong rows[4][6];
#if MISSING
    crossings_keep(s, cells, y, z, w, &own);
    active &= cells_at(s, cells, y, z, w);
#endif
    crossings_of_rows(&r, &own, rows);
#if MISSING
    for (uint n = 1; n < 4; n++) {
        crossings k;
        for (uint type = 0; type < 6; type++) k.type[type] = rows[n][type];
        crossings_keep(s, cells, y + (n & 1), z + (n >> 1), w, &k);
        for (uint type = 0; type < 6; type++) rows[n][type] = k.type[type];
    }
#endif
#ifdef REAL
    row_vertices(s, y, z, w, &own, type_base(s, y, z, w, 0, offsets, bases), samples, mesh);
#endif
    if (active) {
        uint out = bases[brick_index(s, y, z, w)].y + triangle_offsets[word_index(s, y, z, w)] - s->triangle_window;
        row_triangles(s, y, z, w, &r, active, rows, out, offsets, bases, cases, mesh);
    }
}

/* Groups stay and take runs of active bricks by ticket; a work-item takes every row of a brick, or one of them. Bricks
 * outside [brick_first, brick_last) are left to another launch, where the mesh is larger than a buffer can be. */
kernel void emit(slab s, global const BITS *samples, global const ulong *cells, global const ulong *words,
                 global const ulong *offsets, global const ushort *triangle_offsets, global const uint2 *bases,
                 global const uint *masks, global const uint *active, global uint *state, global const uchar *cases,
                 global float *positions, global float *normals, global uint *triangles) {
    local uint shared[1];
    mesh_buffers mesh = {positions + s.position_offset, normals + s.position_offset, triangles + s.triangle_offset};
    global uint *head = state + s.head_offset;
    active += s.active_offset;
    uint active_count = head[STATE_ACTIVE_BRICKS], lid = (uint)get_local_id(0), run = 0;
    while (run < active_count) {
        group_barrier();
        if (lid == 0) shared[0] = RUN_BRICKS * atomic_inc(&head[STATE_EMIT_TICKET]);
        group_barrier();
        run = shared[0];
        uint end = min(run + RUN_BRICKS, active_count);
#if WORK_ITEMS == 1
        uint mine = ~0u;
        for (uint n = run; n < end; n++) {
#else
        uint mine = 1u << (lid % BRICK_WORDS);
        for (uint n = run + lid / BRICK_WORDS; n < end; n += WORK_ITEMS / BRICK_WORDS) {
#endif
            uint number = active[n], w = number % s.words_x;
            uint y0 = number / s.words_x % s.bricks_y * BRICK_ROWS;
            uint z0 = s.word_z + number / s.words_x / s.bricks_y * BRICK_PLANES;
            bool here = number >= s.brick_first && number < s.brick_last;
            for (uint rows = here ? masks[number] & mine : 0; rows; rows &= rows - 1) {
                uint place = lowest_bit(rows);
                row_emit(&s, y0 + place % BRICK_ROWS, z0 + place / BRICK_ROWS, w, samples, cells, words, offsets,
                         triangle_offsets, bases, cases, mesh);
            }
        }
    }
}
