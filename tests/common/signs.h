/*
 * signs.h - which samples of a structured grid are inside and which are missing, and the surface that follows
 *
 * Knows the contract alone: inside is `sample >= isovalue`; a sample is missing where it is not finite, is the missing
 * value or is blanked; a cube is there with all its samples, unless it is blanked.
 */
#ifndef SIGNS_H
#define SIGNS_H

#include "expected.h"
#include "tetracubes.h"

typedef struct signs {
    const tc_grid_options *grid;
    bool *inside, *present; /* by sample */
    bool complete;          /* no sample is missing, no cube is blanked */
} signs;

/* Exits where memory runs out. */
void signs_make(signs *s, const tc_grid_options *grid, double isovalue);
void signs_free(signs *s);

/* From the number of a sample to its indices, and back; the last: of corner x + 2 y + 4 z of the cube that begins at p.
 */
void grid_place(const tc_grid_options *grid, int64_t n, int64_t p[3]);
int64_t signs_index(const signs *s, const int64_t p[3]);
int64_t signs_corner(const signs *s, const int64_t p[3], unsigned corner);

bool signs_odd(const signs *s, const int64_t p[3]); /* of i + j + k */

/* Whether the cube that begins at p, which may lie outside the grid, has all its samples and is not blanked. */
bool signs_cube(const signs *s, const int64_t p[3]);

/* The surface of either method, its vertices numbered in the documented order; to be freed by expected_free. mirrored:
 * the grid turns right into left. */
void signs_expect(const signs *s, tc_method method, bool mirrored, expected *e);

/* The same of a complex, its vertices in any order. */
void complex_expect(const tc_tetrahedra_grid_options *complex, double isovalue, expected *e);

/* The first difference between the mesh's counts and the expected ones, in words that stay valid until the next call;
 * NULL where there is none. */
const char *counts_fault(const expected *e, const tc_mesh_data *mesh);

/* The same of edges, fans, boundary and Euler characteristic, from the indices alone (topology.h). complete: nothing of
 * the grid is missing, so that every vertex has one fan. */
const char *topology_fault(const expected *e, bool complete, const tc_mesh_data *mesh);

#endif
