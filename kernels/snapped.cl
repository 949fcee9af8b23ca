/*
 * snapped.cl - kernel 2 in method snap: on which edge the vertex of a snapped sample lies
 */
#ifndef SNAPPED_CL
#define SNAPPED_CL

#include "mesh.cl"
#include "nearest.cl"

#ifdef REAL

/* The edge of the vertex of sample (x, y, z), counted from `first`: the one with the nearest crossing, of those along
 * which it may move. offsets: NULL, or those to the samples of its link. */
inline_always uint snapped_edge(const slab *s, corner first, uint x, uint y, uint z, const long *offsets,
                                grid_arrays in) {
    const bool inner = x > 0 && x + 1 < s->nx && y > 0 && y + 1 < s->ny && z > 0 && z + 1 < s->nz;
    const bool odd = (s->parity + x + y + z) & 1;
    uint nearest = inner && offsets ? nearest_inside(s, in.samples + row_start(s, y, z) + x, offsets, odd)
                                    : nearest_on_border(s, x, y, z, in.samples);
    if (nearest == LINK_EVEN) nearest = x + 1 < s->nx ? 1 : 0; /* only where the caller changes samples meanwhile */
    const int step_x = link_steps[nearest][0], step_y = link_steps[nearest][1], step_z = link_steps[nearest][2];
    const int forth = step_x + 2 * step_y + 4 * step_z > 0 ? 1 : -1; /* to higher sample indices */
    const uint back_x = forth > 0 ? 0 : step_x, back_y = forth > 0 ? 0 : step_y, back_z = forth > 0 ? 0 : step_z;
    return EDGE_CODE(x + back_x - first.x, y + back_y - first.y, z + back_z - first.z, forth * step_x, forth * step_y,
                     forth * step_z);
}

#endif

#endif
