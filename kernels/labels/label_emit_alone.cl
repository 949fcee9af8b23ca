/*
 * label_emit_alone.cl - kernel 2 of label maps where a work-item has bricks to itself, a row after the other
 *
 * 1. The samples of a row are compared with those of the rows beside it, 64 cubes at once. That tells which cubes have
 * two labels and which have more, and of the former the pattern and both labels.
 * 2. Vertices are listed, and vector code makes those of many rows.
 * 3. The numbers of the vertices on a row's edges lie in slots, one for each type of edge. A cube with two labels takes
 * its triangles from them by one entry of a table (LABEL_CUBES), and the numbers then step over its crossed edges.
 * Cubes with more labels go tetrahedron by tetrahedron (label_triangles.cl).
 *
 * Cubes have different numbers of triangles, which are unpredictable. So a fixed number is copied for each cube, and
 * the next cube overwrites the surplus. All goes through private memory, and from there to the mesh in whole cache
 * lines.
 */
#ifndef LABEL_EMIT_ALONE_CL
#define LABEL_EMIT_ALONE_CL

#include "label_triangles.cl"

/* Vertices and triangles that are made before they are brought to the mesh, and what one row or cube adds to them. */
enum { LABEL_BATCH = 512, LABEL_ROW_MOST = 64 * LABEL_ROW_TYPES, LABEL_CUBE_MOST = 60, LABEL_LANES = 16 };

/* What a work-item needs of private memory. */
typedef struct label_work {
    uint list[LABEL_BATCH + LABEL_ROW_MOST + LABEL_LANES]; /* vertices, as LABEL_ITEM has them */
    float positions[3 * (LABEL_BATCH + LABEL_ROW_MOST + LABEL_LANES)];
    uint triangles[3 * (LABEL_BATCH + LABEL_CUBE_MOST) + LABEL_LANES];
    uint labels[2 * (LABEL_BATCH + LABEL_CUBE_MOST) + 2 * LABEL_LANES];
    uint vertex_count, triangle_count;
    ulong vertex, triangle;    /* indices of the first ones */
    samples64 inner, outer;    /* labels of a row's cubes, where these have two */
    bytes64 patterns;          /* bit n: corner n has the inner label */
    ulong words[LABEL_LANES];  /* of the edges that a row's cubes have, from EX to EX_YZ1 */
    uint numbers[LABEL_LANES]; /* of the first vertices in these words */
    uint next[LABEL_LANES];    /* of those at 64, in the next brick */
    uint bricks[8];            /* of the first vertices of the tiles that the bricks beside this one are in */
} label_work;

/* --------------------------------------------------------------------------------------------------------- vertices */

/* A sample of a brick, with the type of a vertex that it owns. */
#define LABEL_ITEM(y, z, type) ((y) << 6 | (z) << 9 | (type) << 11)

/* Appends the samples of a word; returns how many the list then has. */
inline_always uint label_list(ulong word, uint item, uint count, uint *list) {
#ifdef MASK_REGISTERS
    const uint16 lane = (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    loop_unrolled for (uint n = 0; n < 64; n += 16) count += items_keep(lane + (item + n), word >> n, list + count);
#else
    for (; word; word &= word - 1) list[count++] = item + lowest_bit(word);
#endif
    return count;
}

/* Brings the vertices that are listed to the mesh. p: of the brick's first row. */
inline_always void label_vertices_flush(const label_job *s, row_origin p, global const uint *tables, label_mesh out,
                                        label_work *work) {
    global const float *from_owners = (global const float *)(tables + LABEL_POSITIONS);
    const int x0 = s->first[0] + (int)(64 * p.w), y0 = s->first[1] + (int)p.y, z0 = s->first[2] + (int)p.z;
    const uint parity = s->parity + p.y + p.z;
    const slab_f32 *m = s->matrix;
    for (uint first = 0; first < work->vertex_count; first += LABEL_LANES) {
        float from[3][LABEL_LANES], positions[3 * LABEL_LANES];
        for (uint n = 0; n < LABEL_LANES; n++) {
            const uint item = work->list[first + n], odd = (parity + item + (item >> 6) + (item >> 9)) & 1;
            global const float *from_owner = from_owners + 3 * (odd * LABEL_ROW_TYPES + (item >> 11 & 31));
            from[0][n] = from_owner[0], from[1][n] = from_owner[1], from[2][n] = from_owner[2];
        }
        for (uint n = 0; n < LABEL_LANES; n++) {
            const uint item = work->list[first + n];
            const float x = (float)(x0 + (int)(item & 63)) + from[0][n];
            const float y = (float)(y0 + (int)(item >> 6 & 7)) + from[1][n];
            const float z = (float)(z0 + (int)(item >> 9 & 3)) + from[2][n];
            positions[3 * n] = ((m[0] * x + m[1] * y) + m[2] * z) + m[3];
            positions[3 * n + 1] = ((m[4] * x + m[5] * y) + m[6] * z) + m[7];
            positions[3 * n + 2] = ((m[8] * x + m[9] * y) + m[10] * z) + m[11];
        }
        for (uint n = 0; n < 3; n++)
            *(words16 *)(work->positions + 3 * first + 16 * n) = *(const words16 *)(positions + 16 * n);
    }
    lines_store(work->positions, 3 * work->vertex_count, out.positions + s->position_offset + 3 * work->vertex);
    work->vertex += work->vertex_count;
    work->vertex_count = 0;
}

/* ------------------------------------------------------------------------------------------------------------ cubes */

/* Cubes of a row, a bit each. */
typedef struct label_sides {
    ulong active; /* those with several labels */
    ulong more;   /* samples around which there may be more than two */
} label_sides;

inline_always bytes64 label_same(samples64 a, samples64 b) { return __builtin_convertvector(a == b, bytes64); }

inline_always label_sides label_sides_make(const label_job *s, row_origin p, global const BITS *samples,
                                           label_work *work) {
    const ulong dy = p.y + 1 < s->ny ? s->nx : 0, dz = p.z + 1 < s->nz ? (ulong)s->nx * s->ny : 0;
    const ulong start = label_start(s, p.y, p.z, p.w);
    const uint left = s->nx - 64 * p.w;
    samples64 corners[8], other;
    loop_unrolled for (uint n = 0; n < 8; n++) corners[n] =
        label_load(s, start + (n & 1) + (n & 2 ? dy : 0) + (n & 4 ? dz : 0), samples);
    if (left <= 64) /* the row ends with the grid: nothing is at x + 1 of its last sample */
        loop_unrolled for (uint n = 0; n < 8; n += 2) corners[n + 1] =
            lane64 < (samples64)(BITS)(left - 1) ? corners[n + 1] : corners[n];
    const samples64 first = corners[0];
    other = first;
    loop_unrolled for (uint n = 1; n < 8; n++) other = corners[n] != first ? corners[n] : other;
    bytes64 inside = 1, two = (char)-1;
    loop_unrolled for (uint n = 1; n < 8; n++) {
        const bytes64 is_first = label_same(corners[n], first);
        inside |= is_first & (bytes64)(char)(1 << n);
        two &= is_first | label_same(corners[n], other);
    }
    const samples64 turned =
        __builtin_astype(other - (samples64)1 < first - (samples64)1, samples64); /* as in label_interface_emit */
    work->patterns = inside ^ __builtin_convertvector(turned, bytes64);
    work->inner = (other & turned) | (first & ~turned);
    work->outer = (first & turned) | (other & ~turned);
    const label_sides sides = {~mask_word(inside == (bytes64)(char)-1) & label_cubes(s, p),
                               ~mask_word(two) & label_mask(left)};
    return sides;
}

/* A word of a row's edges and the number of the first vertex in it. at: the row that owns them, or NO_ROW. */
inline_always void label_slot(uint edge, uint at, uint own, uint type, uint brick, label_arrays in, label_work *work) {
    const uint row = at == NO_ROW ? own : at;
    work->words[edge] = in.words[(ulong)LABEL_WORDS * row + type] & (at == NO_ROW ? 0 : ~0ul);
    work->numbers[edge] = work->bricks[brick] + in.bases[row].vertices + in.offsets[(ulong)LABEL_OFFSETS * row + type];
}

inline_always uint label_next(uint at, uint type, uint brick, label_arrays in, const label_work *work) {
    return at == NO_ROW ? 0
                        : work->bricks[brick] + in.bases[at].vertices + in.offsets[(ulong)LABEL_OFFSETS * at + type];
}

/* next_y, next_z: which of work->bricks has the next row in y, or in z: 0 this brick, else 2 or 4. y1, z1, yz1: these
 * rows. */
inline_always void label_slots_make(const label_job *s, row_origin p, uint own, label_arrays in, label_work *work) {
    const uint next_y = p.y % BRICK_ROWS + 1 == BRICK_ROWS ? 2 : 0,
               next_z = (p.z - s->z0) % BRICK_PLANES + 1 == BRICK_PLANES ? 4 : 0;
    const uint y1 = label_row_find(s, p.y + 1, p.z, p.w, in.rows), z1 = label_row_find(s, p.y, p.z + 1, p.w, in.rows);
    const uint yz1 = label_row_find(s, p.y + 1, p.z + 1, p.w, in.rows);
    loop_unrolled for (uint type = 0; type < LABEL_WORDS; type++) label_slot(type, own, own, type, 0, in, work);
    label_slot(EX_Y1, y1, own, 0, next_y, in, work);
    label_slot(EZ_Y1, y1, own, 2, next_y, in, work);
    label_slot(EXZ_Y1, y1, own, 4, next_y, in, work);
    label_slot(EX_Z1, z1, own, 0, next_z, in, work);
    label_slot(EY_Z1, z1, own, 1, next_z, in, work);
    label_slot(EXY_Z1, z1, own, 3, next_z, in, work);
    label_slot(EX_YZ1, yz1, own, 0, next_y | next_z, in, work);
}

/* Of edges that the samples at 64 own. */
inline_always void label_next_make(const label_job *s, row_origin p, label_arrays in, label_work *work) {
    const uint next_y = p.y % BRICK_ROWS + 1 == BRICK_ROWS ? 2 : 0,
               next_z = (p.z - s->z0) % BRICK_PLANES + 1 == BRICK_PLANES ? 4 : 0;
    const uint x1 = label_row_find(s, p.y, p.z, p.w + 1, in.rows);
    const uint xy1 = label_row_find(s, p.y + 1, p.z, p.w + 1, in.rows),
               xz1 = label_row_find(s, p.y, p.z + 1, p.w + 1, in.rows);
    work->next[EY] = label_next(x1, 1, 1, in, work), work->next[EZ] = label_next(x1, 2, 1, in, work);
    work->next[EYZ] = label_next(x1, 5, 1, in, work);
    work->next[EZ_Y1] = label_next(xy1, 2, 1 | next_y, in, work),
    work->next[EY_Z1] = label_next(xz1, 1, 1 | next_z, in, work);
}

/* --------------------------------------------------------------------------------------------------------- triangles
 */

inline_always void label_triangles_flush(const label_job *s, label_mesh out, label_work *work) {
    const uint count = work->triangle_count;
    lines_store(work->triangles, 3 * count, out.triangles + s->triangle_offset + 3 * work->triangle);
    lines_store(work->labels, 2 * count, out.labels + s->label_offset + 2 * work->triangle);
    work->triangle += count;
    work->triangle_count = 0;
}

/* Triangles of a cube with two labels, which are those of an isovalue between them: by slots of the numbers at the cube
 * and at x + 1. */
inline_always void label_two_emit(uint x, uint odd, uint16 numbers, uint16 at_next_x, global const uint *tables,
                                  label_work *work) {
    const uint pattern = ((const uchar *)&work->patterns)[x];
    global const uchar *entry = (global const uchar *)(tables + LABEL_CUBES + LABEL_CASE_WORDS * (256 * odd + pattern));
    uint *to = work->triangles + 3 * work->triangle_count, *labels = work->labels + 2 * work->triangle_count;
    const uint count = entry[0];
    uint16 sides;
    sides.even = ((const BITS *)&work->inner)[x], sides.odd = ((const BITS *)&work->outer)[x];
#ifdef WORD_SHUFFLES
    *(words16 *)to = words_shuffled(numbers, at_next_x, *(global const bytes16 *)(entry + 1), true);
    if (count > 5)
        *(words16 *)(to + 15) = words_shuffled(numbers, at_next_x, *(global const bytes16 *)(entry + 16), true);
#else
    uint slots[32];
    vstore16(numbers, 0, slots), vstore16(at_next_x, 1, slots);
    for (uint n = 0; n < 3 * count; n++) to[n] = slots[entry[1 + n]];
#endif
    *(words16 *)labels = sides;
    if (count > 5) *(words16 *)(labels + 10) = sides;
    work->triangle_count += count;
}

/* The triangles of a cube with more than two labels. */
inline_always void label_more_emit(const label_job *s, local const label_row *r, uint x, uint odd,
                                   global const BITS *first, global const uint *tables, label_work *work) {
    const label_numbers v = {r, x};
    const ulong dz = (ulong)s->nx * s->ny;
    const uint l[8] = {first[0],  first[1],      first[s->nx],      first[s->nx + 1],
                       first[dz], first[dz + 1], first[dz + s->nx], first[dz + s->nx + 1]};
    for (uint t = 0; t < 5; t++) {
        if (!(label_cells_any(r->cells[t]) >> x & 1)) continue;
        const uint at = tables[LABEL_MAPS + (5 * odd + t) * LABEL_MAP_WORDS + LABEL_MAP_CORNERS];
        const uint4 own = (uint4)(l[at & 7], l[at >> 4 & 7], l[at >> 8 & 7], l[at >> 12 & 7]);
        const label_triangles to = {work->triangles, work->labels};
        work->triangle_count +=
            label_cell_emit(s, v, own, t, odd, tables, label_triangles_after(to, work->triangle_count));
    }
}

/* ------------------------------------------------------------------------------------------------------------- rows */

inline_always void label_row_emit(const label_job *s, row_origin p, uint own, label_near near, label_arrays in,
                                  global const uint *tiles, global const BITS *samples, global const uint *tables,
                                  label_mesh out, local label_row *r, label_work *work) {
    const label_sides sides = label_sides_make(s, p, samples, work);
    const uint odd = (s->parity + p.y + p.z) & 1; /* of the row's first cube */
    const uint item = LABEL_ITEM(p.y % BRICK_ROWS, (p.z - s->z0) % BRICK_PLANES, 0);
    global const BITS *first = samples + label_start(s, p.y, p.z, p.w);
    uint count = work->vertex_count;
    label_slots_make(s, p, own, in, work);
    loop_unrolled for (uint type = 0; type < LABEL_WORDS; type++) count =
        label_list(work->words[type], item + LABEL_ITEM(0, 0, type), count, work->list);
    if (sides.more) {
        label_row_make(s, p, near, in, tiles, r);
        for (uint type = LABEL_WORDS; type < LABEL_ROW_TYPES; type++)
            if (r->words[type]) count = label_list(r->words[type], item + LABEL_ITEM(0, 0, type), count, work->list);
    }
    work->vertex_count = count;
    if (sides.active >> 63) label_next_make(s, p, in, work);
    uint16 numbers = vload16(0, work->numbers);
    const ulong8 low = vload8(0, work->words), high = vload8(1, work->words);
    for (ulong rest = sides.active; rest; rest &= rest - 1) {
        const uint x = lowest_bit(rest);
        const uint8 low_steps = convert_uint8(low >> x & 1), high_steps = convert_uint8(high >> x & 1);
        const uint16 at_next_x = numbers + (uint16)(low_steps, high_steps);
        if (sides.more >> x & 1)
            label_more_emit(s, r, x, (odd + x) & 1, first + x, tables, work);
        else
            label_two_emit(x, (odd + x) & 1, numbers, x == 63 ? vload16(0, work->next) : at_next_x, tables, work);
        if (work->triangle_count >= LABEL_BATCH) label_triangles_flush(s, out, work);
        numbers = at_next_x;
    }
}

inline_always void label_row_prefetch(uint brick, uint row, label_arrays in) {
    const ulong at = (ulong)BRICK_WORDS * brick + row;
    line_prefetch(in.words + LABEL_WORDS * at);
    line_prefetch(in.words + LABEL_WORDS * at + LABEL_WORDS - 1);
    line_prefetch(in.offsets + LABEL_OFFSETS * at);
    line_prefetch(in.bases + at);
}

/* Prefetches what kernel 1 has left of a brick's rows and of the next ones in y and z, and the samples. */
inline_always void label_brick_prefetch(const label_job *s, uint brick, label_arrays in, global const BITS *samples) {
    const row_origin p = row_origin_of(s, brick, 0);
    const uint next_y = p.y + BRICK_ROWS < s->ny ? s->words_x : 0;
    const uint next_z = p.z + BRICK_PLANES < s->z1 ? s->words_x * s->bricks_y : 0;
    label_row_prefetch(brick + next_y + next_z, 0, in);
    for (uint rows = in.rows[brick]; rows; rows &= rows - 1) label_row_prefetch(brick, lowest_bit(rows), in);
    for (uint z = 0; z < BRICK_PLANES; z++) label_row_prefetch(brick + next_y, BRICK_ROWS * z, in);
    for (uint y = 0; y < BRICK_ROWS; y++) label_row_prefetch(brick + next_z, y, in);
    label_samples_prefetch(s, brick, samples);
}

/* Numbers of the first vertices of the tiles of a brick and of those that lie 0 or 1 bricks further in x, y and z. */
inline_always void label_bricks_beside(const label_job *s, uint brick, row_origin p, global const uint *tiles,
                                       label_work *work) {
    for (uint n = 0; n < 8; n++) {
        const bool exists = p.w + (n & 1) < s->words_x && p.y + (n & 2 ? BRICK_ROWS : 0) < s->ny &&
                            p.z + (n & 4 ? BRICK_PLANES : 0) < s->z1;
        const uint beside = brick + (n & 1) + s->words_x * ((n >> 1 & 1) + (n >> 2) * s->bricks_y);
        work->bricks[n] = exists ? label_near_of(s, beside, tiles).vertices : 0;
    }
}

inline_always void label_brick_emit(const label_job *s, uint brick, label_arrays in, global const uint *tiles,
                                    global const BITS *samples, global const uint *tables, label_mesh out,
                                    local label_row *made, label_work *work) {
    const label_near near = label_near_of(s, brick, tiles);
    const row_origin origin = row_origin_of(s, brick, 0);
    const label_row_base base = in.bases[(ulong)BRICK_WORDS * brick + lowest_bit(in.rows[brick])];
    work->vertex = near.vertices + base.vertices - s->vertex_base, work->triangle = near.triangles + base.triangles;
    work->vertex_count = work->triangle_count = 0;
    for (uint n = 0; n < LABEL_LANES; n++) work->words[n] = work->numbers[n] = work->next[n] = 0;
    label_bricks_beside(s, brick, origin, tiles, work);
    for (uint rows = in.rows[brick]; rows; rows &= rows - 1) {
        const uint row = lowest_bit(rows);
        label_row_emit(s, row_origin_of(s, brick, row), BRICK_WORDS * brick + row, near, in, tiles, samples, tables,
                       out, made, work);
        if (work->vertex_count >= LABEL_BATCH) label_vertices_flush(s, origin, tables, out, work);
    }
    label_vertices_flush(s, origin, tables, out, work);
    label_triangles_flush(s, out, work);
}

#endif
