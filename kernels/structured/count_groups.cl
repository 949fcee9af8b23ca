/*
 * count_groups.cl - counting where the work-items of a group share bricks: each takes a row
 */
#ifndef COUNT_GROUPS_CL
#define COUNT_GROUPS_CL

#include "count.cl"

/* A brick of a layer of the tile; bricks are numbered in x, then y. */
typedef struct tile_brick {
    uint w, y0;
} tile_brick;

inline_always tile_brick brick_locate(const slab *s, tile t, uint n) {
    tile_brick b = {n % s->words_x, t.y0 + n / s->words_x * BRICK_ROWS};
    return b;
}

inline_always sample_rows tile_rows_at(const slab *s, tile t, uint y, uint z, uint w, tile_words signs) {
    ulong at = 0, next = 0, zero = 0, zero_next = 0;
    if (y < s->ny && z < s->nz) {
        global const ulong *row = tile_row(s, t, y, z, w, signs);
        at = *row & word_valid(s, w);
        if (ZEROS) zero = *zeros_of(s, row);
        if (w + 1 < s->words_x) {
            row = tile_row(s, t, y, z, w + 1, signs);
            next = *row & word_valid(s, w + 1);
            if (ZEROS) zero_next = *zeros_of(s, row);
        }
    }
    return ZEROS ? rows_with_zeros(at, next, zero, zero_next) : rows_shifted(at, next);
}

/* What a work-item tells its group about the row that it counted. */
typedef struct row_report {
    ulong packed;
    emit_counts e;
} row_report;

inline_always row_report row_count(const slab *s, tile t, uint y, uint z, uint w, tile_words signs,
                                   global const ulong *cells) {
    cube_rows r = cube_rows_of(s, y, z, w, tile_rows_at(s, t, y, z, w, signs), tile_rows_at(s, t, y + 1, z, w, signs),
                               tile_rows_at(s, t, y, z + 1, w, signs), tile_rows_at(s, t, y + 1, z + 1, w, signs));
    row_counts c = rows_count(s, &r, y, z, w, cells);
    row_report report = {c.packed, {(uint)c.vertices, (uint)c.triangles, (uint)c.cells}};
    return report;
}

/* What a brick emits: sums over its rows; bit n of `rows`: row n emits something. */
typedef struct brick_report {
    emit_counts e;
    uint rows;
} brick_report;

/* What a group needs of local memory. */
typedef struct count_memory {
    row_report rows[WORK_ITEMS];
    brick_report bricks[BRICKS_AT_ONCE];
} count_memory;

inline_always void emit_counts_add(emit_counts *sum, emit_counts e) {
    sum->vertices += e.vertices, sum->triangles += e.triangles, sum->cells += e.cells;
}

/* For a brick with rows[0] to [31]: stores where in it the work-item's row begins, and what the brick emits. */
inline_always void brick_sum(uint brick, const local row_report *rows, global ulong *offsets,
                             global ushort *triangle_offsets, local brick_report *out) {
    const uint brick_row = (uint)get_local_id(0) % BRICK_WORDS;
    const row_report own = rows[brick_row];
    brick_report all = {{0, 0, 0}, 0};
    emit_counts before = all.e;
#pragma unroll 4
    for (uint m = 0; m < BRICK_WORDS; m++) {
        const emit_counts row = rows[m].e;
        if (m == brick_row) before = all.e;
        emit_counts_add(&all.e, row);
        all.rows |= (uint)(row.vertices + row.triangles > 0) << m;
    }
    if (own.e.vertices + own.e.triangles > 0) {
        offsets[BRICK_WORDS * brick + brick_row] = own.packed + before.vertices;
        triangle_offsets[BRICK_WORDS * brick + brick_row] = (ushort)before.triangles;
    }
    if (brick_row == 0) *out = all;
}

/* Counts the layer that begins with plane z0, and adds to *sums, equally in all work-items. A brick stores the sums
 * before it, from the start of the tile. *emitting: how many bricks of the tile emit something. Only the sums live
 * across a barrier, and a work-item without a row counts another one's: some compilers make wrong code otherwise. */
inline_always void layer_count(const slab *s, tile t, uint z0, tile_words signs, global const ulong *cells,
                               global const brick_range *ranges, global ulong *offsets, global ushort *triangle_offsets,
                               emit_counts *sums, global uint *emitting, local count_memory *memory) {
    const uint count = layer_bricks(s, t);
    for (uint n = 0; n < count; n += BRICKS_AT_ONCE) {
        {
            uint lid = (uint)get_local_id(0), brick_row = lid % BRICK_WORDS;
            tile_brick b = brick_locate(s, t, min(n + lid / BRICK_WORDS, count - 1));
            uint y = b.y0 + brick_row % BRICK_ROWS, z = z0 + brick_row / BRICK_ROWS;
            bool mine = n + lid / BRICK_WORDS < count && y < t.y1 && z < t.z1;
            row_report report = row_count(s, t, mine ? y : b.y0, mine ? z : z0, b.w, signs, cells);
            if (!mine) report.e.vertices = 0, report.e.triangles = 0, report.e.cells = 0;
            memory->rows[lid] = report;
        }
        group_barrier();
        {
            uint own = (uint)get_local_id(0) / BRICK_WORDS;
            tile_brick b = brick_locate(s, t, min(n + own, count - 1));
            brick_sum(brick_index(s, b.y0, z0, b.w), memory->rows + BRICK_WORDS * own, offsets, triangle_offsets,
                      &memory->bricks[own]);
        }
        group_barrier();
        {
            uint own = (uint)get_local_id(0);
            emit_counts before = *sums;
            for (uint m = 0; m < BRICKS_AT_ONCE; m++) {
                if (m == own) before = *sums;
                emit_counts_add(sums, memory->bricks[m].e);
            }
            if (own < BRICKS_AT_ONCE && n + own < count) {
                tile_brick b = brick_locate(s, t, n + own);
                global brick_state *state = &signs.bricks[brick_index(s, b.y0, z0, b.w)];
                state->vertices = before.vertices, state->triangles = before.triangles;
                state->rows = memory->bricks[own].rows;
                if (state->rows) atomic_inc(emitting);
            }
        }
        group_barrier();
    }
}

#endif
