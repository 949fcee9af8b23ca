/*
 * snap.cl - method snap: samples near the surface become vertices of it, before kernel 1 counts
 *
 * host/lib/reference/reference_snap.c is the twin. Kernels, in order:
 *
 * 1. snap_sign: the first stage of kernel 1 (sign.cl), over all bricks;
 * 2. snap_near: lists the bricks that are mixed or beside a brick on another side;
 * 3. snap_open: these get words of their own, also where they are uniform, and words of zeros, empty so far;
 * 4. snap_wish: which samples are near enough to a crossing of theirs;
 * 5. snap_pass, once for each colour (link.h): samples of the colour that wish it and are regular points (regular.cl)
 *    become zeros. They do not see each other, so their order does not matter;
 * 6. snap_close: the zeros of the last colour, which wait elsewhere while others read the words, join the rest.
 */
#ifndef SNAP_CL
#define SNAP_CL

#include "cells.cl"
#include "count.cl"
#include "nearest.cl"
#include "regular.cl"
#include "snap_rows.cl"

kernel void snap_sign(slab s, global const BITS *samples, global brick_range *ranges, global ulong *words,
                      global brick_state *bricks, global uint *state) {
    local sign_room room;
    uint nonfinite = 0;
    words += UNIFORM_BRICKS * BRICK_WORDS;
    for (uint n = (uint)get_group_id(0); n < s.tiling.tile_count; n += (uint)get_num_groups(0)) {
        const tile t = tile_locate(&s, n);
        for (uint z = t.z0; z < t.z1; z += BRICK_PLANES)
            layer_sign(&s, t.y0, t.y1, z, samples, words, bricks, ranges, &nonfinite, &room);
    }
    if (nonfinite) atomic_or(&state[s.results.head_offset + STATE_NONFINITE], 1u);
}

/* ------------------------------------------------------------------------------------------------------------ bricks
 */

inline_always uint brick_count_of(const slab *s) {
    return (s->z1 - s->results.word_z + BRICK_PLANES - 1) / BRICK_PLANES * s->bricks_y * s->words_x;
}

inline_always bool brick_near(const slab *s, uint number, global const brick_state *bricks) {
    const uint sign = bricks[number].sign, layers = brick_count_of(s) / s->words_x / s->bricks_y;
    const int w = (int)(number % s->words_x), row = (int)(number / s->words_x % s->bricks_y),
              layer = (int)(number / s->words_x / s->bricks_y);
    if (sign == SIGN_MIXED) return true;
#pragma unroll 1
    for (uint n = 0; n < 27; n++) {
        const int x = w + (int)(n % 3) - 1, y = row + (int)(n / 3 % 3) - 1, z = layer + (int)(n / 9) - 1;
        if (x < 0 || y < 0 || z < 0 || x >= (int)s->words_x || y >= (int)s->bricks_y || z >= (int)layers) continue;
        if (bricks[((uint)z * s->bricks_y + (uint)y) * s->words_x + (uint)x].sign != sign) return true;
    }
    return false;
}

kernel void snap_near(slab s, global const brick_state *bricks, global uint *near, global uint *state) {
    const uint count = brick_count_of(&s);
    for (uint n = (uint)get_global_id(0); n < count; n += (uint)get_global_size(0))
        if (brick_near(&s, n, bricks)) near[atomic_inc(&state[s.results.head_offset + STATE_NEAR_BRICKS])] = n;
}

/* Work-items per brick: one for each of its rows, or one for all. */
#define BRICK_ITEMS    (BRICK_WORDS / (WORK_ITEMS == 1 ? BRICK_WORDS : 1))
#define GROUP_BRICKS   (WORK_ITEMS / BRICK_ITEMS)
#define FIRST_BRICK    ((uint)get_group_id(0) * GROUP_BRICKS + (uint)get_local_id(0) / BRICK_ITEMS)
#define BRICKS_FURTHER ((uint)get_num_groups(0) * GROUP_BRICKS)
#define ITEM_ROW       ((uint)get_local_id(0) % BRICK_ITEMS)

kernel void snap_open(slab s, global ulong *words, global brick_state *bricks, global const uint *near,
                      global const uint *state) {
    const uint count = state[s.results.head_offset + STATE_NEAR_BRICKS];
    words += UNIFORM_BRICKS * BRICK_WORDS;
    for (uint step = 0; step < count; step += BRICKS_FURTHER) {
        const uint n = step + FIRST_BRICK, number = n < count ? near[n] : 0, sign = bricks[number].sign;
        const uint w = number % s.words_x, y0 = number / s.words_x % s.bricks_y * BRICK_ROWS;
        const uint z0 = s.results.word_z + number / s.words_x / s.bricks_y * BRICK_PLANES;
        for (uint row = ITEM_ROW; row < BRICK_WORDS && n < count; row += BRICK_ITEMS) {
            const bool exists = y0 + row % BRICK_ROWS < s.ny && z0 + row / BRICK_ROWS < s.z1;
            global ulong *word = words + BRICK_WORDS * (ulong)number + row;
            if (sign != SIGN_MIXED) *word = exists ? sign_word(sign) & word_valid(&s, w) : 0;
            word[BRICK_WORDS * (ulong)s.snapping.zero_bricks] = 0;
        }
        group_barrier();
        if (n < count && ITEM_ROW == 0) bricks[number].sign = SIGN_MIXED;
    }
}

/* ------------------------------------------------------------------------------------------------------------- links
 */

inline_always void link_enter(link_signs *l, uint n, lanes sign, lanes zero, lanes exists) {
    l->plus[n] = sign & ~zero & exists;
    l->minus[n] = ~sign & ~zero & exists;
    l->zero[n] = zero & exists;
}

inline_always lanes shifted_up(lanes word, lanes before) { return word << 1 | before >> 63; }
inline_always lanes shifted_down(lanes word, lanes after) { return word >> 1 | after << 63; }

/* Samples of a row that have one before them and one after them in x. */
inline_always ulong has_before(uint w) { return w ? ~0ul : ~1ul; }
inline_always ulong has_after(const slab *s, uint w) { return w + 1 < s->words_x ? ~0ul : word_valid(s, w) >> 1; }

/* Enters the samples a step away in y and z: in the column itself as sample n, at lower and at higher x as samples
 * `before` and `after`. */
inline_always void column_enter(const slab *s, stored_words m, uint y, uint z, uint w, int step_y, int step_z,
                                lanes exists, uint n, uint before, uint after, bool zeros, link_signs *l) {
    const uint plane = z + step_z;
    const lanes sign = rows_beside(s, m, y, plane, w, step_y, false);
    const lanes zero = zeros ? rows_beside(s, m, y, plane, w, step_y, true) : (lanes)0;
    if (n < LINK_EVEN) link_enter(l, n, sign, zero, exists);
    if (before >= LINK_EVEN) return;
    const lanes sign_low = rows_beside(s, m, y, plane, w - 1, step_y, false);
    const lanes sign_high = rows_beside(s, m, y, plane, w + 1, step_y, false);
    const lanes zero_low = zeros ? rows_beside(s, m, y, plane, w - 1, step_y, true) : (lanes)0;
    const lanes zero_high = zeros ? rows_beside(s, m, y, plane, w + 1, step_y, true) : (lanes)0;
    link_enter(l, before, shifted_up(sign, sign_low), shifted_up(zero, zero_low), exists & has_before(w));
    link_enter(l, after, shifted_down(sign, sign_high), shifted_down(zero, zero_high), exists & has_after(s, w));
}

#define NONE LINK_EVEN

/* The link of every sample of the rows: an odd or an even one. Of an even one, samples along the axes are odd and no
 * zeros yet. */
inline_always void link_load(const slab *s, stored_words m, uint y, uint z, uint w, bool odd, link_signs *l) {
    const lanes low = lanes_select(LANE_NUMBERS + y > (lanes)0),
                high = lanes_select(LANE_NUMBERS + (y + 1) < (lanes)s->ny);
    const lanes all = ~(lanes)0, below = z > s->results.word_z ? all : (lanes)0, above = z + 1 < s->z1 ? all : (lanes)0;
    column_enter(s, m, y, z, w, 0, 0, all, NONE, 0, 1, odd, l);
    column_enter(s, m, y, z, w, -1, 0, low, 2, odd ? NONE : 6, 7, true, l);
    column_enter(s, m, y, z, w, 1, 0, high, 3, odd ? NONE : 8, 9, true, l);
    column_enter(s, m, y, z, w, 0, -1, below, 4, odd ? NONE : 10, 11, true, l);
    column_enter(s, m, y, z, w, 0, 1, above, 5, odd ? NONE : 12, 13, true, l);
    if (odd) return;
    column_enter(s, m, y, z, w, -1, -1, low & below, 14, NONE, NONE, true, l);
    column_enter(s, m, y, z, w, 1, -1, high & below, 15, NONE, NONE, true, l);
    column_enter(s, m, y, z, w, -1, 1, low & above, 16, NONE, NONE, true, l);
    column_enter(s, m, y, z, w, 1, 1, high & above, 17, NONE, NONE, true, l);
}

/* On which borders of the grid samples are, by axis. */
typedef struct borders {
    lanes across[3];
} borders;

inline_always borders borders_of(const slab *s, uint y, uint z, uint w) {
    borders b = {{~((lanes)has_before(w) & has_after(s, w)),
                  lanes_select(LANE_NUMBERS + y == (lanes)0) | lanes_select(LANE_NUMBERS + (y + 1) == (lanes)s->ny),
                  z == 0 || z + 1 == s->nz ? ~(lanes)0 : (lanes)0}};
    return b;
}

/* The samples of a colour. */
inline_always lanes samples_of(const slab *s, uint y, uint z, uint w, uint colour) {
    const lanes exist = lanes_select(LANE_NUMBERS + y < (lanes)s->ny) & word_valid(s, w), even = even_rows(s, y, z);
    if (colour == COLOUR_ODD) return exist & ~even;
    const uint odd_k = (z + (uint)s->first[2]) & 1, odd_j = (colour >> 1) & 1;
    const lanes rows = lanes_select(((LANE_NUMBERS + (y + (uint)s->first[1])) & 1ul) == (lanes)odd_j);
    return COLOUR_EVEN(odd_j, odd_k) == colour ? exist & even & rows : (lanes)0;
}

#if MISSING
/* Samples of which all cubes in the grid are present. */
inline_always lanes cubes_around(const slab *s, global const ulong *cells, uint y, uint z, uint w) {
    lanes present = ~(lanes)0;
#pragma unroll 1
    for (uint n = 0; n < 4; n++) {
        const uint back_y = n & 1, back_z = n >> 1;
        if (z < back_z || z - back_z + 1 >= s->nz) continue;
        const lanes beside = LANE_NUMBERS + (ulong)y - (ulong)back_y; /* wraps below 0 */
        const lanes outside = lanes_select(beside + 1ul >= (lanes)s->ny) | lanes_select(beside + 1ul == (lanes)0ul);
        const lanes word = cells_rows(s, cells, y - back_y, z - back_z, w) | outside;
        const lanes low = (w ? cells_rows(s, cells, y - back_y, z - back_z, w - 1) : (lanes)~0ul) | outside;
        present &= (word | ~(lanes)has_after(s, w)) & shifted_up(word, low);
    }
    return present;
}
#endif

/* ------------------------------------------------------------------------------------------------------------ passes
 */

#ifdef REAL

#define LINK_STEP(x, y, z) {x, y, z},
constant const char link_steps[LINK_EVEN][3] = {LINK_SAMPLES(LINK_STEP)};

/* Whether the sample at index `at` is near enough to a crossing; border: bits of axes along which it may not move. */
inline_always bool sample_wishes(const slab *s, ulong at, bool odd, uint border, global const BITS *samples) {
    const BITS sample = samples[at];
    const bool inside = bits_inside(sample, &s->test);
    const uint count = odd ? LINK_ODD : LINK_EVEN;
    REAL steepness = 0;
#pragma unroll 1
    for (uint n = 0; n < count; n++) {
        const int step_x = link_steps[n][0], step_y = link_steps[n][1], step_z = link_steps[n][2];
        if ((border & 1 && step_x) || (border & 2 && step_y) || (border & 4 && step_z)) continue;
        const BITS other = samples[(long)at + step_x + (step_y + step_z * (long)s->ny) * (long)s->nx];
        if (bits_inside(other, &s->test) != inside && crossing_is_nearer(s, sample, other, false, &steepness))
            return true;
    }
    return false;
}

/* Which samples of LANES rows have a crossing along which they may move. */
inline_always lanes rows_crossed(const slab *s, stored_words m, uint y, uint z, uint w, const borders *b) {
    const lanes sign = rows_beside(s, m, y, z, w, 0, false), even = even_rows(s, y, z);
    link_signs l;
    lanes crossed_axis = 0, crossed_across = 0;
    link_load(s, m, y, z, w, false, &l);
#pragma unroll
    for (uint n = 0; n < LINK_EVEN; n++) {
        const lanes *c = b->across;
        const lanes stays = n < 2    ? c[0]
                            : n < 4  ? c[1]
                            : n < 6  ? c[2]
                            : n < 10 ? c[0] | c[1]
                            : n < 14 ? c[0] | c[2]
                                     : c[1] | c[2];
        const lanes opposite = ((sign & l.minus[n]) | (~sign & l.plus[n])) & ~stays;
        if (n < LINK_ODD)
            crossed_axis |= opposite;
        else
            crossed_across |= opposite;
    }
    return crossed_axis | (crossed_across & even);
}

/* wishes: a word for each row of the bricks near the surface. */
kernel void snap_wish(slab s, global const BITS *samples, global const ulong *cells, global ulong *words,
                      global brick_state *bricks, global const uint *near, global const uint *state,
                      global ulong *wishes) {
    const uint count = state[s.results.head_offset + STATE_NEAR_BRICKS];
    const stored_words m = {words + UNIFORM_BRICKS * BRICK_WORDS, bricks};
    for (uint n = FIRST_BRICK; n < count; n += BRICKS_FURTHER) {
        const uint number = near[n], w = number % s.words_x, y0 = number / s.words_x % s.bricks_y * BRICK_ROWS;
        const uint z0 = s.results.word_z + number / s.words_x / s.bricks_y * BRICK_PLANES;
        for (uint row = ITEM_ROW; row < BRICK_WORDS; row += LANES * BRICK_ITEMS) {
            const uint y = y0 + row % BRICK_ROWS, z = z0 + row / BRICK_ROWS;
            ulong wish[LANES];
            lanes crossed_any = 0;
            const borders b = borders_of(&s, y, z, w);
            if (y < s.ny && z < s.z1) {
                crossed_any = rows_crossed(&s, m, y, z, w, &b) & word_valid(&s, w);
                crossed_any &= lanes_select(LANE_NUMBERS + y < (lanes)s.ny);
#if MISSING
                if (lanes_any(crossed_any)) crossed_any &= cubes_around(&s, cells, y, z, w);
#endif
            }
            for (uint lane = 0; lane < LANES; lane++) {
                wish[lane] = 0;
                for (ulong rest = lane_of(&crossed_any, lane); rest; rest &= rest - 1) {
                    const uint bit = lowest_bit(rest);
                    const uint border = (uint)(lane_of(&b.across[0], lane) >> bit & 1) |
                                        (uint)(lane_of(&b.across[1], lane) >> bit & 1) << 1 |
                                        (uint)(lane_of(&b.across[2], lane) >> bit & 1) << 2;
                    const bool odd = (s.parity + bit + y + lane + z) & 1;
                    if (sample_wishes(&s, row_start(&s, y + lane, z) + 64ul * w + bit, odd, border, samples))
                        wish[lane] |= 1ul << bit;
                }
            }
            lanes_store(lanes_of(wish), wishes + BRICK_WORDS * (ulong)number + row);
        }
    }
}

#endif

/* ------------------------------------------------------------------------------------------------------------ passes
 */

/* The samples of the colour in LANES rows that become zeros. */
inline_always lanes rows_snap(const slab *s, stored_words m, uint y, uint z, uint w, lanes wanted, bool odd) {
    link_signs l;
    const borders b = borders_of(s, y, z, w);
    link_load(s, m, y, z, w, odd, &l);
    return points_regular(&l, b.across, wanted, odd);
}

/* Those of the last colour replace the wishes. */
kernel void snap_pass(slab s, uint colour, global ulong *words, global brick_state *bricks, global const uint *near,
                      global const uint *state, global ulong *wishes) {
    const uint count = state[s.results.head_offset + STATE_NEAR_BRICKS];
    const stored_words m = {words + UNIFORM_BRICKS * BRICK_WORDS, bricks};
    for (uint n = FIRST_BRICK; n < count; n += BRICKS_FURTHER) {
        const uint number = near[n], w = number % s.words_x, y0 = number / s.words_x % s.bricks_y * BRICK_ROWS;
        const uint z0 = s.results.word_z + number / s.words_x / s.bricks_y * BRICK_PLANES;
        for (uint row = ITEM_ROW; row < BRICK_WORDS; row += LANES * BRICK_ITEMS) {
            const uint y = y0 + row % BRICK_ROWS, z = z0 + row / BRICK_ROWS;
            const ulong index = BRICK_WORDS * (ulong)number + row;
            lanes wanted = lanes_load(wishes + index) & samples_of(&s, y, z, w, colour);
            if (lanes_any(wanted))
                wanted = colour == COLOUR_ODD ? rows_snap(&s, m, y, z, w, wanted, true)
                                              : rows_snap(&s, m, y, z, w, wanted, false);
            if (colour == COLOUR_ODD)
                lanes_store(wanted, wishes + index);
            else if (lanes_any(wanted))
                lanes_add(wanted, m.words + BRICK_WORDS * (ulong)s.snapping.zero_bricks + index);
        }
    }
}

kernel void snap_close(slab s, global ulong *words, global const uint *near, global const uint *state,
                       global const ulong *last) {
    const uint count = state[s.results.head_offset + STATE_NEAR_BRICKS];
    words += BRICK_WORDS * (UNIFORM_BRICKS + (ulong)s.snapping.zero_bricks);
    for (uint n = FIRST_BRICK; n < count; n += BRICKS_FURTHER)
        for (uint row = ITEM_ROW; row < BRICK_WORDS; row += BRICK_ITEMS) {
            const ulong index = BRICK_WORDS * (ulong)near[n] + row;
            words[index] |= last[index];
        }
}

#endif
