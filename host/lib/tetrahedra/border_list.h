/*
 * border_list.h - the border of a complex on the device path: the faces that one present tetrahedron has, or by method
 * hybrid one present cell
 *
 * It depends on the grid alone, and is found by threads of the host when a surface is first closed.
 */
#ifndef BORDER_LIST_H
#define BORDER_LIST_H

#include "kernels/tetrahedra/complex_job.h"
#include "grid/complex.h"

typedef struct border_list {
    uint32_t *points; /* those of the faces, ascending */
    cap_face
        *faces; /* by tetrahedron, then by the corner that they do not have; by cell, then as cell_faces has them */
    uint64_t point_count, face_count;
    double greatest; /* sample at these points; below the isovalue: the border adds nothing */
    device_buffer points_buffer, faces_buffer;
    uint64_t point_offset, face_offset; /* of the first item in its buffer */
} border_list;

/* Finds the border where it is not known yet. TC_ERROR_DATA for invalid point numbers, and for tetrahedra that are not
 * what their cells are cut into. */
tc_status border_list_provide(const tc_grid *grid, bool keeps_cells, border_list **out);

void border_buffers_release(tc_context *context, border_list *border); /* on the device; NULL: nothing */
void border_list_release(tc_context *context, border_list *border);    /* NULL: nothing */

#endif
