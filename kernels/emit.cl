/*
 * emit.cl - kernel 2: vertices and triangles of the bricks that have any
 *
 * Runs over the list that kernel 1 left. Groups stay and take runs of active bricks by ticket. How a brick is emitted
 * depends on who shares it: emit_brick.cl, emit_rows.cl. Triangles come from the table of a cube (2 parities x 256
 * patterns), which the host derives from the 16 cases of a tetrahedron.
 */

#define RUN_BRICKS 8 /* active bricks that a group takes at once */

/* Bricks outside [brick_first, brick_last) are left to another launch, where the mesh is larger than a buffer can be.
 */
kernel void emit(slab s, global const BITS *samples, global const ulong *cells, global const ulong *words,
                 global const ulong *offsets, global const ushort *triangle_offsets, global const brick_state *bricks,
                 global const uint *active, global uint *state, global const ushort *cases, global float *positions,
                 global float *normals, global uint *triangles) {
    local uint shared[1];
    brick_work work;
    mesh_buffers mesh = {positions + s.position_offset, normals + s.position_offset, triangles + s.triangle_offset};
    row_results k1 = {words + UNIFORM_BRICKS * BRICK_WORDS, offsets, cells, triangle_offsets, bricks};
    global uint *head = state + s.head_offset;
    active += s.active_offset;
    uint active_count = head[STATE_ACTIVE_BRICKS], lid = (uint)get_local_id(0), run = 0;
    brick_work_begin(&s, &work);
    while (run < active_count) {
        group_barrier();
        if (lid == 0) shared[0] = RUN_BRICKS * atomic_inc(&head[STATE_EMIT_TICKET]);
        group_barrier();
        run = shared[0];
        uint end = min(run + RUN_BRICKS, active_count);
        for (uint step = run; step < end; step += (WORK_ITEMS + BRICK_WORDS - 1) / BRICK_WORDS) {
            uint n = step + lid / BRICK_WORDS, number = n < end ? active[n] : 0;
#if WORK_ITEMS == 1
            if (n + 1 < active_count) brick_prefetch(&s, active[n + 1], brick_corner(&s, active[n + 1]), k1);
#endif
            if (n < end && number >= s.brick_first && number < s.brick_last)
                brick_emit(&s, number, brick_corner(&s, number), samples, k1, cases, mesh, &work);
        }
    }
}
