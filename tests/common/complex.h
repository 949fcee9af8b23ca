/*
 * complex.h - cells of every type put together for tests, and what must hold of their tetrahedra
 */
#ifndef COMPLEX_H
#define COMPLEX_H

#include "tetracubes.h"

#include <stdbool.h>

typedef struct cell_list {
    uint64_t point_count, cell_count;
    float *points;
    uint8_t *types;
    int64_t *offsets, *connectivity;
    int64_t *cell_faces, *face_offsets, *face_connectivity; /* of polyhedra */
    uint64_t inverted_count;                                /* cells that were put in with negative volume */
} cell_list;

/* Room for so many; exits where memory runs out. */
cell_list cell_list_make(uint64_t points, uint64_t cells);
void cell_list_free(cell_list *list);
tc_cells cell_list_view(const cell_list *list);

uint32_t cell_list_point(cell_list *list, double x, double y, double z);

/* A cell with positive volume in VTK's order of corners, or turned over. */
void cell_list_add(cell_list *list, int type, int corner_count, const uint32_t *corners, bool inverted);

/* A polyhedron: counts[n] points of face n, one face after the other. Faces go in in random order, each from a random
 * point on, in a random direction. */
void cell_list_add_polyhedron(cell_list *list, int face_count, const int *counts, const uint32_t *points);

/* Gives the points other numbers, at random. */
void cell_list_renumber(cell_list *list);

/* A block of unit cubes as hexahedra, so many along x, y and z, in the order of their points. renumbered: of either
 * orientation, and points numbered at random. */
cell_list hexahedra_make(const uint32_t sizes[3], bool renumbered);

/* A block of size^3 unit cubes, columns of them cut into wedges, others into hexahedra, voxels, pyramids around their
 * middle and tetrahedra at random, of either orientation; points numbered at random. The same seed makes the same
 * block. */
cell_list mixed_block_make(uint32_t size, uint64_t seed);

/* The truncated octahedra around the points of a body-centred lattice of size^3 cells of side 4, with 6 squares and 8
 * hexagons each, of volume 32. Points at random numbers, as in the next. */
cell_list kelvin_block_make(uint32_t size, uint64_t seed);

/* size^2 columns on hexagons of area 3, of size prisms of height 1: hexagonal ones, the same as polyhedra, pentagonal
 * prisms with wedges, or pairs of hexahedra. */
cell_list honeycomb_make(uint32_t size, uint64_t seed);

/* About half the wedges, pyramids and tetrahedra as hexahedra of which corners are one point: what solvers write. */
void cell_list_collapse(cell_list *list);

/* Leaves out the polyhedra. */
void cell_list_drop_polyhedra(cell_list *list);

typedef struct complex_facts {
    uint64_t boundary_faces; /* of one tetrahedron */
    uint64_t bad_faces;      /* of three or more, or passed by two in the same direction */
    uint64_t bad_tetrahedra; /* with a point out of range or twice */
    uint64_t not_positive;   /* tetrahedra of no volume or less */
    double volume;           /* six times it */
} complex_facts;

complex_facts complex_facts_of(const tc_tetrahedra *complex, const float *points, uint64_t point_count);

#endif
