/*
 * held_triangles.h - triangles of a piece that use vertices of the next one, kept by their corners until that comes
 *
 * They are the last of a piece, so they follow each other, and what is held is at most what one layer of bricks makes.
 */
#ifndef HELD_TRIANGLES_H
#define HELD_TRIANGLES_H

#include "tetracubes.h"

typedef struct held_triangles {
    uint64_t first, count; /* in the whole mesh */
    float *corners;        /* 9 per triangle, as far as they are known */
    uint32_t *missing;     /* 3 per triangle: a vertex of the next piece, or UINT32_MAX */
    uint32_t *indices;     /* 3 per triangle: 0, 1, 2, ... */
    uint64_t capacity;
} held_triangles;

/* Makes a mesh of what is held, with the vertices of the next piece; the mesh is valid until held_take. 0 where nothing
 * is held. */
int held_complete(held_triangles *held, const tc_mesh_data *next, tc_mesh_data *mesh, uint64_t *first_triangle);

/* Takes the triangles of a piece from the first on that uses vertices of the next one: *piece keeps those before. */
int held_take(held_triangles *held, uint64_t first_triangle, tc_mesh_data *piece);

void held_release(held_triangles *held);

#endif
