/*
 * smooth.h - constrained smoothing of a label map's surfaces (tc_extract_labels says what it does)
 */
#ifndef SMOOTH_H
#define SMOOTH_H

#include "grid/label_volume.h"
#include "grid/mesh.h"

/* Moves the mesh's vertices. The grid is uniform. */
tc_status labels_smooth(const label_volume *volume, uint32_t sweeps, tc_mesh *mesh);

#endif
