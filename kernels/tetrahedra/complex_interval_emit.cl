/*
 * complex_interval_emit.cl - kernel complex_interval_emit: the tetrahedra of an interval volume
 */
#ifndef COMPLEX_INTERVAL_EMIT_CL
#define COMPLEX_INTERVAL_EMIT_CL

#if WORK_ITEMS == 1
#include "complex_interval_emit_alone.cl"
#else
#include "complex_interval_emit_groups.cl"
#endif

#ifdef REAL

kernel void complex_interval_emit(complex_job low, volume_job v, global const uint *tetrahedra,
                                  global const uchar *cases, global const volume_cluster *clusters,
                                  global const uint *numbers, global const ushort *slots, global uint *entries,
                                  global const uint2 *edges, global uint *state, global uint *out) {
    local uint shared[4];
    const volume_emit e = {
        &low, &v, tetrahedra + low.tetrahedron_offset, cases, clusters, numbers, edges, slots, entries, state, out};
    uint tile_index = 0;
    while (tile_index < v.tile_count) {
        tile_index = ticket_take(&state[VOLUME_TICKETS + KERNEL_VOLUME_EMIT], shared);
        if (tile_index < v.tile_count) tile_emit(tile_index, &e);
    }
}

#endif

#endif
