/*
 * emit.cl - kernel 2: vertices and triangles of the bricks that have any
 *
 * Runs over the list that kernel 1 left. A vertex's number is where its brick's output begins, plus where its row's
 * does, plus where its edge type's does, plus the crossed edges of that type at lower x: a population count. Triangles
 * come from the table of a cube (2 parities x 256 patterns), which the host derives from the 16 cases of a tetrahedron.
 * Every row of 64 cubes needs the sign words of four rows of samples, and the numbers of edges that these rows own.
 */

#define CUBE_EDGES 18
#define CASE_BYTES 32
#define RUN_BRICKS 8 /* active bricks that a group takes at once */

inline_always uint lowest_bit(ulong word) { return (uint)popcount(~word & (word - 1)); }

typedef struct mesh_buffers {
    global float *positions;
    global float *normals;
    global uint *triangles;
} mesh_buffers;

/* -------------------------------------------------------------------------------------------------------- vertices */

/* Crossed edges of a brick in the order of their vertices: where they are, and the samples at their ends. A work-item
 * with a brick to itself collects them first, so that the arithmetic runs over arrays; others store at once. */
#define BATCH_EDGES 1024
#define BATCH_STEP  16

typedef struct vertex_batch {
    corner brick;
    ulong out; /* place of the next vertex in the mesh */
    uint count;
#if WORK_ITEMS == 1
    uint place[BATCH_EDGES];
    BITS a[BATCH_EDGES], b[BATCH_EDGES];
#endif
} vertex_batch;

/* Without REAL (a wide type on a device without fp64) the host makes the vertices. */
#ifdef REAL

#if WORK_ITEMS == 1

inline_always void batch_add(vertex_batch *batch, const slab *s, uint place, BITS a, BITS b, global const BITS *samples,
                             mesh_buffers mesh) {
    batch->place[batch->count] = place;
    batch->a[batch->count] = a;
    batch->b[batch->count] = b;
    batch->count++;
}

/* By steps of a fixed length into private arrays, which is what compilers turn into vector code. */
inline_always void batch_flush(vertex_batch *batch, const slab *s, global const BITS *samples, mesh_buffers mesh) {
    const corner brick = batch->brick;
    for (uint first = 0; first < batch->count; first += BATCH_STEP) {
        float t[BATCH_STEP], positions[3 * BATCH_STEP];
        for (uint n = 0; n < BATCH_STEP; n++) {
            t[n] = crossing(SAMPLE_VALUE(batch->a[first + n]), SAMPLE_VALUE(batch->b[first + n]), ISOVALUE(s));
            position_make(s, brick, batch->place[first + n], t[n], positions + 3 * n);
        }
        global float *out = mesh.positions + 3 * (batch->out + first);
        uint count = min(batch->count - first, (uint)BATCH_STEP);
        if (count == BATCH_STEP)
            for (uint n = 0; n < 3; n++) vstore16(vload16(n, positions), n, out);
        else
            for (uint n = 0; n < 3 * count; n++) out[n] = positions[n];
#if NORMALS
        for (uint n = 0; n < count; n++)
            normal_store(samples, s, brick, batch->place[first + n], t[n], mesh.normals + 3 * (batch->out + first + n));
#endif
    }
    batch->out += batch->count;
    batch->count = 0;
}

#else

inline_always void batch_add(vertex_batch *batch, const slab *s, uint place, BITS a, BITS b, global const BITS *samples,
                             mesh_buffers mesh) {
    float position[3], t = crossing(SAMPLE_VALUE(a), SAMPLE_VALUE(b), ISOVALUE(s));
    position_make(s, batch->brick, place, t, position);
    for (uint n = 0; n < 3; n++) mesh.positions[3 * batch->out + n] = position[n];
#if NORMALS
    normal_store(samples, s, batch->brick, place, t, mesh.normals + 3 * batch->out);
#endif
    batch->out++;
}

#endif

/* The crossed edges of one type in a row. In even cubes the edge runs from the row's sample to the one `far` further
 * on; in odd ones a diagonal starts `near_odd` samples further on instead and ends at far_odd. */
inline_always void edges_add(vertex_batch *batch, const slab *s, ulong crossed, ulong even, ulong start, ulong far,
                             uint place, ulong near_odd, ulong far_odd, uint place_odd, global const BITS *samples,
                             mesh_buffers mesh) {
    for (; crossed; crossed &= crossed - 1) {
        uint bit = lowest_bit(crossed);
        bool odd = !(even >> bit & 1);
        batch_add(batch, s, (odd ? place_odd : place) + bit, samples[start + bit + (odd ? near_odd : 0)],
                  samples[start + bit + (odd ? far_odd : far)], samples, mesh);
    }
}

/* All vertices of a row of 64 samples, in order. */
inline_always void row_vertices(vertex_batch *batch, const slab *s, uint y, uint z, uint w, const crossings *k,
                                global const BITS *samples, mesh_buffers mesh) {
    ulong even = even_cubes(s, y, z), start = row_start(s, y, z) + 64ul * w, ny = s->nx, nz = (ulong)s->nx * s->ny;
    uint at = (y - batch->brick.y) << 7 | (z - batch->brick.z) << 11;
    edges_add(batch, s, k->type[0], ~0ul, start, 1, at + PLACE(0, 0, 0, 1, 0, 0), 0, 0, 0, samples, mesh);
    edges_add(batch, s, k->type[1], ~0ul, start, ny, at + PLACE(0, 0, 0, 0, 1, 0), 0, 0, 0, samples, mesh);
    edges_add(batch, s, k->type[2], ~0ul, start, nz, at + PLACE(0, 0, 0, 0, 0, 1), 0, 0, 0, samples, mesh);
    edges_add(batch, s, k->type[3], even, start, ny + 1, at + PLACE(0, 0, 0, 1, 1, 0), 1, ny,
              at + PLACE(1, 0, 0, -1, 1, 0), samples, mesh);
    edges_add(batch, s, k->type[4], even, start, nz + 1, at + PLACE(0, 0, 0, 1, 0, 1), 1, nz,
              at + PLACE(1, 0, 0, -1, 0, 1), samples, mesh);
    edges_add(batch, s, k->type[5], even, start, ny + nz, at + PLACE(0, 0, 0, 0, 1, 1), ny, nz,
              at + PLACE(0, 1, 0, 0, -1, 1), samples, mesh);
}

#endif

/* ------------------------------------------------------------------------------------------------------- triangles */

/* Where the numbers of the vertices that a row of 64 samples owns begin. */
typedef struct owner {
    uint first;
    ulong packed;
} owner;

inline_always owner owner_of(const slab *s, uint y, uint z, uint w, global const ulong *offsets,
                             global const uint2 *bases) {
    owner o;
    o.packed = offsets[word_index(s, y, z, w)];
    o.first = (z < s->z1 ? s->vertex_base : s->vertex_base_next) + bases[brick_index(s, y, z, w)].x;
    return o;
}

inline_always uint number_of(owner o, uint type) { return o.first + offset_of_type(o.packed, type); }

/* A row of 64 cubes: the crossed edges of the four rows of samples and the numbers of their first vertices, in the
 * order of cube_edges (host/lib/tables.h): 13 of samples at x, 5 of samples at x + 1. */
typedef struct cube_numbers {
    ulong8 crossed_a, crossed_b;
    ulong crossed_c[2];
    uint8 base_a, base_b;
    uint base_c[2];
} cube_numbers;

inline_always cube_numbers cube_numbers_of(const crossings *a, const crossings *b, const crossings *c,
                                           const crossings *d, const owner o[4]) {
    cube_numbers n;
    n.crossed_a =
        (ulong8)(a->type[0], a->type[1], a->type[2], a->type[3], a->type[4], a->type[5], b->type[0], b->type[2]);
    n.crossed_b =
        (ulong8)(b->type[4], c->type[0], c->type[1], c->type[3], d->type[0], a->type[1], a->type[2], a->type[5]);
    n.crossed_c[0] = b->type[2], n.crossed_c[1] = c->type[1];
    n.base_a = (uint8)(number_of(o[0], 0), number_of(o[0], 1), number_of(o[0], 2), number_of(o[0], 3),
                       number_of(o[0], 4), number_of(o[0], 5), number_of(o[1], 0), number_of(o[1], 2));
    n.base_b = (uint8)(number_of(o[1], 4), number_of(o[2], 0), number_of(o[2], 1), number_of(o[2], 3),
                       number_of(o[3], 0), number_of(o[0], 1), number_of(o[0], 2), number_of(o[0], 5));
    n.base_c[0] = number_of(o[1], 2), n.base_c[1] = number_of(o[2], 1);
    return n;
}

/* popcount of a vector, in the form that compilers know: some built-in ones go element by element. */
inline_always ulong8 popcount8(ulong8 x) {
    x -= (x >> 1) & 0x5555555555555555ul;
    x = (x & 0x3333333333333333ul) + ((x >> 2) & 0x3333333333333333ul);
    x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0ful;
    return (x * 0x0101010101010101ul) >> 56;
}

/* Numbers of the 18 vertices of the cube at a bit; those on edges that are not crossed are meaningless. */
inline_always void cube_vertices(const cube_numbers *n, uint bit, uint number[CUBE_EDGES]) {
    ulong at_x = (1ul << bit) - 1, at_x1 = at_x << 1 | 1;
    ulong8 below = (ulong8)(at_x, at_x, at_x, at_x, at_x, at_x1, at_x1, at_x1);
    vstore8(n->base_a + convert_uint8(popcount8(n->crossed_a & at_x)), 0, number);
    vstore8(n->base_b + convert_uint8(popcount8(n->crossed_b & below)), 1, number);
    number[16] = n->base_c[0] + (uint)popcount(n->crossed_c[0] & at_x1);
    number[17] = n->base_c[1] + (uint)popcount(n->crossed_c[1] & at_x1);
}

/* Edges at x + 1 of the last cube of a row are the first of the next word. */
inline_always void cube_vertices_next(const slab *s, uint y, uint z, uint w, uint number[CUBE_EDGES],
                                      global const ulong *offsets, global const uint2 *bases) {
    owner a = owner_of(s, y, z, w, offsets, bases);
    number[13] = number_of(a, 1), number[14] = number_of(a, 2), number[15] = number_of(a, 5);
    number[16] = number_of(owner_of(s, y + 1, z, w, offsets, bases), 2);
    number[17] = number_of(owner_of(s, y, z + 1, w, offsets, bases), 1);
}

/* The signs of a cube's corners, corner n in bit n. */
inline_always uint pattern_at(ulong8 corners, uint bit) {
    char8 inside = convert_char8((corners & (ulong8)(1ul << bit)) != 0ul);
    return (uint)(((as_ulong(inside) & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56);
}

inline_always void row_triangles(const slab *s, uint y, uint z, uint w, const cube_row *r, ulong active,
                                 const cube_numbers *numbers, uint out, global const ulong *offsets,
                                 global const uint2 *bases, global const uchar *cases, mesh_buffers mesh) {
    ulong8 corners = (ulong8)(r->a0, r->a1, r->b0, r->b1, r->c0, r->c1, r->d0, r->d1);
    for (; active; active &= active - 1) {
        uint bit = lowest_bit(active), number[CUBE_EDGES];
        cube_vertices(numbers, bit, number);
        if (bit == 63) cube_vertices_next(s, y, z, w + 1, number, offsets, bases);
        uint odd = (uint)(~r->even >> bit & 1);
        global const uchar *entry = cases + CASE_BYTES * (256 * odd + pattern_at(corners, bit));
        global const uchar *edge = entry + 1;
        global uint *index = mesh.triangles + 3ul * out;
        out += entry[0];
#pragma clang loop vectorize(disable) /* four or five rounds: gathers cost more */
        for (uint n = entry[0]; n; n--, edge += 3, index += 3) {
            index[0] = number[edge[0]];
            index[1] = number[edge[1]];
            index[2] = number[edge[2]];
        }
    }
}

/* ------------------------------------------------------------------------------------------------------------ rows */

/* The crossings of the rows y + 1, z + 1 and both that a cube names, seen from their own samples: parity alternates
 * from row to row. */
inline_always void crossings_beside(const cube_row *r, crossings *b, crossings *c, crossings *d) {
    b->type[0] = r->b0 ^ r->b1;
    b->type[2] = r->b0 ^ r->d0;
    b->type[4] = choose(r->even, r->b1 ^ r->d0, r->b0 ^ r->d1);
    c->type[0] = r->c0 ^ r->c1;
    c->type[1] = r->c0 ^ r->d0;
    c->type[3] = choose(r->even, r->c1 ^ r->d0, r->c0 ^ r->d1);
    d->type[0] = r->d0 ^ r->d1;
}

typedef struct row_results {
    global const ulong *words, *offsets, *cells;
    global const ushort *triangle_offsets;
    global const uint2 *bases;
} row_results; /* of kernel 1 */

inline_always void row_emit(vertex_batch *batch, const slab *s, uint y, uint z, uint w, uint triangle_base,
                            global const BITS *samples, row_results k1, global const uchar *cases, mesh_buffers mesh) {
    global const ulong *row = k1.words + word_index(s, y, z, 0);
    ulong plane = (ulong)s->ny * s->words_x;
    cube_row r = cube_row_load(s, y, z, w, row, row + s->words_x, row + plane, row + plane + s->words_x);
    crossings a = crossings_owned(&r);
    ulong active = cubes_active(&r);
#if MISSING
    crossings_keep(s, k1.cells, y, z, w, &a);
    active &= cells_at(s, k1.cells, y, z, w);
#endif
#ifdef REAL
    row_vertices(batch, s, y, z, w, &a, samples, mesh);
#endif
    if (!active) return;
    crossings b = {{0, 0, 0, 0, 0, 0}}, c = b, d = b;
    crossings_beside(&r, &b, &c, &d);
#if MISSING
    crossings_keep(s, k1.cells, y + 1, z, w, &b);
    crossings_keep(s, k1.cells, y, z + 1, w, &c);
    crossings_keep(s, k1.cells, y + 1, z + 1, w, &d);
#endif
    const owner owners[4] = {owner_of(s, y, z, w, k1.offsets, k1.bases), owner_of(s, y + 1, z, w, k1.offsets, k1.bases),
                             owner_of(s, y, z + 1, w, k1.offsets, k1.bases),
                             owner_of(s, y + 1, z + 1, w, k1.offsets, k1.bases)};
    cube_numbers numbers = cube_numbers_of(&a, &b, &c, &d, owners);
    row_triangles(s, y, z, w, &r, active, &numbers, triangle_base + k1.triangle_offsets[word_index(s, y, z, w)],
                  k1.offsets, k1.bases, cases, mesh);
}

/* The rows of brick `number` that are in mask. */
inline_always void brick_emit(const slab *s, uint number, uint mask, vertex_batch *batch, global const BITS *samples,
                              row_results k1, global const uchar *cases, mesh_buffers mesh) {
    uint w = number % s->words_x;
    corner brick = {64 * w, number / s->words_x % s->bricks_y * BRICK_ROWS,
                    s->word_z + number / s->words_x / s->bricks_y * BRICK_PLANES};
    uint2 base = k1.bases[number];
    batch->brick = brick;
    batch->count = 0;
    for (bool first = true; mask; mask &= mask - 1, first = false) {
        uint place = lowest_bit(mask), y = brick.y + place % BRICK_ROWS, z = brick.z + place / BRICK_ROWS;
        if (first) {
            uint row_first = (uint)k1.offsets[word_index(s, y, z, w)] & 0x3fff;
            batch->out = (uint)(s->vertex_base + base.x + row_first - s->vertex_window);
        }
        row_emit(batch, s, y, z, w, base.y - s->triangle_window, samples, k1, cases, mesh);
#if defined(REAL) && WORK_ITEMS == 1
        if (batch->count + 6 * 64 > BATCH_EDGES) batch_flush(batch, s, samples, mesh);
#endif
    }
#if defined(REAL) && WORK_ITEMS == 1
    batch_flush(batch, s, samples, mesh);
#endif
}

/* Groups stay and take runs of active bricks by ticket; a work-item takes every row of a brick, or one of them. Bricks
 * outside [brick_first, brick_last) are left to another launch, where the mesh is larger than a buffer can be. */
kernel void emit(slab s, global const BITS *samples, global const ulong *cells, global const ulong *words,
                 global const ulong *offsets, global const ushort *triangle_offsets, global const uint2 *bases,
                 global const uint *masks, global const uint *active, global uint *state, global const uchar *cases,
                 global float *positions, global float *normals, global uint *triangles) {
    local uint shared[1];
    mesh_buffers mesh = {positions + s.position_offset, normals + s.position_offset, triangles + s.triangle_offset};
    row_results k1 = {words, offsets, cells, triangle_offsets, bases};
    vertex_batch batch;
    global uint *head = state + s.head_offset;
    active += s.active_offset;
    uint active_count = head[STATE_ACTIVE_BRICKS], lid = (uint)get_local_id(0), run = 0;
    uint mine = WORK_ITEMS == 1 ? ~0u : 1u << (lid % BRICK_WORDS);
    while (run < active_count) {
        group_barrier();
        if (lid == 0) shared[0] = RUN_BRICKS * atomic_inc(&head[STATE_EMIT_TICKET]);
        group_barrier();
        run = shared[0];
        uint end = min(run + RUN_BRICKS, active_count);
        for (uint step = run; step < end; step += (WORK_ITEMS + BRICK_WORDS - 1) / BRICK_WORDS) {
            uint n = step + lid / BRICK_WORDS, number = n < end ? active[n] : 0;
            if (n < end && number >= s.brick_first && number < s.brick_last)
                brick_emit(&s, number, masks[number] & mine, &batch, samples, k1, cases, mesh);
        }
    }
}
