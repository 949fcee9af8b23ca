/*
 * complex_caps.h - what closes a surface of a complex on the device path: vertices at the inside points of the border,
 * and the inside parts of its faces
 *
 * By kernels behind a surface that the device has whole; by the host where it was made slab by slab, as slabs share
 * edges.
 */
#ifndef COMPLEX_CAPS_H
#define COMPLEX_CAPS_H

#include "tetrahedra/border_list.h"
#include "tetrahedra/complex_run.h"

/* The border for a method, found where it is not known yet. */
tc_status caps_border_get(tc_grid *grid, tc_method method, border_list **out);

/* Counts what the border adds to a surface that is numbered; head has the counts then. Emits it behind the surface. */
tc_status caps_count(complex_run *r, const tc_extract_options *options);
tc_status caps_emit(complex_run *r, const device_buffer *positions, const device_buffer *triangles);

/* What the border adds to a surface whose crossed edges have these numbers. */
typedef struct cap_sizes {
    uint64_t vertices, triangles;
} cap_sizes;

tc_status caps_host_count(tc_grid *grid, const tc_extract_options *options, const edge_numbers *edges,
                          cap_sizes *sizes);

/* Puts it at the end of a mesh, where there is room for it. */
tc_status caps_host_emit(tc_grid *grid, const tc_extract_options *options, const edge_numbers *edges, cap_sizes sizes,
                         tc_mesh *mesh);

/* Carries a field to the border's vertices, the first of which has this number. */
void caps_carry(const tc_grid *grid, const border_list *border, double isovalue, const carry *c, uint64_t first);

#endif
