/*
 * snap.cl - method snap: samples near the surface become vertices of it, before kernel 1 counts
 *
 * host/lib/reference/reference_snap.c is the twin. Kernels, in order:
 *
 * 1. snap_sign: the first stage of kernel 1 (sign.cl), over all bricks;
 * 2. snap_near: lists the bricks that are mixed or beside a brick on another side;
 * 3. snap_violated: which of their samples are violated, near enough to a crossing of theirs; lists the bricks that
 * have any. Mixed bricks get words of zeros, empty so far;
 * 4. snap_words: bricks on that list that are uniform get sign words of their own, and words of zeros;
 * 5. snap_even, once for each colour of even samples (link.h), and snap_odd: violated samples that are regular points
 *    (regular_alone.cl, regular_groups.cl) become zeros. Samples of one colour do not see each other, so a word
 *    that another group stores to meanwhile has the same bits for its readers before and after;
 * 6. snap_join: the zeros of odd samples, which snap_odd has stored in `violated`, are added to the words of zeros.
 */
#ifndef SNAP_CL
#define SNAP_CL

#include "../structured/cells.cl"
#include "../structured/count.cl"
#include "snap_crossed.cl"

inline_always global uint *snap_ticket(const slab *s, global uint *state, uint ticket) {
    return state + s->results.head_offset + STATE_SNAP_TICKET + ticket;
}

/* The next run of this length that the group takes. Called by the whole group. */
inline_always uint run_take(global uint *ticket, uint length, local uint *shared) {
    group_barrier();
    if (get_local_id(0) == 0) shared[0] = length * atomic_inc(ticket);
    group_barrier();
    return shared[0];
}

kernel void snap_sign(slab s, global const BITS *samples, global brick_range *ranges, global ulong *words,
                      global brick_state *bricks, global uint *state) {
    local sign_memory memory;
    local uint shared[1];
    global uint *ticket = snap_ticket(&s, state, TICKET_SIGN);
    words += UNIFORM_BRICKS * BRICK_WORDS;
    for (uint n = run_take(ticket, 1, shared); n < s.tiling.tile_count; n = run_take(ticket, 1, shared)) {
        const tile t = tile_locate(&s, n);
        for (uint z = t.z0; z < t.z1; z += BRICK_PLANES)
            layer_sign(&s, t.y0, t.y1, z, samples, words, bricks, ranges,
                       &state[s.results.head_offset + STATE_NONFINITE], &memory);
    }
}

/* ----------------------------------------------------------------------------------------------------------- bricks */

inline_always uint brick_count_of(const slab *s) { return window_layers(s) * s->bricks_y * s->words_x; }

/* Whether a brick is mixed, or one around it is on another side. */
inline_always bool brick_near(const slab *s, uint brick, global const brick_state *bricks) {
    const brick_steps steps = brick_steps_of(s, brick);
    const uint sign = bricks[brick].sign;
    uint differ = 0;
    if (sign == SIGN_MIXED) return true;
#pragma unroll
    for (uint n = 0; n < 27; n++)
        differ |= bricks[brick + steps.layer[n / 9] + steps.row[n / 3 % 3] + steps.word[n % 3]].sign ^ sign;
    return differ != 0;
}

/* Bricks that are entered in the list together, so that work-items alone do not wait for each other at every brick. */
#define NEAR_AT_ONCE (WORK_ITEMS == 1 ? 64u : 1u)

kernel void snap_near(slab s, global const brick_state *bricks, global uint *near, global uint *state) {
    const uint count = brick_count_of(&s), step = NEAR_AT_ONCE * (uint)get_global_size(0);
    for (uint first = NEAR_AT_ONCE * (uint)get_global_id(0); first < count; first += step) {
        uint found[NEAR_AT_ONCE], found_count = 0;
        for (uint n = first; n < min(first + NEAR_AT_ONCE, count); n++)
            if (brick_near(&s, n, bricks)) found[found_count++] = n;
        if (!found_count) continue;
        const uint at = atomic_add(&state[s.results.head_offset + STATE_NEAR_BRICKS], found_count);
        for (uint n = 0; n < found_count; n++) near[at + n] = found[n];
    }
}

/* Work-items per brick: one for each of its rows, or one for all. */
#define BRICK_ITEMS  (BRICK_WORDS / (WORK_ITEMS == 1 ? BRICK_WORDS : 1))
#define GROUP_BRICKS (WORK_ITEMS / BRICK_ITEMS)
#define OWN_BRICK    ((uint)get_local_id(0) / BRICK_ITEMS)
#define ITEM_ROW     ((uint)get_local_id(0) % BRICK_ITEMS)

/* Bricks near the surface that a group takes at once. */
inline_always uint run_length(uint count) {
    return clamp(count / (16 * (uint)get_num_groups(0)), (uint)GROUP_BRICKS, 256u);
}

/* RUNS_OF takes runs of a list of `count` bricks by ticket, BRICKS_OF_RUN goes over a run, GROUP_BRICKS at a time. They
 * use `shared`, and define length, run, end and step. */
#define RUNS_OF(count, ticket)                                                                                         \
    const uint length = run_length(count);                                                                             \
    for (uint run = run_take(ticket, length, shared); run < count; run = run_take(ticket, length, shared))
#define BRICKS_OF_RUN(count) for (uint end = min(run + length, count), step = run; step < end; step += GROUP_BRICKS)

#ifdef REAL

#if WORK_ITEMS == 1
#include "snap_violated_alone.cl"
#else
#include "snap_violated_groups.cl"
#endif

/* violated: a word for each row of the bricks near the surface. Mixed bricks get words of zeros. */
kernel void snap_violated(slab s, global const BITS *samples, global const ulong *cells, global ulong *words,
                          global brick_state *bricks, global const uint *near, global uint *state,
                          global ulong *violated, global uint *violated_bricks) {
    local uint shared[1];
    const uint count = state[s.results.head_offset + STATE_NEAR_BRICKS];
    violated_work work;
    brick_around a;
    words += UNIFORM_BRICKS * BRICK_WORDS;
    global ulong *zeros = words + BRICK_WORDS * (ulong)s.snapping.zero_bricks;
    violated_results results = {violated, bricks, violated_bricks,
                                &state[s.results.head_offset + STATE_VIOLATED_BRICKS]};
    violated_begin(&s, &work);
    RUNS_OF(count, snap_ticket(&s, state, TICKET_VIOLATED)) BRICKS_OF_RUN(count) {
        const uint n = step + OWN_BRICK, brick = near[min(n, end - 1)];
        if (n >= end) continue;
        for (uint row = ITEM_ROW; row < BRICK_WORDS && bricks[brick].sign == SIGN_MIXED; row += BRICK_ITEMS)
            zeros[BRICK_WORDS * (ulong)brick + row] = 0;
        around_make(&s, words, bricks, brick, &a);
        violated_find(&s, &a, brick_origin(&s, brick), brick, samples, cells, results, &work);
    }
    violated_end(&s, samples, results, &work);
}

#endif

/* Uniform bricks that have violated samples get words of their own, and words of zeros. */
kernel void snap_words(slab s, global ulong *words, global brick_state *bricks, global const uint *violated_bricks,
                       global uint *state) {
    local uint shared[1];
    const uint count = state[s.results.head_offset + STATE_VIOLATED_BRICKS];
    words += UNIFORM_BRICKS * BRICK_WORDS;
    RUNS_OF(count, snap_ticket(&s, state, TICKET_WORDS)) BRICKS_OF_RUN(count) {
        const uint n = step + OWN_BRICK, brick = violated_bricks[min(n, end - 1)], sign = bricks[brick].sign;
        const grid_index origin = brick_origin(&s, brick);
        for (uint row = ITEM_ROW; row < BRICK_WORDS && n < end && sign != SIGN_MIXED; row += BRICK_ITEMS) {
            const bool exists = origin.y + row % BRICK_ROWS < s.ny && origin.z + row / BRICK_ROWS < s.z1;
            global ulong *word = words + BRICK_WORDS * (ulong)brick + row;
            *word = exists ? sign_word(sign) & word_valid(&s, brick_word(&s, brick)) : 0;
            word[BRICK_WORDS * (ulong)s.snapping.zero_bricks] = 0;
        }
        group_barrier();
        if (n < end && ITEM_ROW == 0) bricks[brick].sign = SIGN_MIXED;
    }
}

/* ----------------------------------------------------------------------------------------------------------- passes */

#if WORK_ITEMS == 1
#include "snap_link_alone.cl"
#else
#include "regular_groups.cl"
#endif

kernel void snap_even(slab s, uint colour, global ulong *words, global const brick_state *bricks,
                      global const uint *violated_bricks, global uint *state, global const ulong *violated) {
    local uint shared[1];
    const uint count = state[s.results.head_offset + STATE_VIOLATED_BRICKS], odd_j = colour >> 1;
    const uint odd_k = COLOUR_EVEN(odd_j, 0) == colour ? 0 : 1;
    const uint odd_y = (odd_j ^ (uint)s.first[1]) & 1, odd_z = (odd_k ^ (uint)s.first[2]) & 1;
    brick_around a;
    words += UNIFORM_BRICKS * BRICK_WORDS;
    global ulong *zeros = words + BRICK_WORDS * (ulong)s.snapping.zero_bricks;
    RUNS_OF(count, snap_ticket(&s, state, TICKET_EVEN + colour)) BRICKS_OF_RUN(count) {
        const uint n = step + OWN_BRICK;
        if (n >= end) continue;
        if (n + 2 < count) around_prefetch(&s, words, violated, violated_bricks[n + 2]);
        const ulong index = BRICK_WORDS * (ulong)violated_bricks[n];
        const grid_index origin = brick_origin(&s, violated_bricks[n]);
        for (uint set = ITEM_ROW; set < SETS_STRIDED; set += BRICK_ITEMS) {
            const row_set r = rows_strided(origin.y, origin.z, brick_word(&s, violated_bricks[n]), set, odd_y, odd_z);
            lanes wanted = rows_load(violated + index, r, true) & samples_even(&s, r);
            if (!lanes_any(wanted)) continue;
            around_make(&s, words, bricks, violated_bricks[n], &a);
            wanted = rows_regular(&s, &a, r, true, wanted, false);
            if (lanes_any(wanted)) rows_add(wanted, zeros + index, r);
        }
    }
}

/* Words of violated samples are replaced by those of the odd samples that become zeros. */
kernel void snap_odd(slab s, global ulong *words, global brick_state *bricks, global const uint *violated_bricks,
                     global uint *state, global ulong *violated) {
    local uint shared[1];
    const uint count = state[s.results.head_offset + STATE_VIOLATED_BRICKS];
    brick_around a;
    words += UNIFORM_BRICKS * BRICK_WORDS;
    RUNS_OF(count, snap_ticket(&s, state, TICKET_ODD)) BRICKS_OF_RUN(count) {
        const uint n = step + OWN_BRICK;
        if (n >= end) continue;
        if (n + 2 < count) around_prefetch(&s, words, violated, violated_bricks[n + 2]);
        const ulong index = BRICK_WORDS * (ulong)violated_bricks[n];
        const grid_index origin = brick_origin(&s, violated_bricks[n]);
        bool have_around = false;
        for (uint set = ITEM_ROW; set < SETS_OF_PLANES; set += BRICK_ITEMS) {
            const row_set r = rows_of_plane(origin.y, origin.z, brick_word(&s, violated_bricks[n]), set);
            lanes wanted = rows_load(violated + index, r, false) & ~samples_even(&s, r);
            if (lanes_any(wanted)) {
                if (!have_around) around_make(&s, words, bricks, violated_bricks[n], &a);
                have_around = true;
                wanted = rows_regular(&s, &a, r, false, wanted, true);
            }
            rows_store(wanted, violated + index, r);
        }
    }
}

kernel void snap_join(slab s, global ulong *words, global const uint *violated_bricks, global uint *state,
                      global const ulong *odd_zeros) {
    local uint shared[1];
    const uint count = state[s.results.head_offset + STATE_VIOLATED_BRICKS];
    words += BRICK_WORDS * (UNIFORM_BRICKS + (ulong)s.snapping.zero_bricks);
    RUNS_OF(count, snap_ticket(&s, state, TICKET_JOIN)) BRICKS_OF_RUN(count) {
        const uint n = step + OWN_BRICK;
        for (uint row = ITEM_ROW; row < BRICK_WORDS && n < end; row += BRICK_ITEMS) {
            const ulong index = BRICK_WORDS * (ulong)violated_bricks[n] + row;
            words[index] |= odd_zeros[index];
        }
    }
}

#endif
