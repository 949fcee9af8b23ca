/*
 * tetrahedralize.h - making a tetrahedral complex in two passes over the cells: count, then write
 *
 * Several threads take cells in blocks. A block writes its tetrahedra behind those of all blocks before it, by prefix
 * sums: their order is that of the cells, whatever the number of threads.
 */
#ifndef TETRAHEDRALIZE_H
#define TETRAHEDRALIZE_H

#include "grid/origin.h"
#include "tetracubes.h"

#include <stdbool.h>

/* Counts of a block of cells. */
typedef struct cell_tally {
    uint64_t tetrahedra, flat, curved, blanked, inverted, folded, unsupported, surplus;
} cell_tally;

/* Where the tetrahedra of a block go; tetrahedra NULL: only counted. */
typedef struct tetrahedron_writer {
    uint32_t (*tetrahedra)[4];
    uint32_t *cells;
    cell_tally *tally;
} tetrahedron_writer;

/* Does cells [first, end); false where one of them cannot be cut, which only the first pass may find, or where memory
 * runs out. */
typedef bool block_function(const void *source, uint64_t first, uint64_t end, tetrahedron_writer *writer);

/* Zeroes the caller's complex. TC_ERROR_ARGUMENT, naming what, where its struct lacks the arrays. */
tc_status complex_begin(tc_tetrahedra *complex, const char *what);

/* Fills *complex, with its struct_size set. Where a block returns false: TC_ERROR_DATA, without a text, and *bad_cell
 * is the first cell of the first such block; in the second pass TC_ERROR_MEMORY. */
tc_status complex_make(block_function *block, const void *source, uint64_t cell_count, tc_tetrahedra *complex,
                       uint64_t *bad_cell);

/* Appends the tetrahedra of one cell to its block. */
void tetrahedra_put(tetrahedron_writer *writer, const uint32_t tetrahedra[][4], int count, uint64_t cell);

/* Six times the volume, positive where (v1 - v0) x (v2 - v0) . (v3 - v0) is. */
double tetrahedron_volume(coordinate_array points, const uint32_t tetrahedron[4]);

#endif
