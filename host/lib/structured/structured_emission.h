/*
 * structured_emission.h - what is emitted by one launch of kernel 2, and where it goes
 */
#ifndef STRUCTURED_EMISSION_H
#define STRUCTURED_EMISSION_H

#include "structured/structured_run.h"

/* Vertices [vertex0, vertex1) and triangles [triangle0, triangle1) of the mesh. */
typedef struct mesh_window {
    uint64_t vertex0, vertex1, triangle0, triangle1;
    uint32_t vertex_offset, triangle_offset; /* 32-bit items before them in the buffers */
    mesh_buffers *buffers;
} mesh_window;

/* Strips of a slab, which are rows of bricks along x, layer after layer, that are emitted by one launch. */
typedef struct emit_step {
    slab_ref ref;
    bool opens_slab; /* the first of its slab */
    uint32_t strip0, strip1;
    uint64_t slab_vertex, slab_triangle; /* before the slab */
    mesh_window part;                    /* of the mesh: what the step makes */
} emit_step;

typedef struct emit_plan {
    tc_mesh *mesh;
    mesh_window whole;     /* where one window holds the mesh */
    uint32_t window_count; /* else 1, or 2 where copies overlap kernels; 0: whole */
    emit_step *steps;
    uint32_t step_count, step_capacity;
    unsigned shrink; /* a step of several strips fills 1 / 2^shrink of a window at most */
    double kernels_end_ms;
} emit_plan;

/* True where each of `windows` windows can hold this many vertices and triangles. */
bool window_fits(const run *r, uint64_t vertices, uint64_t triangles, uint32_t windows);

/* The largest numbers of vertices and triangles of a step. */
void steps_largest(const emit_plan *e, uint64_t *vertices, uint64_t *triangles);

/* Chooses windows and steps: the whole mesh at once, else two windows that alternate, else one (structured_cut.c).
 * TC_ERROR_MEMORY, with the memory needed, where a strip is too large for one. */
tc_status steps_plan(run *r, emit_plan *e, bool whole);

#endif
