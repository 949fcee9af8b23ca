/*
 * surface_picture.h - a mesh as a picture: parallel projection, hidden surfaces by depth, soft light on both sides
 *
 * The mesh is fitted into the picture, centred, with a margin. Every pixel has SAMPLES x SAMPLES samples. What a sample
 * shows is the triangle of least depth at it, of equal depths the first one; neighbours leave no gap and no overlap, as
 * positions are whole multiples of 1/256 of a sample (surface_draw.c). Sides that triangles turn to the outside are
 * blue, inner sides ochre; where triangles lie between labels, each label has a colour of its own.
 *
 * Normals are those of the mesh where it has some, else the mean of the triangles around a vertex, by their area; where
 * that is far from the triangle's own normal, at an edge or a corner, the triangle's own.
 *
 * The same mesh gives the same pixels on every machine, with any number of threads: arithmetic is IEEE's basic
 * operations and the square root.
 */
#ifndef SURFACE_PICTURE_H
#define SURFACE_PICTURE_H

#include "mesh_write.h"
#include "picture.h"
#include "view.h"

/* Draws the mesh into the picture, which is white before. Parts are as in mesh_write_options; part_count 0: one, of the
 * whole mesh. Triangles with a corner that is not finite are left out. Returns 0, or STATUS_FAILED without memory. */
int surface_picture(const tc_mesh_data *mesh, const mesh_part *parts, int part_count, view_angles angles, picture *p);

#endif
