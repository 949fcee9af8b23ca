/*
 * snapped.cl - kernel 2 in method snap: on which edge the vertex of a snapped sample lies: the one with the nearest
 * crossing, of those along which it may move
 */
#ifndef SNAPPED_CL
#define SNAPPED_CL

#include "../structured/mesh.cl"
#include "nearest.cl"

#ifdef REAL

/* The edge between a sample and one of its link: what is added to the sample's EDGE_CODE. */
inline_always uint link_code(uint n) {
    const int step_x = link_steps[n][0], step_y = link_steps[n][1], step_z = link_steps[n][2];
    const int forth = step_x + 2 * step_y + 4 * step_z > 0 ? 1 : -1; /* to higher sample indices */
    const uint back = forth > 0 ? 0 : (uint)step_x + ((uint)step_y << 7) + ((uint)step_z << 11);
    return back + EDGE_CODE(0, 0, 0, forth * step_x, forth * step_y, forth * step_z);
}

/* The index in its link of the other end of a snapped sample's edge. Where the caller has changed samples meanwhile and
 * there is none, a neighbour in x. */
inline_always uint snapped_to(const slab *s, uint x, uint y, uint z, global const BITS *samples) {
    const uint nearest = nearest_of_sample(s, x, y, z, samples);
    return nearest < LINK_EVEN ? nearest : x + 1 < s->nx ? 1 : 0;
}

#endif

#if WORK_ITEMS == 1
#include "snapped_alone.cl"
#endif

#endif
