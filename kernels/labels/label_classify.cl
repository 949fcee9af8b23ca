/*
 * label_classify.cl - kernel 1 of label maps: words of edges that differ, vertices and triangles of every row of cubes,
 * prefix sums
 *
 * Groups take tiles, runs of bricks, by ticket. Items are rows, which follow each other as bricks and rows in them do,
 * so prefix sums over items are where each row's output begins.
 */
#ifndef LABEL_CLASSIFY_CL
#define LABEL_CLASSIFY_CL

#include "label_rows.cl"

/* What kernel 1 leaves, for each row of each brick. rows: of each brick, bit n: row n has words and the rest. */
typedef struct label_arrays {
    global ulong *words;          /* LABEL_WORDS */
    global ushort *offsets;       /* LABEL_OFFSETS: for each shared type, the row's vertices of the types before it */
    global label_row_base *bases; /* within the tile */
    global uint *rows;
} label_arrays;

inline_always uint label_tile_of(const label_job *s, uint brick) {
    return brick < s->own_bricks ? brick / s->tile_bricks : s->own_tiles + (brick - s->own_bricks) / s->tile_bricks;
}

inline_always uint label_tile_first(const label_job *s, uint tile) {
    return tile < s->own_tiles ? tile * s->tile_bricks : s->own_bricks + (tile - s->own_tiles) * s->tile_bricks;
}

/* One past the last brick of a tile. */
inline_always uint label_tile_end(const label_job *s, uint tile) {
    return min(label_tile_first(s, tile) + s->tile_bricks, tile < s->own_tiles ? s->own_bricks : s->brick_count);
}

/* Marks a row that emits something. Others of its brick may be marked by other work-items. */
inline_always void label_row_mark(global uint *rows, uint row) {
    if (WORK_ITEMS == 1)
        *rows |= 1u << row;
    else
        atomic_or(rows, 1u << row);
}

/* Counts a row: vertices and triangles. store: its words and offsets are kept. */
inline_always uint2 label_row_count(const label_job *s, uint brick, uint row, global const BITS *samples,
                                    label_arrays out, bool store, uint *cells) {
    const row_origin p = row_origin_of(s, brick, row);
    ulong e[LABEL_EDGES], t[LABEL_ROW_TYPES], active = 0;
    uint2 sums = 0;
    if (p.y >= s->ny || p.z >= s->z1) return sums;
    label_edges_make(s, p, samples, e);
    if (!label_edges_any(e)) return sums;
    const ulong even = label_even(s, p.y, p.z), cubes = label_cubes(s, p);
    const ulong at = (ulong)BRICK_WORDS * brick + row;
    label_types(even, e, t);
#pragma unroll
    for (uint n = 0; n < LABEL_ROW_TYPES; n++) { /* all unrolled: a variable index would need a stack */
        if (store && n < LABEL_SHARED_TYPES) out.offsets[LABEL_OFFSETS * at + n] = (ushort)sums.x;
        sums.x += (uint)popcount(t[n]);
    }
#pragma unroll
    for (uint n = 0; n < 5; n++) {
        const label_cells c = label_cells_in(label_tetrahedra(even, e, n), cubes);
        active |= label_cells_any(c);
        sums.y += label_cell_triangles(c, cubes);
    }
    if (!(sums.x | sums.y)) return sums;
#pragma unroll
    for (uint n = 0; n < LABEL_WORDS; n++)
        if (store) out.words[LABEL_WORDS * at + n] = e[n];
    if (store) label_row_mark(&out.rows[brick], row);
    *cells += (uint)popcount(active);
    return sums;
}

/* Sums of a tile; store: what its rows have is kept. */
inline_always uint2 label_tile_count(const label_job *s, tile_scan scan, uint tile_index, global const BITS *samples,
                                     label_arrays out, bool store, uint *cells) {
    const uint first = label_tile_first(s, tile_index), end = label_tile_end(s, tile_index);
    uint2 running = 0;
    for (uint n = 0; n < s->tile_bricks * BRICK_WORDS; n += WORK_ITEMS) {
        const uint item = n + (uint)get_local_id(0), brick = first + item / BRICK_WORDS, row = item % BRICK_WORDS;
        uint found = 0;
        if (WORK_ITEMS == 1 && brick >= end) break;
#if WORK_ITEMS == 1
        if (row == 0 && brick + 1 < end) label_samples_prefetch(s, brick + 1, samples);
#endif
        if (WORK_ITEMS == 1 && row == 0 && label_brick_uniform(s, brick, samples)) {
            n += BRICK_WORDS - 1;
            continue;
        }
        uint2 sums = brick < end && item < s->tile_bricks * BRICK_WORDS
                         ? label_row_count(s, brick, row, samples, out, store, &found)
                         : (uint2)0;
        const uint2 before = group_prefix(sums, &running, scan.sums);
        if (store && (sums.x | sums.y)) {
            label_row_base base = {before.x, before.y};
            out.bases[(ulong)BRICK_WORDS * brick + row] = base;
        }
        if (brick < s->own_bricks) *cells += found;
    }
    return running;
}

/* Appends the tile's bricks that emit something. */
inline_always void label_tile_list(const label_job *s, uint tile_index, label_arrays out, global uint *active,
                                   global uint *head) {
    const uint first = label_tile_first(s, tile_index), end = label_tile_end(s, tile_index);
    group_barrier();
    for (uint n = 0; n < s->tile_bricks; n += WORK_ITEMS) {
        const uint brick = first + n + (uint)get_local_id(0);
        if (brick < end && brick < s->own_bricks && n + (uint)get_local_id(0) < s->tile_bricks &&
            atomic_or(&out.rows[brick], 0u))
            active[atomic_inc(&head[LABEL_ACTIVE_BRICKS])] = brick;
    }
}

inline_always void label_tile_settle(const label_job *s, tile_scan scan, uint tile_index, global const BITS *samples,
                                     label_arrays out) {
    uint unposted, none = 0;
    bool look = false;
    while (!tile_settle(scan, tile_index, look, &unposted)) {
        tile_post(scan, unposted, label_tile_count(s, scan, unposted, samples, out, false, &none));
        look = true;
    }
}

/* state: head and tiles, cleared, as rows are. active receives the own bricks that emit something. */
kernel void label_classify(label_job s, global const BITS *samples, global ulong *words, global ushort *offsets,
                           global label_row_base *bases, global uint *rows, global uint *active, global uint *state) {
    local uint shared[4];
    local uint2 sums[WORK_ITEMS + 1];
    const tile_scan scan = {s.spin_limit, state + LABEL_HEAD_WORDS, shared, sums};
    const label_arrays out = {words, offsets, bases, rows};
    own_tiles own = {NO_TILE, NO_TILE};
    uint tile_index = 0, cells = 0;
    while (tile_index < s.tile_count) {
        tile_index = ticket_take(&state[LABEL_TICKET], shared);
        if (tile_index < s.tile_count) {
            const uint2 found = label_tile_count(&s, scan, tile_index, samples, out, true, &cells);
            tile_post(scan, tile_index, found);
            if (get_local_id(0) == 0 && (found.x | found.y)) {
                atomic_add(&state[LABEL_VERTEX_UNITS], found.x / 64 + 1);
                atomic_add(&state[LABEL_TRIANGLE_UNITS], found.y / 64 + 1);
            }
            label_tile_list(&s, tile_index, out, active, state);
            if (SETTLES_LATER)
                own_append(&own, tile_index, scan.tiles);
            else
                label_tile_settle(&s, scan, tile_index, samples, out);
        }
    }
    for (uint n = own.first; SETTLES_LATER && n != NO_TILE; n = scan.tiles[TILE_WORDS * n + TILE_NEXT])
        label_tile_settle(&s, scan, n, samples, out);
    if (cells) atomic_add(&state[LABEL_ACTIVE_CELLS], cells);
}

#endif
