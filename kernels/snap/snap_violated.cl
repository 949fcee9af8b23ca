/*
 * snap_violated.cl - method snap: the list of bricks that have violated samples
 */
#ifndef SNAP_VIOLATED_CL
#define SNAP_VIOLATED_CL

#include "../base/common.cl"

/* A word of violated samples for each row, and a list of the bricks with any. */
typedef struct violated_results {
    global ulong *violated;
    global brick_state *bricks;
    global uint *violated_bricks, *violated_brick_count;
} violated_results;

/* Adds a brick to the list, on its first call for this brick. */
inline_always void violated_brick_enter(uint brick, violated_results results) {
    if (atomic_inc(&results.bricks[brick].rows) == 0)
        results.violated_bricks[atomic_inc(results.violated_brick_count)] = brick;
}

#endif
