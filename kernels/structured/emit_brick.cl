/*
 * emit_brick.cl - kernel 2 where a work-item has bricks to itself: passes over the 32 rows of a brick, eight rows at
 * once
 *
 * Steps 1 and 2 are in emit_numbers.cl.
 * 3. Vector code makes the vertices of the listed edges.
 * 4. Active cubes are listed with their cases. The numbers of a cube's vertices come into slots (case_slots.h), from
 * which its case takes the indices of its triangles.
 *
 * Cases have different numbers of indices, which are unpredictable. So a fixed number is copied for each cube, and the
 * next cube overwrites the surplus. Positions and triangles go through private memory, batch by batch, and from there
 * to the mesh in whole cache lines.
 */
#ifndef EMIT_BRICK_CL
#define EMIT_BRICK_CL

#include "emit_numbers.cl"
#include "vertex.cl"

#define PARITY_BIT (ZEROS ? 16 : 8) /* of a case, after a pattern's bits and those of zero corners */
#define BORDER_BIT 17               /* with zeros: an entry's index in place of a case */
#define CASE_BITS  (CLOSED ? (ZEROS ? BORDER_BIT + 1 : 11) : PARITY_BIT + 1)
#define CASE_STEP  (3 * OF_METHOD(triangles_usual)) /* indices that are copied at once, as many as most cubes have */
#define BATCH_STEP 16

/* The signs of a cube's corners, corner n in bit n. */
inline_always uint pattern_at(ulong8 corners, uint bit) {
#ifdef WORD_SHUFFLES
    return signs_packed(corners << (ulong8)(63 - bit));
#endif
    char8 inside = convert_char8((corners & (ulong8)(1ul << bit)) != 0ul);
    return (uint)(((as_ulong(inside) & 0x8040201008040201ul) * 0x0101010101010101ul) >> 56);
}

/* --------------------------------------------------------------------------------------------------------- vertices */

#ifdef REAL

/* Loads the samples at the ends of listed edges, and prefetches their points. */
inline_always void batch_gather(const slab *s, const uint *list, uint count, grid_arrays in, brick_work *work) {
    for (uint n = 0; n < count; n++) {
        const ulong sample = work->row_start[list[n] >> 7 & 0x7f] + (list[n] & 0x7f);
        const long step = work->step[list[n] >> 14];
        global const BITS *from = in.samples + sample;
        work->a[n] = *from;
        work->b[n] = from[step];
        if (CLOSED)
            work->b[n] = step ? work->b[n] : (BITS) ~*from; /* any other value, so that the difference is not 0 */
#if GRID == 2
        global const float *p0 = in.coordinates + (3 * sample + s->arrays.point_offset);
        line_prefetch(p0);
        line_prefetch(p0 + 3 * step);
#endif
    }
}

/* Makes a batch of vertices, BATCH_STEP at a time into private arrays: loops of fixed length, which compilers
 * vectorise. */
inline_always void batch_store(const slab *s, grid_index origin, const uint *list, uint count, ulong out,
                               grid_arrays in, mesh_buffers mesh, brick_work *work) {
    for (uint first = 0; first < count; first += BATCH_STEP) {
        float t[BATCH_STEP], positions[3 * BATCH_STEP];
#if GRID || NORMALS
        uint left = min(count - first, (uint)BATCH_STEP);
#endif
        for (uint n = 0; n < BATCH_STEP; n++) {
            t[n] = crossing(SAMPLE_VALUE(work->a[first + n]), SAMPLE_VALUE(work->b[first + n]), ISOVALUE(&s->test));
            if (CLOSED) t[n] = is_at_sample(list[first + n]) ? 0 : t[n];
#if GRID == 0
            position_make(s, origin, list[first + n], t[n], positions + 3 * n);
#endif
        }
#if GRID /* items past the end of the list are no valid edges */
        for (uint n = 0; n < left; n++) {
            uint edge = list[first + n];
            position_between(s, in, origin, edge, work->row_start[edge >> 7 & 0x7f] + (edge & 0x7f),
                             work->step[edge >> 14], t[n], positions + 3 * n);
        }
#endif
        for (uint n = 0; n < 3; n++)
            *(words16 *)(work->positions + 3 * first + 16 * n) = *(const words16 *)(positions + 16 * n);
#if NORMALS
        for (uint n = 0; n < left; n++)
            normal_store(in, s, origin, list[first + n], t[n], mesh.normals + 3 * (out + first + n));
#endif
    }
    lines_store(work->positions, 3 * count, mesh.positions + 3 * out);
}

inline_always void vertices_emit(const slab *s, grid_index origin, uint count, ulong out, grid_arrays in,
                                 mesh_buffers mesh, brick_work *work) {
    origin = edges_origin(origin);
    for (uint z = 0; z < BRICK_PLANES + EDGES_BEFORE; z++)
        for (uint y = 0; y <= BRICK_ROWS + EDGES_BEFORE; y++)
            work->row_start[y | z << 4] = row_start(s, origin.y + y, origin.z + z) + (ulong)(int)origin.x;
    if (ZEROS) {
        snapped_turn(s, false, &work->snapped, work->link_codes, work->row_start, in.samples, work->list);
        snapped_turn(s, true, &work->snapped, work->link_codes, work->row_start, in.samples, work->list);
    }
    for (uint first = 0; first < count; first += BATCH_EDGES) {
        uint batch = min(count - first, (uint)BATCH_EDGES);
        batch_gather(s, work->list + first, batch, in, work);
        batch_store(s, origin, work->list + first, batch, out + first, in, mesh, work);
    }
}

#endif

/* -------------------------------------------------------------------------------------------------------- triangles */

/* Both forms of cubes_list append the active cubes of the rows in `mask` to the list, which has `count` items, and
 * return how many it has then. An item is a cube's index in the table of numbers from bit CASE_BITS on, below that its
 * case. With mask registers, patterns of all rows are made first: loading a part of a vector that was just stored would
 * stall. */
#ifdef MASK_REGISTERS
/* Patterns of 64 cubes, from words of their rows in this plane and in the next. */
inline_always bytes64 row_patterns(const ulong *row, const ulong *next_z) {
    bytes64 patterns = 0;
    loop_unrolled for (uint n = 0; n < 4; n++) {
        patterns |= bits_spread(row[n]) & (bytes64)(char)(1 << n);
        patterns |= bits_spread(next_z[n]) & (bytes64)(char)(16 << n);
    }
    return patterns;
}

inline_always uint cubes_list(const slab *s, uint mask, uint count, brick_work *work) {
    const uint16 lane = (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    for (uint rows = mask; rows; rows &= rows - 1) {
        uint brick_row = lowest_bit(rows), y = brick_row % BRICK_ROWS, z = brick_row / BRICK_ROWS;
        work->patterns[brick_row] = row_patterns(work->corners[z] + 2 * y, work->corners[z + 1] + 2 * y);
        if (ZEROS)
            work->zero_patterns[brick_row] =
                row_patterns(work->zero_corners[z] + 2 * y, work->zero_corners[z + 1] + 2 * y);
    }
    for (; mask; mask &= mask - 1) {
        uint brick_row = lowest_bit(mask), y = brick_row % BRICK_ROWS, z = brick_row / BRICK_ROWS, x = 0;
        const uchar *patterns = (const uchar *)&work->patterns[brick_row];
        const uchar *zero_patterns = (const uchar *)&work->zero_patterns[ZEROS ? brick_row : 0];
        ulong active = work->active[z][y];
        do {
            uint skipped = lowest_bit(active);
            x += skipped, active >>= skipped;
            uint16 odd = (lane ^ x ^ row_odd(s, y, z)) & 1, number = NUMBER_INDEX(x, y, z) + lane;
            uint16 items = convert_uint16(vload16(0, patterns + x)) | odd << PARITY_BIT | number << CASE_BITS;
            if (ZEROS) items |= convert_uint16(vload16(0, zero_patterns + x)) << 8;
            count += items_keep(items, active, work->list + count);
            x += 16, active >>= 16;
        } while (active);
    }
    return count;
}
#else
inline_always uint cubes_list(const slab *s, uint mask, uint count, brick_work *work) {
    for (; mask; mask &= mask - 1) {
        const uint brick_row = lowest_bit(mask), y = brick_row % BRICK_ROWS, z = brick_row / BRICK_ROWS;
        const ulong8 corners = (ulong8)(vload4(0, work->corners[z] + 2 * y), vload4(0, work->corners[z + 1] + 2 * y));
        ulong8 zero_corners = 0;
        if (ZEROS)
            zero_corners =
                (ulong8)(vload4(0, work->zero_corners[z] + 2 * y), vload4(0, work->zero_corners[z + 1] + 2 * y));
        ulong active = work->active[z][y];
        const uint end = count + (uint)popcount(active);
        do {
            const uint x = lowest_bit(active), odd = (x ^ row_odd(s, y, z)) & 1;
            uint pattern = pattern_at(corners, x) | odd << PARITY_BIT;
            if (ZEROS) pattern |= pattern_at(zero_corners, x) << 8;
            work->list[count++] = pattern | NUMBER_INDEX(x, y, z) << CASE_BITS;
            active &= active - 1;
        } while (active);
        count = end;
    }
    return count;
}
#endif

#if CLOSED

/* Lists the faces on the border of the cubes of a row of the brick; `at` has a word for each row of its plane. */
inline_always uint faces_list(const slab *s, uint y, uint z, const ulong at[CAP_FACES][BRICK_ROWS], uint count,
                              brick_work *work) {
    const ulong8 corners = (ulong8)(vload4(0, work->corners[z] + 2 * y), vload4(0, work->corners[z + 1] + 2 * y));
    ulong8 zero_corners = 0;
    if (ZEROS)
        zero_corners = (ulong8)(vload4(0, work->zero_corners[z] + 2 * y), vload4(0, work->zero_corners[z + 1] + 2 * y));
    const uint border = ZEROS ? 1u << BORDER_BIT : 0;
    const ulong any = at[0][y] | at[1][y] | at[2][y] | at[3][y] | at[4][y] | at[5][y];
    for (ulong rest = any; rest; rest &= rest - 1) {
        const uint x = lowest_bit(rest), inside = pattern_at(corners, x), odd = (x ^ row_odd(s, y, z)) & 1;
        const uint zeros = ZEROS ? pattern_at(zero_corners, x) : 0;
        for (uint face = 0; face < CAP_FACES && inside; face++)
            if (at[face][y] >> x & 1)
                work->list[count++] =
                    border_case(odd, face, inside, zeros) | border | NUMBER_INDEX(x, y, z) << CASE_BITS;
    }
    return count;
}

/* Lists the active cubes of each row in mask, and behind them its faces on the border. */
inline_always uint border_list(const slab *s, grid_index origin, uint mask, row_results k1, brick_work *work) {
    ulong at[CAP_FACES][BRICK_ROWS];
    uint count = 0;
    for (uint z = 0; z < BRICK_PLANES; z++) {
        const border_faces f = border_faces_of(s, k1.cells, origin.y, origin.z + z, origin.x / 64);
        for (uint face = 0; face < CAP_FACES; face++) vstore8(f.at[face], 0, at[face]);
        for (uint rows = mask >> (BRICK_ROWS * z) & ((1u << BRICK_ROWS) - 1); rows; rows &= rows - 1) {
            const uint y = lowest_bit(rows);
            count = cubes_list(s, 1u << (BRICK_ROWS * z + y), count, work);
            count = faces_list(s, y, z, at, count, work);
        }
    }
    return count;
}

#endif

/* Both forms of case_store: stores the vertex numbers of a cube's triangles, by the slots in its case. Surplus
 * numbers follow them. `number` points to the numbers of the cube's first sample. */
#ifdef WORD_SHUFFLES
#define WORDS_AT(words) (*(const words16 *)(words))

/* Brings the numbers of a cube's vertices into their slots. Numbers that are as far apart in the table as their slots
 * are loaded together. */
inline_always void slots_fill(const uint *number, uint16 *low, uint16 *high) {
    uint16 slots[2] = {0, 0};
#define SLOT(slot, x, y, z, type)                                                                                      \
    if ((type) < VERTEX_TYPES)                                                                                         \
        slots[(slot) / 16] = words_with(slots[(slot) / 16], 1 << (slot) % 16,                                          \
                                        WORDS_AT(number + NUMBER_AT(x, y, z, type) - (slot) % 16));
    if (NUMBER_STEP == 8) {
        SLOTS_OF_EIGHT(SLOT)
    } else {
        SLOTS_OF_FOUR(SLOT)
    }
#undef SLOT
    *low = slots[0], *high = slots[1];
}

inline_always void case_store(const uint *number, global const uchar *entry, uint *out, const brick_work *work) {
    uint16 low, high;
    slots_fill(number, &low, &high);
    *(words16 *)out = words_shuffled(low, high, *(global const bytes16 *)(entry + 1), VERTEX_TYPES > AT_SAMPLE_TYPE);
#ifndef MASK_REGISTERS /* few cubes have more than five triangles, and a shuffle takes several instructions here */
    if (entry[0] <= 5) return;
#endif
    *(words16 *)(out + 15) =
        words_shuffled(low, high, *(global const bytes16 *)(entry + 16), VERTEX_TYPES > AT_SAMPLE_TYPE);
}
#else
inline_always void case_store(const uint *number, global const uchar *entry, uint *out, const brick_work *work) {
    loop_copied for (uint n = 0; n < CASE_STEP; n++) out[n] = number[work->slot_index[entry[1 + n]]];
    if (3 * entry[0] > CASE_STEP)
        loop_copied for (uint n = CASE_STEP; n < CASE_ITEMS; n++) out[n] = number[work->slot_index[entry[1 + n]]];
}
#endif

/* The entry in the table of cases; item: of the list, its lower CASE_BITS. */
inline_always global const uchar *entry_of(global const uchar *cases, uint item) {
    if (!ZEROS) return cases + CUBE_CASE_BYTES * item;
    if (CLOSED && item >> BORDER_BIT) return cases + CUBE_CASE_BYTES * (item & ((1u << BORDER_BIT) - 1));
    return case_of(cases, item >> PARITY_BIT, item & 0xff, item >> 8 & 0xff);
}

inline_always void triangles_emit(uint count, global const uchar *cases, global uint *index, brick_work *work) {
    for (uint first = 0; first < count; first += BATCH_CUBES) {
        uint *at = work->triangles, end = min(count, first + BATCH_CUBES);
        for (uint n = first; n < end; n++) {
            global const uchar *entry = entry_of(cases, work->list[n] & ((1u << CASE_BITS) - 1));
            case_store(work->number + NUMBER_STEP * (work->list[n] >> CASE_BITS), entry, at, work);
            at += 3u * *entry;
        }
        uint written = (uint)(at - work->triangles);
        lines_store(work->triangles, written, index);
        index += written;
    }
}

/* ------------------------------------------------------------------------------------------------------------ brick */

/* Prefetches the samples of the rows that emit, and of the rows after them in y and z, where their edges end. */
inline_always void samples_prefetch(const slab *s, grid_index origin, uint mask, global const BITS *samples) {
    uint before = 0;
#ifdef REAL
    if (ZEROS) { /* of all rows, and of those before them */
        links_prefetch(s, origin.x / 64, origin.y, origin.z, samples);
        return;
    }
#endif
    for (uint n = 0; n < NUMBER_PLANES && origin.z + n < s->nz; n++, mask >>= BRICK_ROWS) {
        uint here = mask & ((1u << BRICK_ROWS) - 1), rows = here | before;
        before = here;
        for (rows |= rows << 1; rows; rows &= rows - 1) {
            uint y = min(origin.y + lowest_bit(rows), s->ny - 1);
            global const BITS *row = samples + row_start(s, y, origin.z + n) + origin.x;
            for (uint sample = 0; sample < 64; sample += 64 / sizeof(BITS)) line_prefetch(row + sample);
        }
    }
}

/* Prefetches kernel 1's results for a brick. */
inline_always void brick_prefetch(const slab *s, uint brick, grid_index origin, row_results k1) {
    uint next_y = origin.y + BRICK_ROWS < s->ny ? s->words_x : 0,
         next_z = origin.z + BRICK_PLANES < s->nz ? s->words_x * s->bricks_y : 0;
    for (uint line = 0; line < BRICK_WORDS; line += 8) {
        line_prefetch(k1.words + (ulong)BRICK_WORDS * brick + line);
        line_prefetch(k1.words + (ulong)BRICK_WORDS * (brick + next_y) + line);
        line_prefetch(k1.offsets + (ulong)BRICK_WORDS * (brick + next_y) + line);
        if (ZEROS) line_prefetch(zeros_of(s, k1.words + (ulong)BRICK_WORDS * brick + line));
    }
    line_prefetch(k1.bricks + brick);
    line_prefetch(k1.words + (ulong)BRICK_WORDS * (brick + next_z));
    line_prefetch(k1.offsets + (ulong)BRICK_WORDS * (brick + next_z));
    line_prefetch(k1.words + (ulong)BRICK_WORDS * (brick + next_y + next_z));
    line_prefetch(k1.offsets + (ulong)BRICK_WORDS * (brick + next_y + next_z));
}

/* Prefetches for the bricks after the first in the list: results of kernel 1 two bricks ahead, samples one ahead. */
inline_always void next_prefetch(const slab *s, global const uint *active, uint count, row_results k1,
                                 global const BITS *samples) {
    if (count > 2) brick_prefetch(s, active[2], brick_origin(s, active[2]), k1);
    if (count > 1) samples_prefetch(s, brick_origin(s, active[1]), k1.bricks[active[1]].rows, samples);
}

/* A group needs no local memory here. */
typedef struct emit_memory {
    uint none;
} emit_memory;

/* Emits a brick where it is wanted. */
inline_always void brick_emit(const slab *s, uint brick, bool wanted, grid_arrays in, row_results k1,
                              global const uchar *cases, mesh_buffers mesh, local emit_memory *memory,
                              brick_work *work) {
    if (!wanted) return;
    brick_signs signs;
    const grid_index origin = brick_origin(s, brick);
    const brick_state state = k1.bricks[brick];
    uint first = s->mesh.vertex_base + state.vertices;
#if CLOSED
    const bool at_border = bricks_at_border(s, k1.cells, origin.y, origin.z, origin.x / 64, 1);
#else
    const bool at_border = false;
#endif
    signs_load(s, origin, brick, k1, &signs);
    corners_store(&signs, work);
    crossed_store(s, origin, &signs, at_border, k1, work);
    uint count = edges_list(s, origin, state.rows, first, in, work);
#ifdef REAL
    vertices_emit(s, origin, count, first - s->mesh.vertex_window, in, mesh, work);
#endif
    plane_number(s, origin, &signs, at_border, k1, work);
    next_rows_number(s, origin, &signs, at_border, k1, work);
    column_number(s, origin, &signs, at_border, k1, work);
#if CLOSED
    count = at_border ? border_list(s, origin, state.rows, k1, work) : cubes_list(s, state.rows, 0, work);
#else
    count = cubes_list(s, state.rows, 0, work);
#endif
    triangles_emit(count, cases, mesh.triangles + 3ul * (uint)(state.triangles - s->mesh.triangle_window), work);
}

#endif
