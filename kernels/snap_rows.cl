/*
 * snap_rows.cl - method snap: LANES rows of samples that are looked at together, their words and those of rows beside
 * them
 */
#ifndef SNAP_ROWS_CL
#define SNAP_ROWS_CL

#include "words.cl"

/* Sign words, and what is known of bricks. */
typedef struct stored_words {
    global ulong *words;
    global brick_state *bricks;
} stored_words;

/* The word of a row, of signs or of zeros; those of the next rows of its brick follow it. */
inline_always global const ulong *row_stored(const slab *s, stored_words m, uint y, uint z, uint w, bool zeros) {
    const uint number = brick_index(s, y, z, w);
    global const ulong *words = brick_words(number, m.bricks[number].sign, m.words);
    return (zeros ? zeros_of(s, words) : words) + row_in_brick(s, y, z);
}

/* Rows of a brick. In sets that are not spread: from (y, z) on, one after another in y. In spread ones, of even samples
 * of one colour: every second one of a plane from (y, z) on, then those of the plane after the next. */
typedef struct row_set {
    uint y, z, w;
    lanes at_y, at_z; /* where each row is */
} row_set;

#if WORK_ITEMS == 1
#include "snap_rows_alone.cl"
#else
#include "snap_rows_groups.cl"
#endif

#endif
