/*
 * sign_groups.cl - signs of bricks where the work-items of a group share them: four take a row of 64 samples
 */
#ifndef SIGN_GROUPS_CL
#define SIGN_GROUPS_CL

#include "sign.cl"

#define BRICKS_AT_ONCE (WORK_ITEMS / BRICK_WORDS)
#define ROW_PARTS      4 /* of 16 samples */

/* A work-item's part of a brick's words and range. */
inline_always void part_read(const slab *s, uint y, uint z, uint part, global const BITS *samples, global ulong *word,
                             local brick_range *range) {
    const uint count = 16 * part < s->nx ? min(s->nx - 16 * part, 16u) : 0;
    global const BITS *row = samples + row_start(s, y, z) + 16 * part;
    BITS low = (BITS) ~(BITS)0, high = 0;
    uint signs = 0;
#pragma unroll 4
    for (uint n = 0; n < count; n++) {
        const BITS bits = row[n], key = key_of(bits, &s->test);
        signs |= (uint)bits_inside(bits, &s->test) << n;
        low = min(low, key), high = max(high, key);
    }
    ((global ushort *)word)[part % ROW_PARTS] = (ushort)signs;
    if (s->results.ranges_known || !count) return;
    atomic_min(&range->low, key_upper(low));
    atomic_max(&range->high, key_upper(high));
}

/* What a group needs of local memory. */
typedef struct sign_memory {
    brick_range found[BRICKS_AT_ONCE];
} sign_memory;

/* The bricks of rows y0 <= y < y1 in the layer that begins with plane z. No variable lives across a barrier, as some
 * compilers make wrong code for that. */
inline_always void layer_sign(const slab *s, uint y0, uint y1, uint z, global const BITS *samples, global ulong *words,
                              global brick_state *bricks, global brick_range *ranges, global uint *nonfinite,
                              local sign_memory *memory) {
    local brick_range *found = memory->found;
    const uint first = brick_index(s, y0, z, 0);
    const uint count = (y1 - y0 + BRICK_ROWS - 1) / BRICK_ROWS * s->words_x;
    for (uint n = 0; n < count; n += BRICKS_AT_ONCE) {
        {
            uint lid = (uint)get_local_id(0), brick = first + min(n + lid, count - 1);
            if (lid < BRICKS_AT_ONCE) {
                found[lid].low = s->results.ranges_known ? ranges[s->results.range_offset + brick].low : ~0u;
                found[lid].high = s->results.ranges_known ? ranges[s->results.range_offset + brick].high : 0;
            }
        }
        group_barrier();
        for (uint step = 0; step < ROW_PARTS; step++) {
            uint item = step * WORK_ITEMS + (uint)get_local_id(0), b = item / (ROW_PARTS * BRICK_WORDS);
            uint brick_row = item / ROW_PARTS % BRICK_WORDS, brick = n + b, w = brick % s->words_x;
            uint y = y0 + brick / s->words_x * BRICK_ROWS + brick_row % BRICK_ROWS, zp = z + brick_row / BRICK_ROWS;
            bool wanted = brick < count && y < s->ny && zp < s->z1;
            if (wanted && s->results.ranges_known) wanted = range_sign(&s->test, found[b]) == SIGN_MIXED;
            if (wanted)
                part_read(s, y, zp, ROW_PARTS * w + item % ROW_PARTS, samples,
                          words + (ulong)BRICK_WORDS * (first + brick) + brick_row, &found[b]);
        }
        group_barrier();
        {
            uint lid = (uint)get_local_id(0), brick = first + n + lid;
            if (lid < BRICKS_AT_ONCE && n + lid < count) {
                brick_range range = found[lid];
                brick_sign_store(brick, range_sign(&s->test, range), bricks);
                if (!s->results.ranges_known)
                    ranges[s->results.range_offset + brick] = range; /* not stored again: others may be reading */
#if FLOATING && !MISSING
                if (!range_finite(range)) atomic_or(nonfinite, 1u);
#endif
            }
        }
        group_barrier();
    }
}

/* Makes the words of a row and stores them `stride` words apart. */
inline_always void row_words_spread(const slab *s, uint y, uint z, global const BITS *samples,
                                    global const brick_range *ranges, global ulong *out, uint stride) {
    for (uint first = 0; first < ROW_PARTS * s->words_x; first += WORK_ITEMS) {
        uint part = first + (uint)get_local_id(0), w = part / ROW_PARTS;
        if (w < s->words_x) {
            uint sign = sign_known(s, y, z, w, ranges);
            uint bits = sign == SIGN_MIXED ? word_part(samples, s, y, z, part)
                                           : (uint)((sign_word(sign) & word_valid(s, w)) >> (16 * (part % ROW_PARTS)));
            ((global ushort *)(out + (ulong)stride * w))[part % ROW_PARTS] = (ushort)bits;
        }
    }
}

inline_always void row_words_make(const slab *s, uint y, uint z, global const BITS *samples,
                                  global const brick_range *ranges, global ulong *out) {
    row_words_spread(s, y, z, samples, ranges, out, 1);
}

/* Makes the words of rows y to y + 7, below y1, brick by brick. */
inline_always void rows_words_make(const slab *s, uint y, uint y1, uint z, global const BITS *samples,
                                   global const brick_range *ranges, global ulong *out) {
    for (uint n = 0; n < BRICK_ROWS && y + n < y1; n++)
        row_words_spread(s, y + n, z, samples, ranges, out + n, BRICK_ROWS);
}

#endif
