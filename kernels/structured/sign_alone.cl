/*
 * sign_alone.cl - signs of bricks where a work-item has bricks to itself: it visits blocks of bricks, to read samples
 * in long runs, 64 at a time
 */
#ifndef SIGN_ALONE_CL
#define SIGN_ALONE_CL

#include "sign.cl"

inline_always samples64 keys64(samples64 bits, const isovalue_test *test) {
#if FLOATING
    return bits ^ (signs64(bits) | KEY_SIGN);
#else
    return bits ^ (BITS)test->key_flip;
#endif
}

inline_always ulong word_make(samples64 bits, const isovalue_test *test) {
    return at_most64(bits - (BITS)test->inside_low, (samples64)(BITS)test->inside_span);
}

/* 64 samples of a row. Those past its end repeat the first, so that they do not change the range. */
inline_always samples64 samples_load64(global const BITS *samples, const slab *s, uint y, uint z, uint w) {
    uint left = s->nx - 64 * w;
    ulong start = row_start(s, y, z) + 64ul * w;
    global const BITS *first = samples + start;
    if (left >= 64) return *(global const samples64_unaligned *)first;
    if (start + 64 <= s->arrays.sample_offset + s->arrays.sample_count) {
        samples64 bits = *(global const samples64_unaligned *)first;
        return lane64 < (BITS)left ? bits : (samples64)bits[0];
    }
    BITS row[64];
    for (uint n = 0; n < 64; n++) row[n] = first[n < left ? n : 0];
    return *(const samples64_unaligned *)row;
}

typedef union keys_parts {
    samples64 all;
    line_keys line[64 / LINE_KEYS];
    BITS16 sixteen[4];
} keys_parts;

inline_always void line_widen(samples64 keys, line_keys *low, line_keys *high) {
    keys_parts parts = {keys};
    line_keys least = *low, most = *high;
    loop_unrolled for (uint n = 0; n < 64 / LINE_KEYS; n++) {
        least = parts.line[n] < least ? parts.line[n] : least;
        most = parts.line[n] > most ? parts.line[n] : most;
    }
    *low = least, *high = most;
}

inline_always brick_range line_range(line_keys low, line_keys high) {
    keys_parts l, h;
    l.line[0] = low, h.line[0] = high;
    BITS16 least = l.sixteen[0], most = h.sixteen[0];
    for (uint n = 1; n < LINE_KEYS / 16; n++) least = min(least, l.sixteen[n]), most = max(most, h.sixteen[n]);
    brick_range range = {keys_least(least), keys_most(most)};
    return range;
}

/* Makes the words of a mixed brick. */
inline_always void brick_words_make(const slab *s, uint y0, uint z0, uint w, global const BITS *samples,
                                    global ulong *out) {
    ulong valid = word_valid(s, w);
    for (uint brick_row = 0; brick_row < BRICK_WORDS; brick_row++) {
        uint y = y0 + brick_row % BRICK_ROWS, z = z0 + brick_row / BRICK_ROWS;
        bool exists = y < s->ny && z < s->z1;
        out[brick_row] = exists ? word_make(samples_load64(samples, s, y, z, w), &s->test) & valid : 0;
    }
}

#define RUN_BRICKS_X 8

/* Prefetches the samples of `count` words. */
inline_always void row_prefetch(const slab *s, uint y, uint z, uint w, uint count, global const BITS *samples) {
    global const BITS *row = samples + row_start(s, min(y, s->ny - 1), min(z, s->nz - 1)) + 64ul * w;
    for (uint n = 0; n < 64 * count; n += 64 / sizeof(BITS)) line_prefetch(row + n);
}

#define BLOCK_BRICKS   64
#define PREFETCH_BYTES 4096

/* Bricks read together: `rows` rows of `count` bricks, at most BLOCK_BRICKS in all. Each plane is read row after
 * row. Where `count` bricks make whole rows of the grid, that is one long run, which memory serves faster than short
 * ones. */
typedef struct read_block {
    uint y, z, w; /* of the first word */
    uint rows, count;
} read_block;

/* Makes words, ranges and signs of a block on the first visit. Prefetches what is read PREFETCH_BYTES later, also in
 * the next plane or the next block, as hardware prefetch stops at page ends. */
inline_always void block_read(const slab *s, read_block p, global const BITS *samples, global ulong *words,
                              global brick_state *bricks, global brick_range *ranges, global uint *nonfinite) {
    const uint rows = p.rows * BRICK_ROWS, rows_ahead = max(PREFETCH_BYTES / (64 * (uint)sizeof(BITS) * p.count), 1u);
    ulong word[BLOCK_BRICKS][BRICK_WORDS];
    line_keys low[BLOCK_BRICKS], high[BLOCK_BRICKS];
    for (uint n = 0; n < p.rows * p.count; n++) low[n] = (BITS) ~(BITS)0, high[n] = 0;
    for (uint plane = 0; plane < BRICK_PLANES; plane++) {
        const uint z = p.z + plane, have = z < s->z1 ? min(rows, s->ny - p.y) : 0;
        const bool last = plane + 1 == BRICK_PLANES;
        global const BITS *ahead = samples + row_start(s, p.y, z) + 64ul * p.w + rows_ahead * (ulong)s->nx;
        for (uint row = 0; row < rows; row++, ahead += s->nx) {
            const uint first = row / BRICK_ROWS * p.count, brick_row = BRICK_ROWS * plane + row % BRICK_ROWS;
            if (row + rows_ahead == rows) /* from here on in the next plane or block */
                ahead = samples + row_start(s, last ? p.y + rows : p.y, last ? p.z : z + 1) + 64ul * p.w;
            for (uint n = 0; n < p.count && row < have; n++) {
                loop_unrolled for (uint m = 0; m < 64; m += 64 / sizeof(BITS)) line_prefetch(ahead + 64 * n + m);
                samples64 bits = samples_load64(samples, s, p.y + row, z, p.w + n);
                word[first + n][brick_row] = word_make(bits, &s->test);
                line_widen(keys64(bits, &s->test), &low[first + n], &high[first + n]);
            }
            for (uint n = 0; n < p.count && row >= have; n++) word[first + n][brick_row] = 0;
        }
    }
    for (uint n = 0; n < p.rows * p.count; n++) {
        uint w = p.w + n % p.count, brick = brick_index(s, p.y + n / p.count * BRICK_ROWS, p.z, w);
        brick_range range = line_range(low[n], high[n]);
        uint sign = range_sign(&s->test, range);
        ranges[s->results.range_offset + brick] = range;
        brick_sign_store(brick, sign, bricks);
#if FLOATING && !MISSING
        if (!range_finite(range)) atomic_or(nonfinite, 1u);
#endif
        if (sign != SIGN_MIXED) continue;
        ulong valid = word_valid(s, w);
        for (uint brick_row = 0; brick_row < BRICK_WORDS; brick_row++)
            words[(ulong)BRICK_WORDS * brick + brick_row] = word[n][brick_row] & valid;
    }
}

/* The side that all bricks of a run are on by their ranges, or SIGN_MIXED. */
inline_always uint run_sign(const isovalue_test *test, global const brick_range *ranges, uint count) {
    brick_range whole = ranges[0];
    if (count == RUN_BRICKS_X) {
        uint16 r = vload16(0, (global const uint *)ranges);
        uint4 low = min(r.even.lo, r.even.hi), high = max(r.odd.lo, r.odd.hi);
        whole.low = min(min(low.x, low.y), min(low.z, low.w));
        whole.high = max(max(high.x, high.y), max(high.z, high.w));
    }
    for (uint n = 1; n < count && count != RUN_BRICKS_X; n++) {
        whole.low = min(whole.low, ranges[n].low);
        whole.high = max(whole.high, ranges[n].high);
    }
    return range_sign(test, whole);
}

/* Stores signs of bricks whose ranges are known. Prefetches the samples of mixed bricks; returns these, a bit each. */
inline_always uint run_sign_again(const slab *s, uint y0, uint z0, uint w, uint count, global const BITS *samples,
                                  global brick_state *bricks, global const brick_range *ranges) {
    const uint first = brick_index(s, y0, z0, w);
    const uint sign = run_sign(&s->test, ranges + s->results.range_offset + first, count);
    uint mixed = 0;
    for (uint n = 0; n < count; n++) brick_sign_store(first + n, sign, bricks);
    for (uint n = 0; n < count && sign == SIGN_MIXED; n++) {
        uint own = range_sign(&s->test, ranges[s->results.range_offset + first + n]);
        bricks[first + n].sign = own;
        if (own != SIGN_MIXED) continue;
        mixed |= 1u << n;
        for (uint brick_row = 0; brick_row < BRICK_WORDS; brick_row++)
            row_prefetch(s, y0 + brick_row % BRICK_ROWS, z0 + brick_row / BRICK_ROWS, w + n, 1, samples);
    }
    return mixed;
}

inline_always void run_words_make(const slab *s, uint y0, uint z0, uint w, uint mixed, global const BITS *samples,
                                  global ulong *words) {
    ulong first = brick_index(s, y0, z0, w);
    for (uint n = 0; mixed >> n; n++)
        if (mixed >> n & 1) brick_words_make(s, y0, z0, w + n, samples, words + BRICK_WORDS * (first + n));
}

/* A layer whose ranges are known. The words of a run with mixed bricks are made after the next such run is prefetched.
 */
inline_always void layer_sign_again(const slab *s, uint y0, uint y1, uint z, global const BITS *samples,
                                    global ulong *words, global brick_state *bricks, global const brick_range *ranges) {
    uint pending = 0, pending_y = y0, pending_w = 0;
    for (uint y = y0; y < y1; y += BRICK_ROWS)
        for (uint w = 0; w < s->words_x; w += RUN_BRICKS_X) {
            uint count = min((uint)RUN_BRICKS_X, s->words_x - w);
            uint mixed = run_sign_again(s, y, z, w, count, samples, bricks, ranges);
            if (!mixed) continue;
            run_words_make(s, pending_y, z, pending_w, pending, samples, words);
            pending = mixed, pending_y = y, pending_w = w;
        }
    run_words_make(s, pending_y, z, pending_w, pending, samples, words);
}

/* A group needs no local memory here. */
typedef struct sign_memory {
    uint none;
} sign_memory;

/* The bricks of rows y0 <= y < y1 in the layer that begins with plane z. */
inline_always void layer_sign(const slab *s, uint y0, uint y1, uint z, global const BITS *samples, global ulong *words,
                              global brick_state *bricks, global brick_range *ranges, global uint *nonfinite,
                              local sign_memory *memory) {
    if (s->results.ranges_known) {
        layer_sign_again(s, y0, y1, z, samples, words, bricks, ranges);
        return;
    }
    const uint most = min(s->words_x, (uint)BLOCK_BRICKS), step = BLOCK_BRICKS / most * BRICK_ROWS;
    for (uint y = y0; y < y1; y += step)
        for (uint w = 0; w < s->words_x; w += most) {
            read_block p = {y, z, w, (min(step, y1 - y) + BRICK_ROWS - 1) / BRICK_ROWS, min(most, s->words_x - w)};
            block_read(s, p, samples, words, bricks, ranges, nonfinite);
        }
}

/* The word at w of a row of any tile; `sign` is the side of its brick. */
inline_always ulong word_at(const slab *s, uint y, uint z, uint w, uint sign, global const BITS *samples) {
    ulong word = sign == SIGN_MIXED ? word_make(samples_load64(samples, s, y, z, w), &s->test) : sign_word(sign);
    return word & word_valid(s, w);
}

/* Makes the words of a row; the next function, those of rows y to y + 7, below y1, brick by brick. */
inline_always void row_words_make(const slab *s, uint y, uint z, global const BITS *samples,
                                  global const brick_range *ranges, global ulong *out) {
    for (uint w = 0; w < s->words_x; w++) out[w] = word_at(s, y, z, w, sign_known(s, y, z, w, ranges), samples);
}

inline_always void rows_words_make(const slab *s, uint y, uint y1, uint z, global const BITS *samples,
                                   global const brick_range *ranges, global ulong *out) {
    for (uint w = 0; w < s->words_x; w++) {
        uint sign = sign_known(s, y, z, w, ranges);
        vstore8((lanes)(sign_word(sign) & word_valid(s, w)), w, out);
        for (uint n = 0; n < BRICK_ROWS && sign == SIGN_MIXED && y + n < y1; n++)
            out[BRICK_ROWS * w + n] = word_at(s, y + n, z, w, sign, samples);
    }
}

#endif
