/*
 * interval_count.cl - kernel interval_count: tetrahedra and samples within of every row of 64 cubes, and of bricks
 *
 * How many tetrahedra a tetrahedron of the grid gives depends on how many of its corners are not below, and how many
 * above. Both numbers are made bit by bit for 64 cubes; then there is a population count for each pair of them.
 */
#ifndef INTERVAL_COUNT_CL
#define INTERVAL_COUNT_CL

#include "interval_rows.cl"

/* Where exactly n of four words are set, for n from 0 to 4. */
typedef struct words_counted {
    ulong exactly[5];
} words_counted;

inline_always words_counted corners_count(ulong a, ulong b, ulong c, ulong d) {
    const ulong sum = a ^ b ^ c, carry = (a & b) | (c & (a ^ b));
    const ulong ones = sum ^ d, over = sum & d, twos = carry ^ over, fours = carry & over;
    words_counted n = {{~(ones | twos | fours), ones & ~twos, twos & ~ones, ones & twos, fours}};
    return n;
}

/* Corners of the cubes of a row; in an odd cube corner n is at n ^ 1, as it is the mirror in x of an even one. */
inline_always void corners_take(const sample_rows rows[4], ulong even, ulong p[8]) {
#pragma unroll
    for (uint n = 0; n < 4; n++) {
        p[2 * n] = choose(even, rows[n].at, rows[n].next);
        p[2 * n + 1] = choose(even, rows[n].next, rows[n].at);
    }
}

inline_always uint pairs_count(const words_counted *low, const words_counted *high, ulong cubes,
                               global const uint *counts) {
    uint sum = 0;
#pragma unroll
    for (uint n = 1; n < 5; n++) {
        const ulong some = low->exactly[n] & cubes;
#pragma unroll
        for (uint m = 0; m < 4 && m <= n; m++) sum += counts[5 * n + m] * (uint)popcount(some & high->exactly[m]);
    }
    return sum;
}

/* Tetrahedra of a row of cubes. */
inline_always uint row_tetrahedra_count(const slab *s, const interval_rows *r, ulong cubes, uint y, uint z,
                                        global const uint *counts) {
    const uint corners[5] = {0x0356, 0x1035, 0x2036, 0x4056, 0x7356};
    ulong low[8], high[8];
    uint sum = 0;
    corners_take(r->low, even_cubes(s, y, z), low);
    corners_take(r->high, even_cubes(s, y, z), high);
#pragma unroll
    for (uint n = 0; n < 5; n++) {
        const uint a = corners[n] >> 12, b = corners[n] >> 8 & 7, c = corners[n] >> 4 & 7, d = corners[n] & 7;
        const words_counted not_below = corners_count(low[a], low[b], low[c], low[d]);
        const words_counted above = corners_count(high[a], high[b], high[c], high[d]);
        sum += pairs_count(&not_below, &above, cubes, counts);
    }
    return sum;
}

/* Counts a brick; of bricks behind those that are emitted only samples. rows: for each row, tetrahedra before it
 * in the brick in the upper half, and samples in the lower half. */
inline_always interval_brick volume_brick_count(const slab *s, const bound *low, const bound *high,
                                                global const ulong *cells, uint brick, bool is_own,
                                                global const uint *counts, global uint *rows) {
    const grid_index origin = brick_origin(s, brick);
    const bool within = brick_is(s, low, brick, SIGN_INSIDE) && brick_is(s, high, brick, SIGN_OUTSIDE);
    interval_brick sum = {0, 0};
    if (brick_is(s, low, brick, SIGN_OUTSIDE) || brick_is(s, high, brick, SIGN_INSIDE)) return sum;
    for (uint n = 0; n < BRICK_WORDS; n++) {
        const uint y = origin.y + n % BRICK_ROWS, z = origin.z + n / BRICK_ROWS, w = origin.x / 64;
        rows[n] = sum.tetrahedra << 16 | sum.samples;
        if (y >= s->ny || z >= s->z1) continue;
        sum.samples += (uint)popcount(samples_within(s, low, high, cells, y, z, w));
        const ulong present = is_own ? cubes_present(s, cells, y, z, w) : 0;
        if (within) {
            sum.tetrahedra += 5 * (uint)popcount(present);
        } else if (present) {
            const interval_rows r = rows_load(s, low, high, y, z, w);
            const ulong cubes = cubes_reached(&r, present);
            if (cubes) sum.tetrahedra += row_tetrahedra_count(s, &r, cubes, y, z, counts);
        }
    }
    return sum;
}

/* All work-items together go through the bricks of the window. counts: INTERVAL_COUNTS numbers. */
kernel void interval_count(slab s, interval_job job, global const ulong *cells, global const ulong *low_words,
                           global const brick_state *low_bricks, global const ulong *high_words,
                           global const brick_state *high_bricks, global const uint *counts, global uint *rows,
                           global interval_brick *bricks) {
    const bound low = bound_of(low_words, 0, low_bricks, job.has_low, ~0ul);
    const bound high = bound_of(high_words, 0, high_bricks, job.has_high, 0);
    for (uint n = (uint)get_global_id(0); n < job.all_bricks; n += (uint)get_global_size(0))
        bricks[n] = volume_brick_count(&s, &low, &high, cells, n, n < job.own_bricks, counts, rows + BRICK_WORDS * n);
}

#endif
