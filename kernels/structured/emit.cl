/*
 * emit.cl - kernel 2: vertices and triangles of the bricks that have any
 *
 * Kernel 1 has made the list of active bricks; groups are persistent and take runs of them by ticket. A work-item alone
 * emits a brick by emit_numbers.cl and emit_brick.cl, a group by emit_rows.cl. Triangles come from a table of a cube's
 * cases (CASE_COUNT patterns for each parity, and faces on the border of closed surfaces), which the host derives from
 * the cases of a tetrahedron or, for the hybrid method, from loops of crossed edges.
 */
#ifndef EMIT_CL
#define EMIT_CL

#if WORK_ITEMS == 1
#include "emit_brick.cl"
#else
#include "emit_rows.cl"
#endif

/* Active bricks that a group takes at once. Where there are many, runs are long: groups then write to different pages
 * of memory, and the first touch of a page delays only one group. */
#define RUN_LEAST      8
#define RUN_MOST       512
#define RUNS_PER_GROUP 16

/* Bricks outside [brick_first, brick_last) are left to another launch, where the mesh is larger than a buffer. Buffers
 * of channels that are not made may be NULL, and are not used. */
kernel void emit(slab s, global const BITS *samples, global const ulong *cells, global const ulong *words,
                 global const ulong *offsets, global const ushort *triangle_offsets, global const brick_state *bricks,
                 global const uint *active, global uint *state, global const uchar *cases, global float *positions,
                 global float *normals, global uint *triangles, global const float *coordinates,
                 global const uchar *blanked) {
    local uint shared[1];
    local emit_memory memory;
    brick_work work;
    mesh_buffers mesh = {positions + s.mesh.vertex_offset, normals + s.mesh.vertex_offset,
                         triangles + s.mesh.triangle_offset};
    grid_arrays in = {samples, coordinates, blanked};
    row_results k1 = {words + UNIFORM_BRICKS * BRICK_WORDS, offsets, cells, triangle_offsets, bricks};
    global uint *head = state + s.results.head_offset;
    active += s.results.active_offset;
    uint active_count = head[STATE_ACTIVE_BRICKS], lid = (uint)get_local_id(0), run = 0;
    const uint run_bricks =
        clamp(active_count / (RUNS_PER_GROUP * (uint)get_num_groups(0)), (uint)RUN_LEAST, (uint)RUN_MOST);
    brick_work_begin(&s, &work);
    while (run < active_count) {
        group_barrier();
        if (lid == 0) shared[0] = run_bricks * atomic_inc(&head[STATE_EMIT_TICKET]);
        group_barrier();
        run = shared[0];
        uint end = min(run + run_bricks, active_count);
        for (uint step = run; step < end; step += (WORK_ITEMS + BRICK_WORDS - 1) / BRICK_WORDS) {
            uint n = step + lid / BRICK_WORDS, brick = n < end ? active[n] : 0;
            next_prefetch(&s, active + n, active_count - n, k1, samples);
            bool wanted = n < end && brick >= s.mesh.brick_first && brick < s.mesh.brick_last;
            brick_emit(&s, brick, wanted, in, k1, cases, mesh, &memory, &work);
        }
    }
}

#endif
