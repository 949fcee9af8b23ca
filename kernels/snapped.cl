/*
 * snapped.cl - kernel 2 in method snap: on which edge the vertex of a snapped sample lies
 */
#ifndef SNAPPED_CL
#define SNAPPED_CL

#include "mesh.cl"
#include "nearest.cl"

#ifdef REAL

#define LINK_STEP(x, y, z) {x, y, z},
constant const char link_steps[LINK_EVEN][3] = {LINK_SAMPLES(LINK_STEP)};

/* The edge of the vertex of sample (x, y, z), counted from `first`: the one with the nearest crossing, of those along
 * which it may move. */
inline_always uint snapped_edge(const slab *s, corner first, uint x, uint y, uint z, grid_arrays in) {
    const bool border_x = x == 0 || x + 1 == s->nx, border_y = y == 0 || y + 1 == s->ny;
    const bool border_z = z == 0 || z + 1 == s->nz;
    const uint count = (s->parity + x + y + z) & 1 ? LINK_ODD : LINK_EVEN;
    const ulong at = row_start(s, y, z) + x;
    const BITS sample = in.samples[at];
    REAL steepness = 0;
    uint nearest = x + 1 < s->nx ? 1 : 0; /* kept only where the caller changes samples meanwhile */
#pragma unroll 1
    for (uint n = 0; n < count; n++) {
        const int step_x = link_steps[n][0], step_y = link_steps[n][1], step_z = link_steps[n][2];
        if ((border_x && step_x) || (border_y && step_y) || (border_z && step_z)) continue;
        const BITS other = in.samples[(long)at + step_x + (step_y + step_z * (long)s->ny) * (long)s->nx];
        if (bits_inside(other, &s->test) == bits_inside(sample, &s->test)) continue;
        if (crossing_is_nearer(s, sample, other, n >= LINK_ODD, &steepness)) nearest = n;
    }
    const int step_x = link_steps[nearest][0], step_y = link_steps[nearest][1], step_z = link_steps[nearest][2];
    const int forth = step_x + 2 * step_y + 4 * step_z > 0 ? 1 : -1; /* to higher sample indices */
    const uint back_x = forth > 0 ? 0 : step_x, back_y = forth > 0 ? 0 : step_y, back_z = forth > 0 ? 0 : step_z;
    return EDGE_CODE(x + back_x - first.x, y + back_y - first.y, z + back_z - first.z, forth * step_x, forth * step_y,
                     forth * step_z);
}

#endif

#endif
