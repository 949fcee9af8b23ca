/*
 * snapped.h - method snap by its definition: the samples that the surface is made to go through, and the mesh of them
 *
 * A sample is moved onto the surface where an edge of it has a crossing near enough, and where it is a regular point:
 * the surface cuts its link, the triangles opposite to it in the tetrahedra around it, in one simple closed curve. On
 * the grid's border the link is a disc, and the curve runs from its edge to its edge; a sample on an edge of the grid's
 * box has its curve run from one face to the other. Here the curve is walked, node by node. Shares no code or table
 * with the library.
 */
#ifndef SNAPPED_H
#define SNAPPED_H

#include "signs.h"

/* By sample: inside, outside, or made a vertex. */
enum { SIDE_OUT = -1, SIDE_ON = 0, SIDE_IN = 1 };

/* Whether the sample at p may become a vertex, as the sides of the samples around it are. Its own is not read. False
 * beside a cube that is missing, and at a corner of the grid. */
bool sample_is_regular(const signs *s, const int8_t *sides, const int64_t p[3]);

/* Samples are taken in five turns, so that no two of one turn share an edge: even ones (i + j + k) by whether j and k
 * are odd, 00, 01, 11, 10, then odd ones. */
enum { TURNS = 5 };
int sample_turn(const signs *s, const int64_t p[3]);

/* The first fault of a mesh made by method snap with this threshold, in words that stay valid until the next call; NULL
 * where there is none. *doubtful: a crossing lies so near the threshold that rounding decides; nothing was checked. */
const char *snapped_fault(const tc_grid_options *grid, double isovalue, double threshold, const tc_mesh_data *mesh,
                          bool *doubtful);

#endif
