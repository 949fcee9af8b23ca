/*
 * snap_wish_alone.cl - wishes for a work-item alone: the samples of a brick that have a crossing are listed first, even
 * ones and odd ones apart, as the number in a row is hard to predict
 */
#ifndef SNAP_WISH_ALONE_CL
#define SNAP_WISH_ALONE_CL

#include "nearest.cl"
#include "snap_crossed.cl"

#define WISHES_MOST (BRICK_WORDS * 32)

typedef struct wish_list {
    brick_place p;
    uint number;
    ulong wishes[BRICK_WORDS];
    uint count[2];
    ushort list[2][WISHES_MOST + 1]; /* even and odd ones: row and place in it */
} wish_list;

/* The list of a brick is gone through after that of the next brick is made, when its samples have been fetched. */
typedef struct wish_room {
    long offsets[LINK_EVEN];
    wish_list lists[2];
    uint brick_count;
} wish_room;

inline_always void rows_enter(const slab *s, row_set r, lanes crossed_any, lanes border, global const BITS *samples,
                              wish_list *l) {
    ulong crossed_rows[BRICK_ROWS], even_rows_of[BRICK_ROWS], border_rows[BRICK_ROWS];
    const uint plane = r.z % BRICK_PLANES;
    if (plane == 0) l->count[0] = l->count[1] = 0;
    vstore8(crossed_any & ~border, 0, crossed_rows), vstore8(samples_even(s, r), 0, even_rows_of);
    vstore8(crossed_any & border, 0, border_rows);
    for (uint y = 0; y < BRICK_ROWS; y++) {
        const uint row = BRICK_ROWS * plane + y;
        l->wishes[row] = border_rows[y] ? border_wishes(s, r.y + y, r.z, r.w, border_rows[y], samples) : 0;
        if (!crossed_rows[y]) continue;
        for (uint odd = 0; odd < 2; odd++) {
            ulong rest = crossed_rows[y] & (odd ? ~even_rows_of[y] : even_rows_of[y]);
            uint count = l->count[odd], end = count + (uint)popcount(rest);
            do {
                l->list[odd][count++] = (ushort)(row << 6 | (lowest_bit(rest) & 63));
                rest &= rest - 1;
            } while (rest);
            l->count[odd] = end;
        }
    }
}

/* Prefetches the samples of rows with crossings, and of the rows beside them. */
inline_always void wishes_prefetch(const slab *s, const wish_list *l, uint rows, global const BITS *samples) {
    uint wide[BRICK_PLANES + 2] = {0}; /* bit n: row n - 1 */
    for (uint z = 0; z < BRICK_PLANES; z++) {
        const uint here = rows >> (BRICK_ROWS * z) & 0xff, beside = here | here << 1 | here << 2;
        for (uint n = 0; n < 3; n++) wide[z + n] |= beside;
    }
    for (uint z = 0; z < BRICK_PLANES + 2; z++)
        for (uint rest = wide[z]; rest; rest &= rest - 1) {
            global const BITS *row =
                samples + row_start(s, l->p.y + lowest_bit(rest) - 1, l->p.z + z - 1) + 64ul * l->p.w;
            for (uint sample = 0; sample < 64; sample += 64 / sizeof(BITS)) line_prefetch(row + sample);
        }
}

inline_always void list_finish(const slab *s, wish_list *l, const long *offsets, global const BITS *samples,
                               global ulong *wishes) {
    ulong starts[BRICK_WORDS];
    global ulong *out = wishes + BRICK_WORDS * (ulong)l->number;
    for (uint row = 0; row < BRICK_WORDS; row++)
        starts[row] = row_start(s, l->p.y + row % BRICK_ROWS, l->p.z + row / BRICK_ROWS) + 64ul * l->p.w;
    for (uint odd = 0; odd < 2; odd++)
        for (uint n = 0; n < l->count[odd]; n++) {
            const uint row = l->list[odd][n] >> 6, bit = l->list[odd][n] & 63;
            const bool wish = wishes_inside(s, samples + starts[row] + bit, offsets, odd);
            l->wishes[row] |= (ulong)wish << bit;
        }
    for (uint n = 0; n < BRICK_WORDS; n += 8) vstore8(vload8(0, l->wishes + n), 0, out + n);
}

inline_always void wishes_begin(const slab *s, wish_room *room) {
    link_offsets(s, room->offsets);
    room->brick_count = 0;
}

inline_always void wishes_make(const slab *s, const brick_around *a, brick_place p, uint number,
                               global const BITS *samples, global const ulong *cells, global ulong *wishes,
                               wish_room *room) {
    wish_list *l = &room->lists[room->brick_count & 1];
    uint rows = 0;
    l->p = p, l->number = number;
    for (uint set = 0; set < SETS_OF_PLANES; set++) {
        const row_set r = set_of_plane(p.y, p.z, p.w, set);
        const borders b = borders_of(s, r);
        const lanes crossed_any = rows_wanted(s, a, r, &b, cells);
        rows |= lanes_nonzero(crossed_any) << (BRICK_ROWS * set);
        rows_enter(s, r, crossed_any, b.across[0] | b.across[1] | b.across[2], samples, l);
    }
    wishes_prefetch(s, l, rows, samples);
    if (room->brick_count++) list_finish(s, &room->lists[room->brick_count & 1], room->offsets, samples, wishes);
}

inline_always void wishes_end(const slab *s, global const BITS *samples, global ulong *wishes, wish_room *room) {
    if (room->brick_count) list_finish(s, &room->lists[(room->brick_count - 1) & 1], room->offsets, samples, wishes);
}

#endif
