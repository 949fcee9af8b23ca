/*
 * complex_vertex.cl - the position of a vertex of a complex
 */
#ifndef COMPLEX_VERTEX_CL
#define COMPLEX_VERTEX_CL

#include "complex_edges.cl"
#include "../base/crossing.cl"

/* The vertex on an edge. */
inline_always void edge_vertex(const complex_job *c, uint2 edge, global const BITS *samples, global const float *points,
                               global float *out) {
    float t = crossing(SAMPLE_VALUE(samples[edge.x]), SAMPLE_VALUE(samples[edge.y]), ISOVALUE(&c->test));
    float3 p0 = vload3(edge.x, points), p1 = vload3(edge.y, points);
    out[0] = t == 1 ? p1.x : p0.x + t * (p1.x - p0.x);
    out[1] = t == 1 ? p1.y : p0.y + t * (p1.y - p0.y);
    out[2] = t == 1 ? p1.z : p0.z + t * (p1.z - p0.z);
}

#endif
