/*
 * emit_rows.cl - kernel 2 where the work-items of a group share bricks: each takes a row of 64 cubes
 *
 * Vertices are stored one by one. The numbers of a cube's 18 vertices are population counts of the crossed edges at
 * lower x in the four rows of samples that the cubes lie between.
 */

#define CUBE_EDGES 18

#ifdef REAL

/* All vertices of a row of 64 samples, in order, from place `out` in the mesh on. */
inline_always void row_vertices(const slab *s, corner brick, uint y, uint z, uint w, const crossings *k, ulong out,
                                grid_arrays in, mesh_buffers mesh) {
    ulong even = even_cubes(s, y, z);
    uint row = (y - brick.y) << 7 | (z - brick.z) << 11;
    for (uint type = 0; type < EDGE_TYPES; type++) {
        for (ulong crossed = k->type[type]; crossed; crossed &= crossed - 1, out++) {
            uint bit = lowest_bit(crossed);
            uint place = edge_place(type, !(even >> bit & 1)) + row + bit;
            ulong from = row_start(s, brick.y + (place >> 7 & 0xf), z) + brick.x + (place & 0x7f);
            long step = place_step(s, place);
            BITS a = in.samples[from], b = in.samples[from + step];
            float position[3], t = crossing(SAMPLE_VALUE(a), SAMPLE_VALUE(b), ISOVALUE(s));
#if GRID
            position_between(s, in, brick, place, from, step, t, position);
#else
            position_make(s, brick, place, t, position);
#endif
            for (uint n = 0; n < 3; n++) mesh.positions[3 * out + n] = position[n];
#if NORMALS
            normal_store(in, s, brick, place, t, mesh.normals + 3 * out);
#endif
        }
    }
}

#endif

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

/* Numbers of the 18 vertices of the cube at a bit; those on edges that are not crossed are meaningless. */
inline_always void cube_vertices(const cube_numbers *n, uint bit, uint number[CUBE_EDGES]) {
    ulong at_x = (1ul << bit) - 1, at_x1 = at_x << 1 | 1;
    ulong8 below = (ulong8)(at_x, at_x, at_x, at_x, at_x, at_x1, at_x1, at_x1);
    vstore8(n->base_a + convert_uint8(popcount(n->crossed_a & at_x)), 0, number);
    vstore8(n->base_b + convert_uint8(popcount(n->crossed_b & below)), 1, number);
    number[16] = n->base_c[0] + (uint)popcount(n->crossed_c[0] & at_x1);
    number[17] = n->base_c[1] + (uint)popcount(n->crossed_c[1] & at_x1);
}

/* Edges at x + 1 of the last cube of a row are the first of the next word. */
inline_always void cube_vertices_next(const slab *s, uint y, uint z, uint w, uint number[CUBE_EDGES], row_results k1) {
    owner a = owner_of(s, y, z, w, k1);
    number[13] = number_of(a, 1), number[14] = number_of(a, 2), number[15] = number_of(a, 5);
    number[16] = number_of(owner_of(s, y + 1, z, w, k1), 2);
    number[17] = number_of(owner_of(s, y, z + 1, w, k1), 1);
}

inline_always void row_triangles(const slab *s, uint y, uint z, uint w, const cube_rows *r, ulong active,
                                 const cube_numbers *numbers, uint out, row_results k1, global const uchar *cases,
                                 mesh_buffers mesh) {
    ulong8 corners = (ulong8)(r->a0, r->a1, r->b0, r->b1, r->c0, r->c1, r->d0, r->d1);
    for (; active; active &= active - 1) {
        uint bit = lowest_bit(active), number[CUBE_EDGES];
        cube_vertices(numbers, bit, number);
        if (bit == 63) cube_vertices_next(s, y, z, w + 1, number, k1);
        uint odd = (uint)(~r->even >> bit & 1);
        global const uchar *entry = cases + CUBE_CASE_BYTES * (256 * odd + pattern_at(corners, bit));
        for (uint n = 0; n < 3u * entry[0]; n++) mesh.triangles[3ul * out + n] = number[entry[1 + n]];
        out += entry[0];
    }
}

/* The sign word of a row, and the same shifted; 0 outside the grid. */
inline_always sample_rows row_of(const slab *s, uint y, uint z, uint w, row_results k1) {
    if (y >= s->ny || z >= s->nz) return rows_shifted(0, 0);
    uint number = brick_index(s, y, z, w), place = row_place(s, y, z);
    ulong next = 0, at = brick_words(number, k1.bricks[number].sign, k1.words)[place] & word_valid(s, w);
    if (w + 1 < s->words_x) next = brick_words(number + 1, k1.bricks[number + 1].sign, k1.words)[place];
    return rows_shifted(at, next);
}

/* The crossings of the rows y + 1, z + 1 and both that a cube names, seen from their own samples: parity alternates
 * from row to row. */
inline_always void crossings_beside(const cube_rows *r, crossings *b, crossings *c, crossings *d) {
    b->type[0] = r->b0 ^ r->b1;
    b->type[2] = r->b0 ^ r->d0;
    if (!HYBRID) b->type[4] = choose(r->even, r->b1 ^ r->d0, r->b0 ^ r->d1);
    c->type[0] = r->c0 ^ r->c1;
    c->type[1] = r->c0 ^ r->d0;
    if (!HYBRID) c->type[3] = choose(r->even, r->c1 ^ r->d0, r->c0 ^ r->d1);
    d->type[0] = r->d0 ^ r->d1;
}

inline_always void row_emit(const slab *s, corner brick, uint number, uint place, grid_arrays in, row_results k1,
                            global const uchar *cases, mesh_buffers mesh) {
    uint y = brick.y + place % BRICK_ROWS, z = brick.z + place / BRICK_ROWS, w = brick.x / 64;
    cube_rows r = cube_rows_of(s, y, z, w, row_of(s, y, z, w, k1), row_of(s, y + 1, z, w, k1),
                               row_of(s, y, z + 1, w, k1), row_of(s, y + 1, z + 1, w, k1));
    crossings a = crossings_owned(&r);
    ulong active = cubes_active(&r);
#if MISSING
    crossings_keep(s, k1.cells, y, z, w, &a);
    active &= cells_at(s, k1.cells, y, z, w);
#endif
    const owner own = owner_of(s, y, z, w, k1);
#ifdef REAL
    row_vertices(s, brick, y, z, w, &a, (uint)(number_of(own, 0) - s->vertex_window), in, mesh);
#endif
    if (!active) return;
    crossings b = {{0, 0, 0, 0, 0, 0}}, c = b, d = b;
    crossings_beside(&r, &b, &c, &d);
#if MISSING
    crossings_keep(s, k1.cells, y + 1, z, w, &b);
    crossings_keep(s, k1.cells, y, z + 1, w, &c);
    crossings_keep(s, k1.cells, y + 1, z + 1, w, &d);
#endif
    const owner owners[4] = {own, owner_of(s, y + 1, z, w, k1), owner_of(s, y, z + 1, w, k1),
                             owner_of(s, y + 1, z + 1, w, k1)};
    cube_numbers numbers = cube_numbers_of(&a, &b, &c, &d, owners);
    uint before = k1.bricks[number].triangles + k1.triangle_offsets[BRICK_WORDS * number + place];
    row_triangles(s, y, z, w, &r, active, &numbers, before - s->triangle_window, k1, cases, mesh);
}

/* What kernel 2 needs of private memory: nothing here. */
typedef struct brick_work {
    uint none;
} brick_work;

inline_always void brick_work_begin(const slab *s, brick_work *work) { work->none = 0; }

/* Others of the group work while one waits for memory. */
inline_always void next_prefetch(const slab *s, global const uint *active, uint count, row_results k1,
                                 global const BITS *samples) {}

/* The work-item's row of brick `number`. */
inline_always void brick_emit(const slab *s, uint number, corner brick, grid_arrays in, row_results k1,
                              global const uchar *cases, mesh_buffers mesh, brick_work *work) {
    uint place = (uint)get_local_id(0) % BRICK_WORDS;
    if (k1.bricks[number].rows >> place & 1) row_emit(s, brick, number, place, in, k1, cases, mesh);
}
