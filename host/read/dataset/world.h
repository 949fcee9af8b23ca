/* world.h - where a uniform grid lies: its matrix from index space to world, as the command line may change it */
#ifndef WORLD_H
#define WORLD_H

#include "dataset/request.h"

/* Applies the request to the matrix of a header, which may be any: --spacing becomes the length of the columns, whose
 * directions stay; a column without a direction gets that of its axis. --origin becomes the last column. STATUS_INPUT
 * unless the matrix is then finite and invertible. */
int world_complete(const read_request *request, const char *path, double matrix[3][4]);

/* Whether the matrix is finite and invertible. */
int world_spans(double matrix[3][4]);

/* The index, in general no whole number, that such a matrix puts at a point. */
void world_index(double matrix[3][4], const double point[3], double index[3]);

/* STATUS_INPUT: what has that name in the file has no direction for an axis, counted from 1. */
int world_no_direction(const char *path, const char *name, int axis);

#endif
