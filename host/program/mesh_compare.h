/* mesh_compare.h - two meshes, byte by byte */
#ifndef MESH_COMPARE_H
#define MESH_COMPARE_H

#include "tetracubes.h"

/* Nonzero where counts, channels and triangles are the same bytes. Else `text`, of so many bytes, says what
 * differs first. */
int meshes_are_same(const tc_mesh_data *device, const tc_mesh_data *reference, char *text, size_t bytes);

#endif
