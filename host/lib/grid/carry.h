/*
 * carry.h - another field of the grid on the vertices of a surface
 *
 * A vertex lies at t on the edge between two samples. A field is carried to it by reading the field at both samples and
 * interpolating; on the host, where the field is. That needs the crossed edges of the surface in the order of their
 * vertices: structured_carry.c and complex_carry.c hand these over in batches, from several threads.
 */
#ifndef CARRY_H
#define CARRY_H

#include "grid/grid.h"

/* Where the values go. */
typedef struct carry {
    const tc_field *field;
    float *out;
    uint64_t capacity; /* vertices */
} carry;

enum { BATCH_EDGES = 1024 };

/* Crossed edges whose vertices have consecutive numbers, from `vertex` on. */
typedef struct edge_batch {
    uint64_t vertex;
    uint32_t count;
    bool has_at_samples;                         /* some of the edges are a sample, both ends: the vertex lies at it */
    int64_t low[BATCH_EDGES], high[BATCH_EDGES]; /* the samples at the ends, the lower number first */
} edge_batch;

/* The values of a grid's samples. */
void carry_samples(const tc_grid *grid, const int64_t *samples, uint32_t count, double *values);

/* Where the isovalue lies on each edge of the batch. */
void carry_crossings(const tc_grid *grid, double isovalue, const edge_batch *batch, float t[BATCH_EDGES]);

/* Carries the field to the vertices of the batch that there is room for; it is then empty, and what comes next follows
 * it. */
void carry_batch(const carry *c, const tc_grid *grid, double isovalue, edge_batch *batch);

#endif
