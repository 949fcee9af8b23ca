/* cell_types.h - VTK's types of cells by their numbers (vtkCellType.h) */
#ifndef CELL_TYPES_H
#define CELL_TYPES_H

#include <stdint.h>

/* "tetrahedron", "quadratic wedge", ...; NULL for a number that is no type. */
const char *cell_type_name(uint8_t type);

/* 0 to 3; of a number that is no type 0. */
int cell_type_dimension(uint8_t type);

/* Points that a cell has, the first ones where it is given more; 0: any number, as of types of fewer than three
 * dimensions here. */
int cell_type_points(uint8_t type);

/* Of cells of three dimensions the corners, which are their first points; 0: all of its points. */
int cell_type_corners(uint8_t type);

#endif
