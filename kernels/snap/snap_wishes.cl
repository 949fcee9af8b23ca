/*
 * snap_wishes.cl - method snap: the list of bricks in which samples wish to be snapped
 */
#ifndef SNAP_WISHES_CL
#define SNAP_WISHES_CL

#include "../base/common.cl"

/* A word for each row, and a list of the bricks that have any. */
typedef struct wish_results {
    global ulong *wishes;
    global brick_state *bricks;
    global uint *wishing, *wishing_count;
} wish_results;

/* Lists a brick, the first time that it is called for it. */
inline_always void wishing_enter(uint number, wish_results results) {
    if (atomic_inc(&results.bricks[number].rows) == 0) results.wishing[atomic_inc(results.wishing_count)] = number;
}

#endif
