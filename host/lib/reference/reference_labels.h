/*
 * reference_labels.h - surfaces of label maps by the scalar reference: plain loops over bricks, cubes and tetrahedra
 */
#ifndef REFERENCE_LABELS_H
#define REFERENCE_LABELS_H

#include "grid/label_volume.h"
#include "grid/mesh.h"

/* Fills the mesh. After a failure its content is undefined: clear it. */
tc_status reference_labels(const label_volume *volume, tc_mesh *mesh);

#endif
