/* cell_types.h - VTK's types of cells by their numbers (vtkCellType.h) */
#ifndef CELL_TYPES_H
#define CELL_TYPES_H

#include <stdint.h>

/* "tetrahedron", "quadratic wedge", ...; NULL for a number that is no type. */
const char *cell_type_name(uint8_t type);

/* 0 to 3; of a number that is no type 0. */
int cell_type_dimension(uint8_t type);

/* Points of a cell; where a file gives it more, the first ones. 0: any number of points. It is 0 of all types of fewer
 * than three dimensions, too. */
int cell_type_points(uint8_t type);

/* Of a three-dimensional cell: how many of its points, the first ones, are its corners; 0: all of them. */
int cell_type_corners(uint8_t type);

#endif
