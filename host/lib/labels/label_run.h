/*
 * label_run.h - surfaces of a label map by kernels: in slabs of whole layers of bricks where the device cannot hold all
 *
 * A slab's kernel 1 counts the layer behind it too, so each slab has the numbers of the vertices that its last
 * triangles use, without knowing the next. Where there are several slabs all are counted first, then counted again and
 * emitted.
 */
#ifndef LABEL_RUN_H
#define LABEL_RUN_H

#include "grid/label_volume.h"
#include "grid/mesh.h"
#include "opencl/kernels.h"

/* The kind of the kernels that a volume needs. */
kernel_kind labels_kind(const label_volume *volume);

/* Fills the mesh, of a uniform grid. After a failure its content is undefined: clear it. */
tc_status labels_extract(const label_volume *volume, scan_parameters scan, tc_mesh *mesh);

/* Words of the table that kernel 2 reads (label_job.h). */
void label_table_make(bool mirrored, uint32_t *words);

#endif
