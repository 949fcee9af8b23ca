/*
 * label_emit.cl - kernel 2 of label maps: vertices and triangles of the bricks that emit something
 *
 * Groups take bricks by ticket; each team, of 32 work-items or one, a row of them at a time. One of the team makes the
 * words and numbers that the row's cubes need, then each work-item has cubes of its own.
 */
#ifndef LABEL_EMIT_CL
#define LABEL_EMIT_CL

#if WORK_ITEMS == 1
#include "label_emit_alone.cl"
#else
#include "label_emit_groups.cl"
#endif

kernel void label_emit(label_job s, global const BITS *samples, global ulong *words, global ushort *offsets,
                       global label_row_base *bases, global uint *rows, global const uint *active, global uint *state,
                       global const uint *tables, global float *positions, global uint *triangles,
                       global uint *labels) {
    local uint shared[4];
    local label_row made[LABEL_TEAMS];
    const label_arrays in = {words, offsets, bases, rows};
    const label_mesh out = {positions, triangles, labels};
    global const uint *tiles = state + LABEL_HEAD_WORDS;
    const uint count = state[LABEL_ACTIVE_BRICKS], team = (uint)get_local_id(0) / LABEL_TEAM;
    const uint lane = (uint)get_local_id(0) % LABEL_TEAM;
    uint number = 0;
    while (number < count) {
        number = ticket_take(&state[LABEL_EMIT_TICKET], shared);
        const uint brick = number < count ? active[number] : 0;
        const label_near near = label_near_of(&s, brick, tiles);
        for (uint first = 0; first < BRICK_WORDS; first += LABEL_TEAMS) {
            const uint row = first + team;
            const bool is_there = number < count && row < BRICK_WORDS && (rows[brick] >> row & 1);
            if (is_there && lane == 0) label_row_make(&s, label_place_of(&s, brick, row), near, in, tiles, &made[team]);
            group_barrier();
            if (is_there) label_row_emit(&s, &made[team], lane, samples, tables, out);
            group_barrier();
        }
    }
}

#endif
