/*
 * surface.h - a mesh against the surface that its grid must have (expected.h)
 *
 * Vertices are known by the documented order. Whatever order its triangles have, the mesh is right where it passes
 * every arc just as the disks do, every other edge once in each direction, where all triangles lie within loops, and
 * where there are as many as one disk per loop needs: n arcs with disks of the Euler characteristic c between them have
 * n - 2 c triangles, c is 1 for a disk and less for everything else that ends in loops.
 *
 * Apart from that, by topology.h, from the indices alone: every edge has two triangles or one, in opposite directions,
 * fans, boundary and Euler characteristic are those of the grid's signs. And by the samples' places: vertices lie where
 * the contract's arithmetic puts them, bit for bit; triangles of tetrahedra face from the higher samples to the lower.
 */
#ifndef SURFACE_H
#define SURFACE_H

#include "expected.h"
#include "subject.h"

/* From the signs of the samples; to be freed by expected_free. */
void subject_expect(const subject *s, expected *e);

enum {
    CHECK_GRID = 1,     /* that the grid's cells fit together */
    CHECK_COUNTS = 2,   /* vertices, triangles, active cells */
    CHECK_TOPOLOGY = 4, /* of the mesh alone, and its sums against the grid's */
    CHECK_ARCS = 8,     /* every edge; where a complete grid's surface ends */
    CHECK_CELLS = 16,   /* which cell's loop a triangle lies in */
    CHECK_PLACES = 32,  /* of vertices */
    CHECK_FACING = 64,  /* of triangles: after counts alone, and not of the hybrid method's, whose disks are not flat */
    CHECK_ALL = 127
};

/* The first fault, in words that stay valid until the next call; NULL where there is none. */
const char *surface_fault(const subject *s, const expected *e, const tc_mesh_data *mesh, unsigned checks);

#endif
