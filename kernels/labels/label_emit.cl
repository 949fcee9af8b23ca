/*
 * label_emit.cl - kernel 2 of label maps: vertices and triangles of the bricks that emit something, which groups take
 * by ticket
 */
#ifndef LABEL_EMIT_CL
#define LABEL_EMIT_CL

#if WORK_ITEMS == 1
#include "label_emit_alone.cl"
#else
#include "label_emit_groups.cl"
#endif

/* Active bricks that a group takes at once: many where there are many. Groups then write to different pages, and seldom
 * wait for an atomic operation, which comes after all stores that bypass the caches. */
#define LABEL_RUN_LEAST      8
#define LABEL_RUN_MOST       512
#define LABEL_RUNS_PER_GROUP 16

kernel void label_emit(label_job s, global const BITS *samples, global ulong *words, global ushort *offsets,
                       global label_row_base *bases, global uint *rows, global const uint *active, global uint *state,
                       global const uint *tables, global float *positions, global uint *triangles,
                       global uint *labels) {
    local uint shared[4];
    local label_row made[LABEL_ROWS_AT_ONCE];
    const label_arrays in = {words, offsets, bases, rows};
    const label_mesh out = {positions, triangles, labels};
    global const uint *tiles = state + LABEL_HEAD_WORDS;
    const uint count = state[LABEL_ACTIVE_BRICKS];
    const uint run_bricks =
        clamp(count / (LABEL_RUNS_PER_GROUP * (uint)get_num_groups(0)), (uint)LABEL_RUN_LEAST, (uint)LABEL_RUN_MOST);
    label_work work;
    uint first = 0;
    while (first < count) {
        first = run_bricks * ticket_take(&state[LABEL_EMIT_TICKET], shared);
        for (uint n = first; n < min(first + run_bricks, count); n++) {
            if (n + 1 < count) label_brick_prefetch(&s, active[n + 1], in, samples);
            label_brick_emit(&s, active[n], in, tiles, samples, tables, out, made, &work);
        }
    }
}

#endif
