/*
 * snap_wish_alone.cl - wishes for a work-item alone: the samples of a brick that have a crossing are listed first, even
 * ones and odd ones apart, as the number in a row is hard to predict
 */
#ifndef SNAP_WISH_ALONE_CL
#define SNAP_WISH_ALONE_CL

#include "nearest.cl"
#include "snap_link.cl"

#define WISHES_MOST (BRICK_WORDS * 32)

typedef struct wish_room {
    long offsets[LINK_EVEN];
    ulong wishes[BRICK_WORDS];
    uint count[2];
    ushort list[2][WISHES_MOST + 1]; /* even and odd ones: row and place in it */
} wish_room;

inline_always void wishes_enter(const slab *s, row_set r, lanes crossed_any, lanes border, global const BITS *samples,
                                wish_room *room) {
    ulong crossed_rows[BRICK_ROWS], even_rows_of[BRICK_ROWS], border_rows[BRICK_ROWS];
    const uint plane = r.z % BRICK_PLANES;
    if (plane == 0) room->count[0] = room->count[1] = 0;
    vstore8(crossed_any & ~border, 0, crossed_rows), vstore8(samples_even(s, r), 0, even_rows_of);
    vstore8(crossed_any & border, 0, border_rows);
    for (uint y = 0; y < BRICK_ROWS; y++) {
        const uint row = BRICK_ROWS * plane + y;
        room->wishes[row] = border_rows[y] ? border_wishes(s, r.y + y, r.z, r.w, border_rows[y], samples) : 0;
        if (!crossed_rows[y]) continue;
        for (uint odd = 0; odd < 2; odd++) {
            ulong rest = crossed_rows[y] & (odd ? ~even_rows_of[y] : even_rows_of[y]);
            uint count = room->count[odd], end = count + (uint)popcount(rest);
            do {
                room->list[odd][count++] = (ushort)(row << 6 | (lowest_bit(rest) & 63));
                rest &= rest - 1;
            } while (rest);
            room->count[odd] = end;
        }
    }
}

inline_always void wishes_store(const slab *s, brick_place p, global const BITS *samples, global ulong *out,
                                wish_room *room) {
    ulong starts[BRICK_WORDS];
    for (uint row = 0; row < BRICK_WORDS; row++)
        starts[row] = row_start(s, p.y + row % BRICK_ROWS, p.z + row / BRICK_ROWS) + 64ul * p.w;
    for (uint odd = 0; odd < 2; odd++)
        for (uint n = 0; n < room->count[odd]; n++) {
            const uint row = room->list[odd][n] >> 6, bit = room->list[odd][n] & 63;
            const bool wish = wishes_inside(s, samples + starts[row] + bit, room->offsets, odd);
            room->wishes[row] |= (ulong)wish << bit;
        }
    for (uint n = 0; n < BRICK_WORDS; n += 8) vstore8(vload8(0, room->wishes + n), 0, out + n);
}

#endif
