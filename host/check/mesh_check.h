/*
 * mesh_check.h - properties of an indexed triangle mesh, from the mesh alone
 *
 * Knows nothing of grids, tables or extraction: it proves the extractor's promises to somebody who does not trust it.
 * Any numbers may be passed: an index out of range is counted, never followed.
 */
#ifndef MESH_CHECK_H
#define MESH_CHECK_H

#include <stdint.h>

/* Invalid triangles are counted as such and left out of every other figure. */
typedef struct mesh_topology {
    uint64_t boundary_edges;       /* edges with exactly one triangle */
    uint64_t nonmanifold_edges;    /* edges with three triangles or more */
    uint64_t nonmanifold_vertices; /* vertices whose triangles form more than one fan; a fan is joined through edges
                                      at the vertex, however many triangles such an edge has */
    uint64_t misoriented_edges;    /* edges with two triangles that pass them in the same direction */
    uint64_t unbalanced_edges;     /* edges that triangles pass more often in one direction than in the other:
                                      boundary edges, misoriented ones, and some with three triangles or more */
    uint64_t orphan_vertices;      /* vertices that no triangle uses */
    uint64_t invalid_triangles;    /* an index out of range, or the same vertex twice */
    int64_t euler_characteristic;  /* vertices (orphans too) - edges + triangles */
    uint64_t components;           /* connected by shared vertices; orphans do not count */
    double area;                   /* this and volume: without triangles that have a non-finite corner */
    double volume;                 /* enclosed, by the divergence theorem; positive where triangles face outward.
                                      Means nothing where edges are unbalanced: it then includes the cone between
                                      these edges and the origin */
} mesh_topology;

/* What every report shows; found in one cheap pass. */
typedef struct mesh_summary {
    double bounds[2][3];           /* minimum and maximum corner of the finite vertices; zeros where there are none */
    uint64_t degenerate_triangles; /* of zero area: two corners or more at one position, or all on a line */
    uint64_t nonfinite_vertices;   /* with a NaN or an infinity among the three coordinates */
} mesh_summary;

/* Triangles by their smallest angle, which is 60 degrees at most; 0 where the area is. Without invalid ones and those
 * that have a non-finite corner. */
enum { SHAPE_ANGLES = 601 };
typedef struct mesh_shapes {
    uint64_t triangles;
    uint64_t below_10, below_20;     /* degrees */
    uint64_t by_tenth[SHAPE_ANGLES]; /* rounded to tenths of a degree */
} mesh_shapes;

/* positions: 3 floats per vertex; triangles: 3 indices each; either may be NULL where its count is 0. Returns 0, or
 * STATUS_FAILED with its message (failure.h) where memory runs out. Takes about 12 bytes per vertex and a window on the
 * triangles of 64 MiB or a sixteenth of them, whichever is more. */
int mesh_check(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
               mesh_topology *result);

void mesh_summarize(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                    mesh_summary *result);

/* Adds the mesh's triangles to those of others. */
void mesh_shapes_add(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count,
                     mesh_shapes *sum);

/* In degrees, to a tenth; of an even number the lower one of the two in the middle. 0 where there are no triangles. */
double mesh_shapes_median(const mesh_shapes *shapes);

/* XXH64 (seed 0) of the positions' bytes, then the indices' bytes, both as they lie in memory. */
uint64_t mesh_hash(const float *positions, uint64_t vertex_count, const uint32_t *triangles, uint64_t triangle_count);

/* The hash of several meshes in turn, one more of them added: XXH64 with the hash so far, 0 before the first, as its
 * seed. */
uint64_t mesh_hash_add(uint64_t before, const float *positions, uint64_t vertex_count, const uint32_t *triangles,
                       uint64_t triangle_count);

#endif
