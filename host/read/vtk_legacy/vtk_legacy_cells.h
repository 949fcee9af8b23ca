/* vtk_legacy_cells.h - the cells of VTK legacy files */
#ifndef VTK_LEGACY_CELLS_H
#define VTK_LEGACY_CELLS_H

#include "vtk_legacy/vtk_legacy_text.h"

/* CELLS, in both layouts, and CELL_TYPES. */
int legacy_cells(legacy *r);
int legacy_cell_types(legacy *r);

/* To be called when all sections of the geometry are read: checks every index, takes the faces of polyhedra. */
int legacy_check_cells(legacy *r);

#endif
